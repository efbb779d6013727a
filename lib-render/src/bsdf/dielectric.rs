//! An interface between dielectrics, rough or smooth: glass, water. And how it bends light.
//!
//! - Parameters: glTF's index `ior` of the inside (where the normal does not point) relative to the outside; roughness, whose
//!   square is GGX's width α, below 1e-3 a smooth interface; the base colour tints refracted light.
//! - Reflects with the exact Fresnel factor for indices up to 2 + √3; beyond it that has a dip, and as in glTF's layer no angle
//!   reflects less than normal incidence. What is not reflected refracts by Snell's law; total internal reflection always
//!   reflects. What is refracted contains (eta_i/eta_t)², as radiance does. f, pdf, frame and sampling: see
//!   [`gltf`](crate::bsdf::gltf).
//! - With consistent normals, a direction on the wrong side of the surface has weight 0.
//! - Source: Walter, Marschner, Li, Torrance 2007, section 5.2; Veach 1997, section 5.2 for the scale of radiance.

use jerboa_ir::lang::F32;

use crate::bsdf::BsdfSample;
use crate::bsdf::frame::{Side, cos_between};
use crate::bsdf::gltf::{GltfValues, make_gltf_bsdf};
use crate::bsdf::models::Model;
use crate::core::color::{Color, black, white};
use crate::core::fresnel::refracted_cos;
use crate::core::vec::Vec3;
use crate::material::gltf_values;

/// `dielectric`: glTF's transmission under the whole of its layer, hence its code. The base colour tints what is refracted.
pub const MODEL: Model = Model {
    name: "dielectric",
    parameters: &[],
    has_parts: false,
    make: |b, site| {
        let values = GltfValues {
            has_specular: true.into(),
            has_transmission: true.into(),
            specular: 1.0.into(),
            specular_color: white(),
            transmission: 1.0.into(),
            ..gltf_values(b, site.row, site.base, site.surf.uv)
        };
        make_gltf_bsdf(site.surf, values)
    },
};

/// The sample of a smooth refraction whose weight is `weight`, but for the scale of radiance.
pub fn refraction(side: Side, wi: Vec3, eta: F32, weight: Color) -> BsdfSample {
    let radiance_scale = 1.0 / (eta * eta);
    let weight = side.transmits(wi).select(weight * radiance_scale, black());
    BsdfSample { radiance_scale, ..BsdfSample::specular(wi, weight) }
}

/// The refracted direction, unit. `eta` is the index on the far side over that on the side of `wo` and `normal`. Under
/// total internal reflection it lies in the surface.
pub fn refract(wo: Vec3, normal: Vec3, eta: F32) -> Vec3 {
    let cos = cos_between(wo, normal);
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
