//! A clear coat, as KHR_materials_clearcoat describes it: a colourless dielectric layer of index 1.5 over anything.
//!
//! - Parameters: strength c in [0, 1], GGX width `alpha` ≥ 1e-3 or `smooth`, a normal of its own.
//! - f = c F(wo·h) D G / 4 cos(wi) cos(wo) around that normal, F exact, and T(wi) T(wo) of what is under it, T = 1 − c F(cos):
//!   reciprocal. (1 − c F of wo alone, as in the extension's text, is not.) Light that goes to and fro under the coat is
//!   lost, as there. A coat of any width reflects at most 1.011 F(cos wo) (quadrature), so all of it stays below 1. World frame.
//! - A solid that light enters is coated on its outside alone, any other surface on both sides.
//! - Sampling: visible normals; a smooth coat is a perfect mirror, which f and pdf leave out.
//! - Source: KHR_materials_clearcoat; Shirley 1991, section 4.2, for the coupling; Walter et al. 2007 for the lobe.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Bool, F32, Fun};

use crate::bsdf::bent::bend_ratio;
use crate::bsdf::frame::{Side, reflect, shading_cos};
use crate::bsdf::layer::Layer;
use crate::bsdf::rough::{Facet, Rough};
use crate::bsdf::{Bsdf, BsdfSample, EvalFn, PdfFn, SampleFn};
use crate::core::color::{black, gray};
use crate::core::fresnel::{fresnel_dielectric, fresnel_passed, refracted_cos};
use crate::core::sampling::share_of;
use crate::core::vec::{Vec3, vec2};
use crate::geometry::{Frame3, SurfaceElement};

/// Index of the coat, as the extension has it.
const IOR: f32 = 1.5;

/// A coat at a point.
#[derive(Clone, Copy)]
pub struct CoatValues {
    /// Is there a coat?
    pub present: Bool,
    /// Perfectly smooth.
    pub smooth: Bool,
    /// May its normal differ from the shading normal of what it covers?
    pub tilted: Bool,
    /// Does light enter what it covers, so that the inside has no coat?
    pub solid: Bool,
    /// Share of the surface that is covered.
    pub strength: F32,
    /// GGX's width.
    pub alpha: F32,
    /// Unit shading normal of the coat, world.
    pub normal: Vec3,
    /// About the albedo of what it covers, for sampling alone; 0 only where that scatters nothing.
    pub under: F32,
}
impl_staged!(CoatValues { present, smooth, tilted, solid, strength, alpha, normal, under });

impl CoatValues {
    /// No coat, over this shading normal.
    pub fn none(normal: Vec3) -> CoatValues {
        let (no, zero) = (Bool::from(false), F32::from(0.0));
        CoatValues { present: no, smooth: no, tilted: no, solid: no, strength: zero, alpha: zero, normal, under: zero }
    }
}

/// The coat of a surface.
pub fn make_coat(surf: SurfaceElement, number: u32, values: CoatValues) -> Layer {
    let seen = move |wo: Vec3| View::new(surf, values, wo);
    Layer {
        present: values.present,
        number,
        bsdf: Bsdf {
            eval: EvalFn::lam(|b, (wi, wo)| b.if_(values.smooth, |_| black(), |_| gray(seen(wo).value(wi).0))),
            pdf: PdfFn::lam(|b, (wi, wo)| b.if_(values.smooth, |_| F32::from(0.0), |_| seen(wo).value(wi).1)),
            sample: SampleFn::lam(|b, (rng, wo)| {
                let ([u, v], _) = rng.pair();
                b.if_(
                    values.smooth,
                    |_| seen(wo).mirrored(),
                    |_| {
                        let (view, rough) = (seen(wo), seen(wo).rough());
                        let local = rough.reflected(rough.sample_normal(vec2(u, v)));
                        let wi = rough.frame.to_world(local);
                        let (f, pdf) = view.value(wi);
                        let found = BsdfSample::scattered(wi, gray(f * shading_cos(surf, wi)), pdf);
                        local.z.gt(0.0).select(found, BsdfSample::scattered(wi, black(), 0.0.into()))
                    },
                )
            }),
            is_specular: values.smooth,
        },
        passes: Fun::lam(|_, (wi, wo)| seen(wo).passes(wi)),
        choice: Fun::lam(|_, wo| seen(wo).choice()),
    }
}

