//! The filter that looks at one texel.

use jerboa_ir::lang::{Block, F32, I32};

use crate::image::ImageFilter;
use crate::image::border::BorderHandling;

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
