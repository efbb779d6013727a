//! What several tests share: a smallest glTF file to vary, and what must hold of every scene.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use jerboa_scenes::{Error, Scene, TextureSource};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// A glTF document of the triangles that `indices` makes of `positions`, in a data: URI.
pub fn document(positions: &[[f32; 3]], indices: &[u32]) -> Value {
    let vertex_bytes = positions.iter().flatten().flat_map(|x| x.to_le_bytes());
    let bytes: Vec<u8> = vertex_bytes.chain(indices.iter().flat_map(|i| i.to_le_bytes())).collect();
    json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": bytes.len(), "uri": data_uri(&bytes)}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 12 * positions.len()},
            {"buffer": 0, "byteOffset": 12 * positions.len(), "byteLength": 4 * indices.len()},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": positions.len(), "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": indices.len(), "type": "SCALAR"},
        ],
    })
}

/// One triangle.
pub fn triangle() -> Value {
    document(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[0, 1, 2])
}

/// One triangle with a material whose base colour texture is the image described by `image`.
pub fn textured(image: Value) -> Value {
    let mut document = triangle();
    document["images"] = json!([image]);
    document["textures"] = json!([{"source": 0}]);
    document["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    document
}

/// Adds an accessor over bytes of its own and returns its index.
pub fn accessor(document: &mut Value, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
    let push = |list: &mut Value, element: Value| {
        let list = list.as_array_mut().unwrap();
        list.push(element);
        list.len() - 1
    };
    let buffer = push(&mut document["buffers"], json!({"byteLength": bytes.len(), "uri": data_uri(bytes)}));
    let view = push(&mut document["bufferViews"], json!({"buffer": buffer, "byteLength": bytes.len()}));
    let accessor = json!({"bufferView": view, "componentType": component, "type": kind, "count": count});
    push(&mut document["accessors"], accessor)
}

/// Bytes as a URI.
pub fn data_uri(bytes: &[u8]) -> String {
    format!("data:application/octet-stream;base64,{}", STANDARD.encode(bytes))
}

/// A document wrapped as GLB.
pub fn glb(document: &Value) -> Vec<u8> {
    let mut json = serde_json::to_vec(document).unwrap();
    json.resize(json.len().next_multiple_of(4), b' ');
    let words = [2, 20 + json.len() as u32, json.len() as u32].map(u32::to_le_bytes);
    [b"glTF", words.as_flattened(), b"JSON", &json].concat()
}

/// Writes a file and returns its path.
pub fn write(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// Loads a document from a folder of its own.
pub fn load(document: &Value) -> Result<Scene, Error> {
    let folder = tempfile::tempdir().unwrap();
    Scene::load(write(folder.path(), "scene.gltf", document.to_string()))
}

/// Panics unless every index of the scene is in range and every number finite.
pub fn check(scene: &Scene) {
    for instance in &scene.instances {
        assert!(instance.mesh < scene.meshes.len());
        assert!(instance.to_world.is_finite() && instance.to_world.inverse().is_finite());
    }
    for mesh in &scene.meshes {
        let vertices = mesh.positions.len();
        assert!(mesh.material < scene.materials.len());
        assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < vertices));
        assert!(mesh.positions.iter().all(|p| p.is_finite()));
        if let Some(normals) = &mesh.normals {
            assert!(normals.len() == vertices && normals.iter().all(|n| n.is_finite()));
        }
        if let Some(tangents) = &mesh.tangents {
            assert!(tangents.len() == vertices && tangents.iter().all(|t| t.is_finite()));
        }
        if let Some(colors) = &mesh.colors {
            assert!(colors.len() == vertices && colors.iter().all(|c| c.is_finite()));
        }
        for uv in mesh.uvs.iter().flatten() {
            assert!(uv.len() == vertices && uv.iter().all(|t| t.is_finite()));
        }
    }
    for material in &scene.materials {
        let numbers = [&material.base_color[..], &material.emissive, &material.specular_color];
        assert!(numbers.concat().iter().all(|x| x.is_finite() && *x >= 0.0));
        assert!(material.ior == 0.0 || material.ior >= 1.0);
        assert!(material.textures().all(|t| t.texture < scene.textures.len() && t.uv_set < 2));
    }
    for texture in &scene.textures {
        assert!(!matches!(texture.source, TextureSource::Image(i) if i >= scene.images.len()));
    }
    for image in &scene.images {
        assert_eq!(image.rgba.len() as u64, u64::from(image.width) * u64::from(image.height));
        assert!(!image.rgba.is_empty());
    }
    for camera in &scene.cameras {
        assert!(camera.to_world.is_finite() && camera.half_height() > 0.0 && camera.half_height().is_finite());
        assert!(camera.film_or_default().0 > 0 && camera.film_or_default().1 > 0);
    }
    for light in &scene.lights {
        assert!(light.to_world.is_finite() && light.direction().is_finite());
        assert!(light.intensity.iter().all(|x| x.is_finite() && *x >= 0.0));
    }
    if let Some(sky) = &scene.environment {
        assert_eq!(sky.radiance.len() as u64, u64::from(sky.width) * u64::from(sky.height));
        assert!(sky.radiance.iter().flatten().all(|x| x.is_finite() && *x >= 0.0));
        assert!(sky.intensity.is_finite() && sky.intensity >= 0.0 && sky.rotation_deg.is_finite());
    }
}
