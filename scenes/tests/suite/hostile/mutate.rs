//! Random faults in a sound file that uses nearly everything.

use crate::common::{accessor, check, data_uri, glb, textured, write};
use crate::compressed::{packed, stream};
use image::ImageFormat;
use jerboa_scenes::{Error, Limits, Scene, Selection};
use serde_json::{Value, json};
use std::io::Cursor;
use std::path::Path;

/// Loads the mutations of `count` seeds from `first` on; notes the seed at work in the file `seed`.
pub fn run(first: u64, count: u64, folder: &Path) {
    let sound = Rich::new(&mut Random(first)).document();
    let scene = load(&write(folder, "sound.gltf", sound.to_string())).unwrap();
    check(&scene);
    assert!(scene.warnings.is_empty() && scene.environment.is_some(), "{:?}", scene.warnings);
    let mut loaded = 0;
    for seed in first..first + count {
        std::fs::write(folder.join("seed"), seed.to_string()).unwrap();
        let file = write(folder, "scene.gltf", mutation(&mut Random(seed)));
        match load(&file) {
            Ok(scene) => {
                check(&scene);
                loaded += 1;
            }
            Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
        }
    }
    println!("{loaded} of {count} loaded");
    // Were all refused, or none, the mutations would test little.
    assert!(count < 100 || (loaded > count / 20 && loaded < count * 19 / 20));
}

/// Likewise, of Draco streams alone.
pub fn run_streams(first: u64, count: u64, folder: &Path) {
    let whole = [1, 2, 5].map(|n| [0, 5, 10].map(|speed| (n, stream(n, speed))));
    for seed in first..first + count {
        std::fs::write(folder.join("seed"), seed.to_string()).unwrap();
        let mut random = Random(seed);
        let (n, mut bytes) = whole[random.below(3)][random.below(3)].clone();
        (0..1 + random.below(4)).for_each(|_| flip(&mut bytes, &mut random));
        if random.below(8) == 0 {
            bytes.truncate(1 + random.below(bytes.len()));
        }
        match Scene::load(write(folder, "scene.gltf", packed(n, &bytes).to_string())) {
            Ok(scene) => check(&scene),
            Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
        }
    }
}

/// Halfway through its animation, and in a variant.
fn load(file: &Path) -> Result<Scene, Error> {
    let selection = Selection { time: Some(0.5), variant: Some("0".into()), ..Selection::default() };
    Scene::load_selected(file, &selection, &Limits::default())
}

fn mutation(random: &mut Random) -> Vec<u8> {
    let mut rich = Rich::new(random);
    let faults = 1 + random.below(4);
    match random.below(4) {
        // A property of the document.
        0 | 1 => {
            let mut document = rich.document();
            for _ in 0..faults {
                let mut target = random.below(count(&document));
                fault(&mut document, &mut target, random);
            }
            if random.below(2) == 0 { glb(&document) } else { document.to_string().into_bytes() }
        }
        // A bit of the file.
        2 => {
            let mut bytes = glb(&rich.document());
            // Not the long texts of the data, which would get nearly all of it.
            let end = bytes.len().min(3000);
            (0..faults).for_each(|_| flip(&mut bytes[..end], random));
            bytes
        }
        // A bit of what is embedded.
        _ => {
            let parts = [&mut rich.image, &mut rich.sky, &mut rich.vertices];
            let part = random.below(3);
            for (i, bytes) in parts.into_iter().enumerate() {
                if i == part {
                    (0..faults).for_each(|_| flip(bytes, random));
                    if random.below(8) == 0 {
                        bytes.truncate(random.below(bytes.len()));
                    }
                }
            }
            rich.document().to_string().into_bytes()
        }
    }
}

fn flip(bytes: &mut [u8], random: &mut Random) {
    let at = random.below(bytes.len());
    bytes[at] ^= if random.below(2) == 0 { 1 << random.below(8) } else { random.below(256) as u8 };
}

/// Values in the tree, the root not counted.
fn count(value: &Value) -> usize {
    let each = |v: &Value| 1 + count(v);
    match value {
        Value::Array(list) => list.iter().map(each).sum(),
        Value::Object(map) => map.values().map(each).sum(),
        _ => 0,
    }
}

/// Spoils the value that `left` values come before in the tree; false, with `left` less those passed, where it is elsewhere.
fn fault(value: &mut Value, left: &mut usize, random: &mut Random) -> bool {
    let spoil = |child: &mut Value| {
        if *left == 0 {
            *child = evil(child, random);
            return true;
        }
        *left -= 1;
        fault(child, left, random)
    };
    match value {
        Value::Array(list) => list.iter_mut().any(spoil),
        Value::Object(map) => map.values_mut().any(spoil),
        _ => false,
    }
}

fn evil(old: &Value, random: &mut Random) -> Value {
    let values = [
        json!(null),
        json!(true),
        json!(-1),
        json!(0),
        json!(1),
        json!(2),
        json!(3),
        json!(99),
        json!(255),
        json!(0xffff_ffffu32),
        json!(u64::MAX),
        json!(1e308),
        json!(-1e38),
        json!(1e-300),
        json!(0.5),
        json!(""),
        json!("../../../../etc/hostname"),
        json!("/dev/zero"),
        json!("data:;base64,AAAA"),
        json!("SCALAR"),
        json!([]),
        json!({}),
        json!([old, old, old]),
        json!({"bufferView": old}),
        json!(old.as_f64().unwrap_or(7.0) + 1.0),
        json!(old.as_u64().unwrap_or(7).wrapping_mul(2)),
        json!(5121),
        json!(5123),
    ];
    values[random.below(values.len())].clone()
}

