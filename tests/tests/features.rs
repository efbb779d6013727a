//! T25: a feature that a scene does not use has left nothing in its residual.
//!
//! Three tables, of what scenes, renders and sources of the library are there for. A row is a feature, whether it is used
//! (asked of the scene or of the choices, not of the renderer's tables), and what stands in a residual only for its sake:
//! words, which are columns that nothing else reads, or code of a source of the library. Every subject, a scene with its
//! choices, a tracer and a device, is held against every row. And each word and each source is found where it is used, so that
//! no row is idle; and every column and every source is some row's, or said to be needed everywhere.

use std::collections::BTreeSet;

use jerboa_ir::lang::SpecTy;
use jerboa_ir::{Node, Program, Time, Ty, print};
use jerboa_lib_render::bsdf::models::{MODELS, Model};
use jerboa_lib_render::host::device::DeviceKind;
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::tables::light_tree::TREE_FROM;
use jerboa_lib_render::host::tables::sharing::MOST_COPIES;
use jerboa_lib_render::host::tables::{CameraKind, Choices, Known, Tables};
use jerboa_lib_render::schema::BUFFERS;
use jerboa_scenes::{AlphaMode, LightKind, Material, Mesh, Scene, TextureRef, TextureSource, builtin};
use jerboa_tests::harness::subjects::{Subject, subjects};
use jerboa_tests::sources::root;

struct Feature {
    name: &'static str,
    /// Does the scene use it?
    used: fn(&Scene) -> bool,
    /// What stands in a residual for its sake alone.
    words: &'static [&'static str],
}

/// What a render may ask for, whatever its scene.
struct Choice {
    name: &'static str,
    /// Does the render ask for it?
    used: fn(&Subject) -> bool,
    /// What stands in a residual for its sake alone.
    words: &'static [&'static str],
}

/// A source of the library.
struct Code {
    /// From `lib-render/src`.
    file: &'static str,
    /// May code of it be in a residual?
    used: fn(&Subject) -> bool,
}

