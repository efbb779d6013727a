//! The files, each with one fault (or none: the controls). What becomes of each stands in `outcomes.txt`.

use crate::common::{accessor, data_uri, document, glb, textured, triangle};
use serde_json::{Value, json};

/// File names and contents.
pub fn cases() -> Vec<(String, Vec<u8>)> {
    let mut all = Corpus(Vec::new());
    all.geometry();
    all.buffers();
    all.images();
    all.documents();
    all.nodes();
    all.cameras_and_lights();
    all.shapes();
    all.animations();
    all.instancing();
    all.containers();
    all.extensions();
    all.wavefront();
    all.0
}

/// The buffer of [`triangle`].
pub fn triangle_bytes() -> Vec<u8> {
    let floats = [0f32, 0., 0., 1., 0., 0., 0., 1., 0.];
    let indices = [0u32, 1, 2];
    floats.iter().flat_map(|x| x.to_le_bytes()).chain(indices.iter().flat_map(|i| i.to_le_bytes())).collect()
}

/// Files by name.
pub(super) struct Corpus(pub(super) Vec<(String, Vec<u8>)>);

impl Corpus {
    pub(super) fn add(&mut self, name: &str, document: Value) {
        self.0.push((format!("{name}.gltf"), document.to_string().into_bytes()));
    }

    /// The triangle, changed.
    pub(super) fn vary(&mut self, name: &str, change: impl FnOnce(&mut Value)) {
        let mut document = triangle();
        change(&mut document);
        self.add(name, document);
    }

