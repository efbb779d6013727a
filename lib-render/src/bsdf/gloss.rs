//! Reflection by a rough surface, without Fresnel's factor: what models of opaque materials share.
//!
//! - Parameter: GGX width `alpha` ≥ 1e-3.
//! - f per steradian, relative to the cosine of the shading normal; pdf per steradian with visible normals, around the bent
//!   shading normal; world frame. Below the surface both are 0.
//! - Source: Walter, Marschner, Li, Torrance 2007, section 5.1, by [`Rough`].

use jerboa_ir::lang::{Bool, F32};

use crate::bsdf::bent::bend_ratio;
use crate::bsdf::frame::{Side, reflect, shading_cos};
use crate::bsdf::rough::{Facet, Rough};
use crate::core::rng::Rng;
use crate::core::vec::{Vec3, vec2};
use crate::geometry::SurfaceElement;

/// A glossy surface seen from wo.
#[derive(Clone, Copy)]
pub struct Gloss {
    surf: SurfaceElement,
    /// The side of wo.
    pub side: Side,
    /// Bent shading normal.
    pub normal: Vec3,
    wo: Vec3,
}

impl Gloss {
    /// The surface from there.
    pub fn new(surf: SurfaceElement, wo: Vec3) -> Gloss {
        let side = Side::new(surf, wo);
        Gloss { surf, side, normal: side.bent_normal(wo), wo }
    }

    /// Reflection to wi.
    pub fn value(self, wi: Vec3, alpha: F32) -> Facet {
        let rough = Rough::new(self.normal, self.wo, alpha);
        let local = rough.frame.to_local(wi);
        let facet = rough.reflection(local);
        let f = facet.f * bend_ratio(local.z, shading_cos(self.surf, wi));
        Facet { f: self.side.reflects(wi).select(f, 0.0.into()), ..facet }
    }

    /// A direction by way of a visible microfacet, and whether it is above the bent surface: else the sample failed. Draws two
    /// numbers.
    pub fn sample(self, rng: Rng, alpha: F32) -> (Vec3, Bool) {
        let ([u, v], _) = rng.pair();
        let rough = Rough::new(self.normal, self.wo, alpha);
        let local = rough.reflected(rough.sample_normal(vec2(u, v)));
        (rough.frame.to_world(local), local.z.gt(0.0))
    }

    /// Where a perfectly smooth surface reflects wo to.
    pub fn mirrored(self) -> Vec3 {
        reflect(self.wo, self.normal)
    }
}
