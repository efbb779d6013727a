//! What a file may show in more than one way: scenes, variants, moments, and shapes that are not the stored ones.

use crate::common::*;
use glam::{DVec3, Vec3, Vec4, vec3};
use jerboa_scenes::*;
use serde_json::{Value, json};

fn le(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// Loads what is selected of a document.
fn select(document: &Value, selection: &Selection) -> Result<Scene, Error> {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "scene.gltf", document.to_string());
    let scene = Scene::load_selected(file, selection, &Limits::default());
    scene.iter().for_each(check);
    scene
}

fn at(document: &Value, time: f64) -> Scene {
    select(document, &Selection { time: Some(time), ..Selection::default() }).unwrap_or_else(|e| panic!("{e}"))
}

/// Adds an animation of one channel to node 0.
fn animate(d: &mut Value, path: &str, times: &[f32], kind: &str, values: &[f32], interpolation: &str) {
    let width = ["SCALAR", "", "VEC3", "VEC4"].iter().position(|k| *k == kind).unwrap() + 1;
    let input = accessor(d, &le(times), 5126, "SCALAR", times.len());
    let output = accessor(d, &le(values), 5126, kind, values.len() / width);
    if d["animations"].is_null() {
        d["animations"] = json!([]);
    }
    d["animations"].as_array_mut().unwrap().push(json!({
        "name": path,
        "samplers": [{"input": input, "output": output, "interpolation": interpolation}],
        "channels": [{"sampler": 0, "target": {"node": 0, "path": path}}],
    }));
}