const FEATURES: &[Feature] = &[
    Feature { name: "textures", used: has_textures, words: &["Textures.", "Uvs."] },
    Feature {
        name: "images",
        used: has_images,
        words: &["Texels.RGBA", "Textures.OFFSET", "Textures.WIDTH", "Textures.HEIGHT"],
    },
    Feature { name: "images of colours", used: has_images, words: &["SrgbCurve.LINEAR"] },
    Feature { name: "patterns", used: has_patterns, words: &["Textures.EVEN_", "Textures.ODD_"] },
    Feature {
        name: "textures of a user's crate",
        used: |s| textures(s).any(|t| matches!(s.textures[t.texture].source, TextureSource::Own(_))),
        words: &["Textures.NUMBERS"],
    },
    Feature {
        name: "KHR_texture_transform",
        used: |s| textures(s).any(|t| t.transform.is_some()),
        words: &["Textures.M0", "Textures.M1"],
    },
    Feature {
        name: "borders",
        used: |s| textures(s).any(|t| s.textures[t.texture].border.is_some()),
        words: &["Textures.BORDER_"],
    },
    Feature {
        name: "normal maps",
        used: |s| any(s, |m| m.normal_texture.is_some()),
        words: &["Materials.NORMAL_SCALE", "Materials.NORMAL_TEXTURE"],
    },
    Feature { name: "metal", used: |s| any(s, |m| m.metallic > 0.0), words: &["Materials.METALLIC"] },
    Feature {
        name: "facets",
        used: |s| any(s, |m| is_glossy(m) || m.model.is_some()),
        words: &["Materials.ROUGHNESS"],
    },
    Feature { name: "transmission", used: |s| any(s, transmits), words: &["Materials.TRANSMISSION"] },
    Feature {
        name: "dielectric layers",
        used: |s| any(s, |m| m.specular > 0.0 || transmits(m) || m.model.is_some()),
        words: &["Materials.IOR"],
    },
    Feature {
        name: "layers of their own strength and colour",
        used: |s| any(s, |m| m.specular > 0.0 || transmits(m)),
        words: &["Materials.SPECULAR", "Materials.SPECULAR_R"],
    },
    Feature {
        name: "volumes",
        used: |s| any(s, |m| m.volume.is_some()),
        words: &["Materials.ABSORPTION_", "Frame.ABSORPTION_"],
    },
    Feature { name: "clear coats", used: |s| any(s, |m| m.clearcoat.is_some()), words: &["Materials.COAT"] },
    Feature { name: "sheen", used: |s| any(s, |m| m.sheen.is_some()), words: &["Materials.SHEEN_"] },
    Feature { name: "anisotropy", used: |s| any(s, |m| m.anisotropy.is_some()), words: &["Materials.ANISOTROPY"] },
    Feature {
        name: "diffuse transmission",
        used: |s| any(s, |m| m.diffuse_transmission.is_some()),
        words: &["Materials.DIFFUSE_TRANSMISSION"],
    },
    Feature { name: "iridescence", used: |s| any(s, |m| m.iridescence.is_some()), words: &["Materials.FILM"] },
    Feature {
        name: "models other than glTF's",
        used: |s| any(s, |m| m.model.is_some()) || !s.own.is_empty(),
        words: &["Parameters.", "Materials.NUMBERS"],
    },
    Feature {
        name: "blends",
        used: |s| any(s, |m| m.model.as_ref().is_some_and(|model| model.parts.is_some())),
        words: &["Materials.FIRST", "Materials.SECOND"],
    },
    Feature {
        name: "alpha masks",
        used: |s| any(s, |m| matches!(m.alpha_mode, AlphaMode::Mask(_))),
        words: &["Materials.ALPHA_CUTOFF"],
    },
    Feature { name: "alpha", used: |s| any(s, |m| m.alpha_mode != AlphaMode::Opaque), words: &["Materials.BASE_A"] },
    Feature {
        name: "interpolated normals",
        used: |s| s.meshes.iter().any(|m| m.normals.is_some()),
        words: &["Normals."],
    },
    Feature { name: "tangents", used: |s| s.meshes.iter().any(|m| m.tangents.is_some()), words: &["Tangents."] },
    Feature { name: "colours of vertices", used: |s| s.meshes.iter().any(|m| m.colors.is_some()), words: &["Colors."] },
    Feature {
        name: "instances that share triangles",
        used: shares,
        words: &["Instances.", "Instances.FIRST", "Instances.AXIS_X_X", "Settings.INSTANCE_COUNT"],
    },
    Feature {
        name: "an environment",
        used: |s| s.environment.is_some(),
        words: &["Environment.", "EnvironmentTexels.", "EnvironmentRows.", "EnvironmentColumns."],
    },
    Feature {
        name: "lights with an area",
        used: |s| any(s, Material::is_emissive),
        words: &["Lights.AREA", "Lights.E2_X", "Materials.EMISSION_", "Primitives.LIGHT"],
    },
    Feature { name: "light", used: is_lit, words: &["Lights.", "Settings.LIGHT_COUNT"] },
    Feature {
        name: "lights of a user's crate",
        used: |s| s.lights.iter().any(|l| matches!(l.kind, LightKind::Own(_))),
        words: &["Lights.NUMBERS"],
    },
    Feature { name: "a choice among lights", used: |s| light_shapes(s) > 1, words: &["LightChoice."] },
    Feature {
        name: "spheres and disks of light",
        used: |s| s.lights.iter().any(|l| matches!(l.kind, LightKind::Sphere { .. } | LightKind::Disk { .. })),
        words: &["Settings.SHAPES", "Lights.RADIUS"],
    },
    Feature {
        name: "suns",
        used: |s| s.lights.iter().any(|l| matches!(l.kind, LightKind::Sun { .. })),
        words: &["Settings.SUNS", "Lights.OPENING"],
    },
    Feature { name: "lights that are seen without a surface", used: has_seen_lights, words: &["SeenLights."] },
    Feature {
        name: "a tree of lights",
        used: |s| placed_lights(s) >= TREE_FROM,
        words: &["LightTree.", "Lights.TRAIL", "Settings.TREE_LIGHTS"],
    },
];

