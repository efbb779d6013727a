//! Scattering (paper, section 4.2). One file per model.

pub mod frame;
pub mod diffuse;

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Bool, F32, Fun};

use crate::core::color::Color;
use crate::core::rng::Rng;
use crate::core::vec::Vec3;

/// (wi, wo) → f, per steradian, without the cosine. Both unit, world frame, pointing away from the surface; `wi` towards
/// the light, `wo` towards the viewer. Perfectly specular parts give 0.
pub type EvalFn = Fun<(Vec3, Vec3), Color>;

/// (wi, wo) → density per steradian with which `sample` gives `wi`, specular parts left out.
pub type PdfFn = Fun<(Vec3, Vec3), F32>;

/// (rng, wo) → a direction. The position after it is not returned: dimensions are allotted by purpose.
pub type SampleFn = Fun<(Rng, Vec3), BsdfSample>;

/// Scattering at one surface point, world frame.
#[derive(Clone, Copy)]
pub struct Bsdf {
    /// Value.
    pub eval: EvalFn,
    /// Density.
    pub pdf: PdfFn,
    /// Direction.
    pub sample: SampleFn,
    /// Perfectly specular altogether: next event estimation is of no use.
    pub is_specular: Bool,
}
impl_staged!(Bsdf { eval, pdf, sample, is_specular });

/// A sampled direction.
#[derive(Clone, Copy)]
pub struct BsdfSample {
    /// Towards where the path goes on, unit, world.
    pub wi: Vec3,
    /// f · |cos| / pdf: what the path's throughput is multiplied with. Black where sampling failed; the rest is then
    /// unspecified but finite.
    pub weight: Color,
    /// What `pdf` gives for `wi`, per steradian; unspecified for a specular sample.
    pub pdf_dir: F32,
    /// Was it a perfectly specular event? (Light sampling could not have found it.)
    pub is_specular: Bool,
    /// (eta_i / eta_t)² of a refraction, which `weight` contains; 1 otherwise. Roulette divides it out (N22).
    pub radiance_scale: F32,
}
impl_staged!(BsdfSample { wi, weight, pdf_dir, is_specular, radiance_scale });