#[test]
fn scenes_are_chosen_by_name_or_number() {
    let mut d = triangle();
    d["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "translation": [1, 0, 0]}]);
    d["scenes"] = json!([{"nodes": [0]}, {"nodes": [1], "name": "moved"}]);
    let x = |scene: Option<&str>| {
        let selection = Selection { scene: scene.map(str::to_string), ..Selection::default() };
        select(&d, &selection).map(|s| s.instances[0].to_world.translation.x)
    };
    assert_eq!((x(None), x(Some("0")), x(Some("1")), x(Some("moved"))), (Ok(0.0), Ok(0.0), Ok(1.0), Ok(1.0)));
    let expected = "scene \"2\": there is no scene of that name or number; there are 0, moved";
    assert_eq!(x(Some("2")).unwrap_err().to_string(), expected);
}

#[test]
fn cameras_are_chosen_by_name_or_number() {
    let mut d = triangle();
    let lens = json!({"yfov": 1, "znear": 1});
    d["cameras"] = json!([
        {"type": "perspective", "perspective": lens},
        {"type": "perspective", "perspective": lens, "name": "side"},
    ]);
    d["nodes"] = json!([{"camera": 0}, {"camera": 1}]);
    d["scenes"][0]["nodes"] = json!([0, 1]);
    let scene = load(&d).unwrap();
    assert_eq!(scene.camera_named("1"), scene.camera_named("side"));
    assert_eq!(scene.camera_named("0").unwrap().name, "");
    let expected = "camera \"2\": there is no camera of that name or number; there are 0, side";
    assert_eq!(scene.camera_named("2").unwrap_err().to_string(), expected);
}

#[test]
fn variants_choose_materials() {
    let mut d = triangle();
    d["materials"] = json!([{"name": "plain"}, {"name": "red"}]);
    d["extensionsUsed"] = json!(["KHR_materials_variants"]);
    d["extensions"] =
        json!({"KHR_materials_variants": {"variants": [{"name": "day"}, {"name": "night"}, {"name": "no"}]}});
    d["meshes"][0]["primitives"][0]["material"] = json!(0);
    d["meshes"][0]["primitives"][0]["extensions"] =
        json!({"KHR_materials_variants": {"mappings": [{"material": 1, "variants": [0, 1]}]}});
    let name = |variant: Option<&str>| {
        let selection = Selection { variant: variant.map(str::to_string), ..Selection::default() };
        select(&d, &selection).map(|s| s.materials[0].name.clone())
    };
    assert_eq!(name(None).unwrap(), "plain");
    assert_eq!(name(Some("night")).unwrap(), "red");
    assert_eq!(name(Some("no")).unwrap(), "plain");
    let expected = "variant \"dusk\": there is no variant of that name or number; there are day, night, no";
    assert_eq!(name(Some("dusk")).unwrap_err().to_string(), expected);
    let builtin = Scene::load_selected(
        "builtin:empty",
        &Selection { variant: Some("day".into()), ..Selection::default() },
        &Limits::default(),
    );
    let expected = "variant \"day\": there is no variant to choose; leave the name out";
    assert_eq!(builtin.unwrap_err().to_string(), expected);
}

#[test]
fn nodes_move_as_their_keyframes_say() {
    let x = |interpolation: &str, values: &[f32], time: f64| {
        let mut d = triangle();
        let values: Vec<f32> = values.iter().flat_map(|x| [*x, 0.0, 0.0]).collect();
        animate(&mut d, "translation", &[1.0, 3.0], "VEC3", &values, interpolation);
        at(&d, time).instances[0].to_world.translation.x
    };
    assert_eq!([0.0, 1.0, 2.5, 3.0, 9.0].map(|t| x("LINEAR", &[10.0, 20.0], t)), [10.0, 10.0, 17.5, 20.0, 20.0]);
    assert_eq!([0.0, 1.0, 2.5, 3.0, 9.0].map(|t| x("STEP", &[10.0, 20.0], t)), [10.0, 10.0, 10.0, 20.0, 20.0]);
    // In-tangent, value, out-tangent: from 0 with slope 1/s to 0 with slope 0; Hermite's basis at t = 1/2 is 1/8.
    let spline = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    assert_eq!([1.0, 2.0, 3.0].map(|t| x("CUBICSPLINE", &spline, t)), [0.0, 2.0 / 8.0, 0.0]);
    // A cubic through its own tangents is that cubic: x = (t - 1)^3.
    let cube = [0.0, 0.0, 0.0, 12.0, 8.0, 12.0];
    assert!((x("CUBICSPLINE", &cube, 2.5) - 1.5f64.powi(3)).abs() < 1e-12);
}

#[test]
fn rotations_take_the_shorter_arc_and_scales_the_straight_line() {
    let mut d = triangle();
    let half = 0.5f32.sqrt();
    // From nothing to minus a quarter turn about Z, which is a quarter turn.
    animate(&mut d, "rotation", &[0.0, 1.0], "VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -half, -half], "LINEAR");
    animate(&mut d, "scale", &[0.0, 1.0], "VEC3", &[1.0, 1.0, 1.0, 3.0, 3.0, 3.0], "LINEAR");
    let x = at(&d, 0.5).instances[0].to_world.transform_vector3(DVec3::X);
    let expected = DVec3::new(1.0, 1.0, 0.0).normalize() * 2.0;
    assert!((x - expected).length() < 1e-7, "{x}");
    // One of them alone.
    let selection = Selection { time: Some(1.0), animation: Some("scale".into()), ..Selection::default() };
    let x = select(&d, &selection).unwrap().instances[0].to_world.transform_vector3(DVec3::X);
    assert_eq!(x, DVec3::X * 3.0);
    // At rest.
    assert_eq!(load(&d).unwrap().instances[0].to_world.transform_vector3(DVec3::X), DVec3::X);
}

#[test]
fn morph_targets_are_added_by_their_weights() {
    let mut d = triangle();
    let normals = accessor(&mut d, &le(&[0., 0., 1., 0., 0., 1., 0., 0., 1.]), 5126, "VEC3", 3);
    let colors = accessor(&mut d, &le(&[0.5; 12]), 5126, "VEC4", 3);
    let up = accessor(&mut d, &le(&[0., 0., 1., 0., 0., 1., 0., 0., 1.]), 5126, "VEC3", 3);
    let tilt = accessor(&mut d, &le(&[1., 0., 0., 0., 0., 0., 0., 0., 0.]), 5126, "VEC3", 3);
    let redder = accessor(&mut d, &le(&[0.5, 0., 0., 0.5, 0., 0., 4., 0., 0.]), 5126, "VEC3", 3);
    let primitive = &mut d["meshes"][0]["primitives"][0];
    primitive["attributes"]["NORMAL"] = json!(normals);
    primitive["attributes"]["COLOR_0"] = json!(colors);
    primitive["targets"] = json!([{"POSITION": up}, {"NORMAL": tilt, "COLOR_0": redder}]);
    assert_eq!(load(&d).unwrap().meshes[0].positions[0], Vec3::ZERO);
    d["meshes"][0]["weights"] = json!([0.25, 1]);
    let mesh = load(&d).unwrap().meshes.remove(0);
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p + vec3(0.0, 0.0, 0.25)));
    assert_eq!(mesh.normals.unwrap()[..2], [vec3(1.0, 0.0, 1.0).normalize(), Vec3::Z]);
    let colors = mesh.colors.unwrap();
    assert_eq!((colors[0], colors[2]), (Vec4::new(1.0, 0.5, 0.5, 0.5), Vec4::new(1.0, 0.5, 0.5, 0.5)));
    // A node's weights come before the mesh's; each shape is read once.
    d["nodes"] = json!([{"mesh": 0, "weights": [2, 0]}, {"mesh": 0}, {"mesh": 0, "weights": [2, 0]}]);
    d["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let scene = load(&d).unwrap();
    let heights: Vec<f32> = scene.instances.iter().map(|i| scene.meshes[i.mesh].positions[0].z).collect();
    assert_eq!((heights, scene.meshes.len()), (vec![2.0, 0.25, 2.0], 2));
    // And those of an animation before both: two targets at two times.
    animate(&mut d, "weights", &[0.0, 1.0], "SCALAR", &[0.0, 0.0, 8.0, 0.0], "LINEAR");
    let scene = at(&d, 0.5);
    assert_eq!(scene.meshes[scene.instances[0].mesh].positions[0].z, 4.0);
    // With tangents: in, value, out, each of both targets.
    let keys = [[9., 9.], [1., 0.], [0., 0.], [0., 0.], [1., 0.], [9., 9.]];
    d["animations"] = json!(null);
    animate(&mut d, "weights", &[0.0, 1.0], "SCALAR", keys.as_flattened(), "CUBICSPLINE");
    assert_eq!(at(&d, 0.5).meshes[0].positions[0].z, 1.0);
}

/// A triangle with three corners on two joints: one stands, one is moved; the third is between them.
fn skinned() -> Value {
    let mut d = triangle();
    let joints = accessor(&mut d, &[0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0], 5121, "VEC4", 3);
    let weights = accessor(&mut d, &le(&[1., 0., 0., 0., 1., 0., 0., 0., 0.5, 0.5, 0., 0.]), 5126, "VEC4", 3);
    let matrix = |x: f32| [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., x, 0., 0., 1.];
    let inverse = accessor(&mut d, &le(&[matrix(0.0), matrix(-5.0)].concat()), 5126, "MAT4", 2);
    let attributes = &mut d["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    d["skins"] = json!([{"joints": [0, 2], "inverseBindMatrices": inverse}]);
    d["nodes"] = json!([
        {"children": [2]},
        {"mesh": 0, "skin": 0, "translation": [100, 0, 0]},
        {"translation": [5, 0, 2]},
    ]);
    d["scenes"][0]["nodes"] = json!([1, 0]);
    d
}

#[test]
fn skins_move_vertices_with_their_joints() {
    let mut d = skinned();
    let positions = |scene: &Scene| {
        let mesh = &scene.meshes[scene.instances[0].mesh];
        mesh.positions.iter().map(|p| scene.instances[0].to_world.transform_point3(p.as_dvec3())).collect::<Vec<_>>()
    };
    // The second joint was bound at x = 5 and is now 2 higher; where the node of the mesh is does not matter.
    let expected = [DVec3::ZERO, DVec3::new(1.0, 0.0, 2.0), DVec3::new(0.0, 1.0, 1.0)];
    assert_eq!(positions(&load(&d).unwrap()), expected);
    animate(&mut d, "translation", &[0.0], "VEC3", &[0.0, 7.0, 0.0], "STEP");
    assert_eq!(positions(&at(&d, 0.0)), expected.map(|p| p + DVec3::Y * 7.0));
}

#[test]
fn instances_of_a_node_multiply_its_meshes() {
    let mut d = triangle();
    let translations = accessor(&mut d, &le(&[1., 0., 0., 0., 2., 0.]), 5126, "VEC3", 2);
    let scales = accessor(&mut d, &le(&[1., 1., 1., 3., 3., 3.]), 5126, "VEC3", 2);
    // Half a turn about Y, in bytes.
    let rotations = accessor(&mut d, &[0, 0, 0, 127, 0, 127, 0, 0], 5120, "VEC4", 2);
    d["accessors"][rotations]["normalized"] = json!(true);
    d["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    d["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    d["nodes"][0]["translation"] = json!([10, 0, 0]);
    d["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes":
        {"TRANSLATION": translations, "ROTATION": rotations, "SCALE": scales, "_ID": 999}}});
    let scene = load(&d).unwrap();
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 2));
    let x = [0, 1].map(|i| scene.instances[i].to_world.transform_point3(DVec3::X));
    assert!((x[0] - DVec3::new(12.0, 0.0, 0.0)).length() < 1e-12, "{x:?}");
    assert!((x[1] - DVec3::new(7.0, 2.0, 0.0)).length() < 1e-12, "{x:?}");
}