/// Textures of materials, each beside what it stands for.
const TEXTURES: &[Feature] = &[
    Feature {
        name: "colour",
        used: |s| any(s, |m| m.base_color_texture.is_some()),
        words: &["Materials.BASE_TEXTURE"],
    },
    Feature {
        name: "metalness and roughness",
        used: |s| any(s, |m| m.metallic_roughness_texture.is_some()),
        words: &["Materials.METALLIC_ROUGHNESS_TEXTURE"],
    },
    Feature {
        name: "emission",
        used: |s| any(s, |m| m.emissive_texture.is_some()),
        words: &["Materials.EMISSION_TEXTURE"],
    },
    Feature {
        name: "strength of the layer",
        used: |s| any(s, |m| m.specular_texture.is_some()),
        words: &["Materials.SPECULAR_TEXTURE"],
    },
    Feature {
        name: "colour of the layer",
        used: |s| any(s, |m| m.specular_color_texture.is_some()),
        words: &["Materials.SPECULAR_COLOR_TEXTURE"],
    },
    Feature {
        name: "transmission",
        used: |s| any(s, |m| m.transmission_texture.is_some()),
        words: &["Materials.TRANSMISSION_TEXTURE"],
    },
    Feature {
        name: "anisotropy",
        used: |s| any(s, |m| m.anisotropy.is_some_and(|lobe| lobe.texture.is_some())),
        words: &["Materials.ANISOTROPY_TEXTURE"],
    },
    Feature {
        name: "share of diffuse transmission",
        used: |s| any(s, |m| m.diffuse_transmission.is_some_and(|lobe| lobe.texture.is_some())),
        words: &["Materials.DIFFUSE_TRANSMISSION_TEXTURE"],
    },
    Feature {
        name: "colour of diffuse transmission",
        used: |s| any(s, |m| m.diffuse_transmission.is_some_and(|lobe| lobe.color_texture.is_some())),
        words: &["Materials.DIFFUSE_TRANSMISSION_COLOR_TEXTURE"],
    },
    Feature {
        name: "share of a film",
        used: |s| any(s, |m| m.iridescence.is_some_and(|film| film.texture.is_some())),
        words: &["Materials.FILM_TEXTURE"],
    },
    Feature {
        name: "thickness of a film",
        used: |s| any(s, |m| m.iridescence.is_some_and(|film| film.thickness_texture.is_some())),
        words: &["Materials.FILM_THICKNESS_TEXTURE"],
    },
    Feature {
        name: "colour of a sheen",
        used: |s| any(s, |m| m.sheen.is_some_and(|sheen| sheen.color_texture.is_some())),
        words: &["Materials.SHEEN_COLOR_TEXTURE"],
    },
    Feature {
        name: "roughness of a sheen",
        used: |s| any(s, |m| m.sheen.is_some_and(|sheen| sheen.roughness_texture.is_some())),
        words: &["Materials.SHEEN_ROUGHNESS_TEXTURE"],
    },
    Feature {
        name: "strength of a coat",
        used: |s| any(s, |m| m.clearcoat.is_some_and(|coat| coat.texture.is_some())),
        words: &["Materials.COAT_TEXTURE"],
    },
    Feature {
        name: "roughness of a coat",
        used: |s| any(s, |m| m.clearcoat.is_some_and(|coat| coat.roughness_texture.is_some())),
        words: &["Materials.COAT_ROUGHNESS_TEXTURE"],
    },
    Feature {
        name: "normals of a coat",
        used: |s| any(s, |m| m.clearcoat.is_some_and(|coat| coat.normal_texture.is_some())),
        words: &["Materials.COAT_NORMAL_TEXTURE", "Materials.COAT_NORMAL_SCALE"],
    },
];

