//! T34: every error, provoked, with its words.

use crate::common::*;
use jerboa_scenes::*;
use serde_json::{Value, json};
use std::collections::HashSet;
use std::path::Path;

/// Names the variant. A new one does not compile until it is added here, and the test fails until it is provoked.
fn variant(error: &Error) -> &'static str {
    match error {
        Error::Read { .. } => "Read",
        Error::Builtin { .. } => "Builtin",
        Error::Choice { .. } => "Choice",
        Error::Container { .. } => "Container",
        Error::Json { .. } => "Json",
        Error::Value { .. } => "Value",
        Error::Index { .. } => "Index",
        Error::Uri { .. } => "Uri",
        Error::Extension { .. } => "Extension",
        Error::Limit { .. } => "Limit",
        Error::Environment { .. } => "Environment",
    }
}

const VARIANTS: usize = 11;

/// What `change` makes of the triangle's file leads to.
fn load_changed(folder: &Path, change: impl FnOnce(&mut Value)) -> Error {
    let mut document = triangle();
    change(&mut document);
    Scene::load(write(folder, "s.gltf", document.to_string())).unwrap_err()
}

#[test]
fn every_error_says_who_where_and_what_to_do() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path();
    let camera = |name: &str, scene: &str| Scene::load(scene).unwrap().camera_named(name).unwrap_err();
    let sound = write(folder, "sound.gltf", triangle().to_string());
    let set_environment = |file: &str, intensity, rotation| {
        Scene::default().set_environment(folder.join(file), intensity, rotation).unwrap_err()
    };
    let cases = [
        (
            Scene::load(folder.join("nowhere.glb")).unwrap_err(),
            "DIR/nowhere.glb: cannot be read: No such file or directory (os error 2); check the path and its permissions",
        ),
        (
            Scene::load("/dev/zero").unwrap_err(),
            "/dev/zero: cannot be read: not a regular file; check the path and its permissions",
        ),
        (
            camera("left", "builtin:empty"),
            "camera \"left\": there is no camera of that name or number; there are camera",
        ),
        (
            Scene::load(&sound).unwrap().camera_named("left").unwrap_err(),
            "camera \"left\": there is no camera to choose; leave the name out",
        ),
        (
            Scene::load(write(folder, "s.glb", "glTF")).unwrap_err(),
            "DIR/s.glb: not a glTF 2.0 file: the GLB header is cut off; export it again as .glb or .gltf",
        ),
        (
            Scene::load(write(folder, "s.gltf", "{\n]")).unwrap_err(),
            "DIR/s.gltf: the JSON does not parse: key must be a string at line 2 column 1; export it again",
        ),
        (
            load_changed(folder, |d| d["accessors"][0]["count"] = json!("3")),
            "DIR/s.gltf: accessors[0].count: not a non-negative integer; correct the property or export again",
        ),
        (
            load_changed(folder, |d| d["nodes"][0]["mesh"] = json!(1)),
            "DIR/s.gltf: nodes[0].mesh: index 1, but there are 1 meshes; the exporter wrote a broken reference",
        ),
        (
            load_changed(folder, |d| d["buffers"][0]["uri"] = json!("../s.bin")),
            "DIR/s.gltf: buffers[0].uri: \"../s.bin\" is outside the scene's folder; \
             use a data: URI or a file in the scene's own folder",
        ),
        (
            load_changed(folder, |d| d["extensionsRequired"] = json!(["FOO_bar"])),
            "DIR/s.gltf: extensionsRequired: FOO_bar is required but unknown to Jerboa; export without it",
        ),
        (
            Scene::load_within(&sound, &Limits { file_bytes: 10, ..Limits::default() }).unwrap_err(),
            "DIR/sound.gltf: a file of SIZE bytes exceeds the limit of 10 (file_bytes); make it smaller or raise the limit",
        ),
        (
            Scene::load_within(&sound, &Limits { geometry_bytes: 40, ..Limits::default() }).unwrap_err(),
            "DIR/sound.gltf: accessors[1]: the geometry up to here, 3 elements of 4 bytes more, \
             exceeds the limit of 40 bytes in all (geometry_bytes); make it smaller or raise the limit",
        ),
        (
            set_environment("sound.gltf", 1.0, 0.0),
            "DIR/sound.gltf: not a usable environment image: neither Radiance HDR nor OpenEXR; give a lat-long .hdr or .exr",
        ),
        (
            set_environment("sound.gltf", -1.0, 0.0),
            "DIR/sound.gltf: not a usable environment image: strength -1 is out of range; give a lat-long .hdr or .exr",
        ),
    ];
    let mut seen: HashSet<_> = cases.iter().map(|(error, _)| variant(error)).collect();
    let size = std::fs::metadata(&sound).unwrap().len().to_string();
    for (error, expected) in cases {
        let said = error.to_string().replace(&folder.display().to_string(), "DIR").replace(&size, "SIZE");
        assert_eq!(said, expected);
    }
    let unknown = Scene::load("builtin:nothing").unwrap_err();
    seen.insert(variant(&unknown));
    let said = unknown.to_string();
    assert!(said.starts_with("builtin:nothing: no such built-in scene; there are cornell-box, far-away, "), "{said}");
    assert_eq!(seen.len(), VARIANTS, "{seen:?}");
}

/// Every limit stops what it should, by name.
#[test]
fn every_limit_is_kept() {
    let png = {
        let mut bytes = std::io::Cursor::new(Vec::new());
        image::RgbImage::new(8, 4).write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        bytes.into_inner()
    };
    let mut document = textured(json!({"uri": data_uri(&png)}));
    let lamp = json!({"KHR_lights_punctual": {"light": 0}});
    document["nodes"] = json!([{"mesh": 0, "children": [1]}, {"mesh": 0, "extensions": lamp}]);
    document["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
    document["materials"][0]["emissiveFactor"] = json!([1, 1, 1]);
    document["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "s.gltf", document.to_string());
    let all = Limits::default;
    Scene::load_within(&file, &all()).unwrap();
    for (name, limits) in [
        ("file_bytes", Limits { file_bytes: 100, ..all() }),
        ("json_values", Limits { json_values: 10, ..all() }),
        ("node_depth", Limits { node_depth: 1, ..all() }),
        ("instances", Limits { instances: 1, ..all() }),
        ("triangles", Limits { triangles: 1, ..all() }),
        ("lights", Limits { lights: 2, ..all() }),
        ("geometry_bytes", Limits { geometry_bytes: 47, ..all() }),
        ("zero_elements", Limits { zero_elements: 2, ..all() }),
        ("image_side", Limits { image_side: 7, ..all() }),
        ("image_bytes", Limits { image_bytes: 127, ..all() }),
        ("images_bytes", Limits { images_bytes: 127, ..all() }),
    ] {
        match Scene::load_within(&file, &limits) {
            Err(Error::Limit { limit, .. }) => assert!(limit.contains(name), "{name}: {limit}"),
            other => panic!("{name}: {other:?}"),
        }
    }
}
