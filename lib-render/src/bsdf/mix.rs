//! A blend of two BSDFs: (1 − k) a + k b. Either may have specular parts.
//!
//! - Parameters: weight k in [0, 1] of the second. As a model: `share` times the red channel of the material's base colour, whose
//!   texture can so be a mask; `first` and `second` are other materials, of which their scattering counts, with their own
//!   colours and textures. Normal map, emission, holes and the inside are those of the material itself.
//! - Sampling: the second with probability k. A specular sample keeps its weight, since its share of f is the share of
//!   samples; any other is weighed with the density of both, so that a specular part (density 0 here) takes nothing from
//!   the smooth one.
//! - Source: Veach 1997, section 9.2.4 (one-sample model, balance heuristic).

use jerboa_ir::lang::{Block, F32};

use crate::bsdf::frame::shading_cos;
use crate::bsdf::models::Model;
use crate::bsdf::{Bsdf, BsdfSample, EvalFn, PdfFn, SampleFn};
use crate::components::Parameter;
use crate::core::rng::{DIM_BLEND, DIM_BSDF, Rng};
use crate::geometry::SurfaceElement;
use crate::schema::Materials;

/// `blend`.
pub const MODEL: Model = Model {
    name: "blend",
    parameters: &[Parameter { name: "share", default: &[0.5], range: (0.0, 1.0) }],
    has_parts: true,
    make: |_, site| {
        // The parts are looked up where they are asked for: a kernel without blends then looks up nothing.
        let mix = |b: &mut Block| {
            let parts = [Materials::FIRST, Materials::SECOND].map(|which| site.part(b, which));
            // A part may draw as many numbers as a BSDF has.
            let draw = |rng: Rng| (rng.ahead(DIM_BLEND - DIM_BSDF).next().0, rng);
            mixed(site.surf, parts, site.numbers().number(0) * site.base.r, draw)
        };
        Bsdf {
            eval: EvalFn::lam(|b, w| mix(b).eval.call(b, w)),
            pdf: PdfFn::lam(|b, w| mix(b).pdf.call(b, w)),
            sample: SampleFn::lam(|b, w| mix(b).sample.call(b, w)),
            is_specular: false.into(),
        }
    },
};

/// The blend. It draws one number before its parts do.
pub fn make_mix_bsdf(surf: SurfaceElement, first: Bsdf, second: Bsdf, k: F32) -> Bsdf {
    mixed(surf, [first, second], k, Rng::next)
}

/// The blend whose choice of a part is drawn so.
fn mixed(surf: SurfaceElement, [first, second]: [Bsdf; 2], k: F32, draw: fn(Rng) -> (F32, Rng)) -> Bsdf {
    let eval = EvalFn::lam(|b, w| {
        let f = first.eval.call(b, w);
        f.lerp(second.eval.call(b, w), k)
    });
    let pdf = PdfFn::lam(|b, w| {
        let p = first.pdf.call(b, w);
        p * (1.0 - k) + second.pdf.call(b, w) * k
    });
    let sample = SampleFn::lam(|b, (rng, wo)| {
        let (u, rng) = draw(rng);
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
