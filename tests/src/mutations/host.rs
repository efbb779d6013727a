//! Mistakes of what surrounds a renderer: film, tables and loader.

use super::Mutation;

pub(super) const MUTATIONS: &[Mutation] = &[
    // ---- film
    Mutation {
        name: "film-sums-in-f32",
        file: "lib-render/src/host/film.rs",
        before: "to_fixed(s)",
        after: "to_fixed((*sum as f64 / 2f64.powi(64)) as f32 + s) - *sum",
        mistake: "a running sum in single precision (69 % too dark after 2^26 samples)",
    },
    Mutation {
        name: "dropped-samples-counted",
        file: "lib-render/src/host/film.rs",
        before: "self.dropped += 1",
        after: "{ self.dropped += 1; self.pixels[index].count += 1 }",
        mistake: "a sample that is thrown away counts, as black",
    },
    // ---- tables
    Mutation {
        name: "classes-ignore-a-column",
        file: "lib-render/src/host/tables/classes.rs",
        before: "spec.3.iter().zip(row).skip(1)",
        after: "spec.3.iter().zip(row).skip(2)",
        mistake: "rows that differ in a known column share a class",
    },
    Mutation {
        name: "normals-transform-as-positions",
        file: "lib-render/src/host/tables/geometry.rs",
        before: "cofactor * n.as_dvec3()",
        after: "to_world * n.as_dvec3()",
        mistake: "normals by the matrix of the instance instead of its inverse transpose",
    },
    Mutation {
        name: "roughness-as-srgb",
        file: "lib-render/src/host/tables/materials.rs",
        before: "textures.row(m.metallic_roughness_texture.as_ref(), Encoding::Linear)",
        after: "textures.row(m.metallic_roughness_texture.as_ref(), Encoding::Srgb)",
        mistake: "a texture of data is decoded as a colour",
    },
    Mutation {
        name: "numbers-of-a-model-one-too-far",
        file: "lib-render/src/host/tables/models.rs",
        before: "self.0.len() - run.len()",
        after: "self.0.len() - run.len() + 1",
        mistake: "a model reads its numbers from the second on",
    },
    // ---- loader
    Mutation {
        name: "stride-ignored",
        file: "scenes/src/gltf/accessor.rs",
        before: "stride as usize",
        after: "size",
        mistake: "interleaved attributes are read as if they were packed",
    },
    Mutation {
        name: "index-bound-off-by-one",
        file: "scenes/src/gltf/accessor.rs",
        before: "i as usize >= vertices",
        after: "i as usize > vertices",
        mistake: "index = number of vertices passes (gltf 1.4.1 accepts any)",
    },
    Mutation {
        name: "obj-counts-back-from-the-end",
        file: "scenes/src/obj/mod.rs",
        before: "(count as i64).saturating_add(given)",
        after: "(count as i64).saturating_add(given) - 1",
        mistake: "negative indices of a face count from one before the last vertex",
    },
    Mutation {
        name: "obj-images-upside-down",
        file: "scenes/src/obj/mod.rs",
        before: "1.0 - v",
        after: "v",
        mistake: "v of an OBJ file, which grows upwards, is taken for glTF's",
    },
    Mutation {
        name: "sun-by-the-whole-texel",
        file: "scenes/src/sky.rs",
        before: "l * share * scale",
        after: "l * scale",
        mistake: "each texel that the sun's disk touches is as bright as the disk",
    },
    // ---- devices
    Mutation {
        name: "last-misses-are-not-shaded",
        file: "lib-render/src/host/wave.rs",
        before: "missed.end",
        after: "missed.end.saturating_sub(1).max(missed.start)",
        mistake: "the last path of a wave that meets nothing keeps what lies in its row",
    },
];
