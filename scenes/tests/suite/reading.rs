//! What glTF means, case by case, on files small enough to check by eye.

use crate::common::*;
use glam::{DVec3, Vec2, Vec3, Vec4, vec3};
use jerboa_scenes::*;
use serde_json::json;

fn le(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|x| x.to_le_bytes()).collect()
}

#[test]
fn a_triangle() {
    let scene = load(&triangle()).unwrap();
    check(&scene);
    assert_eq!(scene.name, "scene");
    assert_eq!(scene.meshes[0].positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]]);
    assert_eq!(scene.meshes[0].normals, None);
    assert_eq!(scene.materials, [Material::default()]);
    assert_eq!(scene.instances.len(), 1);
    assert_eq!(scene.warnings, []);
}

#[test]
fn a_glb_is_the_same_scene() {
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene::load(write(folder.path(), "scene.glb", glb(&triangle()))).unwrap();
    assert_eq!(scene, load(&triangle()).unwrap());
}

#[test]
fn transforms_compose_in_double_precision() {
    let mut d = triangle();
    d["nodes"] = json!([
        {"translation": [1000000.3, 0, 0], "children": [1]},
        {"rotation": [0, 0, 1, 1], "scale": [2, 3, 4], "children": [2]},
        {"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0.125,0.25,0.5,1], "mesh": 0},
    ]);
    let to_world = load(&d).unwrap().instances[0].to_world;
    // (1/8, 1/4, 1/2) scaled (1/4, 3/4, 2), turned a quarter about Z (-3/4, 1/4, 2), moved.
    let expected = DVec3::new(1000000.3 - 0.75, 0.25, 2.0);
    assert!((to_world.transform_point3(DVec3::ZERO) - expected).length() < 1e-9, "{to_world}");
    assert!((to_world.transform_vector3(DVec3::X) - DVec3::Y * 2.0).length() < 1e-12);
}

#[test]
fn the_named_scene_is_read_else_the_first_else_all() {
    let mut d = triangle();
    d["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "scale": [2, 2, 2]}, {"children": [1]}]);
    d["scenes"] = json!([{"nodes": [0]}, {"nodes": [2, 0]}]);
    d["scene"] = json!(1);
    assert_eq!(load(&d).unwrap().instances.len(), 2);
    d.as_object_mut().unwrap().remove("scene");
    assert_eq!(load(&d).unwrap().instances.len(), 1);
    d.as_object_mut().unwrap().remove("scenes");
    assert_eq!(load(&d).unwrap().instances.len(), 2);
}

#[test]
fn strips_and_fans_keep_their_winding() {
    let positions = [0.0, 1.0, 2.0, 3.0, 4.0].map(|x| [x, x * x, 0.0]);
    let mut d = document(&positions, &[0, 1, 2, 3, 4]);
    d["meshes"][0]["primitives"][0]["mode"] = json!(5);
    assert_eq!(load(&d).unwrap().meshes[0].triangles, [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
    d["meshes"][0]["primitives"][0]["mode"] = json!(6);
    assert_eq!(load(&d).unwrap().meshes[0].triangles, [[1, 2, 0], [2, 3, 0], [3, 4, 0]]);
}

/// Some exporters write all numbers as fractions.
#[test]
fn codes_may_be_whole_fractions() {
    let mut d = triangle();
    d["meshes"][0]["primitives"][0]["mode"] = json!(4.0);
    d["accessors"][0]["componentType"] = json!(5126.0);
    assert_eq!(load(&d), load(&triangle()));
}

#[test]
fn without_indices_the_corners_are_in_order() {
    let mut d = triangle();
    d["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("indices");
    assert_eq!(load(&d).unwrap().meshes[0].triangles, [[0, 1, 2]]);
}

#[test]
fn attributes_of_every_kind() {
    let mut d = triangle();
    let normals = accessor(&mut d, &le(&[0., 0., 1., 0., 0., 1., 0., 0., 1.]), 5126, "VEC3", 3);
    let tangents = accessor(&mut d, &le(&[1., 0., 0., -1., 1., 0., 0., -1., 1., 0., 0., -1.]), 5126, "VEC4", 3);
    let uv0 = accessor(&mut d, &[0, 0, 255, 0, 51, 102], 5121, "VEC2", 3);
    let shorts: Vec<u8> = [0u16, 0, 65535, 0, 13107, 26214].iter().flat_map(|x| x.to_le_bytes()).collect();
    let uv1 = accessor(&mut d, &shorts, 5123, "VEC2", 3);
    let colors = accessor(&mut d, &[255, 0, 0, 0, 255, 0, 0, 0, 51], 5121, "VEC3", 3);
    for normalized in [uv0, uv1, colors] {
        d["accessors"][normalized]["normalized"] = json!(true);
    }
    d["meshes"][0]["primitives"][0]["attributes"] = json!({
        "POSITION": 0, "NORMAL": normals, "TANGENT": tangents, "TEXCOORD_0": uv0, "TEXCOORD_1": uv1, "COLOR_0": colors,
    });
    let mesh = load(&d).unwrap().meshes.remove(0);
    assert_eq!(mesh.normals, Some(vec![Vec3::Z; 3]));
    assert_eq!(mesh.tangents, Some(vec![Vec4::new(1.0, 0.0, 0.0, -1.0); 3]));
    let uv = Some(vec![Vec2::ZERO, Vec2::X, Vec2::new(0.2, 0.4)]);
    assert_eq!(mesh.uvs, [uv.clone(), uv]);
    let colors = mesh.colors.unwrap();
    assert_eq!(colors[0], Vec4::new(1.0, 0.0, 0.0, 1.0));
    assert_eq!(colors[2], Vec4::new(0.0, 0.0, 0.2, 1.0));
}

#[test]
fn interleaved_and_sparse() {
    let mut d = triangle();
    // Position and normal in turn: stride 24.
    let floats = [0., 0., 0., 0., 0., 1., 1., 0., 0., 0., 1., 0., 0., 1., 0., 1., 0., 0.];
    let a = accessor(&mut d, &le(&floats), 5126, "VEC3", 3);
    let view = d["accessors"][a]["bufferView"].as_u64().unwrap() as usize;
    d["bufferViews"][view]["byteStride"] = json!(24);
    let b = d["accessors"].as_array().unwrap().len();
    let normals = json!({"bufferView": view, "byteOffset": 12, "componentType": 5126, "type": "VEC3", "count": 3});
    d["accessors"].as_array_mut().unwrap().push(normals);
    let which = accessor(&mut d, &[1], 5121, "SCALAR", 1);
    let values = accessor(&mut d, &le(&[5., 6., 7.]), 5126, "VEC3", 1);
    d["accessors"][a]["sparse"] = json!({
        "count": 1,
        "indices": {"bufferView": d["accessors"][which]["bufferView"], "componentType": 5121},
        "values": {"bufferView": d["accessors"][values]["bufferView"]},
    });
    d["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": a, "NORMAL": b});
    let mesh = load(&d).unwrap().meshes.remove(0);
    assert_eq!(mesh.positions, [Vec3::ZERO, vec3(5.0, 6.0, 7.0), Vec3::Y]);
    assert_eq!(mesh.normals, Some(vec![Vec3::Z, Vec3::Y, Vec3::X]));
}

#[test]
fn an_accessor_without_a_view_is_zero_but_for_its_sparse_part() {
    let mut d = triangle();
    let sparse = accessor(&mut d, &[1, 0, 2, 0], 5123, "SCALAR", 2);
    let values = accessor(&mut d, &le(&[1., 0., 0., 0., 1., 0.]), 5126, "VEC3", 2);
    d["accessors"][0] = json!({"componentType": 5126, "count": 3, "type": "VEC3", "sparse": {
        "count": 2,
        "indices": {"bufferView": d["accessors"][sparse]["bufferView"], "componentType": 5123},
        "values": {"bufferView": d["accessors"][values]["bufferView"]},
    }});
    assert_eq!(load(&d).unwrap(), load(&triangle()).unwrap());
}

#[test]
fn quantized_positions_need_the_extension() {
    let mut d = triangle();
    let a = accessor(&mut d, &[0, 0, 0, 127, 0, 0, 0, 129, 0], 5120, "VEC3", 3);
    d["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(a);
    assert!(load(&d).is_err());
    d["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    d["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    assert_eq!(load(&d).unwrap().meshes[0].positions[1..], [vec3(127.0, 0.0, 0.0), vec3(0.0, -127.0, 0.0)]);
    d["accessors"][a]["normalized"] = json!(true);
    assert_eq!(load(&d).unwrap().meshes[0].positions[1..], [Vec3::X, Vec3::NEG_Y]);
}

#[test]
fn a_mesh_is_read_once_and_instanced() {
    let mut d = triangle();
    d["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "translation": [1, 2, 3]}]);
    d["scenes"][0]["nodes"] = json!([0, 1]);
    let scene = load(&d).unwrap();
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 2));
    assert_eq!(scene.bounds(), Some((DVec3::ZERO, DVec3::new(2.0, 3.0, 3.0))));
}

#[test]
fn a_material_with_everything() {
    let mut d = textured(json!({"uri": data_uri(&png([10, 20, 30, 40]))}));
    d["samplers"] = json!([{"magFilter": 9728, "wrapS": 33648, "wrapT": 33071}]);
    d["textures"] = json!([{"source": 0}, {"source": 0, "sampler": 0}]);
    let turned = json!({"index": 1, "texCoord": 0, "extensions": {"KHR_texture_transform":
        {"offset": [0.5, 0.25], "rotation": 1.5, "scale": [2, 3], "texCoord": 1}}});
    d["materials"] = json!([{
        "name": "all",
        "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.25,
            "baseColorTexture": {"index": 0}, "metallicRoughnessTexture": turned},
        "normalTexture": {"index": 0, "scale": 0.5},
        "occlusionTexture": {"index": 99},
        "emissiveFactor": [1, 0.5, 0], "emissiveTexture": {"index": 0},
        "alphaMode": "MASK", "doubleSided": true,
        "extensions": {
            "KHR_materials_emissive_strength": {"emissiveStrength": 8},
            "KHR_materials_ior": {"ior": 1.75},
            "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [2, 1, 1]},
            "KHR_materials_transmission": {"transmissionFactor": 0.75},
            "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 3, "attenuationColor": [1, 0.5, 0.25]},
            "KHR_materials_unlit": {},
        },
    }]);
    let scene = load(&d).unwrap();
    check(&scene);
    let m = &scene.materials[0];
    assert_eq!((m.base_color, m.metallic, m.roughness), ([0.1, 0.2, 0.3, 0.4], 0.5, 0.25));
    assert_eq!(m.base_color_texture, Some(TextureRef { texture: 0, uv_set: 0, transform: None }));
    let transform = Some(UvTransform { offset: [0.5, 0.25], rotation: 1.5, scale: [2.0, 3.0] });
    assert_eq!(m.metallic_roughness_texture, Some(TextureRef { texture: 1, uv_set: 1, transform }));
    assert_eq!((m.normal_scale, m.emissive), (0.5, [8.0, 4.0, 0.0]));
    assert_eq!((m.alpha_mode, m.double_sided, m.unlit, m.ior), (AlphaMode::Mask(0.5), true, true, 1.75));
    assert_eq!((m.specular, m.specular_color, m.transmission), (0.5, [2.0, 1.0, 1.0], 0.75));
    let volume = m.volume.unwrap();
    assert_eq!((volume.attenuation_distance, volume.attenuation_color), (3.0, [1.0, 0.5, 0.25]));
    let [plain, sampled] = &scene.textures[..] else { panic!("{} textures", scene.textures.len()) };
    assert_eq!((plain.wrap_s, plain.wrap_t, plain.filter), (Wrap::Repeat, Wrap::Repeat, Filter::Bilinear));
    assert_eq!((sampled.wrap_s, sampled.wrap_t, sampled.filter), (Wrap::Mirror, Wrap::Clamp, Filter::Nearest));
    // One image, used twice, with its eight bits untouched.
    assert_eq!(scene.images.len(), 1);
    assert_eq!(scene.images[0].rgba, [[10, 20, 30, 40]]);
    // The mesh has no texture coordinates at all.
    assert_eq!(scene.warnings.len(), 1, "{:?}", scene.warnings);
}

#[test]
fn a_sampler_names_a_border_and_the_bicubic_filter() {
    let mut d = textured(json!({"uri": data_uri(&png([10, 20, 30, 40]))}));
    d["samplers"] = json!([{"magFilter": 9728, "extras": {"filter": "bicubic", "border": [0, 0.25, 1, 0.5]}}]);
    d["textures"][0]["sampler"] = json!(0);
    let texture = load(&d).unwrap().textures.remove(0);
    assert_eq!((texture.filter, texture.border), (Filter::Bicubic, Some([0.0, 0.25, 1.0, 0.5])));
    for (key, value, expected) in [
        ("filter", json!("cubic"), "filter: \"cubic\" is not \"bicubic\"; magFilter names the other filters;"),
        ("filter", json!(9728), "filter: not a string;"),
        ("border", json!([0, 0, 0]), "border: not an array of 4 numbers;"),
        ("border", json!([0, 0, "0", 1]), "border[2]: not a number;"),
        (
            "border",
            json!([0, 0, 1.5, 1]),
            "border: a border is four numbers from 0 to 1: linear red, green, blue and alpha;",
        ),
        ("border", json!([-1, 0, 0, 1]), "border: a border is four numbers from 0 to 1"),
    ] {
        d["samplers"][0]["extras"] = json!({key: value});
        let error = load(&d).unwrap_err().to_string();
        assert!(error.contains(&format!("samplers[0].extras.{expected}")), "{error}");
    }
}

#[test]
fn a_material_names_a_model() {
    let mut d = triangle();
    d["materials"] = json!([
        {"name": "blend", "extras": {"bsdf": {"model": "blend", "first": 1, "second": 2, "share": 0.25}}},
        {"name": "metal", "extras": {"bsdf": {"model": "conductor", "eta": [0.2, 0.9, 1.5], "k": 3}}},
        {"name": "plain"},
    ]);
    d["meshes"][0]["primitives"][0]["material"] = json!(0);
    let scene = load(&d).unwrap();
    check(&scene);
    let names: Vec<&str> = scene.materials.iter().map(|m| &*m.name).collect();
    assert_eq!(names, ["metal", "plain", "blend"]);
    let expected = Model::named("blend").with("share", &[0.25]).of([0, 1]);
    assert_eq!(scene.materials[2].model, Some(Model { path: "materials[0].extras.bsdf".into(), ..expected }));
    let expected = Model::named("conductor").with("eta", &[0.2, 0.9, 1.5]).with("k", &[3.0]);
    assert_eq!(scene.materials[0].model, Some(Model { path: "materials[1].extras.bsdf".into(), ..expected }));
    assert_eq!(scene.materials[1].model, None);

    let mut refused = |bsdf: serde_json::Value, expected: &str| {
        d["materials"][0]["extras"]["bsdf"] = bsdf;
        let error = load(&d).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    };
    refused(json!({}), "materials[0].extras.bsdf.model: missing");
    refused(json!({"model": 1}), "materials[0].extras.bsdf.model: not a string");
    refused(json!({"model": "phong", "ns": "ten"}), "materials[0].extras.bsdf.ns: not a number");
    refused(json!({"model": "phong", "ks": [0.5, true]}), "materials[0].extras.bsdf.ks[1]: not a number");
    refused(json!({"model": "blend", "first": 1}), "materials[0].extras.bsdf.second: missing");
    refused(json!({"model": "blend", "first": 1, "second": 7}), "materials[0].extras.bsdf.second");
    refused(
        json!({"model": "blend", "first": 1, "second": 0}),
        "materials[0].extras.bsdf.second: a material that is made",
    );
    // What is no object is a note of somebody else's.
    d["materials"][0]["extras"]["bsdf"] = json!("dielectric");
    assert_eq!(load(&d).unwrap().materials[0].model, None);
}

pub(crate) fn png(rgba: [u8; 4]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::RgbaImage::from_pixel(1, 1, image::Rgba(rgba)).write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

#[test]
fn cameras_and_lights() {
    let mut d = triangle();
    d["cameras"] = json!([
        {"type": "perspective", "name": "wide", "perspective": {"yfov": 1.25, "aspectRatio": 2, "znear": 0.1}},
        {"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}, "extras": {"width": 300, "height": 200}},
    ]);
    d["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "point", "color": [1, 0.5, 0.25], "intensity": 4, "range": 7},
        {"type": "spot", "spot": {"innerConeAngle": 0.25}},
        {"type": "directional", "intensity": 2},
    ]}});
    let light = |i: usize| json!({"KHR_lights_punctual": {"light": i}});
    d["nodes"] = json!([
        {"camera": 0, "translation": [1, 2, 3], "scale": [5, 5, 5]},
        {"camera": 1, "name": "node name", "rotation": [0, 1, 0, 1]},
        {"extensions": light(0), "translation": [4, 5, 6]},
        {"extensions": light(1)},
        {"extensions": light(2), "rotation": [-1, 0, 0, 1]},
    ]);
    d["scenes"][0]["nodes"] = json!([0, 1, 2, 3, 4]);
    let scene = load(&d).unwrap();
    check(&scene);
    let wide = scene.camera_named("wide").unwrap();
    assert_eq!(
        (wide.lens, wide.aspect, wide.film_or_default()),
        (Lens::Pinhole { yfov: 1.25 }, Some(2.0), (1280, 640))
    );
    assert_eq!((wide.position(), wide.forward()), (DVec3::new(1.0, 2.0, 3.0), DVec3::NEG_Z));
    let side = scene.camera_named("node name").unwrap();
    assert_eq!(side.film_or_default(), (300, 200));
    // A quarter about +Y takes -Z to -X.
    assert!((side.forward() - DVec3::NEG_X).length() < 1e-12);
    assert_eq!((scene.lights[0].kind, scene.lights[0].intensity), (LightKind::Point, [4.0, 2.0, 1.0]));
    assert_eq!(scene.lights[0].position(), DVec3::new(4.0, 5.0, 6.0));
    let outer = std::f32::consts::FRAC_PI_4;
    assert_eq!(scene.lights[1].kind, LightKind::Spot { inner: 0.25, outer });
    assert_eq!((scene.lights[2].kind, scene.lights[2].intensity), (LightKind::Directional, [2.0; 3]));
    assert!((scene.lights[2].direction() - DVec3::NEG_Y).length() < 1e-12);
}

#[test]
fn lights_take_a_size_from_their_extras() {
    let mut d = triangle();
    d["extensions"]["KHR_lights_punctual"]["lights"] = json!([
        {"type": "point", "extras": {"radius": 0.25}},
        {"type": "spot", "spot": {"innerConeAngle": 0.25}, "extras": {"radius": 2}},
        {"type": "directional", "extras": {"angle": 0.5, "radius": 1}},
        {"type": "point", "extras": {"radius": 0, "angle": "wide"}},
        {"type": "point", "extras": {"radius": 1e-300}},
    ]);
    let light = |i: usize| json!({"extensions": {"KHR_lights_punctual": {"light": i}}});
    d["nodes"] = (0..5).map(light).collect();
    d["scenes"][0]["nodes"] = json!([0, 1, 2, 3, 4]);
    let kinds: Vec<LightKind> = load(&d).unwrap().lights.iter().map(|l| l.kind).collect();
    let disk = LightKind::Disk { inner: 0.25, outer: std::f32::consts::FRAC_PI_4, radius: 2.0 };
    let none = LightKind::Point;
    assert_eq!(kinds, [LightKind::Sphere { radius: 0.25 }, disk, LightKind::Sun { angle: 0.5 }, none, none]);
    let mut refused = |i: usize, extras: serde_json::Value, expected: &str| {
        d["extensions"]["KHR_lights_punctual"]["lights"][i]["extras"] = extras;
        let error = load(&d).unwrap_err().to_string();
        let lights = "extensions.KHR_lights_punctual.lights";
        assert!(error.contains(&format!("{lights}[{i}].extras.{expected}")), "{error}");
    };
    refused(2, json!({"angle": 3.5}), "angle: 3.5: the angle across a sun is 0 to pi, in radians");
    refused(1, json!({"radius": -1}), "radius: -1: a radius is a finite number of metres, 0 or more");
    refused(0, json!({"radius": "wide"}), "radius: not a number");
}

/// A Radiance file of 2 x 1 texels: (1, 2, 4) and the smallest exponent.
fn hdr() -> Vec<u8> {
    let texels = [32, 64, 128, 131, 255, 1, 0, 1];
    [&b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n"[..], &texels].concat()
}

#[test]
fn a_sky_in_place_of_an_image() {
    let mut d = triangle();
    let sky = json!({"elevation_deg": 20, "azimuth_deg": 45, "turbidity": 4, "albedo": [0.5, 0.5, 0.5], "sun": false});
    d["scenes"][0]["extras"] = json!({"environment": {"sky": sky, "intensity": 2}});
    let found = load(&d).unwrap().environment.unwrap();
    let sky =
        Sky { elevation_deg: 20.0, azimuth_deg: 45.0, turbidity: 4.0, albedo: [0.5; 3], sun: false, ..Sky::default() };
    assert_eq!(found, Environment { intensity: 2.0, ..sky.environment().unwrap() });
    d["scenes"][0]["extras"]["environment"]["sky"]["turbidity"] = json!(0);
    let error = load(&d).unwrap_err().to_string();
    assert!(error.contains("scenes[0].extras.environment.sky: Turbidity must be between 1"), "{error}");
}

#[test]
fn environments() {
    let folder = tempfile::tempdir().unwrap();
    let mut d = triangle();
    d["scenes"][0]["extras"] = json!({"environment": {"uri": "my%20sky.hdr", "intensity": 2, "rotation_deg": 90}});
    write(folder.path(), "my sky.hdr", hdr());
    let mut scene = Scene::load(write(folder.path(), "scene.gltf", d.to_string())).unwrap();
    check(&scene);
    let sky = scene.environment.clone().unwrap();
    assert_eq!((sky.width, sky.height, sky.intensity, sky.rotation_deg), (2, 1, 2.0, 90.0));
    // mantissa x 2^(e - 136), exactly.
    let tiny = 2f32.powi(-126) * 2f32.powi(-9);
    assert_eq!(sky.radiance, [[1.0, 2.0, 4.0], [255.0 * tiny, tiny, 0.0]]);

    let exr = folder.path().join("sky.exr");
    image::Rgb32FImage::from_fn(2, 1, |x, _| image::Rgb([x as f32, f32::NAN, -1.0])).save(&exr).unwrap();
    scene.set_environment(&exr, 3.0, 45.0).unwrap();
    check(&scene);
    let sky = scene.environment.clone().unwrap();
    assert_eq!((sky.intensity, sky.rotation_deg), (3.0, 45.0));
    assert_eq!(sky.radiance, [[0.0; 3], [1.0, 0.0, 0.0]]);
    assert_eq!(scene.warnings.len(), 1);
    assert!(scene.warnings[0].message.starts_with("2 texels"));
}

#[test]
fn files_beside_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("data")).unwrap();
    let mut d = triangle();
    let bytes = le(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]).into_iter().chain([0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    write(folder.path(), "data/ä b.bin", bytes.collect::<Vec<u8>>());
    for uri in ["data/ä b.bin", "data/%C3%A4%20b.bin", "./data/../data/ä b.bin"] {
        d["buffers"][0]["uri"] = json!(uri);
        let scene = Scene::load(write(folder.path(), "scene.gltf", d.to_string())).unwrap();
        assert_eq!(scene.triangle_count(), 1);
    }
}

#[test]
fn the_last_vertex_is_one_below_their_number() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let error = load(&document(&corners, &[0, 1, 3])).unwrap_err().to_string();
    assert!(error.contains('3') && error.contains("3 vertices"), "{error}");
}
