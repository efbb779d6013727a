//! Scattering (paper, section 4.2). One file per model.

pub mod frame;
pub mod bent;
pub mod diffuse;
pub mod phong;
pub mod mirror;
pub mod dielectric;
pub mod mix;
pub mod rough;
pub mod gltf;
pub mod layer;
pub mod coat;
pub mod sheen;
pub mod gloss;
pub mod conductor;
pub mod rough_diffuse;
pub mod plastic;
pub mod thin_wall;
pub mod thin_glass;
pub mod models;

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Bool, F32, Fun, Staged, known};

use crate::core::color::{Color, black};
use crate::core::rng::Rng;
use crate::core::vec::Vec3;

/// (wi, wo) → f, per steradian, without the cosine: that of wi and the material's shading normal, after the normal map,
/// whatever normal the model used inside. Both unit, world frame, pointing away from the surface; `wi` towards
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
    /// finite, and `pdf_dir` 0 unless `pdf` counts such samples.
    pub weight: Color,
    /// What `pdf` gives for `wi`, per steradian; unspecified for a specular sample.
    pub pdf_dir: F32,
    /// Was it a perfectly specular event? (Light sampling could not have found it.)
    pub is_specular: Bool,
    /// (eta_i / eta_t)² of a refraction, which `weight` contains; 1 otherwise. Roulette divides it out (N22).
    pub radiance_scale: F32,
}
impl_staged!(BsdfSample { wi, weight, pdf_dir, is_specular, radiance_scale });

impl BsdfSample {
    /// A perfectly specular event.
    pub fn specular(wi: Vec3, weight: Color) -> BsdfSample {
        BsdfSample { wi, weight, pdf_dir: 1.0.into(), is_specular: true.into(), radiance_scale: 1.0.into() }
    }

    /// A direction with a density, and f times |cos| there.
    pub fn scattered(wi: Vec3, f_cos: Color, pdf: F32) -> BsdfSample {
        let weight = pdf.gt(0.0).select(f_cos / pdf, black());
        BsdfSample { wi, weight, pdf_dir: pdf, is_specular: false.into(), radiance_scale: 1.0.into() }
    }
}

impl Bsdf {
    /// Perfectly specular scattering: there is nothing to evaluate.
    pub fn specular(sample: SampleFn) -> Bsdf {
        Bsdf {
            eval: EvalFn::lam(|_, _| black()),
            pdf: PdfFn::lam(|_, _| F32::from(0.0)),
            sample,
            is_specular: true.into(),
        }
    }

    /// The same, whose functions stay functions but where the evaluator knows `what` decides what is left of them: a kernel that
    /// must be ready for every model asks each of them more than once, and would have all of it as often.
    pub fn whole_unless_known<T: Staged>(self, what: T) -> Bsdf {
        Bsdf {
            eval: EvalFn::rec("eval", |_| known(what), |b, _, w| self.eval.call(b, w)),
            pdf: PdfFn::rec("pdf", |_| known(what), |b, _, w| self.pdf.call(b, w)),
            sample: SampleFn::rec("sample", |_| known(what), |b, _, w| self.sample.call(b, w)),
            is_specular: self.is_specular,
        }
    }

    /// `then` where the condition holds, else `other`. The functions choose inside (Law 4).
    pub fn choose(condition: Bool, then: Bsdf, other: Bsdf) -> Bsdf {
        Bsdf {
            eval: EvalFn::lam(|b, w| b.if_(condition, |b| then.eval.call(b, w), |b| other.eval.call(b, w))),
            pdf: PdfFn::lam(|b, w| b.if_(condition, |b| then.pdf.call(b, w), |b| other.pdf.call(b, w))),
            sample: SampleFn::lam(|b, w| b.if_(condition, |b| then.sample.call(b, w), |b| other.sample.call(b, w))),
            is_specular: condition.select(then.is_specular, other.is_specular),
        }
    }
}