/// Share of light that passes a coat of this strength once, in a direction of this cosine to its normal, in [0, 1].
pub fn passed(strength: F32, cos: F32) -> F32 {
    let eta = F32::from(IOR);
    (1.0 - strength) + strength * fresnel_passed(cos, refracted_cos(cos, eta), eta)
}

/// The coat seen from wo.
#[derive(Clone, Copy)]
struct View {
    /// What is covered.
    surf: SurfaceElement,
    /// The same with the coat's normal.
    coat: SurfaceElement,
    values: CoatValues,
    wo: Vec3,
    side: Side,
    /// Bent normal of the coat.
    normal: Vec3,
}

impl View {
    fn new(surf: SurfaceElement, values: CoatValues, wo: Vec3) -> View {
        let coat = SurfaceElement { local: Frame3 { normal: values.normal, ..surf.local }, ..surf };
        let side = Side::new(coat, wo);
        View { surf, coat, values, wo, side, normal: side.bent_normal(wo) }
    }

    /// Is there a coat on this side?
    fn covers(self, outside: Bool) -> Bool {
        !self.values.solid | outside
    }

    fn rough(self) -> Rough {
        Rough::new(self.normal, self.wo, self.values.alpha)
    }

    /// f and density of a rough coat.
    fn value(self, wi: Vec3) -> (F32, F32) {
        let rough = self.rough();
        let local = rough.frame.to_local(wi);
        let Facet { cos, f, pdf } = rough.reflection(local);
        // The lobe is relative to the bent normal of the coat, f to the shading normal of what it covers.
        let own = shading_cos(self.coat, wi);
        let under = shading_cos(self.surf, wi);
        let tilt = under.gt(0.0).select(own / under, 0.0.into());
        let ratio = bend_ratio(local.z, own) * self.values.tilted.select(tilt, 1.0.into());
        let f = self.values.strength * fresnel_dielectric(cos, IOR.into()) * f * ratio;
        let seen = self.covers(self.side.outside);
        ((seen & self.side.reflects(wi)).select(f, 0.0.into()), seen.select(pdf, 0.0.into()))
    }

    /// The sample of a smooth coat.
    fn mirrored(self) -> BsdfSample {
        let wi = reflect(self.wo, self.normal);
        let weight = self.values.strength * fresnel_dielectric(self.normal.dot(self.wo), IOR.into());
        let seen = self.covers(self.side.outside) & self.side.reflects(wi);
        BsdfSample::specular(wi, gray(seen.select(weight, 0.0.into())))
    }

    /// Share of the light of wi towards wo that passes the coat, both ways.
    fn passes(self, wi: Vec3) -> F32 {
        let outside = self.side.reflects(wi).select(self.side.outside, !self.side.outside);
        self.passes_once(self.wo, self.side.outside) * self.passes_once(wi, outside)
    }

    fn passes_once(self, w: Vec3, outside: Bool) -> F32 {
        let passed = passed(self.values.strength, self.side.normal.dot(w).abs());
        self.covers(outside).select(passed, 1.0.into())
    }

    /// Probability of sampling the coat.
    fn choice(self) -> F32 {
        let c = self.values.strength;
        let reflected = c * fresnel_dielectric(self.side.normal.dot(self.wo).abs(), IOR.into());
        // A tenth of the largest possible reflection: f may be large where a smooth coat reflects little.
        let own = reflected * 0.9 + c * 0.1;
        let choice = share_of(own, (1.0 - reflected) * self.values.under);
        self.covers(self.side.outside).select(choice, 0.0.into())
    }
}
