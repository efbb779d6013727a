//! Minnaert's reflection: brighter, or darker, where it is seen or lit from the side.
//!
//! - Parameters: the base colour ρ, exponent `k` in [1, 8]; k = 1 is Lambert.
//! - f = ρ (k + 1)/2π · (cos wi cos wo)^(k−1) per steradian where wi lies on the side of wo, 0 elsewhere; world frame.
//! - What comes back of light that is the same from everywhere is ρ cos^(k−1) wo.
//! - Sampling: cosine-weighted.
//! - Source: Minnaert 1941, "The reciprocity principle in lunar photometry".

use std::f32::consts::TAU;

use jerboa_ir::lang::F32;
use jerboa_lib_render::bsdf::diffuse::{diffuse_is_seen, diffuse_pdf, sample_diffuse};
use jerboa_lib_render::bsdf::frame::{Side, shading_cos};
use jerboa_lib_render::bsdf::models::{Model, Site};
use jerboa_lib_render::bsdf::{Bsdf, BsdfSample, EvalFn, PdfFn, SampleFn};
use jerboa_lib_render::components::Parameter;
use jerboa_lib_render::core::color::black;
use jerboa_lib_render::core::math::{exp, log};
use jerboa_lib_render::core::vec::Vec3;

/// What materials call it.
pub const NAME: &str = "minnaert";

/// The row to register.
pub const MODEL: Model = Model {
    name: NAME,
    parameters: &[Parameter { name: "k", default: &[2.0], range: (1.0, 8.0) }],
    has_parts: false,
    make: |_, site| make_minnaert_bsdf(site, site.numbers().number(0)),
};

/// Minnaert's reflection.
pub fn make_minnaert_bsdf(site: Site, k: F32) -> Bsdf {
    let value = move |wi: Vec3, wo: Vec3| {
        let side = Side::new(site.surf, wo);
        let cosines = (side.normal.dot(wi) * side.normal.dot(wo)).abs();
        let power = exp((k - 1.0) * log(cosines.max(f32::MIN_POSITIVE)));
        diffuse_is_seen(side, wi).select(site.base * ((k + 1.0) / TAU * power), black())
    };
    Bsdf {
        eval: EvalFn::lam(|_, (wi, wo)| value(wi, wo)),
        pdf: PdfFn::lam(|_, (wi, wo)| diffuse_pdf(Side::new(site.surf, wo), wi)),
        sample: SampleFn::lam(|_, (rng, wo)| {
            let side = Side::new(site.surf, wo);
            let wi = sample_diffuse(rng, side);
            BsdfSample::scattered(wi, value(wi, wo) * shading_cos(site.surf, wi), diffuse_pdf(side, wi))
        }),
        is_specular: false.into(),
    }
}
