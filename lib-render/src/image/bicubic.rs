//! The filter that looks at sixteen texels.

use jerboa_ir::lang::{Block, F32, I32};

use crate::image::border::BorderHandling;
use crate::image::{ImageFilter, Texel};

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
