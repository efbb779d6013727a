//! Physically corrected Phong reflection, on both sides of a surface; as a model, over Lambert's with the base colour.
//!
//! - Parameters: reflectance `ks` per channel, exponent `ns` ≥ 0; above 1e6 it is a mirror.
//! - f = ks (ns + 2)/2π · cosⁿˢ(wi, mirror image of wo) per steradian, 0 where wi lies below the surface.
//! - pdf = (ns + 1)/2π · cosⁿˢ, which also gives directions below the surface; those have weight 0.
//! - The power of the cosine is exp(ns · log1p(−d²/2)), d the distance of the two directions: 2e-6 relative up to
//!   ns = 1e6, where the power of a rounded cosine is off by 19 % (N6).
//! - Source: Lafortune & Willems 1994, "Using the modified Phong reflectance model for physically based rendering".

use std::f32::consts::TAU;

use jerboa_ir::lang::{Bool, F32};

use crate::bsdf::diffuse::make_diffuse_bsdf;
use crate::bsdf::frame::{Side, reflect, shading_cos};
use crate::bsdf::mix::make_mix_bsdf;
use crate::bsdf::models::Model;
use crate::bsdf::{Bsdf, BsdfSample, EvalFn, PdfFn, SampleFn};
use crate::components::Parameter;
use crate::core::color::{Color, black};
use crate::core::math::{exp, exp_m1, log, log1p};
use crate::core::rng::Rng;
use crate::core::sampling::cone_rim;
use crate::core::vec::Vec3;
use crate::geometry::{Frame3, SurfaceElement};

/// Exponent from which on the lobe counts as a mirror; decided here only.
const MIRROR_NS: f32 = 1e6;

/// `phong`: with the base colour as diffuse part at most 1 in all.
pub const MODEL: Model = Model {
    name: "phong",
    parameters: &[
        Parameter { name: "ks", default: &[0.5, 0.5, 0.5], range: (0.0, 1.0) },
        Parameter { name: "ns", default: &[10.0], range: (0.0, f32::MAX) },
    ],
    has_parts: false,
    make: |_, site| make_mixed_phong_bsdf(site.surf, site.base, site.numbers().color(0), site.numbers().number(3)),
};

/// Diffuse and Phong lobe, mixed by the luminance of their colours, as the paper's shader does.
pub fn make_mixed_phong_bsdf(surf: SurfaceElement, kd: Color, ks: Color, ns: F32) -> Bsdf {
    let (bright, dark) = (ks.luminance(), kd.luminance());
    let k = bright.gt(0.0).select(bright / (bright + dark), 0.0.into());
    make_mix_bsdf(surf, make_diffuse_bsdf(surf, kd), make_phong_bsdf(surf, ks, ns), k)
}

/// Phong reflection.
pub fn make_phong_bsdf(surf: SurfaceElement, ks: Color, ns: F32) -> Bsdf {
    let is_mirror = ns.gt(MIRROR_NS);
    let value = |wi: Vec3, wo: Vec3| {
        let side = Side::new(surf, wo);
        let f = ks * ((ns + 2.0) / TAU * power(mirrored(side, wo), wi, ns));
        is_seen(side, wi).select(f, black())
    };
    let density = |wi: Vec3, wo: Vec3| (ns + 1.0) / TAU * power(mirrored(Side::new(surf, wo), wo), wi, ns);
    Bsdf {
        eval: EvalFn::lam(|b, (wi, wo)| b.if_(is_mirror, |_| black(), |_| value(wi, wo))),
        pdf: PdfFn::lam(|b, (wi, wo)| b.if_(is_mirror, |_| F32::from(0.0), |_| density(wi, wo))),
        sample: SampleFn::lam(|b, (rng, wo)| {
            let side = Side::new(surf, wo);
            let axis = mirrored(side, wo);
            b.if_(
                is_mirror,
                |_| BsdfSample::specular(axis, side.reflects(axis).select(ks, black())),
                |_| {
                    let wi = sample_lobe(rng, axis, ns);
                    BsdfSample::scattered(wi, value(wi, wo) * shading_cos(surf, wi), density(wi, wo))
                },
            )
        }),
        is_specular: is_mirror,
    }
}

/// The axis of the lobe.
fn mirrored(side: Side, wo: Vec3) -> Vec3 {
    reflect(wo, side.bent_normal(wo))
}

fn is_seen(side: Side, wi: Vec3) -> Bool {
    side.reflects(wi) & side.normal.dot(wi).gt(0.0)
}

/// cosⁿˢ of the angle between two unit vectors, 0 from 90 degrees on.
fn power(axis: Vec3, wi: Vec3, ns: F32) -> F32 {
    let below = (wi - axis).length2() * 0.5;
    below.lt(1.0).select(exp(ns * log1p(-below)), 0.0.into())
}

/// A direction with density (ns + 1)/2π cosⁿˢ around the axis. Draws two numbers.
fn sample_lobe(rng: Rng, axis: Vec3, ns: F32) -> Vec3 {
    let ([u, turns], _) = rng.pair();
    // cos = u^(1/(ns+1)), by its distance from 1, which is all a narrow lobe has.
    let one_minus_cos = -exp_m1(log(1.0 - u) / (ns + 1.0));
    Frame3::around(axis).to_world(cone_rim(one_minus_cos, turns))
}
