//! Rough diffuse reflection that keeps all energy, on both sides of a surface: sand, plaster, the moon.
//!
//! - Parameters: the base colour ρ in [0, 1], the albedo of a facet; roughness r in [0, 1], where 0 is Lambert.
//! - f = ρ/π · A (1 + r s/t) + m/π · (1 − E(wi)) (1 − E(wo)) / (1 − Ē) per steradian where wi lies on the side of wo, 0
//!   elsewhere; world frame. s = wi·wo − cos wi cos wo, t = max(cos wi, cos wo) where s > 0, else 1; A = 1 / (1 + c₁ r);
//!   E and Ē are the albedos of the first term with ρ = 1, and m = ρ² Ē / (1 − ρ (1 − Ē)): a white surface returns all light.
//! - Exact and reciprocal; Oren and Nayar's model loses light and is not smooth.
//! - Sampling: cosine-weighted around the shading normal, density cos/π. A weight is below 1 + r / cos wo.
//! - Source: Portsmouth, Kutz, Hill 2025, "EON: A practical energy-preserving rough diffuse BRDF".

use std::f32::consts::{FRAC_1_PI, PI};

use jerboa_ir::lang::F32;

use crate::bsdf::diffuse::{diffuse_is_seen, diffuse_pdf, sample_diffuse};
use crate::bsdf::frame::{Side, shading_cos};
use crate::bsdf::models::Model;
use crate::bsdf::{Bsdf, BsdfSample, EvalFn, PdfFn, SampleFn};
use crate::core::color::{Color, black};
use crate::core::math::acos;
use crate::core::vec::Vec3;
use crate::geometry::SurfaceElement;

/// `rough-diffuse`.
pub const MODEL: Model = Model {
    name: "rough-diffuse",
    parameters: &[],
    has_parts: false,
    make: |b, site| {
        let roughness = site.roughness(b);
        make_rough_diffuse_bsdf(site.surf, site.base, roughness)
    },
};

/// 1/2 − 2/(3π): how much a grazing view gains by roughness, over A.
const C1: f32 = 0.5 - 2.0 / (3.0 * PI);
/// 2/3 − 28/(15π): the same on average.
const C2: f32 = 2.0 / 3.0 - 28.0 / (15.0 * PI);

/// Rough diffuse reflection.
pub fn make_rough_diffuse_bsdf(surf: SurfaceElement, rho: Color, r: F32) -> Bsdf {
    let value = move |wi: Vec3, wo: Vec3| {
        let side = Side::new(surf, wo);
        diffuse_is_seen(side, wi).select(reflection(side, wi, wo, rho, r), black())
    };
    Bsdf {
        eval: EvalFn::lam(|_, (wi, wo)| value(wi, wo)),
        pdf: PdfFn::lam(|_, (wi, wo)| diffuse_pdf(Side::new(surf, wo), wi)),
        sample: SampleFn::lam(|_, (rng, wo)| {
            let side = Side::new(surf, wo);
            let wi = sample_diffuse(rng, side);
            BsdfSample::scattered(wi, value(wi, wo) * shading_cos(surf, wi), diffuse_pdf(side, wi))
        }),
        is_specular: false.into(),
    }
}

/// f of two directions on one side.
fn reflection(side: Side, wi: Vec3, wo: Vec3, rho: Color, r: F32) -> Color {
    let (i, o) = (side.normal.dot(wi), side.normal.dot(wo));
    // wo may be below the shading normal; s is a product of sines and a cosine all the same.
    let (s, i, o) = (wi.dot(wo) - i * o, i.abs(), o.abs());
    let a = 1.0 / (1.0 + C1 * r);
    let single = a * (1.0 + r * s.gt(0.0).select(s / i.max(o), s)).max(0.0);
    // 1 − E is a r (c₁ − G/π), and 1 − Ē is a r (c₁ − c₂): so nothing is divided by 0 where r is.
    let lost = a * r * (missing(i) * missing(o)) / (C1 - C2);
    let average = 1.0 - a * r * (C1 - C2);
    rho.map(|rho| {
        let again = rho * average / (1.0 - rho * (1.0 - average));
        rho * (single + again * lost) * FRAC_1_PI
    })
}

/// c₁ − G/π, at least 0: G is what roughness adds to the albedo at this cosine.
fn missing(cos: F32) -> F32 {
    let cos = cos.min(1.0);
    let sin2 = 1.0 - cos * cos;
    let sin = sin2.sqrt();
    // (1 − sin³) / cos without the quotient of two small numbers.
    let tail = cos * (1.0 + sin + sin2) / (1.0 + sin);
    let g = sin * (acos(cos) - sin * cos) + (2.0 / 3.0) * (sin * tail - sin);
    (C1 - g * FRAC_1_PI).max(0.0)
}