#[test]
fn cameras_of_every_kind() {
    let mut d = triangle();
    let lens = json!({"yfov": 1, "aspectRatio": 1.5});
    d["cameras"] = json!([
        {"type": "orthographic", "orthographic": {"xmag": 3, "ymag": 2, "zfar": 1, "znear": 0}},
        {"type": "perspective", "perspective": lens, "extras": {"aperture": 0.5, "focus": 3}},
        {"type": "perspective", "perspective": lens, "extras": {"aperture": 0}},
        {"type": "perspective", "perspective": lens, "extras": {"fisheye": 3.5, "width": 10, "height": 10}},
    ]);
    d["nodes"] = json!([{"camera": 0}, {"camera": 1}, {"camera": 2}, {"camera": 3}]);
    d["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    let scene = load(&d).unwrap();
    check(&scene);
    let lenses: Vec<Lens> = scene.cameras.iter().map(|c| c.lens).collect();
    let expected = [
        Lens::Orthographic { ymag: 2.0 },
        Lens::Thin { yfov: 1.0, aperture: 0.5, focus: 3.0 },
        Lens::Pinhole { yfov: 1.0 },
        Lens::Fisheye { angle: 3.5 },
    ];
    assert_eq!(lenses, expected);
    let aspects: Vec<Option<f64>> = scene.cameras.iter().map(|c| c.aspect).collect();
    assert_eq!(aspects, [Some(1.5); 4]);
    // What is not given stays.
    let thin = &scene.cameras[1];
    let changed = |aperture, focus| thin.with_lens(aperture, focus).map(|c| c.lens);
    assert_eq!(changed(None, Some(5.0)), Some(Lens::Thin { yfov: 1.0, aperture: 0.5, focus: 5.0 }));
    assert_eq!(changed(Some(0.0), None), Some(Lens::Pinhole { yfov: 1.0 }));
    assert_eq!((changed(Some(-1.0), None), changed(None, Some(0.0))), (None, None));
    assert_eq!(scene.cameras[0].with_lens(Some(1.0), Some(1.0)), None);
    assert_eq!(scene.cameras[2].with_lens(Some(1.0), None), None, "in focus where?");
}
