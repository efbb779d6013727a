//! Files with one fault in an extension. What becomes of each stands in `outcomes.txt`.

use super::corpus::Corpus;
use crate::common::{accessor, data_uri, textured};
use crate::compressed::{packed, stream};
use serde_json::{Value, json};

impl Corpus {
    /// Files of every extension that has something to spoil and is not in another list.
    pub(super) fn extensions(&mut self) {
        self.draco();
        self.variants();
        self.films();
        self.lobes();
        self.many_instances();
        self.many_shapes();
    }

    fn draco(&mut self) {
        let whole = stream(3, 5);
        self.add("draco-control", packed(3, &whole));
        let mut spoilt = |name: &str, change: &dyn Fn(&mut Vec<u8>)| {
            let mut bytes = whole.clone();
            change(&mut bytes);
            self.add(name, packed(3, &bytes));
        };
        spoilt("draco-cut-off", &|b| b.truncate(b.len() / 2));
        spoilt("draco-one-byte-short", &|b| b.truncate(b.len() - 1));
        spoilt("draco-magic-only", &|b| b.truncate(5));
        spoilt("draco-zeros", &|b| b.fill(0));
        spoilt("draco-point-cloud", &|b| b[7] = 0);
        spoilt("draco-method-7", &|b| b[8] = 7);
        // The header of a mesh of plain indices, then 4e9 faces and 4e9 points.
        let huge = [&b"DRACO\x02\x02\x01\x00\0\0"[..], &[0xff, 0xff, 0xff, 0xff, 0x0e].repeat(2), &[1; 64]].concat();
        self.add("draco-4e9-faces", packed(3, &huge));
        let mut ext = |name: &str, change: &dyn Fn(&mut Value)| {
            let mut d = packed(3, &whole);
            change(&mut d["meshes"][0]["primitives"][0]);
            self.add(name, d);
        };
        const DRACO: &str = "KHR_draco_mesh_compression";
        ext("draco-view-out-of-range", &|p| p["extensions"][DRACO]["bufferView"] = json!(9));
        ext("draco-view-text", &|p| p["extensions"][DRACO]["bufferView"] = json!("0"));
        ext("draco-text", &|p| p["extensions"][DRACO] = json!("0"));
        ext("draco-attribute-text", &|p| p["extensions"][DRACO]["attributes"]["POSITION"] = json!("0"));
        ext("draco-attribute-2e32", &|p| p["extensions"][DRACO]["attributes"]["POSITION"] = json!(1u64 << 32));
        ext("draco-attribute-of-another-kind", &|p| p["extensions"][DRACO]["attributes"]["POSITION"] = json!(2));
        ext("draco-attribute-without-accessor", &|p| p["extensions"][DRACO]["attributes"]["COLOR_0"] = json!(0));
        ext("draco-without-attributes", &|p| p["extensions"][DRACO] = json!({"bufferView": 0}));
        ext("draco-without-indices", &|p| p["indices"] = json!(null));
        ext("draco-strip", &|p| p["mode"] = json!(5));
        let mut more = packed(3, &whole);
        more["accessors"][0]["count"] = json!(1_000_000);
        self.add("draco-too-few-points", more);
        let mut narrow = packed(3, &whole);
        narrow["accessors"][1]["componentType"] = json!(5121);
        self.add("draco-indices-of-bytes", narrow);
    }

    fn variants(&mut self) {
        let mut variant = |name: &str, variants: Value, mappings: Value| {
            self.vary(name, |d| {
                d["materials"] = json!([{}]);
                d["extensions"] = json!({"KHR_materials_variants": {"variants": variants}});
                d["meshes"][0]["primitives"][0]["extensions"] =
                    json!({"KHR_materials_variants": {"mappings": mappings}});
            });
        };
        let one = json!([{"name": "only"}]);
        let mapping = |material: Value, variants: Value| json!([{"material": material, "variants": variants}]);
        variant("variant-control", one.clone(), mapping(json!(0), json!([0])));
        variant("variant-material-out-of-range", one.clone(), mapping(json!(7), json!([0])));
        variant("variant-material-text", one.clone(), mapping(json!("0"), json!([0])));
        variant("variant-without-material", one.clone(), json!([{"variants": [0]}]));
        variant("variant-number-text", one.clone(), mapping(json!(0), json!(["0"])));
        variant("variant-numbers-no-list", one.clone(), mapping(json!(0), json!(0)));
        variant("variant-mappings-object", one.clone(), json!({"material": 0, "variants": [0]}));
        variant("variant-of-another", one, mapping(json!(0), json!([5])));
        variant("variant-list-empty", json!([]), json!([]));
        variant("variant-list-object", json!({"name": "only"}), json!([]));
    }

