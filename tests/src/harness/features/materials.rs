//! Features of materials.

use super::Feature;
use super::used::*;

/// The table.
pub const TABLE: &[Feature] = &[
    Feature {
        name: "diffuse reflection",
        used: |s| any(s, is_diffuse),
        facts: &["Materials.HAS_DIFFUSE"],
        leaves: &["bsdf/diffuse.rs"],
    },
    Feature {
        name: "metal",
        used: |s| any(s, |m| m.metallic > 0.0),
        facts: &["Materials.HAS_METAL"],
        leaves: &["Materials.METALLIC"],
    },
    Feature {
        name: "facets",
        used: |s| s.shows_light() && has_facets(s),
        facts: &["Materials.SMOOTH"],
        leaves: &["Materials.ROUGHNESS"],
    },
    Feature {
        name: "rough facets",
        used: |s| s.shows_light() && any(s, has_rough_facets),
        facts: &["Materials.SMOOTH", "Materials.COAT_SMOOTH"],
        leaves: &["bsdf/rough.rs", "core/microfacet.rs"],
    },
    Feature {
        name: "smooth facets",
        used: |s| s.shows_light() && any(s, has_smooth_facets),
        facts: &["Materials.SMOOTH"],
        leaves: &["bsdf/gltf/smooth.rs"],
    },
    Feature {
        name: "transmission",
        used: |s| any(s, transmits),
        facts: &["Materials.HAS_TRANSMISSION"],
        leaves: &["Materials.TRANSMISSION"],
    },
    Feature {
        name: "dielectric layers",
        used: |s| any(s, |m| m.specular > 0.0 || transmits(m) || m.model.is_some()),
        facts: &["Materials.HAS_SPECULAR"],
        leaves: &["Materials.IOR"],
    },
    Feature {
        name: "layers of their own strength and colour",
        used: |s| any(s, |m| m.specular > 0.0 || transmits(m)),
        facts: &[],
        leaves: &["Materials.SPECULAR", "Materials.SPECULAR_R"],
    },
    Feature {
        name: "solids, which bend light",
        used: |s| any(s, |m| transmits(m) && m.volume.is_some()) || has_model(s, "dielectric"),
        facts: &["Materials.THIN"],
        leaves: &["bsdf/dielectric.rs"],
    },
    Feature {
        name: "thin walls, which do not",
        used: |s| s.shows_light() && any(s, is_thin_wall),
        facts: &["Materials.THIN"],
        leaves: &["bsdf/thin_wall.rs"],
    },
    Feature {
        name: "volumes",
        used: |s| any(s, |m| m.volume.is_some()),
        facts: &["Materials.HAS_ABSORPTION", "Settings.HAS_VOLUMES"],
        leaves: &["Materials.ABSORPTION_", "Frame.ABSORPTION_", "Lights.ABSORPTION_", "tracer/absorption.rs"],
    },
    Feature {
        name: "clear coats",
        used: |s| any(s, |m| m.clearcoat.is_some()),
        facts: &["Materials.HAS_COAT", "Materials.COAT_SMOOTH", "Models.USED"],
        leaves: &["Materials.COAT", "bsdf/coat.rs"],
    },
    Feature {
        name: "sheen",
        used: |s| any(s, |m| m.sheen.is_some()),
        facts: &["Materials.HAS_SHEEN", "Models.USED"],
        leaves: &["Materials.SHEEN_", "bsdf/sheen.rs"],
    },
    Feature {
        name: "anisotropy",
        used: |s| any(s, |m| m.anisotropy.is_some()),
        facts: &["Materials.HAS_ANISOTROPY", "Models.USED"],
        leaves: &["Materials.ANISOTROPY"],
    },
    Feature {
        name: "diffuse transmission",
        used: |s| any(s, |m| m.diffuse_transmission.is_some()),
        facts: &["Materials.HAS_DIFFUSE_TRANSMISSION", "Models.USED"],
        leaves: &["Materials.DIFFUSE_TRANSMISSION"],
    },
    Feature {
        name: "iridescence",
        used: |s| any(s, |m| m.iridescence.is_some()),
        facts: &["Materials.HAS_FILM", "Models.USED"],
        leaves: &["Materials.FILM", "core/thin_film.rs"],
    },
    Feature {
        name: "models other than glTF's",
        used: |s| any(s, |m| m.model.is_some()) || !s.scene.own.is_empty(),
        facts: &["Materials.MODEL", "Models.USED"],
        leaves: &["Parameters.", "Materials.NUMBERS"],
    },
    Feature {
        name: "blends",
        used: |s| any(s, |m| m.model.as_ref().is_some_and(|model| model.parts.is_some())),
        facts: &["Materials.MODEL"],
        leaves: &["Materials.FIRST", "Materials.SECOND"],
    },
    Feature {
        name: "unlit surfaces",
        used: |s| any(s, |m| m.unlit) && s.shows_light(),
        facts: &["Materials.UNLIT"],
        leaves: &["tracer/unlit.rs"],
    },
];
