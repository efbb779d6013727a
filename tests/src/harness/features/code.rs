//! What many features share, columns and sources: whom it is there for.

use jerboa_lib_render::host::device::DeviceKind;
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::tables::CameraKind;
use jerboa_scenes::{AlphaMode, Material};

use super::Feature;
use super::used::*;
use crate::harness::subjects::Subject;

/// The table.
pub const TABLE: &[Feature] = &[
    code("surfaces, and streams of hits", &["ray.rs", "core/color.rs"], |s| {
        has_surfaces(s) || s.device != DeviceKind::CpuScalar
    }),
    code("surfaces that show more than their distance", &["Primitives."], |s| {
        let shows_side = !s.shows_light() && s.tracer != TracerKind::Depth;
        shows_materials(s) || shows_side || s.device != DeviceKind::CpuScalar
    }),
    code("points of triangles", &["geometry/triangle.rs"], |s| {
        shows_materials(s) && s.tracer != TracerKind::AovPlace
            || matches!(s.tracer, TracerKind::Normals | TracerKind::Occlusion | TracerKind::AovNormal)
    }),
    code("materials", &["Geometries.MATERIAL"], shows_materials),
    code("reflectance", &["Materials.BASE_R", "Materials.BASE_G", "Materials.BASE_B"], |s| {
        shows_materials(s) && s.tracer != TracerKind::AovPlace
    }),
    code("rays that leave surfaces", &["Vertices.", "geometry/offset.rs", "core/vec.rs"], leaves_surfaces),
    code("sides of surfaces", &["bsdf/frame.rs", "core/onb.rs"], |s| {
        leaves_surfaces(s) || s.tracer == TracerKind::AovNormal
    }),
    code("the side that the camera sees", &["tracer/mod.rs"], |s| {
        matches!(s.tracer, TracerKind::Occlusion | TracerKind::AovNormal)
    }),
    code("scattering", &["geometry.rs", "bsdf/gltf/view.rs"], scatters),
    code("drawn directions, and choices by share", &["core/sampling.rs"], |s| {
        let drawn = scatters_widely(s) || s.tracer == TracerKind::Occlusion;
        drawn || has_shown_facets(s) || s.camera() == CameraKind::Thin
    }),
    code("angles", &["core/math/mod.rs", "core/math/trig.rs"], |s| {
        let drawn = scatters_widely(s) || s.tracer == TracerKind::Occlusion;
        drawn || s.shows_light() && s.scene.environment.is_some() || s.camera() != CameraKind::Pinhole
    }),
    code("exponentials and powers", &["core/math/exp.rs"], |s| {
        any(s, |m| m.volume.is_some() || m.iridescence.is_some()) || has_model(s, "phong")
    }),
    code("holes, and back faces that are culled", &["cutout.rs"], |s| {
        any(s, |m| m.alpha_mode != AlphaMode::Opaque) || s.choices.cull_back_faces
    }),
    code("edges of triangles: where they are placed, and for frames", &["geometry/plane.rs"], |s| {
        shares(s) || any(s, |m| m.normal_texture.is_some() || m.anisotropy.is_some())
    }),
    code("lobes of extensions", &["lobes.rs"], |s| any(s, has_lobes)),
    code("emission, and widths of facets", &["material.rs"], |s| {
        s.shows_light() && (any(s, Material::is_emissive) || has_facets(s))
    }),
    code("gloss", &["bsdf/mod.rs", "bsdf/gltf/values.rs", "core/fresnel.rs"], has_shown_facets),
    code("layers over materials", &["bsdf/layer.rs"], |s| any(s, |m| m.sheen.is_some() || m.clearcoat.is_some())),
    code("gloss of opaque models", &["bsdf/gloss.rs"], |s| has_model(s, "plastic") || has_model(s, "conductor")),
    code("shares of models", &["bsdf/mix.rs"], |s| has_model(s, "blend") || has_model(s, "phong")),
    code("cumulative sums", &["core/cdf.rs"], |s| light_shapes(s) > 1 || shares(s)),
    code("one path after the other", &["device/cpu.rs"], |s| s.device == DeviceKind::CpuScalar),
    code("rays in turns", &["traverse/turns.rs"], |s| s.device != DeviceKind::CpuScalar),
];

const fn code(name: &'static str, leaves: &'static [&'static str], used: fn(&Subject) -> bool) -> Feature {
    Feature { name, used, facts: &[], leaves }
}

fn has_shown_facets(subject: &Subject) -> bool {
    subject.shows_light() && has_facets(subject)
}
