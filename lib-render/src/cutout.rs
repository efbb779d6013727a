//! Holes in surfaces: glTF's alpha modes, as part of intersection. A point of a surface that is not there is no hit, for a
//! shadow ray either; nor is a back face where a render [culls](crate::culling) it. Reads alpha and the side only.

use jerboa_ir::lang::{Block, Bool, F32, Row, U32};

use crate::core::rng::Stream;
use crate::core::vec::Vec2;
use crate::culling::is_culled;
use crate::cutout::blend::blended_is_there;
use crate::cutout::mask::masked_is_there;
use crate::geometry::triangle::Triangle;
use crate::schema::{ALPHA_MASK, ALPHA_OPAQUE, Geometries, Materials};
use crate::texture::look_up;
use crate::tracer::RayState;
use crate::traverse::AcceptFn;

pub mod blend;
pub mod mask;

/// Alpha of a material at these texture coordinates: factor times texture.
pub fn alpha(b: &mut Block, row: Row<Materials>, uv: [Vec2; 2]) -> F32 {
    let factor = row.get(Materials::BASE_A);
    b.if_(
        row.get(Materials::BASE_TEXTURED),
        |b| factor * look_up(b, row.get(Materials::BASE_TEXTURE), uv).alpha,
        |_| factor,
    )
}

/// Is there a surface at these texture coordinates, where its vertices have the alpha `vertices`?
pub fn is_there(
    b: &mut Block,
    row: Row<Materials>,
    (uv, vertices): ([Vec2; 2], F32),
    stream: Stream,
    vertex: U32,
    primitive: U32,
) -> Bool {
    let mode = row.get(Materials::ALPHA_MODE);
    b.if_(
        mode.eq(ALPHA_OPAQUE),
        |_| Bool::from(true),
        |b| {
            let alpha = alpha(b, row, uv) * vertices;
            b.if_(
                mode.eq(ALPHA_MASK),
                |_| masked_is_there(row, alpha),
                |_| blended_is_there(alpha, stream, vertex, primitive),
            )
        },
    )
}

/// Whether a hit of the ray that leads to vertex `state.vertex` counts. Two edges of one path need two vertices: with one,
/// a card crossed on the way to a surface would be open on the way on.
pub fn make_accept(state: RayState) -> AcceptFn {
    AcceptFn::lam(move |b, (ray, hit)| {
        let triangle = Triangle::of(b, hit);
        b.dispatch(triangle.geometry(), |b, row| {
            let material = row.get(Geometries::MATERIAL);
            let is_culled = is_culled(b, material, triangle, ray);
            let there = |b: &mut Block| {
                let at = (triangle.uv(b, row), triangle.alpha(b, row));
                is_there(b, material, at, state.rng, state.vertex, hit.primitive)
            };
            b.if_(is_culled, |_| Bool::from(false), there)
        })
    })
}
