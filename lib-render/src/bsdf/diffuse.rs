//! Lambert's diffuse reflection, of both sides of a surface.
//!
//! - Parameters: albedo `kd` in [0, 1] per channel.
//! - f = kd/π per steradian where wi lies on the side of wo, 0 elsewhere; world frame.
//! - Sampling: cosine-weighted around the shading normal; a direction below the surface has weight 0.
//! - Source: Lambert 1760; Malley's method (Pharr, Jakob, Humphreys 2023, section A.5.3).

use std::f32::consts::FRAC_1_PI;

use jerboa_ir::lang::{Bool, F32};

use crate::bsdf::frame::Side;
use crate::bsdf::{Bsdf, BsdfSample, EvalFn, PdfFn, SampleFn};
use crate::core::color::{Color, black};
use crate::core::rng::Rng;
use crate::core::sampling::{cosine_hemisphere, cosine_hemisphere_pdf};
use crate::core::vec::{Vec3, vec2};
use crate::geometry::{Frame3, SurfaceElement};

/// Diffuse reflection.
pub fn make_diffuse_bsdf(surf: SurfaceElement, kd: Color) -> Bsdf {
    Bsdf {
        eval: EvalFn::lam(|_, (wi, wo)| {
            diffuse_is_seen(Side::new(surf, wo), wi).select(kd * F32::from(FRAC_1_PI), black())
        }),
        pdf: PdfFn::lam(|_, (wi, wo)| diffuse_pdf(Side::new(surf, wo), wi)),
        sample: SampleFn::lam(|_, (rng, wo)| {
            let side = Side::new(surf, wo);
            let wi = sample_diffuse(rng, side);
            BsdfSample {
                wi,
                weight: diffuse_is_seen(side, wi).select(kd, black()),
                pdf_dir: diffuse_pdf(side, wi),
                is_specular: false.into(),
                radiance_scale: 1.0.into(),
            }
        }),
        is_specular: false.into(),
    }
}

/// Does light from wi reach the viewer's side of the surface?
pub fn diffuse_is_seen(side: Side, wi: Vec3) -> Bool {
    side.reflects(wi) & side.normal.dot(wi).gt(0.0)
}

/// Does light from wi come through to the viewer's side of the surface?
pub fn diffuse_comes_through(side: Side, wi: Vec3) -> Bool {
    side.transmits(wi) & side.normal.dot(wi).lt(0.0)
}

/// Density of [`sample_diffuse`], per steradian.
pub fn diffuse_pdf(side: Side, wi: Vec3) -> F32 {
    cosine_hemisphere_pdf(side.normal.dot(wi))
}

/// A direction with density cos/π around the shading normal. Draws two numbers.
pub fn sample_diffuse(rng: Rng, side: Side) -> Vec3 {
    let ([u, v], _) = rng.pair();
    Frame3::around(side.normal).to_world(cosine_hemisphere(vec2(u, v)))
}
