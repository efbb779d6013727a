//! glTF's metallic-roughness material with KHR_materials_{specular, ior, transmission, volume, anisotropy,
//! diffuse_transmission, iridescence}. The layers over it are [`coat`](crate::bsdf::coat) and [`sheen`](crate::bsdf::sheen).
//!
//! f = (1 − metallic) · (layer + under the layer: (1 − transmission) · diffuse + transmission · refraction)
//!     + metallic · metal
//!
//! - Layer: GGX reflection with the exact dielectric Fresnel factor of `ior`, tinted at normal incidence by
//!   `specular_color` and scaled by `specular`. With `specular` 0 there is no layer: roughness 1 is exactly Lambert.
//! - Diffuse: base/π · (1 − F(cos wi)) (1 − F(cos wo)), F the layer's factor: reciprocal and never above 1 in all. (glTF's
//!   own 1 − F(wo·h) returns up to twice the light at grazing angles.)
//! - Refraction: GGX, base · (1 − F), F of the same microfacet by its cosines to wo and to wi: reciprocal also next to total
//!   reflection. An index within 1e-3 of 1 counts as 1.001 where the interface is rough. Thin walls (no volume) pass the
//!   mirror image of the reflection instead, unbent, and look alike from both sides.
//! - Metal: GGX reflection with Schlick's factor, F0 = base, F90 = 1. Single scattering, separable Smith masking.
//! - Anisotropy: another width along a direction of the surface, for all of GGX; α ≥ 1e-3 both ways, never perfectly smooth.
//! - Diffuse transmission: a share of the diffuse light comes through with a colour of its own, weighed with what passes the
//!   layer on both sides; into a solid it bends, as refraction does, by the reciprocal form: 1/index² of it from inside.
//! - Iridescence: the factors of layer and metal give way to those of a thin film ([`fresnel_film`](crate::core::thin_film::fresnel_film), at the cosine outside),
//!   and 1 − its largest channel passes.
//! - Reflection and refraction are perfectly smooth where `smooth`: then f and pdf hold the diffuse part alone.
//! - World frame. f is relative to the cosine of the shading normal; below the surface only refraction is not 0; with
//!   consistent normals the geometric normal tells below from above.
//! - Sampling: diffuse or microfacet by their shares at wo; visible normals; reflection or refraction by Fresnel's factor
//!   at the microfacet. `sample` calls the code of `pdf` and `eval` for the direction it found.
//! - Source: glTF 2.0, appendix B, and the extensions' texts; Shirley 1991, section 4.2, for the coupling of diffuse.

mod smooth;
mod values;
mod view;

use crate::bsdf::{Bsdf, EvalFn, PdfFn, SampleFn};
use crate::geometry::SurfaceElement;

pub use values::GltfValues;
use view::View;

/// The material's BSDF.
pub fn make_gltf_bsdf(surf: SurfaceElement, values: GltfValues) -> Bsdf {
    // Perfectly specular, or nothing at all (a black emitter): light sampling is of no use.
    let no_diffuse = values.diffuse_albedo().is_black() & values.diffuse_transmittance().is_black();
    let only_smooth = values.is_nothing() | (values.smooth & no_diffuse);
    Bsdf {
        eval: EvalFn::lam(|b, (wi, wo)| View::new(b, surf, values, wo).value(b, wi).f),
        pdf: PdfFn::lam(|b, (wi, wo)| View::new(b, surf, values, wo).value(b, wi).pdf),
        sample: SampleFn::lam(|b, (rng, wo)| View::new(b, surf, values, wo).sample(b, rng)),
        is_specular: only_smooth,
    }
}
