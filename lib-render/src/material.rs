//! Materials: scattering and emission of a surface (paper, section 4.2).

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Bool, F32, Fun};

use crate::bsdf::Bsdf;
use crate::core::color::Color;
use crate::core::vec::Vec3;

/// What leaves a point of an emitter in a direction, and how likely the samplers find both.
#[derive(Clone, Copy)]
pub struct EmissionValue {
    /// Radiance, W/(m² sr).
    pub intensity: Color,
    /// Density of the point under light sampling, per square metre, the choice of the light included.
    pub pdf_area: F32,
    /// Density of the direction under emission sampling, per steradian.
    pub pdf_dir: F32,
}
impl_staged!(EmissionValue { intensity, pdf_area, pdf_dir });

/// (direction away from the surface) → emission.
pub type EmissionFn = Fun<Vec3, EmissionValue>;

/// The right-hand side of the rendering equation at a point: f and L_e.
#[derive(Clone, Copy)]
pub struct Material {
    /// Scattering.
    pub bsdf: Bsdf,
    /// Emission; asked for only where `is_emissive`.
    pub emission: EmissionFn,
    /// Does it emit?
    pub is_emissive: Bool,
    /// Unlit: the path ends here with `base` as emission.
    pub is_unlit: Bool,
    /// Base colour: what an unlit surface shows, and the albedo of the debug tracer.
    pub base: Color,
    /// Absorption coefficient behind the surface, 1/m; black where there is no absorbing volume.
    pub absorption: Color,
}
impl_staged!(Material { bsdf, emission, is_emissive, is_unlit, base, absorption });
