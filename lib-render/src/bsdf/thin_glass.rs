//! A thin sheet of clear or coloured glass, seen as one surface: a window.
//!
//! - Parameters: glTF's index `ior`; the base colour t is what is left of light that crosses the sheet once.
//! - Specular: f and pdf are 0. With R the exact Fresnel reflectance of one face, light that goes to and fro inside adds up to
//!   a reflectance of R + (1 − R)² t² R / (1 − R² t²), which is 2R / (1 + R) for clear glass, and a transmittance of
//!   (1 − R)² t / (1 − R² t²). Light passes straight, and the sheet looks alike from both sides.
//! - glTF's own thin walls have one face: R and 1 − R.
//! - Sampling: reflection by its share. With consistent normals, a direction on the wrong side has weight 0.
//! - Source: Stokes 1862, "On the intensity of the light reflected from or transmitted through a pile of plates".

use jerboa_ir::lang::F32;

use crate::bsdf::frame::{Side, reflect};
use crate::bsdf::models::Model;
use crate::bsdf::{Bsdf, BsdfSample, SampleFn};
use crate::core::color::{Color, black};
use crate::core::fresnel::fresnel_dielectric;
use crate::geometry::SurfaceElement;
use crate::schema::Materials;

/// `thin-glass`.
pub const MODEL: Model = Model {
    name: "thin-glass",
    parameters: &[],
    has_parts: false,
    make: |_, site| make_thin_glass_bsdf(site.surf, site.row.get(Materials::IOR), site.base),
};

/// A sheet whose inside lets `t` through.
pub fn make_thin_glass_bsdf(surf: SurfaceElement, ior: F32, t: Color) -> Bsdf {
    Bsdf::specular(SampleFn::lam(|b, (rng, wo)| {
        let side = Side::new(surf, wo);
        let normal = side.bent_normal(wo);
        let (reflected, passed) = sheet(fresnel_dielectric(normal.dot(wo), ior), t);
        let sum = reflected.max_channel() + passed.max_channel();
        let choice = sum.gt(0.0).select(reflected.max_channel() / sum, 1.0.into());
        let (u, _) = rng.next();
        b.if_(
            u.lt(choice),
            |_| {
                let wi = reflect(wo, normal);
                BsdfSample::specular(wi, side.reflects(wi).select(reflected / choice, black()))
            },
            |_| BsdfSample::specular(-wo, side.transmits(-wo).select(passed / (1.0 - choice), black())),
        )
    }))
}

/// What a sheet reflects and lets through, where one face reflects `r`. At r = 1 all is reflected.
fn sheet(r: F32, t: Color) -> (Color, Color) {
    let enters = 1.0 - r;
    let passed = t.map(|t| enters.gt(0.0).select(enters * enters * t / (1.0 - r * r * (t * t)), 0.0.into()));
    (passed.zip(t, |passed, t| r + passed * (r * t)), passed)
}
