//! What the host lays out in tables is what the scene says: how images are decoded, where normals and tangents point.

use glam::{DAffine3, DQuat, DVec3, Vec3};
use jerboa_ir::lang::{Buf, Col, F32};
use jerboa_lib_render::host::tables::{Choices, Known, Tables};
use jerboa_lib_render::schema::{self, Materials, Normals, Primitives, Tangents, Textures, Vertices};
use jerboa_scenes::{Filter, Image, Instance, Material, Mesh, Scene, Texture, TextureRef, TextureSource};

fn tables(scene: &Scene) -> Tables {
    Tables::new(scene, &Choices::default(), Known::Structure)
}

/// A word of a table.
fn word<B: Buf, T>(tables: &Tables, column: Col<B, T>, row: u32) -> u32 {
    let memory = &tables.memory[schema::binding::<B>()];
    memory.words[row as usize * B::COLUMNS.len() + column.0 as usize]
}

/// A vector of a table.
fn vector<B: Buf>(tables: &Tables, columns: [Col<B, F32>; 3], row: u32) -> Vec3 {
    Vec3::from(columns.map(|column| f32::from_bits(word(tables, column, row))))
}

#[test]
fn an_image_is_decoded_as_its_use_demands() {
    // glTF 2.0, section 3.9, and the extensions' texts: colours are sRGB; roughness, normals and strengths are numbers.
    let image = || Some(TextureRef { texture: 0, uv_set: 0, transform: None });
    let material = Material {
        base_color_texture: image(),
        metallic_roughness_texture: image(),
        normal_texture: image(),
        emissive_texture: image(),
        specular_texture: image(),
        specular_color_texture: image(),
        transmission_texture: image(),
        ..Material::default()
    };
    let texture = Texture::repeating("", TextureSource::Image(0), Filter::Bilinear);
    let scene = Scene {
        materials: vec![material],
        textures: vec![texture],
        images: vec![Image { name: String::new(), width: 1, height: 1, rgba: vec![[0; 4]] }],
        ..Scene::default()
    };
    let tables = tables(&scene);
    use Materials as M;
    let colors = [M::BASE_TEXTURE, M::EMISSION_TEXTURE, M::SPECULAR_COLOR_TEXTURE];
    let numbers = [M::METALLIC_ROUGHNESS_TEXTURE, M::NORMAL_TEXTURE, M::SPECULAR_TEXTURE, M::TRANSMISSION_TEXTURE];
    let is_srgb = |column| word(&tables, Textures::SRGB, word(&tables, column, 0));
    assert_eq!(colors.map(is_srgb), [1; 3]);
    assert_eq!(numbers.map(is_srgb), [0; 4]);
}

#[test]
fn normals_and_tangents_stay_with_their_surface() {
    let positions = vec![Vec3::ZERO, Vec3::new(1.0, 0.0, 0.5), Vec3::new(0.0, 1.0, 0.25)];
    let normal = positions[1].cross(positions[2]).normalize();
    let mesh = Mesh {
        normals: Some(vec![normal; 3]),
        tangents: Some(vec![positions[1].normalize().extend(1.0); 3]),
        positions,
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    // Uneven scales, turned; the last two mirror.
    for scale in [[1.0, 1.0, 1.0], [1.0, 4.0, 0.25], [-3.0, 1.0, 0.5], [0.1, 2.0, -7.0]] {
        let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 1.0);
        let to_world = DAffine3::from_scale_rotation_translation(scale.into(), turn, DVec3::new(1.0, 2.0, 3.0));
        let scene = Scene {
            meshes: vec![mesh.clone()],
            instances: vec![Instance { mesh: 0, to_world }],
            materials: vec![Material::default()],
            ..Scene::default()
        };
        let tables = tables(&scene);
        let corners = [Primitives::I0, Primitives::I1, Primitives::I2].map(|i| word(&tables, i, 0));
        let [a, b, c] = corners.map(|i| vector(&tables, [Vertices::X, Vertices::Y, Vertices::Z], i));
        let front = (b - a).cross(c - a).normalize();
        let along = to_world.transform_vector3(mesh.positions[1].as_dvec3()).normalize().as_vec3();
        for i in corners {
            let normal = vector(&tables, [Normals::X, Normals::Y, Normals::Z], i);
            let tangent = vector(&tables, [Tangents::X, Tangents::Y, Tangents::Z], i);
            assert!(normal.distance(front) < 1e-5, "scale {scale:?}: {normal}, not {front}");
            assert!(tangent.distance(along) < 1e-5, "scale {scale:?}: {tangent}, not {along}");
            // The bitangent w (n × t) turns with the mirror image.
            let sign = f32::from_bits(word(&tables, Tangents::SIGN, i));
            assert_eq!(sign, (scale[0] * scale[1] * scale[2]).signum() as f32, "scale {scale:?}");
        }
    }
}

/// N16: the product of the first corner's edges is the normal to some roundings, whichever corner of a needle comes first.
#[test]
fn normals_of_needles_keep_their_digits() {
    for (width, first) in [1e-2f32, 1e-4, 1e-6].into_iter().flat_map(|width| (0..3).map(move |first| (width, first))) {
        let a = Vec3::new(0.3, 0.2, 0.1);
        let corners = [a, a + Vec3::new(0.0, width, 0.6 * width), a + Vec3::new(0.61, 0.37, 0.83)];
        let mesh = Mesh {
            positions: (0..3).map(|i| corners[(first + i) % 3]).collect(),
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let scene = Scene {
            meshes: vec![mesh],
            instances: vec![Instance { mesh: 0, to_world: DAffine3::IDENTITY }],
            materials: vec![Material::default()],
            ..Scene::default()
        };
        let tables = tables(&scene);
        let place = |i| vector(&tables, [Vertices::X, Vertices::Y, Vertices::Z], word(&tables, i, 0));
        let [p, q, r] = [Primitives::I0, Primitives::I1, Primitives::I2].map(place);
        let [x, y, z] = [p, q, r].map(Vec3::as_dvec3);
        let truth = (y - x).cross(z - x).normalize();
        // As `Triangle::face_normal` has it.
        let (e1, e2) = (q - p, r - p);
        let scale = e1.abs().max_element().max(e2.abs().max_element());
        let normal = (e1 / scale).cross(e2 / scale).as_dvec3().normalize();
        assert!(normal.distance(truth) < 4e-7, "{width}, {first}: off by {}", normal.distance(truth));
    }
}
