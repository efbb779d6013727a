//! Scattering of light that travels from the lights: the one place where it differs from what a camera's paths see.
//!
//! A BSDF is written for paths that come from the camera: radiance that arrives from wi leaves towards wo as
//! f(wi, wo) |cos(wi, shading normal)|. Against the surface's own area that is a BSDF
//!
//! > f̃(wi → wo) = f(wi, wo) |wi·n| / |wi·g|,    n shading normal, g face normal
//!
//! and the light that a path from a light carries is multiplied by f̃ |wo·g| / pdf. With shading normals f̃ is not
//! symmetric even where f is (Veach 1997, section 5.3); and where light is refracted, f itself is not: it has the factor
//! (η of wo's side / η of wi's side)², which flux does not change by (section 5.2). So `f` is asked for in the direction in
//! which light goes, and only a perfectly specular event, which cannot be asked, is turned round.

use jerboa_ir::lang::{Block, F32};

use crate::bsdf::BsdfSample;
use crate::core::color::{Color, black, gray};
use crate::core::vec::Vec3;
use crate::geometry::SurfaceElement;
use crate::material::Material;

/// f̃, per steradian: for light that arrives from one direction and leaves towards another (unit, away from the surface).
pub fn scattered(b: &mut Block, surf: SurfaceElement, mat: Material, from: Vec3, to: Vec3) -> Color {
    mat.bsdf.eval.call(b, (from, to)).absorb(gray(shading_over_face(surf, mat, from)))
}

/// What the light of a path is multiplied by that arrives from `from` and goes on as a sample of the BSDF that was drawn for
/// that direction says. Black where the sample failed.
pub fn carried(b: &mut Block, surf: SurfaceElement, mat: Material, from: Vec3, sample: BsdfSample) -> Color {
    let to = sample.wi;
    b.if_(
        sample.is_specular,
        |_| {
            // The weight is f(to, from) |cos(to, n)| / pdf, with the scale of radiance for the way back.
            let (arriving, leaving) = (shading_over_face(surf, mat, from), shading_over_face(surf, mat, to));
            let weight = sample.weight / sample.radiance_scale;
            weight.absorb(gray(leaving.gt(0.0).select(arriving / leaving, 0.0.into())))
        },
        |b| {
            let is_drawn = sample.pdf_dir.gt(0.0) & !sample.weight.is_black();
            let value = scattered(b, surf, mat, from, to) * (surf.face_cos(to).abs() / sample.pdf_dir);
            is_drawn.select(value, black())
        },
    )
}

/// |cos| to the shading normal over |cos| to the face; 0 along the face.
fn shading_over_face(surf: SurfaceElement, mat: Material, w: Vec3) -> F32 {
    let face = surf.face_cos(w).abs();
    face.gt(0.0).select(mat.normal.dot(w).abs() / face, 0.0.into())
}
