//! Features of meshes and of instances.

use jerboa_scenes::AlphaMode;

use super::Feature;
use super::used::*;

/// The table.
pub const TABLE: &[Feature] = &[
    Feature {
        name: "interpolated normals",
        used: |s| has_mesh(s, |m| m.normals.is_some()),
        facts: &["Geometries.HAS_NORMALS"],
        leaves: &["Normals."],
    },
    Feature {
        name: "tangents",
        used: |s| has_mesh(s, |m| m.tangents.is_some()),
        facts: &["Geometries.HAS_TANGENTS"],
        leaves: &["Tangents."],
    },
    Feature {
        name: "colours of vertices",
        used: |s| has_mesh(s, |m| m.colors.is_some()),
        facts: &["Geometries.HAS_COLORS"],
        leaves: &["Colors."],
    },
    Feature {
        name: "the first set of coordinates",
        used: |s| has_mesh(s, |m| m.uvs[0].is_some()) && (has_textures(s) || any(s, |m| m.anisotropy.is_some())),
        facts: &["Geometries.HAS_UV0"],
        leaves: &["Uvs.U0", "Uvs.V0"],
    },
    Feature {
        name: "instances that share triangles",
        used: shares,
        facts: &["Settings.HAS_INSTANCES"],
        leaves: &[
            "Instances.FIRST",
            "Instances.AXIS_X_X",
            "Instances.",
            "Settings.INSTANCE_COUNT",
            "traverse/instance.rs",
            "geometry/place.rs",
        ],
    },
    Feature {
        name: "holes",
        used: |s| any(s, |m| m.alpha_mode != AlphaMode::Opaque),
        facts: &["Materials.ALPHA_MODE", "Settings.HAS_CUTOUTS"],
        leaves: &["Materials.BASE_A"],
    },
    Feature {
        name: "alpha masks",
        used: |s| any(s, |m| matches!(m.alpha_mode, AlphaMode::Mask(_))),
        facts: &["Materials.ALPHA_MODE"],
        leaves: &["Materials.ALPHA_CUTOFF", "cutout/mask.rs"],
    },
    Feature {
        name: "surfaces that fade",
        used: |s| any(s, |m| m.alpha_mode == AlphaMode::Blend),
        facts: &["Materials.ALPHA_MODE"],
        leaves: &["cutout/blend.rs"],
    },
    Feature {
        name: "back faces that are culled",
        used: |s| s.choices.cull_back_faces && any(s, |m| !m.double_sided),
        facts: &["Materials.CULLED", "Settings.HAS_CUTOUTS"],
        leaves: &["culling.rs"],
    },
];
