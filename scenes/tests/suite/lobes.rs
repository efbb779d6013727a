//! The lobes of glTF's extensions.

use crate::common::*;
use crate::reading::png;
use jerboa_scenes::*;
use serde_json::{Value, json};

/// The material with this extension, and the warnings; texture 0 is there.
fn read(name: &str, extension: Value) -> (Material, Vec<Warning>) {
    let mut d = textured(json!({"uri": data_uri(&png([9; 4]))}));
    d["materials"] = json!([{"extensions": {name: extension}}]);
    let scene = load(&d).unwrap();
    (scene.materials[0].clone(), scene.warnings)
}

/// The first texture, as it is.
const TEXTURE: Option<TextureRef> = Some(TextureRef { texture: 0, uv_set: 0, transform: None });

#[test]
fn a_clearcoat() {
    let coat = |extension| read("KHR_materials_clearcoat", extension).0.clearcoat;
    assert_eq!(coat(json!({})), Some(Clearcoat::new(0.0, 0.0)));
    let full = json!({
        "clearcoatFactor": 0.75, "clearcoatTexture": {"index": 0},
        "clearcoatRoughnessFactor": 0.5, "clearcoatRoughnessTexture": {"index": 0},
        "clearcoatNormalTexture": {"index": 0, "scale": 2},
    });
    let expected = Clearcoat {
        texture: TEXTURE,
        roughness_texture: TEXTURE,
        normal_texture: TEXTURE,
        normal_scale: 2.0,
        ..Clearcoat::new(0.75, 0.5)
    };
    assert_eq!(coat(full), Some(expected));
    let (m, warnings) = read("KHR_materials_clearcoat", json!({"clearcoatFactor": 7}));
    assert_eq!(m.clearcoat, Some(Clearcoat::new(1.0, 0.0)));
    assert_eq!(warnings[0].path, "materials[0].extensions.KHR_materials_clearcoat.clearcoatFactor");
}
