//! Absorption: what is left of light on its way through the volumes of a scene.

use jerboa_ir::lang::{Block, F32};

use crate::core::color::{Color, black};
use crate::core::math::exp;
use crate::core::vec::Vec3;
use crate::geometry::SurfaceElement;
use crate::material::Material;
use crate::ray::{Hit, Ray};
use crate::schema::Settings;
use crate::tracer::{RayState, settings};

/// Throughput at a hit: what absorption leaves along the ray.
pub(super) fn arriving(b: &mut Block, state: RayState, hit: Hit) -> Color {
    after(b, state.throughput, state.absorption, hit.t)
}

/// Throughput at what a vertex asks for, a light or the camera, in a direction and at a distance: what absorption leaves
/// along the ray and on the way from the vertex.
pub(super) fn reaching(
    b: &mut Block,
    (ray, hit, state): (Ray, Hit, RayState),
    surf: SurfaceElement,
    mat: Material,
    wi: Vec3,
    distance: F32,
) -> Color {
    let light = arriving(b, state, hit);
    after(b, light, absorption_along(state, surf, mat, -ray.dir, wi), distance)
}

/// Throughput of a ray that comes from infinitely far away: nothing is left where it went through what absorbs.
pub(super) fn from_afar(b: &mut Block, state: RayState) -> Color {
    let left = |light: F32, sigma: F32| sigma.gt(0.0).select(0.0.into(), light);
    b.if_(settings().get(Settings::HAS_VOLUMES), |_| state.throughput.zip(state.absorption, left), |_| state.throughput)
}

/// Light after a distance through what absorbs.
fn after(b: &mut Block, light: Color, absorption: Color, distance: F32) -> Color {
    b.if_(
        settings().get(Settings::HAS_VOLUMES),
        |_| light * absorption.map(|sigma| exp(-sigma.absorb(distance))),
        |_| light,
    )
}

/// Absorption along the next ray: a ray that enters meets the volume of this surface, one that leaves meets none, one
/// that is reflected what it met before.
pub(super) fn absorption_along(state: RayState, surf: SurfaceElement, mat: Material, wo: Vec3, wi: Vec3) -> Color {
    let crosses = (surf.face_cos(wo) * surf.face_cos(wi)).lt(0.0);
    let beyond = surf.is_behind(wi).select(mat.absorption, black());
    let has_volumes = settings().get(Settings::HAS_VOLUMES);
    has_volumes.select(crosses.select(beyond, state.absorption), black())
}
