//! KHR_draco_mesh_compression: what a stream says, and what becomes of broken ones.

use crate::common::*;
use draco_core::{
    DataType, EncoderBuffer, EncoderOptions, FaceIndex, GeometryAttributeType, Mesh, MeshEncoder, PointAttribute,
    PointIndex,
};
use glam::Vec3;
use serde_json::{Value, json};

/// A grid of n × n squares on a paraboloid, as positions and triangles.
fn bowl(n: u32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let at = |i: u32| i as f32 / n as f32 - 0.5;
    let place = |i: u32| [at(i % (n + 1)), at(i / (n + 1)), at(i % (n + 1)).powi(2) + at(i / (n + 1)).powi(2)];
    let positions = (0..(n + 1).pow(2)).map(place).collect();
    let square = |i: u32| {
        let a = i / n * (n + 1) + i % n;
        [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
    };
    (positions, (0..n * n).flat_map(square).collect())
}

/// The bowl as a Draco stream, with normals and texture coordinates. Speed 10 takes another method than the rest, and 0 another
/// traversal than 5.
pub fn stream(n: u32, speed: i32) -> Vec<u8> {
    let (positions, triangles) = bowl(n);
    let mut mesh = Mesh::new();
    mesh.set_num_points(positions.len());
    let normals = positions.iter().map(|p| Vec3::new(-2.0 * p[0], -2.0 * p[1], 1.0).normalize().to_array());
    let uvs = positions.iter().map(|p| [p[0] + 0.5, p[1] + 0.5]);
    mesh.add_attribute(attribute(GeometryAttributeType::Position, &positions));
    mesh.add_attribute(attribute(GeometryAttributeType::Normal, &normals.collect::<Vec<_>>()));
    mesh.add_attribute(attribute(GeometryAttributeType::TexCoord, &uvs.collect::<Vec<_>>()));
    mesh.set_num_faces(triangles.len());
    for (i, t) in triangles.iter().enumerate() {
        mesh.set_face(FaceIndex(i as u32), t.map(PointIndex));
    }
    let mut encoder = MeshEncoder::new();
    encoder.set_mesh(mesh);
    let mut buffer = EncoderBuffer::new();
    let mut options = EncoderOptions::new();
    options.set_compression_level(10 - speed);
    encoder.encode(&options, &mut buffer).unwrap();
    buffer.data().to_vec()
}

fn attribute<const N: usize>(kind: GeometryAttributeType, values: &[[f32; N]]) -> PointAttribute {
    let mut attribute = PointAttribute::new();
    attribute.init(kind, N as u8, DataType::Float32, false, values.len());
    let bytes: Vec<u8> = values.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    attribute.buffer_mut().write(0, &bytes);
    attribute
}

/// A file whose one primitive is in this stream, of the size of the bowl of n × n.
pub fn packed(n: u32, stream: &[u8]) -> Value {
    let mut d = triangle();
    d["buffers"] = json!([{"byteLength": stream.len(), "uri": data_uri(stream)}]);
    d["bufferViews"] = json!([{"buffer": 0, "byteLength": stream.len()}]);
    d["accessors"] = json!([
        {"componentType": 5126, "count": (n + 1).pow(2), "type": "VEC3"},
        {"componentType": 5123, "count": 6 * n * n, "type": "SCALAR"},
        {"componentType": 5126, "count": (n + 1).pow(2), "type": "VEC3"},
        {"componentType": 5126, "count": (n + 1).pow(2), "type": "VEC2"},
    ]);
    d["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": 0, "NORMAL": 2, "TEXCOORD_0": 3});
    d["meshes"][0]["primitives"][0]["extensions"] = json!({"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}}});
    d["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    d["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    d
}

#[test]
fn a_stream_is_the_mesh_it_was_made_of() {
    for speed in [0, 5, 10] {
        compare(7, speed);
    }
}

fn compare(n: u32, speed: i32) {
    let (positions, triangles) = bowl(n);
    let scene = load(&packed(n, &stream(n, speed))).unwrap();
    check(&scene);
    assert_eq!(scene.warnings, []);
    let mesh = &scene.meshes[0];
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (positions.len(), triangles.len()));
    let (normals, uvs) = (mesh.normals.as_ref().unwrap(), mesh.uvs[0].as_ref().unwrap());
    for ((p, n), uv) in mesh.positions.iter().zip(normals).zip(uvs) {
        // Normals have 8 bits or more to an axis of the octahedron, texture coordinates 10.
        assert!(n.distance(Vec3::new(-2.0 * p.x, -2.0 * p.y, 1.0).normalize()) < 0.03, "{n} at {p}");
        assert!((p.x + 0.5 - uv.x).abs() < 0.003 && (p.y + 0.5 - uv.y).abs() < 0.003, "{uv} at {p}");
    }
    // Points and triangles come in another order, and positions were rounded to 11 bits or more.
    let corners = |triangle: [Vec3; 3]| {
        let mut corners = triangle.map(|p| (p * 1000.0).round().as_ivec3().to_array());
        corners.sort();
        corners
    };
    let mut ours: Vec<_> = mesh.triangles.iter().map(|t| corners(t.map(|i| mesh.positions[i as usize]))).collect();
    let mut theirs: Vec<_> = triangles.iter().map(|t| corners(t.map(|i| Vec3::from(positions[i as usize])))).collect();
    ours.sort();
    theirs.sort();
    for (a, b) in ours.iter().flatten().flatten().zip(theirs.iter().flatten().flatten()) {
        assert!((a - b).abs() <= 1, "{a}, not {b} thousandths");
    }
}

#[test]
fn a_broken_stream_is_an_error_with_its_place() {
    let whole = stream(3, 5);
    let error = |d: Value| load(&d).unwrap_err().to_string();
    let cut = error(packed(3, &whole[..whole.len() / 2]));
    let place = "meshes[0].primitives[0].extensions.KHR_draco_mesh_compression: the Draco stream cannot be decoded";
    assert!(cut.contains(place), "{cut}");
    let larger = error(packed(4, &whole));
    assert!(larger.contains("accessors[0]: 25 elements, but"), "{larger}");
    let mut d = packed(3, &whole);
    d["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] = json!(9);
    assert!(error(d).contains("the Draco stream has no such attribute"));
}

#[test]
fn other_compressions_are_named_with_what_to_do() {
    for (name, remedy) in [
        ("EXT_meshopt_compression", "export without mesh compression, or with Draco's"),
        ("KHR_texture_basisu", "export textures as PNG, JPEG or WebP"),
    ] {
        let mut d = triangle();
        d["extensionsRequired"] = json!([name]);
        let error = load(&d).unwrap_err().to_string();
        assert!(error.contains(name) && error.ends_with(remedy), "{error}");
    }
}