const CHOICES: &[Choice] = &[
    // Weights of paths from both sides ask this of lights whose kind they do not know.
    Choice {
        name: "spot lights",
        used: |s| {
            has_light(s, |kind| matches!(kind, LightKind::Spot { .. } | LightKind::Disk { .. }))
                || s.tracer == TracerKind::Bidirectional
        },
        words: &["Lights.COS_OUTER"],
    },
    Choice {
        name: "edges of spot lights",
        used: |s| has_light(s, |kind| matches!(kind, LightKind::Spot { .. } | LightKind::Disk { .. })),
        words: &["Lights.COS_INNER"],
    },
    Choice { name: "a limit of depth", used: |s| s.choices.max_depth.is_some(), words: &["Settings.MAX_DEPTH"] },
    Choice {
        name: "roulette",
        used: |s| s.choices.rr_depth.is_some() && s.shows_light(),
        words: &["Settings.RR_DEPTH", "Settings.RR_CAP"],
    },
    Choice { name: "an offset of rays", used: |s| s.choices.ray_offset > 0.0, words: &["Settings.RAY_OFFSET"] },
    Choice {
        name: "ambient occlusion",
        used: |s| s.tracer == TracerKind::Occlusion,
        words: &["Settings.OCCLUSION_DISTANCE"],
    },
    Choice { name: "a lens", used: |s| s.camera() == CameraKind::Thin, words: &["Frame.LENS_", "Frame.FOCUS"] },
    Choice {
        name: "light that surfaces have scattered",
        used: Subject::shows_light,
        words: &[
            "Lights.",
            "Environment.",
            "EnvironmentTexels.",
            "Materials.EMISSION_",
            "Materials.ROUGHNESS",
            "Parameters.",
        ],
    },
    Choice {
        name: "paths from infinitely far away, disks before ceilings",
        used: |s| s.tracer.is_splatting() || has_light(s, |kind| matches!(kind, LightKind::Disk { .. })),
        words: &["Lights.SCENE_RADIUS"],
    },
    Choice { name: "two paths that meet", used: |s| s.tracer == TracerKind::Bidirectional, words: &["LightVertices."] },
    Choice {
        name: "streams of paths",
        used: |s| matches!(s.device, DeviceKind::Cpu | DeviceKind::GpuWavefront),
        words: &["Next.", "Hits.", "Order.", "Shadows."],
    },
    Choice { name: "paths that wait", used: |s| s.device != DeviceKind::CpuScalar, words: &["Paths."] },
    Choice { name: "samples in the order of pixels", used: |s| s.device != DeviceKind::Cpu, words: &["Samples."] },
    Choice {
        name: "sums that kernels add to",
        used: |s| s.device.is_gpu() || s.tracer.is_splatting(),
        words: &["Pixels."],
    },
    Choice {
        name: "counts of paths by the device",
        used: |s| s.device == DeviceKind::GpuWavefront,
        words: &["Ranges.", "Counts."],
    },
];

/// Columns that are no row's: what every picture needs.
const EVERYWHERE: &[&str] = &[
    "Geometries.MATERIAL",
    "Frame.",
    "Materials.BASE_R",
    "Materials.BASE_G",
    "Materials.BASE_B",
    "Primitives.",
    "Vertices.",
    "Tree.",
];

