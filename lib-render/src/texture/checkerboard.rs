//! The checkerboard of the paper, section 4.1.

use crate::core::color::Color;
use crate::image::Texel;
use crate::texture::Texture;

/// Unit squares, `even` where ⌊u⌋ + ⌊v⌋ is even, `odd` elsewhere; opaque.
pub fn make_checkerboard_texture(even: Color, odd: Color) -> Texture {
    Texture::lam(|_, uv| {
        let parity = (uv.x.floor().to_i32() + uv.y.floor().to_i32()) & 1;
        Texel { color: parity.eq(0).select(even, odd), alpha: 1.0.into() }
    })
}
