//! Features of lights.

use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::tables::light_tree::TREE_FROM;
use jerboa_scenes::{LightKind, Material};

use super::Feature;
use super::used::*;

/// The table.
pub const TABLE: &[Feature] = &[
    Feature {
        name: "light",
        used: |s| is_lit(&s.scene) && s.shows_light(),
        facts: &["Settings.HAS_LIGHTS"],
        leaves: &["Lights.", "Settings.LIGHT_COUNT", "light.rs"],
    },
    Feature {
        name: "a choice among lights",
        used: |s| light_shapes(s) > 1,
        facts: &["Settings.HAS_ONE_LIGHT"],
        leaves: &["LightChoice."],
    },
    Feature {
        name: "a tree of lights",
        used: |s| placed_lights(s) >= TREE_FROM,
        facts: &["Settings.HAS_LIGHT_TREE"],
        leaves: &["LightTree.", "Lights.TRAIL", "Settings.TREE_LIGHTS", "light/tree.rs"],
    },
    Feature {
        name: "an environment",
        used: |s| s.scene.environment.is_some() && s.shows_light(),
        facts: &["Settings.HAS_ENVIRONMENT", "Lights.KIND"],
        leaves: &[
            "Environment.",
            "EnvironmentTexels.",
            "EnvironmentRows.",
            "EnvironmentColumns.",
            "light/environment.rs",
            "core/alias.rs",
        ],
    },
    Feature {
        name: "lights with an area",
        used: |s| any(s, Material::is_emissive),
        facts: &["Materials.EMISSIVE", "Lights.KIND", "Lights.MATERIAL"],
        leaves: &["Lights.AREA", "Lights.E2_X", "Materials.EMISSION_", "Primitives.LIGHT", "light/area.rs"],
    },
    Feature {
        name: "triangles of light",
        used: has_triangle_lights,
        facts: &["Lights.KIND"],
        leaves: &["core/triangle.rs"],
    },
    Feature {
        name: "parallelograms of light",
        used: has_quad_lights,
        facts: &["Lights.KIND"],
        leaves: &["Lights.PRIMITIVE1", "Lights.TURN1"],
    },
    Feature {
        name: "lamps that shine on both sides",
        used: |s| any(s, |m| m.is_emissive() && m.double_sided) && s.shows_light(),
        facts: &["Materials.DOUBLE_SIDED", "Lights.DOUBLE_SIDED"],
        leaves: &["light/both_sides.rs"],
    },
    Feature {
        name: "lamps that are textured, or coated",
        used: |s| any(s, |m| m.is_emissive() && (m.emissive_texture.is_some() || m.clearcoat.is_some())),
        facts: &["Lights.TEXTURED"],
        leaves: &["Lights.TURN"],
    },
    Feature {
        name: "lights of a user's crate",
        used: |s| has_light(s, |kind| matches!(kind, LightKind::Own(_))),
        facts: &["Lights.KIND"],
        leaves: &["Lights.NUMBERS"],
    },
    Feature {
        name: "lights at a place",
        used: |s| has_light(s, |kind| kind != LightKind::Directional),
        facts: &["Lights.KIND"],
        leaves: &["light/point.rs"],
    },
    // Weights of paths from both sides ask this of lights whose kind they do not know.
    Feature {
        name: "spot lights",
        used: |s| has_light(s, is_cone) || s.tracer == TracerKind::Bidirectional,
        facts: &["Lights.KIND"],
        leaves: &["Lights.COS_OUTER"],
    },
    Feature {
        name: "edges of spot lights",
        used: |s| has_light(s, is_cone),
        facts: &["Lights.KIND"],
        leaves: &["Lights.COS_INNER", "light/spot.rs"],
    },
    Feature {
        name: "directional lights",
        used: |s| has_light(s, |kind| matches!(kind, LightKind::Directional | LightKind::Sun { .. })),
        facts: &["Lights.KIND"],
        leaves: &["light/directional.rs"],
    },
    Feature {
        name: "spheres and disks of light",
        used: |s| has_light(s, |kind| matches!(kind, LightKind::Sphere { .. } | LightKind::Disk { .. })),
        facts: &["Lights.KIND", "Models.USED"],
        leaves: &["Settings.SHAPES", "Lights.RADIUS"],
    },
    Feature {
        name: "spheres of light",
        used: |s| has_light(s, |kind| matches!(kind, LightKind::Sphere { .. })),
        facts: &["Lights.KIND"],
        leaves: &["light/sphere.rs"],
    },
    Feature {
        name: "disks of light",
        used: |s| has_light(s, |kind| matches!(kind, LightKind::Disk { .. })),
        facts: &["Lights.KIND"],
        leaves: &["light/disk.rs"],
    },
    Feature {
        name: "suns",
        used: |s| has_light(s, |kind| matches!(kind, LightKind::Sun { .. })),
        facts: &["Lights.KIND", "Models.USED"],
        leaves: &["Settings.SUNS", "Lights.OPENING", "light/sun.rs"],
    },
    Feature {
        name: "lights that are seen without a surface",
        used: has_seen_lights,
        facts: &["Models.USED"],
        leaves: &["SeenLights.", "light/seen.rs"],
    },
];

fn is_cone(kind: LightKind) -> bool {
    matches!(kind, LightKind::Spot { .. } | LightKind::Disk { .. })
}