/// Sources of which a residual has code only if the scene, or the render, uses them; and beside them the source of each model that
/// is called like it ([`source_of`]).
const SOURCES: &[Code] = &[
    Code { file: "bsdf/coat.rs", used: |s| any(&s.scene, |m| m.clearcoat.is_some()) },
    Code { file: "bsdf/sheen.rs", used: |s| any(&s.scene, |m| m.sheen.is_some()) },
    Code { file: "bsdf/layer.rs", used: |s| any(&s.scene, |m| m.sheen.is_some() || m.clearcoat.is_some()) },
    Code { file: "core/thin_film.rs", used: |s| any(&s.scene, |m| m.iridescence.is_some()) },
    Code { file: "bsdf/gloss.rs", used: |s| has_model(s, "plastic") || has_model(s, "conductor") },
    Code { file: "bsdf/mix.rs", used: |s| has_model(s, "blend") || has_model(s, "phong") },
    Code { file: "bsdf/dielectric.rs", used: |s| any(&s.scene, |m| is_glossy(m) || m.model.is_some()) },
    Code { file: "bsdf/rough.rs", used: |s| any(&s.scene, |m| is_glossy(m) || m.model.is_some()) },
    Code { file: "core/microfacet.rs", used: |s| any(&s.scene, |m| is_glossy(m) || m.model.is_some()) },
    Code { file: "core/fresnel.rs", used: |s| any(&s.scene, |m| is_glossy(m) || m.model.is_some()) },
    Code { file: "normal_map.rs", used: |s| any(&s.scene, |m| m.normal_texture.is_some()) },
    Code { file: "cutout.rs", used: |s| any(&s.scene, |m| m.alpha_mode != AlphaMode::Opaque) },
    Code { file: "image.rs", used: |s| has_images(&s.scene) },
    Code { file: "image/nearest.rs", used: |s| has_images(&s.scene) },
    Code { file: "image/bilinear.rs", used: |s| has_images(&s.scene) },
    Code { file: "image/bicubic.rs", used: |s| has_images(&s.scene) },
    Code { file: "image/border.rs", used: |s| has_images(&s.scene) },
    Code { file: "image/border/repeat.rs", used: |s| has_images(&s.scene) },
    Code { file: "image/border/clamp.rs", used: |s| has_images(&s.scene) },
    Code { file: "image/border/mirror.rs", used: |s| has_images(&s.scene) },
    Code { file: "image/border/constant.rs", used: |s| has_images(&s.scene) },
    Code { file: "texture/checkerboard.rs", used: |s| has_patterns(&s.scene) },
    Code { file: "texture/noise.rs", used: |s| has_patterns(&s.scene) },
    Code { file: "texture/transform.rs", used: |s| has_textures(&s.scene) },
    Code { file: "light/area.rs", used: |s| any(&s.scene, Material::is_emissive) },
    Code {
        file: "light/directional.rs",
        used: |s| has_light(s, |kind| matches!(kind, LightKind::Directional | LightKind::Sun { .. })),
    },
    Code { file: "light/point.rs", used: |s| has_light(s, |kind| kind != LightKind::Directional) },
    Code {
        file: "light/spot.rs",
        used: |s| has_light(s, |kind| matches!(kind, LightKind::Spot { .. } | LightKind::Disk { .. })),
    },
    Code { file: "light/sphere.rs", used: |s| has_light(s, |kind| matches!(kind, LightKind::Sphere { .. })) },
    Code { file: "light/disk.rs", used: |s| has_light(s, |kind| matches!(kind, LightKind::Disk { .. })) },
    Code { file: "light/sun.rs", used: |s| has_light(s, |kind| matches!(kind, LightKind::Sun { .. })) },
    Code { file: "light/seen.rs", used: |s| has_seen_lights(&s.scene) },
    Code { file: "light/environment.rs", used: |s| s.scene.environment.is_some() && s.shows_light() },
    Code { file: "light/tree.rs", used: |s| placed_lights(&s.scene) >= TREE_FROM },
    Code { file: "light.rs", used: |s| is_lit(&s.scene) && s.shows_light() },
    Code { file: "mis.rs", used: |s| is_lit(&s.scene) && s.tracer == TracerKind::Path },
    Code { file: "core/spherical.rs", used: |s| s.choices.solid_angle || has_seen_lights(&s.scene) },
    Code { file: "core/alias.rs", used: |s| s.scene.environment.is_some() && s.shows_light() },
    Code { file: "core/cdf.rs", used: |s| light_shapes(&s.scene) > 1 || shares(&s.scene) },
    Code { file: "core/exact.rs", used: |s| s.device.is_gpu() || s.tracer.is_splatting() },
    Code { file: "camera/pinhole.rs", used: |s| s.camera() == CameraKind::Pinhole },
    Code { file: "camera/thin_lens.rs", used: |s| s.camera() == CameraKind::Thin },
    Code { file: "camera/orthographic.rs", used: |s| s.camera() == CameraKind::Orthographic },
    Code { file: "camera/fisheye.rs", used: |s| s.camera() == CameraKind::Fisheye },
    Code { file: "tracer/absorption.rs", used: |s| any(&s.scene, |m| m.volume.is_some()) },
    Code { file: "tracer/roulette.rs", used: |s| s.choices.rr_depth.is_some() && s.shows_light() },
    Code { file: "tracer/path.rs", used: Subject::shows_light },
    Code { file: "tracer/light.rs", used: |s| s.tracer.is_splatting() },
    Code { file: "tracer/lens.rs", used: |s| s.tracer.is_splatting() },
    Code { file: "tracer/adjoint.rs", used: |s| s.tracer.is_splatting() },
    Code { file: "tracer/bidirectional.rs", used: |s| s.tracer == TracerKind::Bidirectional },
    Code { file: "tracer/occlusion.rs", used: |s| s.tracer == TracerKind::Occlusion },
    Code { file: "tracer/aov.rs", used: |s| matches!(s.tracer, TracerKind::AovNormal | TracerKind::AovPlace) },
    Code {
        file: "tracer/debug.rs",
        used: |s| matches!(s.tracer, TracerKind::Normals | TracerKind::Albedo | TracerKind::Depth),
    },
    Code { file: "traverse/instance.rs", used: |s| shares(&s.scene) },
    Code { file: "geometry/place.rs", used: |s| shares(&s.scene) },
    Code { file: "device/both.rs", used: |s| s.tracer == TracerKind::Bidirectional },
    Code { file: "device/stream.rs", used: |s| s.device != DeviceKind::CpuScalar },
    Code { file: "device/megakernel.rs", used: |s| s.device == DeviceKind::GpuMegakernel },
    Code { file: "device/wavefront.rs", used: |s| s.device.is_gpu() },
    Code { file: "device/pixel.rs", used: |s| s.device.is_gpu() || s.tracer.is_splatting() },
];

