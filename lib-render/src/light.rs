//! Lights (paper, section 4.3).

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Bool, F32, Fun, U32};

use crate::core::color::Color;
use crate::core::rng::Rng;
use crate::core::vec::{Vec2, Vec3};
use crate::material::EmissionValue;

/// A light as seen from a point: for next event estimation.
#[derive(Clone, Copy)]
pub struct DirectLightSample {
    /// Towards the light, unit, world.
    pub wi: Vec3,
    /// Point on the light, world, for lights that have a place; `point + wi · distance` otherwise.
    pub pos: Vec3,
    /// Bound on the absolute error of each coordinate of `pos`.
    pub error: Vec3,
    /// Distance to it, m; infinity for the environment and for parallel light.
    pub distance: F32,
    /// Radiance towards the point (area lights, environment); intensity / distance² or irradiance for the others.
    pub intensity: Color,
    /// Density per steradian at the receiving point, choice of the light included; for lights without extent the
    /// probability of the choice.
    pub pdf_dir: F32,
    /// No extent: only light sampling finds it, so its weight is 1.
    pub is_delta: Bool,
    /// Primitives that a shadow ray to it must not hit, or `NONE`.
    pub primitive: U32,
    /// The other half of a quad, or `NONE`.
    pub primitive1: U32,
}
impl_staged!(DirectLightSample { wi, pos, error, distance, intensity, pdf_dir, is_delta, primitive, primitive1 });

/// A ray that leaves a light: for light tracing.
#[derive(Clone, Copy)]
pub struct EmissionSample {
    /// Where it starts, world.
    pub pos: Vec3,
    /// Where it goes, unit, world.
    pub dir: Vec3,
    /// Radiance, or intensity for lights without extent.
    pub intensity: Color,
    /// Cosine at the light; 1 for lights without extent.
    pub cos: F32,
    /// Density of the point, per square metre, choice of the light included.
    pub pdf_area: F32,
    /// Density of the direction, per steradian.
    pub pdf_dir: F32,
}
impl_staged!(EmissionSample { pos, dir, intensity, cos, pdf_area, pdf_dir });

/// A light.
#[derive(Clone, Copy)]
pub struct Light {
    /// (rng, point) → a direction towards the light.
    pub sample_direct: Fun<(Rng, Vec3), DirectLightSample>,
    /// rng → a ray that leaves it.
    pub sample_emission: Fun<Rng, EmissionSample>,
    /// (direction away from the light, unit; barycentric weights or nothing) → emission.
    pub emission: Fun<(Vec3, Vec2), EmissionValue>,
    /// Can a ray hit it?
    pub has_area: Bool,
}
impl_staged!(Light { sample_direct, sample_emission, emission, has_area });
