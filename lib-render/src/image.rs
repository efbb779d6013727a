//! Images: texels, what lies beyond the border, and filters (paper, section 4.1).
//!
//! Texel (0, 0) covers [0, 1/width) × [0, 1/height) of the unit square; v = 0 is the top. Texel centres lie at half
//! integers. Coordinates may be anything: infinite ones and NaN read some texel.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, F32, Fun, I32, Row, U32};

use crate::core::color::{Color, color};
use crate::core::vec::Vec2;
use crate::schema::{
    FILTER_BICUBIC, FILTER_NEAREST, SrgbCurve, Texels, Textures, WRAP_BORDER, WRAP_CLAMP, WRAP_MIRROR, WRAP_REPEAT,
};
use crate::texture::Lookup;

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

/// What coordinates outside of the image mean, along one axis.
#[derive(Clone, Copy)]
pub struct BorderHandling {
    /// Coordinate → the same place in [0, 1], both ends included; 0 for NaN. With a border it is in [−2, 3], −2 for NaN, and
    /// outside of the image if the coordinate is.
    pub fold: Fun<F32, F32>,
    /// (index from −1 to size, size) → index from 0 to size − 1 of the texel that continues the image there.
    pub index: Fun<(I32, I32), I32>,
    /// The same for what reaches two texels far: nothing changes any more beyond −2 and 3, or it is folded to [0, 1].
    pub far_fold: Fun<F32, F32>,
    /// (any index that `far_fold` leads to, size) → index from 0 to size − 1, or as it is.
    pub far_index: Fun<(I32, I32), I32>,
    /// Does the image not go on outside? Then an index stands for itself.
    pub is_border: Bool,
}
impl_staged!(BorderHandling { fold, index, far_fold, far_index, is_border });

impl BorderHandling {
    /// The index of the nearest texel, or of the border.
    fn nearest(self, i: I32, size: I32) -> I32 {
        self.is_border.select(i, within(i, size))
    }
}

/// (image, coordinates) → value.
pub type ImageFilter = Fun<(Image, Vec2), Texel>;

/// Border handling by its code, one of `WRAP_*`.
pub fn make_border(wrap: U32) -> BorderHandling {
    let is_border = is_border(wrap);
    let nearest = move |i: I32, size: I32| is_border.select(i, within(i, size));
    BorderHandling {
        fold: Fun::lam(|b, x: F32| {
            let mirror_or_border = |b: &mut Block| b.if_(is_border, |_| clamp_far(x), |_| mirror(x));
            b.if_(wrap.eq(WRAP_REPEAT), |_| repeat(x), |b| b.if_(wrap.eq(WRAP_CLAMP), |_| clamp(x), mirror_or_border))
        }),
        index: Fun::lam(|b, (i, size): (I32, I32)| {
            b.if_(wrap.eq(WRAP_REPEAT), |_| around(i, size), |_| nearest(i, size))
        }),
        far_fold: Fun::lam(|b, x: F32| {
            let mirror_or_not = |b: &mut Block| b.if_(wrap.eq(WRAP_MIRROR), |_| mirror(x), |_| clamp_far(x));
            b.if_(wrap.eq(WRAP_REPEAT), |_| repeat(x), mirror_or_not)
        }),
        far_index: Fun::lam(|b, (i, size): (I32, I32)| {
            let mirrored = wrap.eq(WRAP_MIRROR).select(reflect(i, size), i);
            // The ring of one texel goes round twice.
            b.if_(wrap.eq(WRAP_REPEAT), |_| around(around(i, size), size), |_| nearest(mirrored, size))
        }),
        is_border,
    }
}

/// Is this the border's code?
fn is_border(wrap: U32) -> Bool {
    Lookup::Border.is_used() & wrap.eq(WRAP_BORDER)
}

/// x − ⌊x⌋. It is 1 for a tiny negative x: there the last texel ends.
fn repeat(x: F32) -> F32 {
    (x - x.floor()).max(0.0)
}

fn clamp(x: F32) -> F32 {
    x.max(0.0).min(1.0)
}

/// To two texels beyond an image of one texel, in which a filter as wide as four texels sees nothing of the image.
fn clamp_far(x: F32) -> F32 {
    x.max(-2.0).min(3.0)
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

/// The index in the mirror image, for i beyond either end.
fn reflect(i: I32, size: I32) -> I32 {
    i.lt(0).select(-1 - i, i.ge(size).select(size + size - 1 - i, i))
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
            border.nearest(x.floor().to_i32(), size)
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

/// The four texels that a cubic spline weighs along an axis, and their weights as those of linear interpolations: between the
/// first two, between the last two, and between what these give.
struct Four {
    indices: [I32; 4],
    first: F32,
    last: F32,
    both: F32,
}

impl Four {
    /// Those around coordinate `x` of an axis of `size` texels.
    fn around(b: &mut Block, border: BorderHandling, x: F32, size: I32) -> Four {
        let x = border.far_fold.call(b, x) * size.to_f32() - 0.5;
        let (i, t) = (x.floor().to_i32(), x - x.floor());
        let s = 1.0 - t;
        let outer = |t: F32| t * t * t / 6.0;
        let inner = |t: F32| (4.0 - t * t * (6.0 - 3.0 * t)) / 6.0;
        let indices = [-1, 0, 1, 2].map(|n| border.far_index.call(b, (i + n, size)));
        let (low, high) = (outer(s) + inner(t), inner(s) + outer(t));
        Four { indices, first: inner(t) / low, last: outer(t) / high, both: high }
    }

    /// The spline through what stands at the four indices.
    fn weigh(&self, b: &mut Block, mut at: impl FnMut(&mut Block, I32) -> Texel) -> Texel {
        let [t0, t1, t2, t3] = self.indices.map(|i| at(b, i));
        t0.lerp(t1, self.first).lerp(t2.lerp(t3, self.last), self.both)
    }
}

/// The sixteen nearest texels, weighed by cubic B-splines along both axes: smooth to the second derivative, and within the range
/// of the texels, as reflectances have to be. It blurs; what meets the texels at their centres (Catmull-Rom) leaves that range.
///
/// Source: Mitchell & Netravali 1988, "Reconstruction filters in computer graphics", B = 1, C = 0; as linear interpolations,
/// which keep to the range in spite of rounding, Sigg & Hadwiger 2005, "Fast third-order texture filtering".
pub fn make_bicubic_filter(u: BorderHandling, v: BorderHandling) -> ImageFilter {
    ImageFilter::lam(|b, (image, uv)| {
        let columns = Four::around(b, u, uv.x, image.width);
        let rows = Four::around(b, v, uv.y, image.height);
        rows.weigh(b, |b, y| columns.weigh(b, |b, x| image.texel.call(b, (x, y))))
    })
}

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
        let is_outside = x.lt(0) | x.ge(width) | y.lt(0) | y.ge(height);
        // What is read outside is some texel, and not used.
        let texel = stored.call(b, (x, y));
        (is_border(row.get(Textures::WRAP_U)) & is_outside).select(border_texel(row), texel)
    });
    Image { texel, width, height }
}

/// What is outside of an image with a border.
fn border_texel(row: Row<Textures>) -> Texel {
    let [r, g, b, alpha] =
        [Textures::BORDER_R, Textures::BORDER_G, Textures::BORDER_B, Textures::BORDER_A].map(|column| row.get(column));
    Texel { color: color(r, g, b), alpha }
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
