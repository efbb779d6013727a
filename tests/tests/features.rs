//! T25: a feature that a scene does not use has left nothing in its residual.
//!
//! One table. A row is a feature, whether a scene uses it (asked of the scene, not of the renderer's tables), and the words
//! that stand in a residual only for its sake: columns that nothing else reads. Every built-in scene is held against every
//! row, on both devices of the CPU. And each word is found where the feature is used, so that no row is idle.

use std::collections::BTreeSet;

use jerboa_ir::print;
use jerboa_lib_render::host::device::DeviceKind;
use jerboa_lib_render::host::generate::{Keep, TracerKind, residual};
use jerboa_lib_render::host::tables::sharing::MOST_COPIES;
use jerboa_lib_render::host::tables::{Choices, Known, Tables};
use jerboa_scenes::{AlphaMode, LightKind, Material, Mesh, Scene, TextureRef, TextureSource, builtin};

struct Feature {
    name: &'static str,
    /// Does the scene use it?
    used: fn(&Scene) -> bool,
    /// What stands in a residual for its sake alone.
    words: &'static [&'static str],
}

const FEATURES: &[Feature] = &[
    Feature { name: "textures", used: has_textures, words: &["Textures.", "Uvs."] },
    Feature { name: "images", used: has_images, words: &["Texels.RGBA", "Textures.OFFSET", "Textures.WIDTH"] },
    Feature { name: "patterns", used: has_patterns, words: &["Textures.EVEN_R", "Textures.ODD_R"] },
    Feature {
        name: "KHR_texture_transform",
        used: |s| textures(s).any(|t| t.transform.is_some()),
        words: &["Textures.M00", "Textures.M12"],
    },
    Feature {
        name: "borders",
        used: |s| textures(s).any(|t| s.textures[t.texture].border.is_some()),
        words: &["Textures.BORDER_R"],
    },
    Feature {
        name: "normal maps",
        used: |s| any(s, |m| m.normal_texture.is_some()),
        words: &["Materials.NORMAL_SCALE"],
    },
    Feature { name: "metal", used: |s| any(s, |m| m.metallic > 0.0), words: &["Materials.METALLIC"] },
    Feature { name: "transmission", used: |s| any(s, transmits), words: &["Materials.TRANSMISSION"] },
    Feature {
        name: "dielectric layers",
        used: |s| any(s, |m| m.specular > 0.0 || transmits(m) || m.model.is_some()),
        words: &["Materials.IOR"],
    },
    Feature {
        name: "volumes",
        used: |s| any(s, |m| m.volume.is_some()),
        words: &["Materials.ABSORPTION_R", "Frame.ABSORPTION_R"],
    },
    Feature { name: "clear coats", used: |s| any(s, |m| m.clearcoat.is_some()), words: &["Materials.COAT"] },
    Feature { name: "sheen", used: |s| any(s, |m| m.sheen.is_some()), words: &["Materials.SHEEN_R"] },
    Feature { name: "anisotropy", used: |s| any(s, |m| m.anisotropy.is_some()), words: &["Materials.ANISOTROPY"] },
    Feature {
        name: "diffuse transmission",
        used: |s| any(s, |m| m.diffuse_transmission.is_some()),
        words: &["Materials.DIFFUSE_TRANSMISSION"],
    },
    Feature { name: "iridescence", used: |s| any(s, |m| m.iridescence.is_some()), words: &["Materials.FILM"] },
    Feature { name: "models other than glTF's", used: |s| any(s, |m| m.model.is_some()), words: &["Parameters."] },
    Feature {
        name: "alpha masks",
        used: |s| any(s, |m| matches!(m.alpha_mode, AlphaMode::Mask(_))),
        words: &["Materials.ALPHA_CUTOFF"],
    },
    Feature { name: "alpha", used: |s| any(s, |m| m.alpha_mode != AlphaMode::Opaque), words: &["Materials.BASE_A"] },
    Feature {
        name: "interpolated normals",
        used: |s| s.meshes.iter().any(|m| m.normals.is_some()),
        words: &["Normals.X"],
    },
    Feature { name: "instances that share triangles", used: shares, words: &["Instances.FIRST", "Instances.AXIS_X_X"] },
    Feature {
        name: "an environment",
        used: |s| s.environment.is_some(),
        words: &["Environment.", "EnvironmentTexels.", "EnvironmentRows.", "EnvironmentColumns."],
    },
    Feature {
        name: "spot lights",
        used: |s| s.lights.iter().any(|l| matches!(l.kind, LightKind::Spot { .. } | LightKind::Disk { .. })),
        words: &["Lights.COS_OUTER", "Lights.COS_INNER"],
    },
    Feature {
        name: "lights with an area",
        used: |s| any(s, Material::is_emissive),
        words: &["Lights.AREA", "Lights.E2_X", "Materials.EMISSION_R"],
    },
    Feature { name: "light", used: is_lit, words: &["Lights."] },
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
];

#[test]
fn what_a_scene_does_not_use_is_in_none_of_its_residuals() {
    let mut idle: BTreeSet<(&str, &str)> =
        FEATURES.iter().flat_map(|f| f.words.iter().map(|word| (f.name, *word))).collect();
    let mut found = Vec::new();
    for name in builtin::list().iter().map(|b| b.name) {
        let scene = Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{name}: {e}"));
        for (kernel, text) in residuals(&scene) {
            for feature in FEATURES {
                for word in feature.words.iter().filter(|word| text.contains(**word)) {
                    if (feature.used)(&scene) {
                        idle.remove(&(feature.name, *word));
                    } else {
                        found.push(format!("{name} has no {}, but `{word}` is in `{kernel}`", feature.name));
                    }
                }
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
    assert!(idle.is_empty(), "words that no residual has: {idle:?}");
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

/// The residuals of a scene whose structure is known: name of the kernel, and text without the declarations of buffers.
fn residuals(scene: &Scene) -> Vec<(String, String)> {
    let tables = Tables::new(scene, &Choices::default(), Known::Structure);
    let requests = DeviceKind::CPU.map(|device| device.requests(&tables, TracerKind::Path)).concat();
    let text = |request| {
        let program =
            residual(&tables, request, Keep::default()).unwrap_or_else(|e| panic!("{}: {e}", scene.name)).program;
        let text = print(&program);
        let start = text.find("\nfun ").expect("a residual has a function");
        text[start..].to_string()
    };
    requests.iter().map(|request| (request.name.clone(), text(request))).collect()
}

// ---- what a scene uses

fn any(scene: &Scene, is: impl Fn(&Material) -> bool) -> bool {
    scene.materials.iter().any(is)
}

fn transmits(material: &Material) -> bool {
    material.transmission > 0.0
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

/// Lights and triangles that shine, and the environment. (Two triangles may be one light.)
fn light_shapes(scene: &Scene) -> usize {
    let shining = |mesh: &Mesh| scene.materials[mesh.material].is_emissive();
    let meshes = scene.instances.iter().map(|i| &scene.meshes[i.mesh]).filter(|mesh| shining(mesh));
    let triangles: usize = meshes.map(|mesh| mesh.triangles.len()).sum();
    triangles + scene.lights.len() + usize::from(scene.environment.is_some())
}

/// Would copies of some mesh in the world be many, and does it not emit?
fn shares(scene: &Scene) -> bool {
    let users = |mesh: usize| scene.instances.iter().filter(|instance| instance.mesh == mesh).count();
    scene.meshes.iter().enumerate().any(|(number, mesh)| {
        let copies = users(number).saturating_sub(1) * mesh.triangles.len();
        copies > MOST_COPIES as usize && !scene.materials[mesh.material].is_emissive()
    })
}
