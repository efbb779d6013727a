//! Texture coordinates that a use of a texture moves, turns and scales.

use jerboa_ir::lang::{Block, Row};

use crate::core::vec::{Vec2, vec2};
use crate::schema::Textures;

/// KHR_texture_transform: the coordinates by the row's matrix, if it has one.
pub fn transform(b: &mut Block, row: Row<Textures>, uv: Vec2) -> Vec2 {
    let get = |column| row.get(column);
    let line = |m0, m1, m2| get(m0) * uv.x + get(m1) * uv.y + get(m2);
    b.if_(
        row.get(Textures::TRANSFORMED),
        |_| vec2(line(Textures::M00, Textures::M01, Textures::M02), line(Textures::M10, Textures::M11, Textures::M12)),
        |_| uv,
    )
}
