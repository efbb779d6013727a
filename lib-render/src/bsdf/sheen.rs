//! The sheen of cloth, as KHR_materials_sheen describes it: a layer of fibres that stand up, over anything.
//!
//! - Parameters: colour C, roughness r in [0, 1], α = r². Below 0.26 r counts as 0.26, from where on the layer's albedo E is at
//!   most 0.999 (the model returns up to four times the light at grazing angles of a smoother one).
//! - f = C D V, D = (2 + 1/α) sin(h)^(1/α) / 2π, V = 1 / (1 + Λ(wi) + Λ(wo)) / 4 cos(wi) cos(wo), cosines below 1e-4 counting as
//!   1e-4; what is under it is scaled by 1 − max(C) max(E(wi), E(wo)). Both are reciprocal, and together at most 1. Both sides
//!   of a surface have it. World frame.
//! - E is a polynomial in √cos and r under an exponential: above the albedo by at most 0.015 where cos ≥ 0.02, by at most
//!   0.35 below, and nowhere under it (quadrature at 29 roughnesses and 36 cosines).
//! - Sampling: uniform over the hemisphere.
//! - Source: KHR_materials_sheen; Estevez & Kulla 2017, "Production friendly microfacet sheen BRDF", equations 2 and 3.

use std::f32::consts::FRAC_1_PI;

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Bool, F32, Fun};

use crate::bsdf::diffuse::diffuse_is_seen;
use crate::bsdf::frame::{Side, shading_cos};
use crate::bsdf::layer::Layer;
use crate::bsdf::{Bsdf, BsdfSample, EvalFn, PdfFn, SampleFn};
use crate::core::color::{Color, black};
use crate::core::math::{exp, pow, sincos_turns};
use crate::core::sampling::share_of;
use crate::core::vec::{Vec3, vec3};
use crate::geometry::{Frame3, SurfaceElement};

/// The least roughness at which the layer returns no more light than came.
const LEAST_ROUGHNESS: f32 = 0.26;

/// The least cosine that is told from 0: f is finite.
const LEAST_COS: f32 = 1e-4;

/// Density of directions.
const DENSITY: f32 = 0.5 * FRAC_1_PI;

/// A sheen at a point.
#[derive(Clone, Copy)]
pub struct SheenValues {
    /// Is there a sheen?
    pub present: Bool,
    /// Its colour.
    pub color: Color,
    /// Its roughness; α is the square.
    pub roughness: F32,
    /// About the albedo of what it covers, for sampling alone; 0 only where that scatters nothing.
    pub under: F32,
}
impl_staged!(SheenValues { present, color, roughness, under });

impl SheenValues {
    /// No sheen.
    pub fn none() -> SheenValues {
        SheenValues { present: false.into(), color: black(), roughness: 0.0.into(), under: 0.0.into() }
    }
}

/// The sheen of a surface.
pub fn make_sheen(surf: SurfaceElement, number: u32, values: SheenValues) -> Layer {
    let values = SheenValues { roughness: values.roughness.max(LEAST_ROUGHNESS), ..values };
    let density = |side: Side, wi: Vec3| side.normal.dot(wi).gt(0.0).select(F32::from(DENSITY), 0.0.into());
    let value = move |side: Side, wi: Vec3, wo: Vec3| {
        let f = values.color * lobe(values.roughness, side.normal, wi, wo);
        diffuse_is_seen(side, wi).select(f, black())
    };
    let most = values.color.max_channel();
    Layer {
        present: values.present,
        number,
        bsdf: Bsdf {
            eval: EvalFn::lam(|_, (wi, wo)| value(Side::new(surf, wo), wi, wo)),
            pdf: PdfFn::lam(|_, (wi, wo)| density(Side::new(surf, wo), wi)),
            sample: SampleFn::lam(|_, (rng, wo)| {
                let side = Side::new(surf, wo);
                let ([z, turns], _) = rng.pair();
                let (sin_phi, cos_phi) = sincos_turns(turns);
                let sin = (1.0 - z * z).max(0.0).sqrt();
                let wi = Frame3::around(side.normal).to_world(vec3(sin * cos_phi, sin * sin_phi, z));
                BsdfSample::scattered(wi, value(side, wi, wo) * shading_cos(surf, wi), density(side, wi))
            }),
            is_specular: false.into(),
        },
        passes: Fun::lam(|_, (wi, wo): (Vec3, Vec3)| {
            let albedo = |w| albedo(values.roughness, shading_cos(surf, w));
            1.0 - most * albedo(wi).max(albedo(wo))
        }),
        choice: Fun::lam(|_, wo| {
            let own = most * albedo(values.roughness, shading_cos(surf, wo));
            share_of(own, (1.0 - own) * values.under)
        }),
    }
}

/// D V at this roughness.
fn lobe(roughness: F32, normal: Vec3, wi: Vec3, wo: Vec3) -> F32 {
    let alpha = roughness * roughness;
    let half = wi + wo;
    // Of the half vector, without the cancellation of 1 − cos².
    let across = half - normal * normal.dot(half);
    let sin2 = (across.length2() / half.length2().max(f32::MIN_POSITIVE)).min(1.0);
    let d = (2.0 + 1.0 / alpha) * DENSITY * pow(sin2, 0.5 / alpha);
    let cos = |w: Vec3| normal.dot(w).max(LEAST_COS).min(1.0);
    let (i, o) = (cos(wi), cos(wo));
    d / ((1.0 + (masking(i, alpha) + masking(o, alpha))) * (4.0 * (i * o)))
}

/// Λ: a fit of Estevez and Kulla, with the constants of the extension's text.
fn masking(cos: F32, alpha: F32) -> F32 {
    let smooth = (1.0 - alpha) * (1.0 - alpha);
    let mix = |rough: f32, end: f32| rough + (end - rough) * smooth;
    let (a, b, c) = (mix(21.5473, 25.3245), mix(3.82987, 3.32435), mix(0.19823, 0.16801));
    let (d, e) = (mix(-1.97760, -1.27393), mix(-4.32054, -4.85967));
    let l = |x: F32| a / (1.0 + b * pow(x, c)) + d * x + e;
    // Symmetric about (1/2, l(1/2)).
    let (low, middle, high) = (l(cos), l(0.5.into()), l(1.0 - cos));
    exp(cos.lt(0.5).select(low, 2.0 * middle - high))
}

/// E, never below the albedo of the white layer towards a cosine.
fn albedo(roughness: F32, cos: F32) -> F32 {
    /// Largest error of the polynomial where it is too low.
    const MARGIN: f32 = 0.0075;
    /// Of powers of √cos, the lowest first, as polynomials in the roughness, highest power first.
    const FIT: [[f32; 4]; 4] = [
        [-3.223408, 7.015099, -4.733057, 1.019468],
        [-12.098726, 23.321731, -12.249913, -0.127426],
        [53.090207, -109.82349, 68.845115, -12.341658],
        [-32.33836, 61.668384, -31.399385, 1.608804],
    ];
    let root = cos.min(1.0).sqrt();
    let horner = |x: F32, terms: [F32; 4]| ((terms[0] * x + terms[1]) * x + terms[2]) * x + terms[3];
    let [a, b, c, d] = FIT.map(|row| horner(roughness, row.map(F32::from)));
    (exp(horner(root, [d, c, b, a])) + MARGIN).min(1.0)
}
