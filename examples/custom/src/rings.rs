//! Rings around the origin of the texture coordinates, of two colours in turn.

use jerboa_lib_render::components::{MakeTexture, Numbers, Own, Parameter};
use jerboa_lib_render::image::Texel;
use jerboa_lib_render::texture::Texture;

/// What scenes call it.
pub const NAME: &str = "rings";

/// The row to register.
pub const TEXTURE: Own<MakeTexture> = Own {
    name: NAME,
    parameters: &[
        Parameter { name: "width", default: &[0.1], range: (1e-3, 1e3) },
        Parameter { name: "even", default: &[1.0, 1.0, 1.0], range: (0.0, 1.0) },
        Parameter { name: "odd", default: &[0.0, 0.0, 0.0], range: (0.0, 1.0) },
    ],
    make: make_rings,
};

/// `even` up to a distance of `width` from the origin, then `odd`, and so on; opaque.
fn make_rings(numbers: Numbers) -> Texture {
    let (width, even, odd) = (numbers.number(0), numbers.color(1), numbers.color(4));
    Texture::lam(|_, uv| {
        let ring = ((uv.x * uv.x + uv.y * uv.y).sqrt() / width).floor().to_i32();
        Texel { color: (ring & 1).eq(0).select(even, odd), alpha: 1.0.into() }
    })
}
