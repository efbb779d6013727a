//! Rough or smooth metal: the metal lobe of [`gltf`](crate::bsdf::gltf) alone.
//!
//! - Parameters: reflectance `f0` at normal incidence per channel (Schlick, F90 = 1), GGX width `alpha`; below 1e-3 a mirror.
//! - Frame, measure, sampling and what happens below the surface: as `gltf`.
//! - Source: glTF 2.0, appendix B; Walter et al. 2007, section 5.

use jerboa_ir::lang::F32;

use crate::bsdf::Bsdf;
use crate::bsdf::gltf::{GltfValues, make_gltf_bsdf};
use crate::core::color::Color;
use crate::geometry::SurfaceElement;
use crate::schema::SMOOTH_ALPHA;

/// A metal.
pub fn make_ggx_bsdf(surf: SurfaceElement, f0: Color, alpha: F32) -> Bsdf {
    let values = GltfValues {
        has_metal: true.into(),
        smooth: alpha.lt(SMOOTH_ALPHA),
        base: f0,
        metallic: 1.0.into(),
        alpha,
        ..GltfValues::none()
    };
    make_gltf_bsdf(surf, values)
}
