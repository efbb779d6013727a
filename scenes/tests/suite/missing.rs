//! T31: what a scene may lack, and what happens then.

use crate::common::*;
use glam::DVec3;
use jerboa_scenes::*;
use serde_json::json;

fn messages(warnings: &[Warning]) -> Vec<String> {
    warnings.iter().map(|w| w.to_string()).collect()
}

#[test]
fn without_camera_and_light() {
    let scene = load(&triangle()).unwrap();
    let expected =
        ["the scene has no camera: the whole scene is framed", "the scene has no light: the image will be black"];
    assert_eq!(messages(&scene.all_warnings()), expected);
    // The whole box is in view: every corner is inside the cone about the axis.
    let camera = scene.camera_or_default();
    let (low, high) = scene.bounds().unwrap();
    for corner in [low, high, DVec3::new(low.x, high.y, low.z), DVec3::new(high.x, low.y, low.z)] {
        let direction = (corner - camera.position()).normalize();
        assert!(direction.dot(camera.forward()).acos() <= camera.half_height().atan() + 1e-9, "{corner}");
    }
}

#[test]
fn nothing_at_all() {
    let scene = load(&json!({"asset": {"version": "2.0"}})).unwrap();
    check(&scene);
    assert!(scene.camera_or_default().to_world.is_finite());
    assert_eq!(scene.all_warnings().len(), 3);
}

#[test]
fn a_missing_texture_is_white() {
    let scene = load(&textured(json!({"uri": "nowhere.png"}))).unwrap();
    check(&scene);
    assert_eq!(scene.materials[0].base_color_texture, None);
    let [warning] = &messages(&scene.warnings)[..] else { panic!("{:?}", scene.warnings) };
    let expected =
        "images[0]: \"nowhere.png\" cannot be read: No such file or directory (os error 2): white is used instead";
    assert_eq!(warning, expected);
}

#[test]
fn a_missing_environment_is_none() {
    let mut d = triangle();
    d["scenes"][0]["extras"] = json!({"environment": {"uri": "nowhere.hdr"}});
    let scene = load(&d).unwrap();
    assert_eq!(scene.environment, None);
    let expected = "scenes[0].extras.environment.uri: \"nowhere.hdr\" cannot be read: \
        No such file or directory (os error 2): there is no environment";
    assert_eq!(messages(&scene.warnings), [expected]);
}

#[test]
fn warnings_are_counted() {
    let mut d = triangle();
    let lines = d["meshes"][0]["primitives"][0].clone();
    let primitives = d["meshes"][0]["primitives"].as_array_mut().unwrap();
    for _ in 0..3 {
        primitives.push(lines.clone());
        primitives.last_mut().unwrap()["mode"] = json!(1);
    }
    let scene = load(&d).unwrap();
    let expected = "meshes[0].primitives[1]: a primitive of points, of lines or without POSITION is left out (3 times)";
    assert_eq!(messages(&scene.warnings), [expected]);
}

#[test]
fn dispersion_is_left_out_by_name() {
    let mut d = triangle();
    d["extensionsUsed"] = json!(["KHR_materials_dispersion"]);
    let expected =
        "extensionsUsed[0]: KHR_materials_dispersion is left out: light of every colour is refracted by the same index";
    assert_eq!(messages(&load(&d).unwrap().warnings), [expected]);
}

#[test]
fn warnings_do_not_pile_up() {
    let mut d = triangle();
    d["extensionsUsed"] = (0..500).map(|i| format!("FOO_{i}")).collect();
    let scene = load(&d).unwrap();
    assert_eq!(scene.warnings.len(), 101);
    assert_eq!(scene.warnings[0].to_string(), "extensionsUsed[0]: FOO_0 is unknown and ignored");
    let last = scene.warnings[100].to_string();
    assert_eq!(last, "extensionsUsed[100]: further warnings are only counted (400 times)");
}
