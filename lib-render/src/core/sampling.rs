//! Warps of uniform numbers to shapes and directions. Directions are local, z is the axis.

use std::f32::consts::{FRAC_1_PI, TAU};

use jerboa_ir::lang::F32;

use crate::core::math::sincos_turns;
use crate::core::vec::{Vec2, Vec3, vec2, vec3};

/// Density of a direction chosen uniformly from the sphere, per steradian.
pub const UNIFORM_SPHERE_PDF: f32 = 1.0 / (4.0 * std::f32::consts::PI);

/// A point of the unit disk, uniform: 1/π per unit of area.
///
/// Source: Shirley & Chiu 1997, "A low distortion map between disk and square"; one sine and cosine for all four wedges.
pub fn concentric_disk(u: Vec2) -> Vec2 {
    let (x, y) = (u.x * 2.0 - 1.0, u.y * 2.0 - 1.0);
    let wide = x.abs().gt(y.abs());
    let r = wide.select(x, y);
    // The centre would be 0/0.
    let q = wide.select(y, x) / r.eq(0.0).select(1.0.into(), r);
    let turns = q * 0.125;
    let (sin, cos) = sincos_turns(wide.select(turns, 0.25 - turns));
    vec2(r * cos, r * sin)
}

/// A direction of the upper hemisphere with density cos/π (Malley's method: Pharr, Jakob, Humphreys 2023, section A.5.3).
/// Its z is at least 0, and above 0 but for a rounding at the rim.
pub fn cosine_hemisphere(u: Vec2) -> Vec3 {
    let d = concentric_disk(u);
    let z2 = 1.0 - d.x * d.x - d.y * d.y;
    vec3(d.x, d.y, z2.max(0.0).sqrt())
}

/// Density of [`cosine_hemisphere`] per steradian, 0 below the plane.
pub fn cosine_hemisphere_pdf(cos: F32) -> F32 {
    cos.max(0.0) * FRAC_1_PI
}

/// A number of (−1, 1) with density 1 − |x|, by its inversion, which keeps the order; `u` is in (0, 1).
pub fn tent(u: F32) -> F32 {
    let a = u * 2.0 - 1.0;
    (1.0 - (1.0 - a.abs()).sqrt()).copysign(a)
}

/// A direction of the sphere, uniform: [`UNIFORM_SPHERE_PDF`].
pub fn uniform_sphere(u: Vec2) -> Vec3 {
    cone_rim(u.x * 2.0, u.y)
}

/// A direction within the cone 1 − cos ≤ `one_minus_cos`, uniform: [`uniform_cone_pdf`]. The complement of the cosine is
/// asked for, since a narrow cone has none that can be told from 1 (N8).
pub fn uniform_cone(u: Vec2, one_minus_cos: F32) -> Vec3 {
    cone_rim(u.x * one_minus_cos, u.y)
}

/// Density of [`uniform_cone`] per steradian.
pub fn uniform_cone_pdf(one_minus_cos: F32) -> F32 {
    1.0 / (TAU * one_minus_cos)
}

/// The direction on the rim of the cone 1 − cos = `one_minus_cos`, `turns` around it.
pub fn cone_rim(one_minus_cos: F32, turns: F32) -> Vec3 {
    let (sin_phi, cos_phi) = sincos_turns(turns);
    let sin = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
    vec3(sin * cos_phi, sin * sin_phi, 1.0 - one_minus_cos)
}

/// a / (a + b), and 1 where both are 0.
pub fn share_of(a: F32, b: F32) -> F32 {
    let sum = a + b;
    sum.gt(0.0).select(a / sum, 1.0.into())
}
