//! A perfect mirror, on both sides of a surface.
//!
//! - Parameters: reflectance `kr` per channel, at every angle: the base colour.
//! - Specular: f and pdf are 0; one direction, the mirror image of wo about the (bent) shading normal, weight `kr`.
//! - With consistent normals, a direction that would enter the surface after all has weight 0.
//! - Source: Pharr, Jakob, Humphreys 2023, section 9.3.

use crate::bsdf::frame::{Side, reflect};
use crate::bsdf::models::Model;
use crate::bsdf::{Bsdf, BsdfSample, SampleFn};
use crate::core::color::{Color, black};
use crate::geometry::SurfaceElement;

/// `mirror`.
pub const MODEL: Model =
    Model { name: "mirror", parameters: &[], has_parts: false, make: |_, site| make_mirror_bsdf(site.surf, site.base) };

/// A mirror.
pub fn make_mirror_bsdf(surf: SurfaceElement, kr: Color) -> Bsdf {
    Bsdf::specular(SampleFn::lam(|_, (_rng, wo)| {
        let side = Side::new(surf, wo);
        let wi = reflect(wo, side.bent_normal(wo));
        BsdfSample::specular(wi, side.reflects(wi).select(kr, black()))
    }))
}
