//! Rough or smooth metal with a complex index of refraction.
//!
//! - Parameters: index `eta` in [0.01, 20] and extinction `k` in [0, 20] per channel, relative to the outside; roughness, whose
//!   square is GGX's width α, below 1e-3 a mirror; the base colour tints what is reflected.
//! - f = base · F D G / (4 cos cos) per steradian where wi lies on the side of wo, 0 elsewhere; world frame; single
//!   scattering, separable Smith masking. F is exact for unpolarised light.
//! - Sampling: visible normals; a direction below the surface has weight 0.
//! - Source: Walter, Marschner, Li, Torrance 2007, section 5.1; Born & Wolf 1999, section 14.2 for Fresnel's formulas.

use jerboa_ir::lang::{Bool, F32};

use crate::bsdf::frame::shading_cos;
use crate::bsdf::gloss::Gloss;
use crate::bsdf::models::Model;
use crate::bsdf::{Bsdf, BsdfSample, EvalFn, PdfFn, SampleFn};
use crate::components::Parameter;
use crate::core::color::{Color, black};
use crate::core::vec::Vec3;
use crate::geometry::SurfaceElement;

/// `conductor`. The default is gold (Johnson & Christy 1972, at 650, 550 and 450 nm).
pub const MODEL: Model = Model {
    name: "conductor",
    parameters: &[
        Parameter { name: "eta", default: &[0.155, 0.424, 1.382], range: (0.01, 20.0) },
        Parameter { name: "k", default: &[3.6, 2.472, 1.915], range: (0.0, 20.0) },
    ],
    has_parts: false,
    make: |b, site| {
        let metal = Metal { eta: site.numbers().color(0), k: site.numbers().color(3), tint: site.base };
        let (alpha, smooth) = site.alpha(b);
        make_conductor_bsdf(site.surf, metal, alpha, smooth)
    },
};

/// What a metal reflects.
#[derive(Clone, Copy)]
pub struct Metal {
    /// Index of refraction.
    pub eta: Color,
    /// Extinction.
    pub k: Color,
    /// Factor on what is reflected.
    pub tint: Color,
}

impl Metal {
    /// Reflectance at a cosine.
    fn reflectance(self, cos: F32) -> Color {
        self.tint * self.eta.zip(self.k, |eta, k| fresnel_conductor(cos, eta, k))
    }
}

/// A metal of this width, or a mirror.
pub fn make_conductor_bsdf(surf: SurfaceElement, metal: Metal, alpha: F32, smooth: Bool) -> Bsdf {
    let value = move |wi: Vec3, wo: Vec3| {
        let facet = Gloss::new(surf, wo).value(wi, alpha);
        (metal.reflectance(facet.cos) * facet.f, facet.pdf)
    };
    Bsdf {
        eval: EvalFn::lam(|b, (wi, wo)| b.if_(smooth, |_| black(), |_| value(wi, wo).0)),
        pdf: PdfFn::lam(|b, (wi, wo)| b.if_(smooth, |_| F32::from(0.0), |_| value(wi, wo).1)),
        sample: SampleFn::lam(|b, (rng, wo)| {
            let gloss = Gloss::new(surf, wo);
            b.if_(
                smooth,
                |_| {
                    let (wi, weight) = (gloss.mirrored(), metal.reflectance(gloss.normal.dot(wo)));
                    BsdfSample::specular(wi, gloss.side.reflects(wi).select(weight, black()))
                },
                |_| {
                    let (wi, found) = gloss.sample(rng, alpha);
                    let (f, pdf) = value(wi, wo);
                    let sample = BsdfSample::scattered(wi, f * shading_cos(surf, wi), pdf);
                    found.select(sample, BsdfSample::scattered(wi, black(), 0.0.into()))
                },
            )
        }),
        is_specular: smooth,
    }
}

/// Reflectance of a metal of complex index eta + ik for unpolarised light at a cosine ≥ 0, exact.
///
/// Source: Born & Wolf 1999, section 14.2, equations 13 to 15 for a² and b². Error ≤ 1e-6 for eta from 0.01 to 20, k up to 20
/// (`tests/tests/scattering/fresnel.rs`), and never below 0: a² and b² are found without the difference that is small, and both
/// polarisations are sums of squares.
pub fn fresnel_conductor(cos: F32, eta: F32, k: F32) -> F32 {
    let (cos2, sin2) = (cos * cos, (1.0 - cos * cos).max(0.0));
    // (a + ib)² = (eta + ik)² − sin²
    let (re, im) = ((eta - k) * (eta + k) - sin2, 2.0 * eta * k);
    let large = 0.5 * ((re * re + im * im).sqrt() + re.abs());
    // Their product is (im / 2)²; 0 where both are.
    let small = (0.25 * (im * im) / large).max(0.0);
    let (a2, b2) = re.gt(0.0).select((large, small), (small, large));
    let a = a2.sqrt();
    let squares = |x: F32, y2: F32| x * x + y2;
    let (lost, whole) = (squares(cos - a, b2), squares(cos + a, b2));
    let s = lost / whole;
    let p = s * (squares(a * cos - sin2, b2 * cos2) / squares(a * cos + sin2, b2 * cos2));
    // At cos = 0 everything is reflected, also where no light bends.
    (cos.gt(0.0) & whole.gt(0.0)).select(0.5 * (s + p), 1.0.into())
}
