//! Components of a user's crate: a BSDF, a texture, a light and a tracer, one file each, registered beside the library's.
//!
//! [`components`] is all it takes. The generic program is made of that list, once; the partial evaluator then treats what is
//! registered like what the library brings: a scene that does not use a component has none of its code.
//!
//! ```
//! use jerboa_example_custom::{components, scene};
//! use jerboa_lib_render::host::film::Film;
//! use jerboa_lib_render::host::library::Library;
//! use jerboa_lib_render::host::renderer::{Options, Renderer};
//!
//! let (library, scene) = (Library::new(components()), scene());
//! let renderer = Renderer::of(&library, &scene, Options { spp: 4, ..Options::default() })?;
//! let mut film = Film::of_size([32, 16]);
//! renderer.render(&scene.camera_or_default(), &mut film)?;
//! assert!(film.mean().pixels.iter().flatten().sum::<f32>() > 0.0);
//! # Ok::<(), jerboa_lib_render::host::error::Error>(())
//! ```
//!
//! The binary renders [`scene`] to a file: `cargo run --release -p jerboa-example-custom -- custom.png`.

pub mod minnaert;
pub mod rings;
pub mod lamp;
pub mod facing;

use glam::{DAffine3, DVec3, Vec2, Vec3};
use jerboa_lib_render::components::Components;
use jerboa_scenes::{
    Camera, Filter, Instance, Light, LightKind, Material, Mesh, Model, Scene, Texture, TextureRef, TextureSource,
};

/// The library's components and those of this crate.
pub fn components() -> Components {
    Components::new()
        .bsdf(minnaert::MODEL)
        .texture(rings::TEXTURE)
        .light(lamp::LIGHT)
        .tracer(facing::NAME, facing::make_facing_tracer)
}

/// A square of 2 m in the plane z = 0 that faces +z, with Minnaert's scattering and rings, under the lamp 2 m before it.
pub fn scene() -> Scene {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let mesh = Mesh {
        positions: corners.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        uvs: [Some(corners.map(Vec2::from).to_vec()), None],
        ..Mesh::default()
    };
    let rings = Model::named(rings::NAME).with("width", &[0.2]).with("even", &[0.9, 0.6, 0.3]).with("odd", &[0.1]);
    let texture = Texture::repeating("rings", TextureSource::Own(0), Filter::Nearest);
    let material = Material {
        model: Some(Model::named(minnaert::NAME).with("k", &[2.0])),
        base_color_texture: Some(TextureRef { texture: 0, uv_set: 0, transform: None }),
        ..Material::diffuse("moon", [1.0; 3])
    };
    let lamp = Light {
        name: "lamp".into(),
        kind: LightKind::Own(1),
        intensity: [8.0; 3],
        to_world: DAffine3::from_translation(DVec3::Z * 2.0),
    };
    Scene {
        name: "custom".into(),
        meshes: vec![mesh],
        instances: vec![Instance { mesh: 0, to_world: DAffine3::IDENTITY }],
        materials: vec![material],
        textures: vec![texture],
        lights: vec![lamp],
        own: vec![rings, Model::named(lamp::NAME).with("exponent", &[1.0])],
        cameras: vec![Camera::look_at("front", DVec3::Z * 4.0, DVec3::ZERO, 0.6)],
        ..Scene::default()
    }
}