/// The sound file, its embedded data apart so that they can be spoilt before they are encoded.
struct Rich {
    vertices: Vec<u8>,
    image: Vec<u8>,
    sky: Vec<u8>,
}

impl Rich {
    fn new(random: &mut Random) -> Self {
        let image = [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::WebP][random.below(3)];
        let texels = image::RgbImage::from_fn(4, 4, |x, y| image::Rgb([x as u8 * 60, y as u8 * 60, 99]));
        let sky = [ImageFormat::OpenExr, ImageFormat::Hdr][random.below(2)];
        let radiance = image::Rgb32FImage::from_fn(8, 4, |x, y| image::Rgb([x as f32, y as f32, 0.5]));
        Rich {
            vertices: (0..24).flat_map(|i| ((i * i % 7) as f32 * 0.25).to_le_bytes()).collect(),
            image: encode(texels.into(), image),
            sky: encode(radiance.into(), sky),
        }
    }

    fn document(&self) -> Value {
        let mut d = textured(json!({"uri": data_uri(&self.image)}));
        let normals = accessor(&mut d, &self.vertices, 5126, "VEC3", 3);
        let uv = accessor(&mut d, &[0, 0, 255, 0, 0, 255], 5121, "VEC2", 3);
        d["accessors"][uv]["normalized"] = json!(true);
        let sparse = accessor(&mut d, &[1], 5121, "SCALAR", 1);
        d["accessors"][0]["sparse"] = json!({
            "count": 1,
            "indices": {"bufferView": d["accessors"][sparse]["bufferView"], "componentType": 5121},
            "values": {"bufferView": 0},
        });
        d["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": 0, "NORMAL": normals, "TEXCOORD_0": uv});
        self.shapes(&mut d, normals);
        d["samplers"] = json!([{"magFilter": 9728, "wrapS": 33071, "extras": {"border": [0, 0.5, 1, 0]}}]);
        d["textures"][0]["sampler"] = json!(0);
        let texture = json!({"index": 0, "extensions": {"KHR_texture_transform": {"scale": [2, 2], "rotation": 1}}});
        d["materials"][0]["normalTexture"] = texture.clone();
        d["materials"][0]["emissiveTexture"] = texture;
        d["materials"][0]["emissiveFactor"] = json!([1, 1, 1]);
        d["materials"][0]["alphaMode"] = json!("MASK");
        d["materials"][0]["extensions"] = json!({
            "KHR_materials_emissive_strength": {"emissiveStrength": 3},
            "KHR_materials_ior": {"ior": 1.4},
            "KHR_materials_transmission": {"transmissionFactor": 0.5},
            "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2},
        });
        d["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1, "znear": 1}, "extras": {"width": 8, "height": 8}}]);
        d["extensions"] = json!({
            "KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}}]},
            "KHR_materials_variants": {"variants": [{"name": "only"}]},
        });
        d["nodes"] = json!([
            {"mesh": 0, "scale": [1, 2, 3], "children": [1, 2]},
            {"camera": 0, "translation": [1, 2, 3]},
            {"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "mesh": 0, "skin": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}},
        ]);
        d["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": normals}}});
        d["scenes"][0]["extras"] = json!({"environment": {"uri": data_uri(&self.sky), "intensity": 2}});
        d
    }

    /// Morph targets, a skin, a variant, and an animation of two of them.
    fn shapes(&self, d: &mut Value, vectors: usize) {
        let joints = accessor(d, &[0; 12], 5121, "VEC4", 3);
        let weights = accessor(d, &[128, 127, 0, 0].repeat(3), 5121, "VEC4", 3);
        d["accessors"][weights]["normalized"] = json!(true);
        let matrices = accessor(d, &self.vertices, 5126, "MAT4", 1);
        let times = accessor(d, &[0.0, 1.0f32].map(f32::to_le_bytes).concat(), 5126, "SCALAR", 2);
        let values = accessor(d, &self.vertices, 5126, "VEC3", 2);
        let amounts = accessor(d, &self.vertices, 5126, "SCALAR", 6);
        let primitive = &mut d["meshes"][0]["primitives"][0];
        primitive["attributes"]["JOINTS_0"] = json!(joints);
        primitive["attributes"]["WEIGHTS_0"] = json!(weights);
        primitive["targets"] = json!([{"POSITION": vectors, "NORMAL": vectors}]);
        primitive["extensions"] = json!({"KHR_materials_variants": {"mappings": [{"material": 0, "variants": [0]}]}});
        d["skins"] = json!([{"joints": [0], "inverseBindMatrices": matrices}]);
        d["animations"] = json!([{
            "samplers": [
                {"input": times, "output": values},
                {"input": times, "output": amounts, "interpolation": "CUBICSPLINE"},
            ],
            "channels": [
                {"sampler": 0, "target": {"node": 0, "path": "translation"}},
                {"sampler": 1, "target": {"node": 0, "path": "weights"}},
            ],
        }]);
    }
}

fn encode(image: image::DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % n.max(1) as u64) as usize
    }
}
