//! A rough interface: reflection and refraction by GGX microfacets, without Fresnel's factor.
//!
//! - Parameters: α ≥ 1e-3; the index ratio `eta` (far side over near side) for refraction.
//! - f per steradian, pdf per steradian with visible normals; local frame around the bent shading normal.
//! - Source: Walter, Marschner, Li, Torrance 2007, equations 20 and 21; radiance form as Pharr, Jakob, Humphreys 2023,
//!   section 9.7; separable Smith masking as glTF 2.0, appendix B.3.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::F32;

use crate::bsdf::dielectric::refract;
use crate::bsdf::frame::reflect;
use crate::core::microfacet::{ggx_d, ggx_g1_over_cos, ggx_sample_visible};
use crate::core::vec::{Vec2, Vec3, vec3};
use crate::geometry::Frame3;

/// The least ratio of indices, over 1, that bends a ray: below it the microfacet that refracts wo to wi is lost in rounding.
const LEAST_BEND: f32 = 1e-3;

/// A rough interface seen from wo.
#[derive(Clone, Copy)]
pub struct Rough {
    /// Frame around the normal on the side of wo.
    pub frame: Frame3,
    /// Towards the viewer, local, z ≥ 0.
    pub wo: Vec3,
    /// GGX's width.
    pub alpha: F32,
}
impl_staged!(Rough { frame, wo, alpha });

/// A pair of directions under a rough interface. All are 0 where no microfacet connects them.
#[derive(Clone, Copy)]
pub struct Facet {
    /// Cosine between wo and the microfacet: what Fresnel's factor depends on.
    pub cos: F32,
    /// f without Fresnel's factor.
    pub f: F32,
    /// Density of wi.
    pub pdf: F32,
}
impl_staged!(Facet { cos, f, pdf });

impl Rough {
    /// The interface with this normal.
    pub fn new(normal: Vec3, wo: Vec3, alpha: F32) -> Rough {
        let frame = Frame3::around(normal);
        let local = frame.to_local(wo);
        Rough { frame, wo: vec3(local.x, local.y, local.z.max(0.0)), alpha }
    }

    /// A microfacet normal that wo sees, local.
    pub fn sample_normal(self, u: Vec2) -> Vec3 {
        ggx_sample_visible(u, self.wo, self.alpha)
    }

    /// Where the microfacet reflects wo to; may lie below the surface.
    pub fn reflected(self, h: Vec3) -> Vec3 {
        reflect(self.wo, h)
    }

    /// Where the microfacet refracts wo to.
    pub fn refracted(self, h: Vec3, eta: F32) -> Vec3 {
        refract(self.wo, h, bending(eta))
    }

    /// Reflection to wi (local).
    pub fn reflection(self, wi: Vec3) -> Facet {
        let h = (self.wo + wi).normalize();
        // D G1(wo) / (4 cos_o): the cosines of masking and of f cancel, so nothing is divided by one.
        let pdf = ggx_d(h, self.alpha) * ggx_g1_over_cos(self.wo.z, self.alpha) * 0.25;
        let facet = Facet { cos: self.wo.dot(h), f: pdf * ggx_g1_over_cos(wi.z, self.alpha), pdf };
        wi.z.gt(0.0).select(facet, nothing())
    }

    /// Refraction to wi (local). f contains 1/eta², as radiance does.
    pub fn refraction(self, wi: Vec3, eta: F32) -> Facet {
        let eta = bending(eta);
        let half = self.wo + wi * eta;
        // On the near side, whichever medium is denser.
        let h = (half / half.length()) * F32::from(1.0).copysign(half.z);
        let (o, i) = (self.wo.dot(h), -wi.dot(h));
        let root = o - eta * i;
        let visible = ggx_d(h, self.alpha) * ggx_g1_over_cos(self.wo.z, self.alpha) * o;
        let squeeze = i / (root * root);
        let f = visible * ggx_g1_over_cos(-wi.z, self.alpha) * squeeze;
        let connects = wi.z.lt(0.0) & o.gt(0.0) & i.gt(0.0);
        connects.select(Facet { cos: o, f, pdf: visible * squeeze * (eta * eta) }, nothing())
    }

    /// Through a thin wall to wi (local): the mirror image of reflection, unbent.
    pub fn passage(self, wi: Vec3) -> Facet {
        self.reflection(vec3(wi.x, wi.y, -wi.z))
    }
}

fn nothing() -> Facet {
    let zero = F32::from(0.0);
    Facet { cos: zero, f: zero, pdf: zero }
}

/// The ratio of indices, kept away from 1.
fn bending(eta: F32) -> F32 {
    (eta - 1.0).abs().lt(LEAST_BEND).select((1.0 + LEAST_BEND).into(), eta)
}