    fn geometry(&mut self) {
        let corners = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];
        self.add("control", triangle());
        self.add("index-out-of-range", document(&corners, &[0, 1, 99]));
        self.add("nan-corner", document(&[[f32::NAN, 0., 0.], [1., 0., 0.], [0., f32::INFINITY, 0.]], &[0, 1, 2]));
        self.vary("nan-normal", |d| {
            let bytes = [f32::NAN; 9].iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
            let a = accessor(d, &bytes, 5126, "VEC3", 3);
            d["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(a);
        });
        self.add("degenerate", document(&[[0.; 3]; 3], &[0, 1, 2]));
        self.vary("position-out-of-range", |d| d["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(77));
        self.vary("position-scalar", |d| d["accessors"][0]["type"] = json!("SCALAR"));
        self.vary("position-matrix", |d| d["accessors"][0]["type"] = json!("MAT4"));
        self.vary("position-u8", |d| d["accessors"][0]["componentType"] = json!(5121));
        self.vary("component-type-9", |d| d["accessors"][0]["componentType"] = json!(9));
        // Only the low 32 bits are a code.
        self.vary("component-type-2e32", |d| d["accessors"][0]["componentType"] = json!((1u64 << 32) + 5126));
        self.vary("index-float", |d| d["accessors"][1]["componentType"] = json!(5126));
        self.vary("normals-too-few", |d| {
            let a = accessor(d, &[0; 24], 5126, "VEC3", 2);
            d["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(a);
        });
        self.vary("points", |d| d["meshes"][0]["primitives"][0]["mode"] = json!(0));
        self.vary("mode-7", |d| d["meshes"][0]["primitives"][0]["mode"] = json!(7));
        self.vary("mode-2e32", |d| d["meshes"][0]["primitives"][0]["mode"] = json!((1u64 << 32) + 4));
        self.vary("mode-list", |d| d["meshes"][0]["primitives"][0]["mode"] = json!(vec![4; 99]));
        self.vary("two-corners", |d| d["accessors"][1]["count"] = json!(2));
        self.vary("material-out-of-range", |d| d["meshes"][0]["primitives"][0]["material"] = json!(3));
        self.vary("no-attributes", |d| {
            d["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("attributes");
        });
        self.vary("no-position", |d| d["meshes"][0]["primitives"][0]["attributes"] = json!({}));
    }

    fn buffers(&mut self) {
        self.vary("count-0", |d| d["accessors"][0]["count"] = json!(0));
        self.vary("count-4e9", |d| d["accessors"][0]["count"] = json!(4_000_000_000u64));
        self.vary("count-max", |d| d["accessors"][0]["count"] = json!(u64::MAX));
        self.vary("count-negative", |d| d["accessors"][0]["count"] = json!(-3));
        self.vary("count-3e8-without-view", |d| {
            d["accessors"][0] = json!({"componentType": 5126, "count": 300_000_000, "type": "VEC3"});
        });
        self.vary("offset-overflow", |d| d["bufferViews"][0]["byteOffset"] = json!(u64::MAX - 15));
        self.vary("accessor-offset-overflow", |d| d["accessors"][0]["byteOffset"] = json!(u64::MAX - 15));
        self.vary("view-too-long", |d| d["bufferViews"][0]["byteLength"] = json!(1_000_000_000));
        self.vary("view-too-short", |d| d["bufferViews"][0]["byteLength"] = json!(35));
        self.vary("buffer-too-long", |d| d["buffers"][0]["byteLength"] = json!(1_000_000_000));
        self.vary("stride-1", |d| d["bufferViews"][0]["byteStride"] = json!(1));
        self.vary("stride-max", |d| d["bufferViews"][0]["byteStride"] = json!(u64::MAX));
        self.vary("no-uri", |d| d["buffers"][0] = json!({"byteLength": 48}));
        let sparse = |count: u64, values: Value| json!({"count": count, "indices": {"bufferView": 1, "componentType": 5125}, "values": values});
        self.vary("sparse-values-short", |d| {
            d["bufferViews"].as_array_mut().unwrap().push(json!({"buffer": 0, "byteLength": 12}));
            d["accessors"][0]["sparse"] = sparse(3, json!({"bufferView": 2}));
        });
        self.vary("sparse-count-0", |d| d["accessors"][0]["sparse"] = sparse(0, json!({"bufferView": 0})));
        self.vary("sparse-count-9", |d| d["accessors"][0]["sparse"] = sparse(9, json!({"bufferView": 0})));
        let which = |d: &mut Value, indices: &[u8]| {
            let a = accessor(d, indices, 5121, "SCALAR", indices.len());
            let view = d["accessors"][a]["bufferView"].clone();
            json!({"count": indices.len(), "indices": {"bufferView": view, "componentType": 5121}, "values": {"bufferView": 0}})
        };
        self.vary("sparse-index-out-of-range", |d| d["accessors"][0]["sparse"] = which(d, &[0, 3]));
        self.vary("sparse-falling", |d| d["accessors"][0]["sparse"] = which(d, &[1, 0]));
        for (name, uri) in [
            ("uri-not-utf8", "%FF.bin"),
            ("uri-traversal", "../outside.bin"),
            ("uri-traversal-encoded", "%2e%2e%2Foutside.bin"),
            ("uri-traversal-nowhere", "x/../../nowhere.bin"),
            ("uri-backslashes", "..\\outside.bin"),
            ("uri-symlink", "link.bin"),
            ("uri-file-scheme", "file:///etc/hostname"),
            ("uri-http", "https://example.com/a.bin"),
            ("uri-absolute", "/etc/hostname"),
            ("uri-device", "/dev/zero"),
            ("uri-folder", "."),
            ("uri-newline", "a\n\u{1b}[31mb.bin"),
            ("uri-missing", "nowhere.bin"),
            ("uri-empty", ""),
            ("uri-nul", "a%00b"),
            ("uri-bad-base64", "data:;base64,????"),
            ("uri-plain-data", "data:text/plain,hello"),
        ] {
            self.vary(name, |d| d["buffers"][0]["uri"] = json!(uri));
        }
        self.vary("uri-number", |d| d["buffers"][0]["uri"] = json!(7));
    }

    fn images(&mut self) {
        self.vary("unused-images", |d| {
            d["images"] =
                json!([{"bufferView": 0}, {}, {"bufferView": 99}, {"uri": "missing.png"}, {"uri": "/dev/zero"}]);
        });
        self.add("image-view-without-type", textured(json!({"bufferView": 0})));
        self.add("image-empty", textured(json!({})));
        let mut beyond = textured(json!({"bufferView": 2, "mimeType": "image/png"}));
        let view = json!({"buffer": 0, "byteOffset": 40, "byteLength": 100_000});
        beyond["bufferViews"].as_array_mut().unwrap().push(view);
        self.add("image-view-too-long", beyond);
        self.add("image-missing", textured(json!({"uri": "missing.png"})));
        self.add("image-traversal", textured(json!({"uri": "../outside.png"})));
        let mut image = |name: &str, bytes: &[u8]| self.add(name, textured(json!({"uri": data_uri(bytes)})));
        image("png-60000", &png(60000, 60000, &[0; 100]));
        image("png-12000", &png(12000, 12000, &[0; 100]));
        image("png-16384-wide", &png(16385, 1, &[0; 100]));
        image("png-truncated", &png(16, 16, &[0; 10]));
        image("png-0x0", &png(0, 0, &[]));
        image("png-cut-off", &png(16, 16, &[0; 10])[..40]);
        image("gif", b"GIF89a\x01\0\x01\0\0\0\0;");
        image("jpeg-cut-off", &[0xff, 0xd8, 0xff, 0xe0, 0, 16]);
        // Within the limits: 17 million texels in 90 kB.
        let mut bomb = std::io::Cursor::new(Vec::new());
        image::GrayImage::new(4096, 4096).write_to(&mut bomb, image::ImageFormat::Png).unwrap();
        image("png-bomb-allowed", bomb.get_ref());
        let mut texture = textured(json!({}));
        texture["textures"] = json!([]);
        self.add("texture-out-of-range", texture.clone());
        texture["textures"] = json!([{"sampler": 0}]);
        self.add("texture-without-source", texture.clone());
        texture["images"] = json!([{"uri": data_uri(&png(1, 1, &[0; 4]))}]);
        texture["textures"] = json!([{"source": 0, "sampler": 0}]);
        texture["samplers"] = json!([{"wrapS": 7}]);
        self.add("sampler-wrap-7", texture);
        for (name, uri) in [("environment-device", "/dev/zero"), ("environment-not-an-image", "control.gltf")] {
            self.vary(name, |d| d["scenes"][0]["extras"] = json!({"environment": {"uri": uri}}));
        }
        let huge = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n";
        self.vary("environment-1e10-texels", |d| {
            d["scenes"][0]["extras"] = json!({"environment": {"uri": data_uri(huge)}})
        });
    }

    fn documents(&mut self) {
        let mut raw = |name: &str, text: &str| self.0.push((format!("{name}.gltf"), text.as_bytes().to_vec()));
        raw("empty", "");
        raw("not-json", "{\"asset\":");
        raw("deep", &"[".repeat(200_000));
        let extras = format!("\"extras\":{}{},\"asset\"", "[".repeat(200_000), "]".repeat(200_000));
        raw("deep-extras", &triangle().to_string().replacen("\"asset\"", &extras, 1));
        raw("number-1e400", &triangle().to_string().replacen("\"count\":3", "\"count\":1e400", 1));
        raw("many-values", &format!("[{}0]", "0,".repeat(9_000_000)));
        raw("a-number", "17");
        raw("bom", &format!("\u{feff}{}", triangle()));
        self.vary("version-1", |d| d["asset"]["version"] = json!("1.0"));
        self.vary("no-asset", |d| d["asset"] = json!(null));
        self.vary("no-scene", |d| {
            d["scenes"] = json!(null);
            d["scene"] = json!(null);
        });
        self.vary("scene-out-of-range", |d| d["scene"] = json!(4));
        self.vary("required-meshopt", |d| d["extensionsRequired"] = json!(["EXT_meshopt_compression"]));
        self.vary("required-unknown", |d| d["extensionsRequired"] = json!(["FOO_bar"]));
        self.vary("used-unknown", |d| d["extensionsUsed"] = json!(["FOO_bar"]));
    }

    fn nodes(&mut self) {
        let mut nodes = |name: &str, nodes: Value| self.vary(name, |d| d["nodes"] = nodes);
        nodes("cycle", json!([{"mesh": 0, "children": [1]}, {"children": [0]}]));
        nodes("own-child", json!([{"children": [0]}]));
        let dag = (1..=60).map(|i| json!({"children": [i, i]})).chain([json!({"mesh": 0})]);
        nodes("dag-of-60", dag.collect());
        let chain = (1..=300_000).map(|i| json!({"children": [i]})).chain([json!({"mesh": 0})]);
        nodes("chain-of-300000", chain.collect());
        nodes("child-out-of-range", json!([{"children": [9]}]));
        nodes("matrix-zero", json!([{"mesh": 0, "matrix": ([0; 16])}]));
        nodes("matrix-projective", json!([{"mesh": 0, "matrix": ([1; 16])}]));
        nodes("matrix-short", json!([{"mesh": 0, "matrix": [1, 2, 3]}]));
        nodes("scale-1e30", json!([{"mesh": 0, "scale": [1e30, 1e30, 1e30]}]));
        nodes(
            "scale-1e30-twice",
            json!([{"scale": [1e30, 1e30, 1e30], "children": [1]}, {"mesh": 0, "scale": [1e30, 1e30, 1e30]}]),
        );
        nodes("scale-1e39", json!([{"mesh": 0, "scale": [1e39, 1, 1]}]));
        nodes("scale-0", json!([{"mesh": 0, "scale": [1, 0, 1]}]));
        nodes("scale-1e-300", json!([{"mesh": 0, "scale": [1, 1, 1e-300]}]));
        nodes("scale-1e-30", json!([{"mesh": 0, "scale": [1e-30, 1e-30, 1e-30]}]));
        nodes("rotation-0", json!([{"mesh": 0, "rotation": [0, 0, 0, 0]}]));
        nodes("mesh-out-of-range", json!([{"mesh": 5}]));
        self.vary("roots-twice", |d| d["scenes"][0]["nodes"] = json!([0, 0]));
        self.vary("all-in-a-cycle-without-scene", |d| {
            d["scenes"] = json!(null);
            d["scene"] = json!(null);
            d["nodes"] = json!([{"children": [1]}, {"children": [0]}]);
        });
        let mut far = document(&[[3e38, 0., 0.], [-3e38, 0., 0.], [0., 3e38, 0.]], &[0, 1, 2]);
        far["nodes"][0]["scale"] = json!([2, 2, 2]);
        self.add("corners-3e38-doubled", far);
    }

    fn cameras_and_lights(&mut self) {
        let mut camera = |name: &str, camera: Value| {
            self.vary(name, |d| {
                d["cameras"] = json!([camera]);
                d["nodes"][0]["camera"] = json!(0);
            });
        };
        let lens = |yfov: f64| json!({"yfov": yfov, "znear": 0});
        camera("camera-fov-0", json!({"type": "perspective", "perspective": lens(0.0)}));
        camera("camera-fov-4", json!({"type": "perspective", "perspective": lens(4.0)}));
        camera("camera-without-lens", json!({"type": "perspective"}));
        camera("camera-without-type", json!({"perspective": lens(1.0)}));
        camera(
            "camera-film-1e9",
            json!({"type": "perspective", "perspective": lens(1.0), "extras": {"width": 1e9, "height": 1}}),
        );
        let box_of = |x: f64, y: f64| json!({"type": "orthographic", "orthographic": {"xmag": x, "ymag": y}});
        camera("camera-box", box_of(1.0, 1.0));
        camera("camera-box-0", box_of(1.0, 0.0));
        camera("camera-box-1e-60", box_of(1.0, 1e-60));
        camera("camera-box-negative", box_of(-1.0, 1.0));
        camera("camera-box-without-size", json!({"type": "orthographic"}));
        let thin = |extras: Value| json!({"type": "perspective", "perspective": lens(1.0), "extras": extras});
        camera("camera-lens-without-focus", thin(json!({"aperture": 1})));
        camera("camera-lens-negative", thin(json!({"aperture": -1, "focus": 1})));
        camera("camera-lens-focus-0", thin(json!({"aperture": 1, "focus": 0})));
        camera("camera-lens-text", thin(json!({"aperture": "wide"})));
        camera("camera-fisheye-7", thin(json!({"fisheye": 7})));
        self.vary("camera-out-of-range", |d| d["nodes"][0]["camera"] = json!(1));
        let mut light = |name: &str, light: Value| {
            self.vary(name, |d| {
                d["extensions"] = json!({"KHR_lights_punctual": {"lights": [light]}});
                d["nodes"][0]["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
            });
        };
        light("light-spot-without-spot", json!({"type": "spot"}));
        light("light-spot-inside-out", json!({"type": "spot", "spot": {"innerConeAngle": 1, "outerConeAngle": 0.5}}));
        light("light-negative", json!({"type": "point", "intensity": -1e38, "color": [1e38, 1e38, 1e38]}));
        light("light-overflow", json!({"type": "point", "intensity": 1e30, "color": [1e30, 1, 1]}));
        light("light-unknown", json!({"type": "laser"}));
        self.vary("light-out-of-range", |d| {
            d["nodes"][0]["extensions"] = json!({"KHR_lights_punctual": {"light": 5}});
        });
    }

    fn shapes(&mut self) {
        let mut morph = |name: &str, target: Value, weights: Value| {
            self.vary(name, |d| {
                d["meshes"][0]["primitives"][0]["targets"] = target;
                d["meshes"][0]["weights"] = weights;
            });
        };
        morph("morph-control", json!([{"POSITION": 0}]), json!([1]));
        morph("morph-out-of-range", json!([{"POSITION": 9}]), json!([1]));
        morph("morph-of-indices", json!([{"POSITION": 1}]), json!([1]));
        morph("morph-overflow", json!([{"POSITION": 0}]), json!([3e38]));
        morph("morph-too-few-weights", json!([{}, {}]), json!([1]));
        morph("morph-weight-text", json!([{}]), json!(["1"]));
        morph("morph-targets-object", json!({"POSITION": 0}), json!([1]));
        self.vary("morph-primitives-differ", |d| {
            let mut other = d["meshes"][0]["primitives"][0].clone();
            other["targets"] = json!([{}]);
            d["meshes"][0]["primitives"].as_array_mut().unwrap().push(other);
        });
        let mut skin = |name: &str, joints: Value, which: [u8; 4], weights: [f32; 4], matrix: f32| {
            self.vary(name, |d| {
                let bytes = weights.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>().repeat(3);
                let a = accessor(d, &which.repeat(3), 5121, "VEC4", 3);
                let b = accessor(d, &bytes, 5126, "VEC4", 3);
                let c = accessor(d, &matrix.to_le_bytes().repeat(16), 5126, "MAT4", 1);
                let attributes = &mut d["meshes"][0]["primitives"][0]["attributes"];
                attributes["JOINTS_0"] = json!(a);
                attributes["WEIGHTS_0"] = json!(b);
                d["skins"] = json!([{"joints": joints, "inverseBindMatrices": c}]);
                d["nodes"] = json!([{"mesh": 0, "skin": 0}, {}]);
            });
        };
        skin("skin-control", json!([0]), [0; 4], [1., 0., 0., 0.], 1.0);
        skin("skin-joint-weightless", json!([0]), [0, 9, 9, 9], [1., 0., 0., 0.], 1.0);
        skin("skin-joint-out-of-range", json!([0]), [0, 9, 0, 0], [0.5, 0.5, 0., 0.], 1.0);
        skin("skin-joint-not-a-node", json!([7]), [0; 4], [1., 0., 0., 0.], 1.0);
        skin("skin-joint-elsewhere", json!([1]), [0; 4], [1., 0., 0., 0.], 1.0);
        skin("skin-without-joints", json!([]), [0; 4], [1., 0., 0., 0.], 1.0);
        skin("skin-matrices-too-few", json!([0, 0]), [0; 4], [1., 0., 0., 0.], 1.0);
        skin("skin-matrix-nan", json!([0]), [0; 4], [1., 0., 0., 0.], f32::NAN);
        skin("skin-matrix-huge", json!([0]), [0; 4], [1., 0., 0., 0.], 3e38);
        skin("skin-weights-0", json!([0]), [0; 4], [0.; 4], 1.0);
        skin("skin-weights-nan", json!([0]), [0; 4], [f32::NAN, 0., 0., 0.], 1.0);
        skin("skin-weights-negative", json!([0]), [0; 4], [-1., 0., 0., 0.], 1.0);
        self.vary("skin-of-a-still-mesh", |d| {
            d["skins"] = json!([{"joints": [0]}]);
            d["nodes"][0]["skin"] = json!(0);
        });
        self.vary("skin-out-of-range", |d| d["nodes"][0]["skin"] = json!(3));
    }

    /// All are loaded at a time of half a second.
    fn animations(&mut self) {
        let mut animation = |name: &str, times: [f32; 2], values: [f32; 6], change: &dyn Fn(&mut Value)| {
            self.vary(name, |d| {
                let bytes = |xs: &[f32]| xs.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
                let input = accessor(d, &bytes(&times), 5126, "SCALAR", 2);
                let output = accessor(d, &bytes(&values), 5126, "VEC3", 2);
                d["animations"] = json!([{
                    "samplers": [{"input": input, "output": output}],
                    "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
                }]);
                change(d);
            });
        };
        let times = [0.0, 1.0];
        let values = [0., 0., 0., 1., 2., 3.];
        animation("animated-control", times, values, &|_| ());
        animation("animated-backwards", [1.0, 0.0], values, &|_| ());
        animation("animated-time-nan", [0.0, f32::NAN], values, &|_| ());
        animation("animated-value-inf", times, [f32::INFINITY; 6], &|_| ());
        animation("animated-values-far-apart", times, [-3e38, 0., 0., 3e38, 0., 0.], &|_| ());
        let channel = |path: &'static str, key: &'static str, value: Value| {
            move |d: &mut Value| d["animations"][0][path][0][key] = value.clone()
        };
        animation("animated-as-cubic", times, values, &channel("samplers", "interpolation", json!("CUBICSPLINE")));
        animation("animated-by-magic", times, values, &channel("samplers", "interpolation", json!("MAGIC")));
        animation("animated-input-of-vectors", times, values, &channel("samplers", "input", json!(0)));
        animation("animated-output-of-indices", times, values, &channel("samplers", "output", json!(1)));
        animation("animated-sampler-out-of-range", times, values, &channel("channels", "sampler", json!(4)));
        let target = |node: i32, path: &str| channel("channels", "target", json!({"node": node, "path": path}));
        animation("animated-node-out-of-range", times, values, &target(9, "translation"));
        animation("animated-rotation-of-3", times, values, &target(0, "rotation"));
        animation("animated-weights-of-3", times, values, &target(0, "weights"));
        animation("animated-pointer", times, values, &target(0, "pointer"));
        animation("animated-scale-0", times, [0.; 6], &target(0, "scale"));
        animation("animated-matrix", times, values, &|d| {
            d["nodes"][0]["matrix"] = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
        });
        animation("animated-twice", times, values, &|d| {
            let again = d["animations"][0].clone();
            d["animations"].as_array_mut().unwrap().push(again);
        });
    }

    fn instancing(&mut self) {
        let mut many = |name: &str, translations: Value, count: usize, bytes: &[u8]| {
            self.vary(name, |d| {
                d["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
                let a = if bytes.is_empty() { 99 } else { accessor(d, bytes, 5126, "VEC3", count) };
                let mut attributes = translations;
                attributes["SCALE"] = json!(a);
                d["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": attributes}});
            });
        };
        let ones = 1f32.to_le_bytes().repeat(9);
        many("instances-control", json!({"TRANSLATION": 0}), 3, &ones);
        many("instances-of-two-numbers", json!({"TRANSLATION": 0}), 2, &ones[..24]);
        many("instances-out-of-range", json!({}), 0, &[]);
        many("instances-nan", json!({}), 3, &f32::NAN.to_le_bytes().repeat(9));
        many("instances-of-scale-0", json!({}), 3, &[0; 36]);
        many("instances-by-indices", json!({"TRANSLATION": 1}), 3, &ones);
        self.vary("instances-without-attributes", |d| {
            d["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": {"_ID": 0}}});
        });
        self.vary("instances-of-zeros", |d| {
            d["accessors"]
                .as_array_mut()
                .unwrap()
                .push(json!({"componentType": 5126, "count": 1 << 20, "type": "VEC3"}));
            d["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 2}}});
        });
    }

    fn containers(&mut self) {
        let mut raw = |name: &str, bytes: &[u8]| self.0.push((format!("{name}.glb"), bytes.to_vec()));
        let sound = glb(&triangle());
        let with = |at: usize, word: u32| {
            let mut bytes = sound.clone();
            bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
            bytes
        };
        raw("glb-control", &sound);
        raw("glb-length-0", &with(8, 0));
        raw("glb-length-max", &with(8, u32::MAX));
        raw("glb-version-1", &with(4, 1));
        raw("glb-chunk-max", &with(12, u32::MAX));
        raw("glb-first-chunk-bin", &with(16, u32::from_le_bytes(*b"BIN\0")));
        raw("glb-magic-only", b"glTF");
        raw("glb-cut-off", &sound[..sound.len() - 1]);
        raw("glb-trailing-bytes", &[&sound[..], b"trailing"].concat());
    }
}

/// A PNG of 8-bit RGB whose header claims any size, with `data` for its texels, stored.
fn png(width: u32, height: u32, data: &[u8]) -> Vec<u8> {
    let chunk = |kind: &[u8; 4], body: &[u8]| {
        let checked = [&kind[..], body].concat();
        [&(body.len() as u32).to_be_bytes()[..], &checked, &crc32(&checked).to_be_bytes()].concat()
    };
    let header = [&width.to_be_bytes()[..], &height.to_be_bytes(), &[8, 2, 0, 0, 0]].concat();
    let size = data.len() as u16;
    let stored =
        [&[0x78, 0x01, 1][..], &size.to_le_bytes(), &(!size).to_le_bytes(), data, &adler32(data).to_be_bytes()];
    let chunks = [chunk(b"IHDR", &header), chunk(b"IDAT", &stored.concat()), chunk(b"IEND", &[])];
    [&b"\x89PNG\r\n\x1a\n"[..], &chunks.concat()].concat()
}

/// PNG specification, annex D, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |c: u32, _| {
        if c & 1 == 1 { 0xedb8_8320 ^ (c >> 1) } else { c >> 1 }
    };
    !bytes.iter().fold(!0, |crc, b| (0..8).fold(crc ^ u32::from(*b), step))
}

/// RFC 1950, section 9.
fn adler32(bytes: &[u8]) -> u32 {
    let (a, b) = bytes.iter().fold((1, 0), |(a, b), x| ((a + u32::from(*x)) % 65521, (b + a + u32::from(*x)) % 65521));
    b << 16 | a
}
