//! Smooth or rough varnish over a diffuse ground, with light that goes to and fro between them: plastic, glazed wood.
//!
//! - Parameters: glTF's index `ior` in [1, 3] (larger ones count as 3); the base colour ρ, the albedo of the ground; roughness,
//!   whose square is GGX's width α, below 1e-3 a smooth varnish.
//! - f = F D G / (4 cos cos) + (1 − F(wi)) (1 − F(wo)) / (π ior²) · ρ / (1 − ρ F̄) per steradian where wi lies on the side of wo, 0
//!   elsewhere; world frame; F exact for a dielectric, F̄ what the varnish throws back of diffuse light from below. With ρ = 1
//!   and a smooth varnish all light is returned.
//! - glTF's own layer takes the ground's light once: 1 − F twice and no F̄.
//! - 1 − F̄ = T / ior², where T is what passes of diffuse light from above, a polynomial: error ≤ 2e-5 for ior in [1, 3]
//!   (`tests/tests/scattering/fresnel.rs`).
//! - Sampling: varnish or ground by their shares at wo; visible normals, cosine-weighted. `sample` calls the code of `pdf`
//!   and `eval` for the direction it found. Smooth: f and pdf hold the ground alone.
//! - Source: Wolff 1994, "Diffuse-reflectance model for smooth dielectric surfaces"; d'Eon 2011 for index matching of F̄;
//!   Walter, Marschner, Li, Torrance 2007 for the varnish.

use std::f32::consts::FRAC_1_PI;

use jerboa_ir::lang::{Block, Bool, F32};

use crate::bsdf::diffuse::{diffuse_is_seen, diffuse_pdf, sample_diffuse};
use crate::bsdf::frame::shading_cos;
use crate::bsdf::gloss::Gloss;
use crate::bsdf::models::Model;
use crate::bsdf::rough::Facet;
use crate::bsdf::{Bsdf, BsdfSample, EvalFn, PdfFn, SampleFn};
use crate::core::color::{Color, black, gray};
use crate::core::fresnel::{fresnel_dielectric, fresnel_passed, refracted_cos};
use crate::core::rng::Rng;
use crate::core::vec::Vec3;
use crate::geometry::SurfaceElement;
use crate::schema::Materials;

/// `plastic`.
pub const MODEL: Model = Model {
    name: "plastic",
    parameters: &[],
    has_parts: false,
    make: |b, site| {
        let (alpha, smooth) = site.alpha(b);
        make_plastic_bsdf(Plastic {
            surf: site.surf,
            ior: site.row.get(Materials::IOR).min(LARGEST_IOR),
            ground: site.base,
            alpha,
            smooth,
        })
    },
};

const LARGEST_IOR: f32 = 3.0;

/// A varnished surface.
#[derive(Clone, Copy)]
pub struct Plastic {
    /// The surface.
    pub surf: SurfaceElement,
    /// Index of the varnish over that of the outside, in [1, 3].
    pub ior: F32,
    /// Albedo of the ground.
    pub ground: Color,
    /// GGX's width.
    pub alpha: F32,
    /// Is the varnish perfectly smooth?
    pub smooth: Bool,
}

/// Plastic.
pub fn make_plastic_bsdf(plastic: Plastic) -> Bsdf {
    Bsdf {
        eval: EvalFn::lam(|b, (wi, wo)| View::new(plastic, wo).value(b, wi).0),
        pdf: PdfFn::lam(|b, (wi, wo)| View::new(plastic, wo).value(b, wi).1),
        sample: SampleFn::lam(|b, (rng, wo)| View::new(plastic, wo).sample(b, rng)),
        is_specular: plastic.smooth & plastic.ground.is_black(),
    }
}

/// What passes of diffuse light from above into a dielectric, 1 less the mean of Fresnel's factor; ior in [1, 3].
///
/// Least largest error over s = √((ior − 1) / (ior + 1)), 1.9e-5: the integral has a term that goes with s².
pub fn diffuse_transmittance(ior: F32) -> F32 {
    const C: [f32; 7] = [0.999_982_1, 0.003_247_29, -0.766_747_8, 1.427_866_5, -2.028_495_9, 1.017_410_8, -0.581_178_1];
    let s = ((ior - 1.0) / (ior + 1.0)).max(0.0).sqrt();
    C[..6].iter().rev().fold(F32::from(C[6]), |sum, c| sum * s + *c)
}

/// The surface seen from wo.
#[derive(Clone, Copy)]
struct View {
    plastic: Plastic,
    gloss: Gloss,
    /// Share of light that passes the varnish towards wo.
    passes: F32,
    /// Albedo of the ground together with what the varnish throws back to it, over ior².
    ground: Color,
    /// Probability of sampling the varnish.
    varnish: F32,
}

impl View {
    fn new(plastic: Plastic, wo: Vec3) -> View {
        let gloss = Gloss::new(plastic.surf, wo);
        let passes = passing(gloss.side.normal.dot(wo).abs(), plastic.ior);
        let (transmitted, ior2) = (diffuse_transmittance(plastic.ior), plastic.ior * plastic.ior);
        let ground = plastic.ground.map(|rho| rho / (ior2 - rho * (ior2 - transmitted)));
        let diffuse = ground.max_channel() * transmitted * passes;
        // A tenth at least: a rough varnish may reflect where this angle reflects little.
        let varnish = (1.0 - passes) * 0.9 + 0.1;
        View { plastic, gloss, passes, ground, varnish: varnish / (varnish + diffuse) }
    }

    /// f and pdf of everything that is not perfectly specular.
    fn value(self, b: &mut Block, wi: Vec3) -> (Color, F32) {
        let side = self.gloss.side;
        let passes = self.passes * passing(side.normal.dot(wi).abs(), self.plastic.ior);
        let diffuse = diffuse_is_seen(side, wi).select(self.ground * (passes * FRAC_1_PI), black());
        let pdf = diffuse_pdf(side, wi) * (1.0 - self.varnish);
        b.if_(
            self.plastic.smooth,
            |_| (diffuse, pdf),
            |_| {
                let Facet { cos, f, pdf: visible } = self.gloss.value(wi, self.plastic.alpha);
                let varnish = gray(fresnel_dielectric(cos, self.plastic.ior) * f);
                (diffuse + varnish, pdf + visible * self.varnish)
            },
        )
    }

    /// A direction. Draws three numbers.
    fn sample(self, b: &mut Block, rng: Rng) -> BsdfSample {
        let (u, rng) = rng.next();
        let is_varnish = u.lt(self.varnish);
        b.if_(
            is_varnish & self.plastic.smooth,
            |_| {
                let wi = self.gloss.mirrored();
                let weight = gray((1.0 - self.passes) / self.varnish);
                BsdfSample::specular(wi, self.gloss.side.reflects(wi).select(weight, black()))
            },
            |b| {
                let ground = (sample_diffuse(rng, self.gloss.side), Bool::from(true));
                let (wi, found) = is_varnish.select(self.gloss.sample(rng, self.plastic.alpha), ground);
                let (f, pdf) = self.value(b, wi);
                let sample = BsdfSample::scattered(wi, f * shading_cos(self.plastic.surf, wi), pdf);
                found.select(sample, BsdfSample::scattered(wi, black(), 0.0.into()))
            },
        )
    }
}

/// Share of light that passes the varnish at this angle.
fn passing(cos: F32, ior: F32) -> F32 {
    fresnel_passed(cos, refracted_cos(cos, ior), ior)
}