/// Sources that are no row's: what every picture needs, and what many rows share.
const COMMON: &str = "bsdf/bent.rs bsdf/diffuse.rs bsdf/frame.rs bsdf/gltf/values.rs bsdf/gltf/view.rs bsdf/mod.rs camera.rs \
    core/color.rs core/math/exp.rs core/math/mod.rs core/math/trig.rs core/onb.rs core/rng.rs core/sampling.rs core/sobol.rs \
    core/vec.rs device/cpu.rs geometry.rs geometry/offset.rs geometry/plane.rs geometry/triangle.rs lobes.rs material.rs \
    ray.rs sampler.rs tracer/mod.rs traverse/bvh.rs traverse/lanes.rs traverse/line.rs traverse/memory.rs traverse/stack.rs \
    traverse/triangle.rs traverse/turns.rs traverse/walk.rs";

#[test]
fn what_a_scene_does_not_use_is_in_none_of_its_residuals() {
    let rows = || FEATURES.iter().chain(TEXTURES);
    let mut idle: BTreeSet<(&str, &str)> = rows().flat_map(|f| f.words.iter().map(|word| (f.name, *word))).collect();
    idle.extend(CHOICES.iter().flat_map(|c| c.words.iter().map(|word| (c.name, *word))));
    let models: Vec<(String, &str)> = MODELS.iter().filter_map(source_of).collect();
    idle.extend(models.iter().map(|(file, _)| ("code", &**file)));
    idle.extend(SOURCES.iter().map(|code| ("code", code.file)));
    let (mut found, mut all_sources) = (BTreeSet::new(), BTreeSet::new());
    for subject in subjects() {
        let asked = rows().map(|f| (f.name, (f.used)(&subject.scene), f.words));
        let asked: Vec<_> = asked.chain(CHOICES.iter().map(|c| (c.name, (c.used)(&subject), c.words))).collect();
        for (kernel, program) in subject.residuals() {
            let (text, sources) = (body(&program), sources(&program));
            all_sources.extend(sources.iter().map(|file| file.to_string()));
            let mut note = |name, used: bool, what, is_there: bool| {
                if is_there && used {
                    idle.remove(&(name, what));
                } else if is_there {
                    found.insert(format!("{}: no {name}, but `{what}` is in `{kernel}`", subject.name));
                }
            };
            for (name, used, words) in &asked {
                words.iter().for_each(|word| note(name, *used, *word, text.contains(word)));
            }
            for Code { file, used } in SOURCES {
                note("code", used(&subject), file, sources.contains(file));
            }
            for (file, model) in &models {
                note("code", has_model(&subject, model), file, sources.contains(&**file));
            }
        }
    }
    let found: Vec<String> = found.into_iter().collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
    assert!(idle.is_empty(), "what no residual has: {idle:?}");
    let is_models = |file: &str| models.iter().any(|(of, _)| of == file);
    let is_listed = |file: &str| {
        COMMON.split_whitespace().any(|common| common == file)
            || is_models(file)
            || SOURCES.iter().any(|code| code.file == file)
    };
    let forgotten: Vec<String> = all_sources.into_iter().filter(|file| !is_listed(file)).collect();
    assert_eq!(forgotten, [""; 0], "sources in residuals that are in no row");
}

