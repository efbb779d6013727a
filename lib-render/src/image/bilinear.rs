//! The filter that looks at four texels.

use jerboa_ir::lang::{Block, F32, I32};

use crate::image::ImageFilter;
use crate::image::border::BorderHandling;

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
