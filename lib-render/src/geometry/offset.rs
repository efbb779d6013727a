//! Where rays start and end so that they do not hit the surface they leave (accuracy.md, N1).
//!
//! A point of a triangle is known up to a box of half width `error`. It is moved along the face normal until it is
//! outside of that box, to the side where the ray goes, and each coordinate is rounded away from the surface (Pharr,
//! Jakob, Humphreys, *Physically Based Rendering*, 4th ed., 6.8.6). There is no absolute length in it: a scene scaled by a
//! power of two gives the same bits.

use jerboa_ir::lang::{F32, U32};

use crate::core::vec::Vec3;
use crate::geometry::SurfaceElement;
use crate::ray::Ray;
use crate::schema::NONE;

/// A step of at least one unit in the last place: 2^-23 of a number.
const ULP: f32 = 1.0 / 8_388_608.0;

/// The point moved off its surface, to the side of `direction`. All in world coordinates; `normal` is unit, `error` bounds
/// the error of each coordinate, m.
pub fn offset_point(point: Vec3, error: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
    let distance = normal.abs().dot(error);
    let signed = normal.dot(direction).lt(0.0).select(-distance, distance);
    point.zip(normal * signed, |p, step| {
        let moved = p + step;
        step.eq(0.0).select(moved, moved + (moved.abs() * ULP).copysign(step))
    })
}

/// Where a ray that leaves the surface in this direction (world, any length) starts.
pub fn offset_origin(surf: SurfaceElement, direction: Vec3) -> Vec3 {
    offset_point(surf.point, surf.error, surf.face_normal, direction)
}

/// The ray that leaves the surface in a unit direction, without end.
pub fn spawn_ray(surf: SurfaceElement, direction: Vec3) -> Ray {
    let org = offset_origin(surf, direction);
    Ray { org, dir: direction, tmax: F32::from(f32::INFINITY), skip: surf.primitive, skip1: NONE.into() }
}

/// The shadow ray to a point that has been moved off its own surface already. Aimed again from the moved origin, with a
/// direction that is not unit, so that it ends there exactly: t = 1. It does not see the surface it starts on and the
/// primitive `target` it ends on.
pub fn spawn_shadow_ray(surf: SurfaceElement, end: Vec3, target: U32) -> Ray {
    let org = offset_origin(surf, end - surf.point);
    Ray { org, dir: end - org, tmax: 1.0.into(), skip: surf.primitive, skip1: target }
}