    /// KHR_materials_iridescence with its textures.
    fn films(&mut self) {
        let mut film = |name: &str, film: Value| {
            let mut d = textured(json!({"uri": data_uri(&pixel())}));
            let uv = accessor(&mut d, &[0; 24], 5126, "VEC2", 3);
            d["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(uv);
            d["materials"][0]["extensions"] = json!({"KHR_materials_iridescence": film});
            self.add(name, d);
        };
        let map = json!({"index": 0});
        film("film-control", json!({"iridescenceTexture": map, "iridescenceThicknessTexture": map}));
        film("film-texture-out-of-range", json!({"iridescenceTexture": {"index": 9}}));
        film("film-thickness-out-of-range", json!({"iridescenceThicknessTexture": {"index": 9}}));
        film("film-thickness-without-index", json!({"iridescenceThicknessTexture": {}}));
        film("film-thickness-number", json!({"iridescenceThicknessTexture": 0}));
        film("film-thickness-index-text", json!({"iridescenceThicknessTexture": {"index": "0"}}));
        film("film-set-7", json!({"iridescenceThicknessTexture": {"index": 0, "texCoord": 7}}));
        let turned = |turn: Value| json!({"index": 0, "extensions": {"KHR_texture_transform": turn}});
        film("film-transform-text", json!({"iridescenceTexture": turned(json!("half"))}));
        film("film-transform-of-3", json!({"iridescenceTexture": turned(json!({"scale": [1, 2, 3]}))}));
        film("film-thickness-negative", json!({"iridescenceThicknessMaximum": -1}));
        film("film-thickness-1e30", json!({"iridescenceThicknessMaximum": 1e30}));
        film("film-thickness-1e300", json!({"iridescenceThicknessMaximum": 1e300}));
        film("film-thickest-below-thinnest", json!({"iridescenceThicknessMinimum": 500}));
        film("film-index-0", json!({"iridescenceIor": 0}));
        film("film-factor-2", json!({"iridescenceFactor": 2}));
        film("film-factor-text", json!({"iridescenceFactor": "all"}));
        film("film-text", json!("thin"));
    }

    fn lobes(&mut self) {
        let mut lobe = |name: &str, extension: &str, value: Value| {
            self.vary(name, |d| {
                d["materials"] = json!([{"extensions": {extension: value}}]);
                d["meshes"][0]["primitives"][0]["material"] = json!(0);
            });
        };
        lobe("coat-list", "KHR_materials_clearcoat", json!([1]));
        lobe("coat-normal-out-of-range", "KHR_materials_clearcoat", json!({"clearcoatNormalTexture": {"index": 0}}));
        lobe("sheen-of-two-numbers", "KHR_materials_sheen", json!({"sheenColorFactor": [1, 1]}));
        lobe("sheen-null", "KHR_materials_sheen", json!({"sheenColorFactor": null}));
        lobe("stretch-text", "KHR_materials_anisotropy", json!({"anisotropyRotation": "90"}));
        lobe(
            "leaf-of-4",
            "KHR_materials_diffuse_transmission",
            json!({"diffuseTransmissionColorFactor": [1, 1, 1, 1]}),
        );
        lobe("unlit-true", "KHR_materials_unlit", json!(true));
        lobe("index-text", "KHR_materials_ior", json!({"ior": "glass"}));
        lobe("volume-distance-0", "KHR_materials_volume", json!({"attenuationDistance": 0}));
    }

    /// EXT_mesh_gpu_instancing beyond the limits, without a byte of data.
    fn many_instances(&mut self) {
        const INSTANCING: &str = "EXT_mesh_gpu_instancing";
        let mut zeros = |name: &str, attribute: &str, kind: &str, count: u64, nodes: usize| {
            self.vary(name, |d| {
                let zeros = json!({"componentType": 5126, "count": count, "type": kind});
                d["accessors"].as_array_mut().unwrap().push(zeros);
                d["scenes"][0]["nodes"] = (0..nodes).collect();
                let extension = json!({INSTANCING: {"attributes": {attribute: 2}}});
                d["nodes"] = (0..nodes).map(|_| json!({"mesh": 0, "extensions": extension})).collect();
            });
        };
        zeros("instances-3e9", "TRANSLATION", "VEC3", 3_000_000_000, 1);
        zeros("instances-of-scale-0-again-and-again", "SCALE", "VEC3", 1 << 18, 1000);
        zeros("instances-turned-by-0", "ROTATION", "VEC4", 3, 1);
        zeros("instances-turned-by-vectors", "ROTATION", "VEC3", 3, 1);
        self.vary("instances-text", |d| d["nodes"][0]["extensions"] = json!({INSTANCING: "3"}));
        self.vary("instances-attributes-text", |d| {
            d["nodes"][0]["extensions"] = json!({INSTANCING: {"attributes": "TRANSLATION"}});
        });
        self.vary("instances-attribute-text", |d| {
            d["nodes"][0]["extensions"] = json!({INSTANCING: {"attributes": {"TRANSLATION": "0"}}});
        });
    }

    /// Many nodes that show one mesh of many parts, each in a shape of its own.
    fn many_shapes(&mut self) {
        const NODES: usize = 20_000;
        let part = json!({"attributes": {}, "targets": [{}]});
        let shapes = |d: &mut Value, node: &dyn Fn(usize) -> Value| {
            d["meshes"][0]["primitives"] = (0..NODES).map(|_| part.clone()).collect();
            d["scenes"][0]["nodes"] = (0..NODES).collect();
            d["nodes"] = (0..NODES).map(node).collect();
        };
        self.vary("morph-of-every-node", |d| shapes(d, &|i| json!({"mesh": 0, "weights": [i]})));
        self.vary("skin-of-every-node", |d| {
            shapes(d, &|i| json!({"mesh": 0, "skin": i}));
            d["skins"] = (0..NODES).map(|_| json!({"joints": [0]})).collect();
        });
        self.vary("morph-too-few-vertices", |d| {
            let a = accessor(d, &[0; 24], 5126, "VEC3", 2);
            d["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": a}]);
            d["meshes"][0]["weights"] = json!([1]);
        });
        self.vary("morph-nan", |d| {
            let a = accessor(d, &f32::NAN.to_le_bytes().repeat(9), 5126, "VEC3", 3);
            d["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": a}]);
            d["meshes"][0]["weights"] = json!([1]);
        });
        self.vary("morph-target-text", |d| {
            d["meshes"][0]["primitives"][0]["targets"] = json!(["POSITION"]);
            d["meshes"][0]["weights"] = json!([1]);
        });
    }
}

/// A PNG of one texel.
fn pixel() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::RgbImage::new(1, 1).write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}
