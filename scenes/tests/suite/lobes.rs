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

#[test]
fn a_sheen() {
    let sheen = |extension| read("KHR_materials_sheen", extension).0.sheen;
    assert_eq!(sheen(json!({})), Some(Sheen::new([0.0; 3], 0.0)));
    let full = json!({
        "sheenColorFactor": [0.5, 0.25, 2], "sheenColorTexture": {"index": 0},
        "sheenRoughnessFactor": 0.5, "sheenRoughnessTexture": {"index": 0},
    });
    let expected = Sheen { color_texture: TEXTURE, roughness_texture: TEXTURE, ..Sheen::new([0.5, 0.25, 1.0], 0.5) };
    assert_eq!(sheen(full), Some(expected));
}

#[test]
fn an_anisotropy() {
    let anisotropy = |extension| read("KHR_materials_anisotropy", extension).0.anisotropy;
    assert_eq!(anisotropy(json!({})), Some(Anisotropy::new(0.0)));
    let full = json!({"anisotropyStrength": 0.5, "anisotropyRotation": 7, "anisotropyTexture": {"index": 0}});
    assert_eq!(anisotropy(full), Some(Anisotropy { strength: 0.5, rotation: 7.0, texture: TEXTURE }));
}

#[test]
fn an_iridescence() {
    let film = |extension| read("KHR_materials_iridescence", extension).0.iridescence;
    assert_eq!(film(json!({})), Some(Iridescence::new(0.0, 400.0)));
    let full = json!({
        "iridescenceFactor": 0.5, "iridescenceTexture": {"index": 0}, "iridescenceIor": 0.5,
        "iridescenceThicknessMinimum": 50, "iridescenceThicknessMaximum": 1e9, "iridescenceThicknessTexture": {"index": 0},
    });
    // An index below that of air and ten metres of film are beyond the model.
    let expected = Iridescence {
        factor: 0.5,
        texture: TEXTURE,
        ior: 1.0,
        thinnest: 50.0,
        thickest: 1e7,
        thickness_texture: TEXTURE,
    };
    assert_eq!(film(full), Some(expected));
}

#[test]
fn a_diffuse_transmission() {
    let lobe = |extension| read("KHR_materials_diffuse_transmission", extension).0.diffuse_transmission;
    assert_eq!(lobe(json!({})), Some(DiffuseTransmission::new(0.0, [1.0; 3])));
    let full = json!({
        "diffuseTransmissionFactor": 0.5, "diffuseTransmissionTexture": {"index": 0},
        "diffuseTransmissionColorFactor": [0.5, 0.25, 0.125], "diffuseTransmissionColorTexture": {"index": 0},
    });
    let expected = DiffuseTransmission {
        texture: TEXTURE,
        color_texture: TEXTURE,
        ..DiffuseTransmission::new(0.5, [0.5, 0.25, 0.125])
    };
    assert_eq!(lobe(full), Some(expected));
}

#[test]
fn faults_name_their_place() {
    for (extension, property) in [
        ("KHR_materials_clearcoat", "clearcoatFactor"),
        ("KHR_materials_sheen", "sheenColorFactor"),
        ("KHR_materials_anisotropy", "anisotropyRotation"),
        ("KHR_materials_iridescence", "iridescenceIor"),
        ("KHR_materials_diffuse_transmission", "diffuseTransmissionFactor"),
    ] {
        let mut d = textured(json!({"uri": data_uri(&png([9; 4]))}));
        d["materials"] = json!([{"extensions": {extension: {property: "much"}}}]);
        let error = load(&d).unwrap_err().to_string();
        assert!(error.contains(&format!("materials[0].extensions.{extension}.{property}: ")), "{error}");
    }
}
