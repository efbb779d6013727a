//! A layer over another BSDF: f = what the layer scatters by itself + what is under it · passes(wi, wo).
//!
//! - Reciprocal if both parts are and `passes` is the same with its directions exchanged. No light is gained if `passes` is
//!   nowhere above what the layer's own scattering leaves of the light of either direction.
//! - Sampling: the layer with probability `choice`, in a dimension of its own, else what is under it. A specular sample
//!   keeps its weight, since its share of f is the share of samples; any other is weighed with the density of both, but for
//!   one that failed (density 0).
//! - Source: Veach 1997, section 9.2.4 (one-sample model, balance heuristic).

use jerboa_ir::lang::{Bool, F32, Fun};

use crate::bsdf::frame::shading_cos;
use crate::bsdf::{Bsdf, BsdfSample, EvalFn, PdfFn, SampleFn};
use crate::core::rng::{DIM_BSDF, DIM_LAYERS};
use crate::core::vec::Vec3;
use crate::geometry::SurfaceElement;

/// What lies over a BSDF.
#[derive(Clone, Copy)]
pub struct Layer {
    /// Is there such a layer at all?
    pub present: Bool,
    /// Which of the layers of a surface it is, the lowest 0: the dimension in which it is chosen.
    pub number: u32,
    /// What it scatters by itself; f relative to the cosine of the surface's shading normal.
    pub bsdf: Bsdf,
    /// (wi, wo) → share of light that passes it on both ways.
    pub passes: Fun<(Vec3, Vec3), F32>,
    /// wo → probability of sampling it rather than what is under it.
    pub choice: Fun<Vec3, F32>,
}

/// The layer over `base`; without the layer, `base`.
pub fn make_layered_bsdf(surf: SurfaceElement, layer: Layer, base: Bsdf) -> Bsdf {
    let eval = EvalFn::lam(|b, w| {
        let under = base.eval.call(b, w);
        b.if_(
            layer.present,
            |b| {
                let own = layer.bsdf.eval.call(b, w);
                own + under * layer.passes.call(b, w)
            },
            |_| under,
        )
    });
    let pdf = PdfFn::lam(|b, (wi, wo)| {
        let under = base.pdf.call(b, (wi, wo));
        b.if_(
            layer.present,
            |b| {
                let choice = layer.choice.call(b, wo);
                let own = layer.bsdf.pdf.call(b, (wi, wo));
                under * (1.0 - choice) + own * choice
            },
            |_| under,
        )
    });
    let sample = SampleFn::lam(|b, (rng, wo)| {
        let choice = b.if_(layer.present, |b| layer.choice.call(b, wo), |_| F32::from(0.0));
        let (u, _) = rng.ahead(DIM_LAYERS - DIM_BSDF + layer.number).next();
        let one = b.if_(
            layer.present & u.lt(choice),
            |b| {
                let own = layer.bsdf.sample.call(b, (rng, wo));
                BsdfSample { weight: own.weight / choice, ..own }
            },
            |b| {
                let under = base.sample.call(b, (rng, wo));
                b.if_(
                    layer.present,
                    |b| {
                        let passes = layer.passes.call(b, (under.wi, wo));
                        BsdfSample { weight: under.weight * (passes / (1.0 - choice)), ..under }
                    },
                    |_| under,
                )
            },
        );
        b.if_(
            layer.present & !one.is_specular & one.pdf_dir.gt(0.0),
            |b| {
                let f = eval.call(b, (one.wi, wo));
                let pdf = pdf.call(b, (one.wi, wo));
                let both = BsdfSample::scattered(one.wi, f * shading_cos(surf, one.wi), pdf);
                BsdfSample { radiance_scale: one.radiance_scale, ..both }
            },
            |_| one,
        )
    });
    Bsdf { eval, pdf, sample, is_specular: base.is_specular & (!layer.present | layer.bsdf.is_specular) }
}
