//! A rough interface: reflection and refraction by GGX microfacets, without Fresnel's factor.
//!
//! - Parameters: α ≥ 1e-3, one for each axis of the frame; for refraction the indices on both sides, away from each other ([`bending`]).
//! - f per steradian, pdf per steradian with visible normals; local frame around the bent shading normal.
//! - Reciprocal to the bit, but for the scale of radiance: nothing is found from one direction that the other would round
//!   otherwise. wo·h of a reflection is half the length of wo + wi, accurate also where that is nearly 0; a refraction
//!   hands out the cosines on both sides.
//! - Source: Walter, Marschner, Li, Torrance 2007, equations 20 and 21; radiance form as Pharr, Jakob, Humphreys 2023,
//!   section 9.7; separable Smith masking as glTF 2.0, appendix B.3.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::F32;

use crate::bsdf::dielectric::refract;
use crate::bsdf::frame::reflect;
use crate::bsdf::thin_wall::behind;
use crate::core::microfacet::{Widths, ggx_d, ggx_g1_over_cos, ggx_sample_visible};
use crate::core::vec::{Vec2, Vec3, vec3};
use crate::geometry::Frame3;

/// The least index, over 1, that bends a ray: below it the microfacet that refracts wo to wi is lost in rounding.
const LEAST_BEND: f32 = 1e-3;

/// A rough interface seen from wo.
#[derive(Clone, Copy)]
pub struct Rough {
    /// Frame around the normal on the side of wo.
    pub frame: Frame3,
    /// Towards the viewer, local, z ≥ 0.
    pub wo: Vec3,
    /// GGX's widths along the frame's tangent and bitangent.
    pub alpha: Widths,
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
    /// The interface with this normal, equally rough all around.
    pub fn new(normal: Vec3, wo: Vec3, alpha: F32) -> Rough {
        Rough::along(Frame3::around(normal), wo, Widths::round(alpha))
    }

    /// The interface with these widths along this frame.
    pub fn along(frame: Frame3, wo: Vec3, alpha: Widths) -> Rough {
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

    /// Where the microfacet refracts wo to; `eta` is the index beyond over the index here.
    pub fn refracted(self, h: Vec3, eta: F32) -> Vec3 {
        refract(self.wo, h, eta)
    }

    /// Reflection to wi (local).
    pub fn reflection(self, wi: Vec3) -> Facet {
        let half = self.wo + wi;
        let length = half.length();
        // The cosines of masking and of f cancel, so nothing is divided by one.
        let (o, i) = (ggx_g1_over_cos(self.wo, self.alpha), ggx_g1_over_cos(wi, self.alpha));
        let d = ggx_d(half / length, self.alpha) * 0.25;
        wi.z.gt(0.0).select(Facet { cos: length * 0.5, f: d * (o * i), pdf: d * o }, nothing())
    }

    /// Refraction to wi (local), and its cosine to the microfacet. f contains 1/eta², as radiance does. The indices are
    /// those of the media of wo and of wi.
    pub fn refraction(self, wi: Vec3, (here, beyond): (F32, F32)) -> (Facet, F32) {
        let half = self.wo * here + wi * beyond;
        let length2 = half.length2();
        // On the near side, whichever medium is denser.
        let h = (half / length2.sqrt()) * F32::from(1.0).copysign(half.z);
        let (cos, cos_beyond) = (self.wo.dot(h), -wi.dot(h));
        let (o, i) = (ggx_g1_over_cos(self.wo, self.alpha), ggx_g1_over_cos(-wi, self.alpha));
        // Walter's root, here · cos − beyond · cos_beyond, is the length of the half vector.
        let d = ggx_d(h, self.alpha) * (cos * cos_beyond / length2);
        let facet = Facet { cos, f: d * (o * i) * (here * here), pdf: d * o * (beyond * beyond) };
        let connects = wi.z.lt(0.0) & cos.gt(0.0) & cos_beyond.gt(0.0);
        connects.select((facet, cos_beyond), (nothing(), 0.0.into()))
    }

    /// Through a thin wall to wi (local): the mirror image of reflection, unbent.
    pub fn passage(self, wi: Vec3) -> Facet {
        self.reflection(behind(wi))
    }
}

fn nothing() -> Facet {
    let zero = F32::from(0.0);
    Facet { cos: zero, f: zero, pdf: zero }
}

/// The index of an inside, kept away from 1.
pub fn bending(ior: F32) -> F32 {
    // By no difference, which Fresnel's factor takes too: smooth glass would seem to have it from here.
    let is_near = ior.gt(1.0 - LEAST_BEND) & ior.lt(1.0 + LEAST_BEND);
    is_near.select((1.0 + LEAST_BEND).into(), ior)
}
