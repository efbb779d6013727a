//! Images: texels, and how one is looked up (paper, section 4.1). One file per filter; what lies outside is a [`border`].
//!
//! Texel (0, 0) covers [0, 1/width) × [0, 1/height) of the unit square; v = 0 is the top. Texel centres lie at half
//! integers. Coordinates may be anything: infinite ones and NaN read some texel.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, F32, Fun, I32, Row, U32};

use crate::core::color::{Color, color};
use crate::core::vec::Vec2;
use crate::image::bicubic::make_bicubic_filter;
use crate::image::bilinear::make_bilinear_filter;
use crate::image::border::{constant, make_border};
use crate::image::nearest::make_nearest_filter;
use crate::schema::{FILTER_BICUBIC, FILTER_NEAREST, SrgbCurve, Texels, Textures};
use crate::texture::Lookup;

pub mod bicubic;
pub mod bilinear;
pub mod border;
pub mod nearest;

/// What a texture gives at a point.
#[derive(Clone, Copy)]
pub struct Texel {
    /// Linear RGB.
    pub color: Color,
    /// Alpha, in [0, 1].
    pub alpha: F32,
}
impl_staged!(Texel { color, alpha });

impl Texel {
    /// (1 − k) self + k other
    pub fn lerp(self, other: Texel, k: F32) -> Texel {
        let alpha = self.alpha * (1.0 - k) + other.alpha * k;
        Texel { color: self.color.lerp(other.color, k), alpha }
    }
}

/// An image.
#[derive(Clone, Copy)]
pub struct Image {
    /// (column, row), both within the image → texel. Outside of it is the border, if the image has one.
    pub texel: Fun<(I32, I32), Texel>,
    /// Columns, at least 1.
    pub width: I32,
    /// Rows, at least 1.
    pub height: I32,
}
impl_staged!(Image { texel, width, height });

/// (image, coordinates) → value.
pub type ImageFilter = Fun<(Image, Vec2), Texel>;

/// The filter of a texture.
pub fn make_image_filter(row: Row<Textures>) -> ImageFilter {
    let (u, v) = (make_border(row.get(Textures::WRAP_U)), make_border(row.get(Textures::WRAP_V)));
    let nearest = make_nearest_filter(u, v);
    let (bilinear, bicubic) = (make_bilinear_filter(u, v), make_bicubic_filter(u, v));
    ImageFilter::lam(|b, at| {
        let filter = row.get(Textures::FILTER);
        let is_bicubic = Lookup::Bicubic.is_used() & filter.eq(FILTER_BICUBIC);
        let smooth = |b: &mut Block| b.if_(is_bicubic, |b| bicubic.call(b, at), |b| bilinear.call(b, at));
        b.if_(filter.eq(FILTER_NEAREST), |b| nearest.call(b, at), smooth)
    })
}

/// The image of a texture, with its border.
pub fn make_image(row: Row<Textures>) -> Image {
    let (width, height) = (row.get(Textures::WIDTH).int_of_bits(), row.get(Textures::HEIGHT).int_of_bits());
    let stored = make_stored_texel(row);
    let texel = Fun::lam(|b, (x, y): (I32, I32)| {
        let is_outside = constant::is_outside((x, y), (width, height));
        // What is read outside is some texel, and not used.
        let texel = stored.call(b, (x, y));
        (constant::is_chosen(row.get(Textures::WRAP_U)) & is_outside).select(constant::texel(row), texel)
    });
    Image { texel, width, height }
}

/// The texels that are stored. Colours are decoded here, before any filter; alpha and data are code / 255.
fn make_stored_texel(row: Row<Textures>) -> Fun<(I32, I32), Texel> {
    Fun::lam(|b, (x, y): (I32, I32)| {
        let at = row.get(Textures::OFFSET) + y.bits() * row.get(Textures::WIDTH) + x.bits();
        let rgba = Row::<Texels>::at(at).get(Texels::RGBA);
        let srgb = row.get(Textures::SRGB);
        let [r, g, blue] = [0u32, 8, 16].map(|shift| decode(b, srgb, (rgba >> shift) & 255));
        Texel { color: color(r, g, blue), alpha: unit(rgba >> 24) }
    })
}

/// A code of a colour channel as linear value.
fn decode(b: &mut Block, srgb: Bool, code: U32) -> F32 {
    b.if_(srgb, |_| Row::<SrgbCurve>::at(code).get(SrgbCurve::LINEAR), |_| unit(code))
}

/// A code from 0 to 255 as a number in [0, 1].
fn unit(code: U32) -> F32 {
    code.to_f32() / 255.0
}