/// Shadow rays have a kernel only where a vertex may ask for light; a renderer that knows nothing must always have it.
#[test]
fn without_lights_no_kernel_traces_shadow_rays() {
    let mut dark = 0;
    for name in builtin::list().iter().map(|b| b.name) {
        let scene = Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{name}: {e}"));
        let has = |known: Known, tracer: TracerKind| {
            let tables = Tables::new(&scene, &Choices::default(), known);
            [DeviceKind::Cpu, DeviceKind::GpuWavefront]
                .map(|device| device.requests(&tables, tracer).iter().any(|r| r.name.ends_with("shadow")))
        };
        dark += u32::from(!is_lit(&scene));
        assert_eq!(has(Known::Structure, TracerKind::Path), [is_lit(&scene); 2], "{name}");
        assert_eq!(has(Known::Nothing, TracerKind::Path), [true; 2], "{name}");
        assert_eq!(has(Known::Structure, TracerKind::Depth), [false; 2], "{name}");
        assert_eq!(has(Known::Structure, TracerKind::Occlusion), [true; 2], "{name}");
    }
    assert!(dark > 0, "every scene is lit");
}

/// The source that is called like a model, if no row of [`SOURCES`] says who uses it.
fn source_of(model: &Model) -> Option<(String, &'static str)> {
    let file = format!("bsdf/{}.rs", model.name.replace('-', "_"));
    let is_file = root().join("lib-render/src").join(&file).is_file();
    (is_file && !SOURCES.iter().any(|code| code.file == file)).then_some((file, model.name))
}

/// The text of a program without the declarations of buffers.
fn body(program: &Program) -> String {
    let text = print(program);
    let start = text.find("\nfun ").expect("a residual has a function");
    text[start..].to_string()
}

/// The sources of the library whose code is in a program.
fn sources(program: &Program) -> BTreeSet<&str> {
    // Reads, and what is done to indices, are shared by whoever asks for the same: they have the line of the first.
    let is_work = |id: usize| matches!(program.nodes[id], Node::Prim { .. }) && program.types[id] != Ty::u32();
    let code = program.locs.iter().enumerate().filter(|(id, _)| is_work(*id));
    code.filter_map(|(_, loc)| loc.file.strip_prefix("lib-render/src/")).collect()
}

