//! A smooth interface between dielectrics: glass, water.
//!
//! - Parameters: index `ior` of the inside (where the normal does not point) relative to the outside; factors `kr` on
//!   reflected and `kt` on refracted light.
//! - Specular: f and pdf are 0. Reflects with the exact Fresnel probability, else refracts by Snell's law; total internal
//!   reflection always reflects. The weight of a refraction contains (eta_i/eta_t)², as radiance does.
//! - With consistent normals, a direction on the wrong side of the surface has weight 0.
//! - Source: Walter, Marschner, Li, Torrance 2007, section 5.2; Veach 1997, section 5.2 for the scale of radiance.

use jerboa_ir::lang::F32;

use crate::bsdf::frame::{Side, reflect};
use crate::bsdf::{Bsdf, BsdfSample, SampleFn};
use crate::core::color::{Color, black};
use crate::core::fresnel::{fresnel_dielectric, refracted_cos};
use crate::core::vec::Vec3;
use crate::geometry::SurfaceElement;

/// A smooth dielectric.
pub fn make_dielectric_bsdf(surf: SurfaceElement, ior: F32, kr: Color, kt: Color) -> Bsdf {
    Bsdf::specular(SampleFn::lam(|b, (rng, wo)| {
        let side = Side::new(surf, wo);
        let normal = side.bent_normal(wo);
        let eta = side.eta(ior);
        let (u, _) = rng.next();
        b.if_(
            u.lt(fresnel_dielectric(normal.dot(wo), eta)),
            |_| {
                let wi = reflect(wo, normal);
                BsdfSample::specular(wi, side.reflects(wi).select(kr, black()))
            },
            |_| refraction(side, refract(wo, normal, eta), eta, kt),
        )
    }))
}

/// The sample of a smooth refraction whose weight is `weight`, but for the scale of radiance.
pub fn refraction(side: Side, wi: Vec3, eta: F32, weight: Color) -> BsdfSample {
    let radiance_scale = 1.0 / (eta * eta);
    let weight = side.transmits(wi).select(weight * radiance_scale, black());
    BsdfSample { radiance_scale, ..BsdfSample::specular(wi, weight) }
}

/// The refracted direction, unit. `eta` is the index on the far side over that on the side of `wo` and `normal`. Under
/// total internal reflection it lies in the surface.
pub fn refract(wo: Vec3, normal: Vec3, eta: F32) -> Vec3 {
    let cos = wo.dot(normal);
    (normal * (cos / eta - refracted_cos(cos, eta)) - wo / eta).normalize()
}

impl Side {
    /// Index of the far side over the index of this one.
    pub fn eta(self, ior: F32) -> F32 {
        // An index of 0 is glTF's "reflects everything", from both sides.
        let inverse = ior.gt(0.0).select(1.0 / ior, 0.0.into());
        self.outside.select(ior, inverse)
    }
}
