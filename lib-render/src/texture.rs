//! Textures: values over texture coordinates (paper, section 4.1).

use jerboa_ir::lang::{Block, Fun, Row};

use crate::components::{Components, Numbers};
use crate::core::color::{Color, color};
use crate::core::vec::{Vec2, vec2};
use crate::image::{Texel, make_image, make_image_filter};
use crate::schema::{TEXTURE_CHECKERBOARD, TEXTURE_OWN, Textures};

/// Texture coordinates → value.
pub type Texture = Fun<Vec2, Texel>;

/// Unit squares, `even` where ⌊u⌋ + ⌊v⌋ is even, `odd` elsewhere; opaque.
pub fn make_checkerboard_texture(even: Color, odd: Color) -> Texture {
    Texture::lam(|_, uv| {
        let parity = (uv.x.floor().to_i32() + uv.y.floor().to_i32()) & 1;
        Texel { color: parity.eq(0).select(even, odd), alpha: 1.0.into() }
    })
}

/// The texture that a row describes.
pub fn make_texture(row: Row<Textures>) -> Texture {
    let get = |column| row.get(column);
    let even = color(get(Textures::EVEN_R), get(Textures::EVEN_G), get(Textures::EVEN_B));
    let odd = color(get(Textures::ODD_R), get(Textures::ODD_G), get(Textures::ODD_B));
    let checkerboard = make_checkerboard_texture(even, odd);
    let (image, filter) = (make_image(row), make_image_filter(row));
    Texture::lam(|b, uv| {
        let uv = transform(b, row, uv);
        let kind = row.get(Textures::KIND);
        let looked_up = |b: &mut Block| {
            b.if_(kind.eq(TEXTURE_CHECKERBOARD), |b| checkerboard.call(b, uv), |b| filter.call(b, (image, uv)))
        };
        own_or(b, row, uv, 0, looked_up)
    })
}

/// What the texture of a user's crate gives whose row it is, from this one on, or else the other.
fn own_or(b: &mut Block, row: Row<Textures>, uv: Vec2, own: u32, other: impl FnOnce(&mut Block) -> Texel) -> Texel {
    let Some(texture) = Components::current().textures().get(own as usize).copied() else {
        return other(b);
    };
    b.if_(
        row.get(Textures::KIND).eq(TEXTURE_OWN + own),
        |b| (texture.make)(Numbers(row.get(Textures::NUMBERS))).call(b, uv),
        |b| own_or(b, row, uv, own + 1, other),
    )
}

/// What the texture gives at a surface with these two sets of coordinates.
pub fn look_up(b: &mut Block, row: Row<Textures>, uv: [Vec2; 2]) -> Texel {
    let set = row.get(Textures::UV_SET).eq(0u32).select(uv[0], uv[1]);
    make_texture(row).call(b, set)
}

/// KHR_texture_transform.
fn transform(b: &mut Block, row: Row<Textures>, uv: Vec2) -> Vec2 {
    let get = |column| row.get(column);
    let line = |m0, m1, m2| get(m0) * uv.x + get(m1) * uv.y + get(m2);
    b.if_(
        row.get(Textures::TRANSFORMED),
        |_| vec2(line(Textures::M00, Textures::M01, Textures::M02), line(Textures::M10, Textures::M11, Textures::M12)),
        |_| uv,
    )
}
