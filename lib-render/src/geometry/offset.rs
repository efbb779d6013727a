//! Where rays start and end so that they do not hit the surface they leave (accuracy.md, N1).
//!
//! A point of a triangle is known up to a box of half width `error`. It is taken inward from the triangle's sides, so that
//! it is not beyond a wall that meets the triangle there ([`Triangle::point`](crate::geometry::triangle::Triangle::point)).
//! Then it is moved along the face normal until it is outside of that box, to the side where the ray goes, and each
//! coordinate is rounded away from the surface (Pharr, Jakob, Humphreys, *Physically Based Rendering*, 4th ed., 6.8.6).
//! There is no absolute length in it: a scene scaled by a power of two gives the same bits.

use jerboa_ir::lang::{F32, Row};

use crate::core::vec::Vec3;
use crate::geometry::SurfaceElement;
use crate::light::DirectLightSample;
use crate::ray::Ray;
use crate::schema::{NONE, Settings};

/// Share of the way to a light that shadow rays leave out, over the ray offset: that of Mitsuba 3 (`ShadowEpsilon`).
const LIGHT_OFFSET: f32 = 10.0;

/// A step of at least one unit in the last place: 2^-23 of a number.
const ULP: f32 = 1.0 / 8_388_608.0;

/// The point moved off its surface, to the side of `direction`. All in world coordinates; `normal` is unit, `error` bounds
/// the error of each coordinate, m.
pub fn offset_point(point: Vec3, error: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
    let distance = with_ray_offset(normal.abs().dot(error), |x, offset| x + (1.0 + point.abs().max_element()) * offset);
    let signed = normal.dot(direction).lt(0.0).select(-distance, distance);
    point.zip(normal * signed, |p, step| {
        let moved = p + step;
        let ulp = moved.abs() * ULP;
        step.gt(0.0).select(moved + ulp, step.lt(0.0).select(moved - ulp, moved))
    })
}

/// Where a ray that leaves the surface in this direction (world, any length) starts.
pub fn offset_origin(surf: SurfaceElement, direction: Vec3) -> Vec3 {
    offset_point(surf.start, surf.error, surf.face_normal, direction)
}

/// What becomes of a value if the render asks for a ray offset.
fn with_ray_offset(exact: F32, moved: impl Fn(F32, F32) -> F32) -> F32 {
    let settings = Row::<Settings>::at(0u32);
    settings.get(Settings::HAS_RAY_OFFSET).select(moved(exact, settings.get(Settings::RAY_OFFSET)), exact)
}

/// The ray that leaves the surface in a unit direction, without end.
pub fn spawn_ray(surf: SurfaceElement, direction: Vec3) -> Ray {
    let org = offset_origin(surf, direction);
    let none = NONE.into();
    Ray { org, dir: direction, tmax: F32::from(f32::INFINITY), skip: surf.primitive, skip1: none, skip2: none }
}

/// The shadow ray to a light. To a light that has a place it is aimed again from the moved origin, with a direction that
/// is not unit, and ends there exactly, at t = 1: both ends are moved, so no part of the way is left out. It does not see
/// the surface it starts on and the light. (With a ray offset, it ends a little before.)
pub fn spawn_shadow_ray(surf: SurfaceElement, light: DirectLightSample) -> Ray {
    let has_place = light.distance.lt(f32::INFINITY);
    let org = offset_origin(surf, light.wi);
    Ray {
        org,
        dir: has_place.select(light.pos - org, light.wi),
        tmax: has_place
            .select(with_ray_offset(1.0.into(), |x, offset| x - LIGHT_OFFSET * offset), f32::INFINITY.into()),
        skip: surf.primitive,
        skip1: light.primitive,
        skip2: light.primitive1,
    }
}