/// No column is forgotten: each is a row's, or needed everywhere, or structure, which is known. (A reference is a row whose
/// number may be unknown.)
#[test]
fn every_column_is_some_rows() {
    let rows = FEATURES.iter().chain(TEXTURES).flat_map(|f| f.words);
    let words: Vec<&str> = rows.chain(CHOICES.iter().flat_map(|c| c.words)).chain(EVERYWHERE).copied().collect();
    let mut forgotten = Vec::new();
    for (table, _, _, columns) in BUFFERS {
        for column in columns.iter().filter(|c| c.time != Time::Structure || matches!(c.ty, SpecTy::Ref(_))) {
            let name = format!("{table}.{}", column.name);
            if !words.iter().any(|word| name.starts_with(word)) {
                forgotten.push(name);
            }
        }
    }
    assert_eq!(forgotten, [""; 0]);
}

// ---- what a scene uses

fn any(scene: &Scene, is: impl Fn(&Material) -> bool) -> bool {
    scene.materials.iter().any(is)
}

fn transmits(material: &Material) -> bool {
    material.transmission > 0.0
}

fn is_glossy(material: &Material) -> bool {
    material.specular > 0.0 || material.metallic > 0.0 || transmits(material) || has_lobes(material)
}

fn has_lobes(m: &Material) -> bool {
    let stretched = m.anisotropy.is_some() || m.iridescence.is_some() || m.diffuse_transmission.is_some();
    stretched || m.sheen.is_some() || m.clearcoat.is_some()
}

fn has_model(subject: &Subject, name: &str) -> bool {
    any(&subject.scene, |m| m.model.as_ref().is_some_and(|model| model.name == name))
}

fn has_light(subject: &Subject, is: impl Fn(LightKind) -> bool) -> bool {
    subject.scene.lights.iter().any(|light| is(light.kind))
}

fn textures(scene: &Scene) -> impl Iterator<Item = &TextureRef> {
    scene.materials.iter().flat_map(Material::textures)
}

fn has_textures(scene: &Scene) -> bool {
    textures(scene).next().is_some()
}

fn has_images(scene: &Scene) -> bool {
    textures(scene).any(|t| matches!(scene.textures[t.texture].source, TextureSource::Image(_)))
}

fn has_patterns(scene: &Scene) -> bool {
    use TextureSource::{Checkerboard, Noise};
    textures(scene).any(|t| matches!(scene.textures[t.texture].source, Checkerboard { .. } | Noise { .. }))
}

fn is_lit(scene: &Scene) -> bool {
    !scene.lights.is_empty() || scene.environment.is_some() || any(scene, Material::is_emissive)
}

fn has_seen_lights(scene: &Scene) -> bool {
    let is_seen = |kind| matches!(kind, LightKind::Sphere { .. } | LightKind::Disk { .. } | LightKind::Sun { .. });
    scene.lights.iter().any(|light| is_seen(light.kind))
}

/// Triangles that shine. (Two of them may be one light.)
fn shining_triangles(scene: &Scene) -> usize {
    let shining = |mesh: &Mesh| scene.materials[mesh.material].is_emissive();
    let meshes = scene.instances.iter().map(|i| &scene.meshes[i.mesh]).filter(|mesh| shining(mesh));
    meshes.map(|mesh| mesh.triangles.len()).sum()
}

/// Lights and triangles that shine, and the environment.
fn light_shapes(scene: &Scene) -> usize {
    shining_triangles(scene) + scene.lights.len() + usize::from(scene.environment.is_some())
}

/// Those of them that have a place.
fn placed_lights(scene: &Scene) -> usize {
    let is_far = |kind| matches!(kind, LightKind::Directional | LightKind::Sun { .. });
    let placed = scene.lights.iter().filter(|light| !is_far(light.kind));
    shining_triangles(scene) + placed.count()
}

/// Would copies of some mesh in the world be many, and does it not emit?
fn shares(scene: &Scene) -> bool {
    let users = |mesh: usize| scene.instances.iter().filter(|instance| instance.mesh == mesh).count();
    scene.meshes.iter().enumerate().any(|(number, mesh)| {
        let copies = users(number).saturating_sub(1) * mesh.triangles.len();
        copies > MOST_COPIES as usize && !scene.materials[mesh.material].is_emissive()
    })
}
