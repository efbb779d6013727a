//! A blend of two BSDFs: (1 − k) a + k b. Either may have specular parts.
//!
//! - Parameters: weight k in [0, 1] of the second.
//! - Sampling: the second with probability k. A specular sample keeps its weight, since its share of f is the share of
//!   samples; any other is weighed with the density of both, so that a specular part (density 0 here) takes nothing from
//!   the smooth one.
//! - Source: Veach 1997, section 9.2.4 (one-sample model, balance heuristic).

use jerboa_ir::lang::F32;

use crate::bsdf::frame::shading_cos;
use crate::bsdf::{Bsdf, BsdfSample, EvalFn, PdfFn, SampleFn};
use crate::geometry::SurfaceElement;

/// The blend.
pub fn make_mix_bsdf(surf: SurfaceElement, first: Bsdf, second: Bsdf, k: F32) -> Bsdf {
    let eval = EvalFn::lam(|b, w| {
        let f = first.eval.call(b, w);
        f.lerp(second.eval.call(b, w), k)
    });
    let pdf = PdfFn::lam(|b, w| {
        let p = first.pdf.call(b, w);
        p * (1.0 - k) + second.pdf.call(b, w) * k
    });
    let sample = SampleFn::lam(|b, (rng, wo)| {
        let (u, rng) = rng.next();
        let one = b.if_(u.lt(k), |b| second.sample.call(b, (rng, wo)), |b| first.sample.call(b, (rng, wo)));
        b.if_(
            one.is_specular,
            |_| one,
            |b| {
                let f = eval.call(b, (one.wi, wo));
                let pdf = pdf.call(b, (one.wi, wo));
                let mixed = BsdfSample::scattered(one.wi, f * shading_cos(surf, one.wi), pdf);
                BsdfSample { radiance_scale: one.radiance_scale, ..mixed }
            },
        )
    });
    Bsdf { eval, pdf, sample, is_specular: first.is_specular & second.is_specular }
}
