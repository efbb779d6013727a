//! Images: texels, what lies beyond the border, and filters (paper, section 4.1).
//!
//! Texel (0, 0) covers [0, 1/width) × [0, 1/height) of the unit square; v = 0 is the top. Texel centres lie at half
//! integers. Coordinates may be anything: infinite ones and NaN read some texel.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, F32, Fun, I32, Row, U32};

use crate::core::color::{Color, color};
use crate::core::vec::Vec2;
use crate::schema::{FILTER_NEAREST, SrgbCurve, Texels, Textures, WRAP_CLAMP, WRAP_REPEAT};

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
    /// (column, row), both within the image → texel.
    pub texel: Fun<(I32, I32), Texel>,
    /// Columns, at least 1.
    pub width: I32,
    /// Rows, at least 1.
    pub height: I32,
}
impl_staged!(Image { texel, width, height });

/// What coordinates outside of the image mean, along one axis.
#[derive(Clone, Copy)]
pub struct BorderHandling {
    /// Coordinate → the same place in [0, 1], both ends included; 0 for NaN.
    pub fold: Fun<F32, F32>,
    /// (index from −1 to size, size) → index from 0 to size − 1 of the texel that continues the image there.
    pub index: Fun<(I32, I32), I32>,
}
impl_staged!(BorderHandling { fold, index });

/// (image, coordinates) → value.
pub type ImageFilter = Fun<(Image, Vec2), Texel>;

/// Border handling by its code, one of `WRAP_*`.
pub fn make_border(wrap: U32) -> BorderHandling {
    BorderHandling {
        fold: Fun::lam(|b, x| {
            b.if_(wrap.eq(WRAP_REPEAT), |_| repeat(x), |b| b.if_(wrap.eq(WRAP_CLAMP), |_| clamp(x), |_| mirror(x)))
        }),
        index: Fun::lam(|b, (i, size): (I32, I32)| {
            b.if_(wrap.eq(WRAP_REPEAT), |_| around(i, size), |_| within(i, size))
        }),
    }
}

/// x − ⌊x⌋. It is 1 for a tiny negative x: there the last texel ends.
fn repeat(x: F32) -> F32 {
    (x - x.floor()).max(0.0)
}

fn clamp(x: F32) -> F32 {
    x.max(0.0).min(1.0)
}

/// The distance from the nearest even integer.
fn mirror(x: F32) -> F32 {
    let m = x - 2.0 * (x * 0.5).floor();
    m.lt(1.0).select(m, 2.0 - m).max(0.0)
}

/// The index on a ring of this size, for i from −1 to size.
fn around(i: I32, size: I32) -> I32 {
    i.lt(0).select(i + size, i.ge(size).select(i - size, i))
}

/// The index in [0, size) nearest to i.
fn within(i: I32, size: I32) -> I32 {
    i.max(0).min(size - 1)
}

/// The texel that contains the point.
pub fn make_nearest_filter(u: BorderHandling, v: BorderHandling) -> ImageFilter {
    ImageFilter::lam(|b, (image, uv)| {
        let nearest = |b: &mut Block, border: BorderHandling, x: F32, size: I32| {
            let x = border.fold.call(b, x) * size.to_f32();
            // At x = 1 the last one.
            within(x.floor().to_i32(), size)
        };
        let column = nearest(b, u, uv.x, image.width);
        let row = nearest(b, v, uv.y, image.height);
        image.texel.call(b, (column, row))
    })
}

/// Bilinear between the four nearest texel centres.
pub fn make_bilinear_filter(u: BorderHandling, v: BorderHandling) -> ImageFilter {
    ImageFilter::lam(|b, (image, uv)| {
        let pair = |b: &mut Block, border: BorderHandling, x: F32, size: I32| {
            let x = border.fold.call(b, x) * size.to_f32() - 0.5;
            let (low, i) = (x.floor(), x.floor().to_i32());
            let first = border.index.call(b, (i, size));
            let second = border.index.call(b, (i + 1, size));
            (first, second, x - low)
        };
        let (x0, x1, kx) = pair(b, u, uv.x, image.width);
        let (y0, y1, ky) = pair(b, v, uv.y, image.height);
        let [t00, t10, t01, t11] = [(x0, y0), (x1, y0), (x0, y1), (x1, y1)].map(|at| image.texel.call(b, at));
        t00.lerp(t10, kx).lerp(t01.lerp(t11, kx), ky)
    })
}

/// The filter of a texture.
pub fn make_image_filter(row: Row<Textures>) -> ImageFilter {
    let (u, v) = (make_border(row.get(Textures::WRAP_U)), make_border(row.get(Textures::WRAP_V)));
    let (nearest, bilinear) = (make_nearest_filter(u, v), make_bilinear_filter(u, v));
    ImageFilter::lam(|b, at| {
        let is_nearest = row.get(Textures::FILTER).eq(FILTER_NEAREST);
        b.if_(is_nearest, |b| nearest.call(b, at), |b| bilinear.call(b, at))
    })
}

/// The image of a texture. Colours are decoded here, before any filter; alpha and data are code / 255.
pub fn make_image(row: Row<Textures>) -> Image {
    let texel = Fun::lam(|b, (x, y): (I32, I32)| {
        let at = row.get(Textures::OFFSET) + y.bits() * row.get(Textures::WIDTH) + x.bits();
        let rgba = Row::<Texels>::at(at).get(Texels::RGBA);
        let srgb = row.get(Textures::SRGB);
        let [r, g, blue] = [0u32, 8, 16].map(|shift| decode(b, srgb, (rgba >> shift) & 255));
        Texel { color: color(r, g, blue), alpha: unit(rgba >> 24) }
    });
    Image { texel, width: row.get(Textures::WIDTH).int_of_bits(), height: row.get(Textures::HEIGHT).int_of_bits() }
}

/// A code of a colour channel as linear value.
fn decode(b: &mut Block, srgb: Bool, code: U32) -> F32 {
    b.if_(srgb, |_| Row::<SrgbCurve>::at(code).get(SrgbCurve::LINEAR), |_| unit(code))
}

/// A code from 0 to 255 as a number in [0, 1].
fn unit(code: U32) -> F32 {
    code.to_f32() / 255.0
}
