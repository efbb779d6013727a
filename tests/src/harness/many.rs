//! Scenes with any number of materials, shaders, lights and textures: for what must not grow with them, or no faster than
//! they do (T24).
//!
//! Each is a wall of squares, one for each material, seen from the front.

use glam::{DAffine3, DVec3, Vec2, Vec3};
use jerboa_lib_render::host::tables::{Choices, Known, Tables};
use jerboa_lib_render::schema::{Geometries, binding};
use jerboa_scenes::{
    Camera, Filter, Image, Instance, Light, LightKind, Material, Mesh, Scene, Texture, TextureRef, TextureSource, Wrap,
};

use super::analytic::rectangle;
use super::bench::Random;

/// A wall of so many materials of one structure, each of its own colour.
pub fn materials(n: usize) -> Scene {
    let colour = |i: usize| [1, 64, 4096].map(|step| ((i * 37 / step) % 64) as f32 / 64.0 + 0.005);
    wall((0..n).map(|i| Material::plastic("a colour", colour(i), 0.4)).collect())
}

/// A wall of so many materials, each of a structure that no other has; at most [`most_shaders`].
pub fn shaders(n: usize) -> Scene {
    let mut materials = structures();
    assert!(n <= materials.len(), "there are {} structures", materials.len());
    materials.truncate(n);
    with_textures(wall(materials))
}

/// How many materials of different structure there are.
pub fn most_shaders() -> usize {
    structures().len()
}

/// A wall of one material, lit by so many points.
pub fn lights(n: usize) -> Scene {
    let mut scene = materials(1);
    let light = |i: usize| point(DVec3::new(i as f64 / n as f64, 0.5, 1.0));
    scene.lights = (0..n).map(light).collect();
    scene
}

/// A wall of so many materials, each with a texture and an image of its own.
pub fn textures(n: usize) -> Scene {
    let mut scene = materials(n);
    for (i, material) in scene.materials.iter_mut().enumerate() {
        material.base_color_texture = Some(TextureRef { texture: i, uv_set: 0, transform: None });
        let source = TextureSource::Image(i);
        let name = format!("texture {i}");
        scene.textures.push(Texture::repeating(name.clone(), source, Filter::Bilinear));
        scene.images.push(Image { name, width: 1, height: 1, rgba: vec![[i as u8, (i >> 8) as u8, 128, 255]] });
    }
    scene
}

/// Squares side by side, in rows, from (0, 0, 0) to (1, 1, 0).
fn wall(materials: Vec<Material>) -> Scene {
    let columns = (materials.len() as f64).sqrt().ceil() as usize;
    let side = 1.0 / columns as f32;
    let uvs = [Some([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(u, v)| Vec2::new(u, v)).to_vec()), None];
    let square = |i: usize| {
        let corner = Vec3::new((i % columns) as f32, (i / columns) as f32, 0.0) * side;
        Mesh { uvs: uvs.clone(), material: i, ..rectangle(corner, Vec3::X * side, Vec3::Y * side) }
    };
    let camera = Camera::look_at("front", DVec3::new(0.5, 0.5, 1.5), DVec3::new(0.5, 0.5, 0.0), 0.7);
    Scene {
        name: format!("{} materials", materials.len()),
        meshes: (0..materials.len()).map(square).collect(),
        instances: (0..materials.len()).map(|mesh| Instance { mesh, to_world: DAffine3::IDENTITY }).collect(),
        cameras: vec![camera],
        lights: vec![point(DVec3::new(0.5, 0.5, 1.0))],
        materials,
        ..Scene::default()
    }
}

fn point(position: DVec3) -> Light {
    let to_world = DAffine3::from_translation(position);
    Light { name: "a point".into(), kind: LightKind::Point, intensity: [1.0; 3], to_world }
}

/// Textures that [`structures`] refer to: a pattern, and an image read in two ways.
fn with_textures(mut scene: Scene) -> Scene {
    let texture = |source, wrap_s, filter| Texture { wrap_s, ..Texture::repeating("a texture", source, filter) };
    let pattern = TextureSource::Checkerboard { even: [0.8; 3], odd: [0.2; 3] };
    scene.textures = vec![
        texture(pattern, Wrap::Repeat, Filter::Nearest),
        texture(TextureSource::Image(0), Wrap::Mirror, Filter::Nearest),
        texture(TextureSource::Image(0), Wrap::Repeat, Filter::Bilinear),
    ];
    let rgba = vec![[128, 128, 255, 255], [140, 120, 250, 255], [120, 140, 250, 255], [128, 120, 240, 255]];
    scene.images = vec![Image { name: "an image".into(), width: 2, height: 2, rgba }];
    scene
}

/// Materials of different structure, in a random order: so any number of them is much like any other number.
fn structures() -> Vec<Material> {
    let texture = |n: usize| n.checked_sub(1).map(|texture| TextureRef { texture, uv_set: 0, transform: None });
    let mut all = Vec::new();
    for number in 0..3 * 2 * 2 * 2 * 2 * 2 * 4 {
        let mut rest = number;
        let mut digit = |base: usize| {
            let digit = rest % base;
            rest /= base;
            digit
        };
        all.push(Material {
            name: format!("structure {number}"),
            metallic: [0.0, 0.5, 1.0][digit(3)],
            roughness: [0.0, 0.4][digit(2)],
            specular: [0.0, 1.0][digit(2)],
            transmission: [0.0, 0.5][digit(2)],
            normal_texture: texture(3 * digit(2)),
            metallic_roughness_texture: texture(3 * digit(2)),
            base_color_texture: texture(digit(4)),
            base_color: [0.7, 0.6, 0.5, 1.0],
            ..Material::default()
        });
    }
    let mut random = Random(24);
    for i in (1..all.len()).rev() {
        all.swap(i, random.below(i + 1));
    }
    // Some differ in numbers only.
    let tables = Tables::new(&with_textures(wall(all.clone())), &Choices::default(), Known::Structure);
    let classes = &tables.facts.tables[binding::<Geometries>()].class_of;
    let mut seen = Vec::new();
    let first = |class: &u32| {
        !seen.contains(class) && {
            seen.push(*class);
            true
        }
    };
    let mut keep = classes.iter().map(first).collect::<Vec<_>>().into_iter();
    all.retain(|_| keep.next().expect("a row for each material"));
    all
}

/// A line through points by least squares: slope, value at 0, and the share of the variance that it explains, R².
pub fn line(points: &[(f64, f64)]) -> (f64, f64, f64) {
    let n = points.len() as f64;
    let mean = |f: fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let sum = |f: &dyn Fn(f64, f64) -> f64| points.iter().map(|p| f(p.0 - x, p.1 - y)).sum::<f64>();
    let (xx, xy, yy) = (sum(&|x, _| x * x), sum(&|x, y| x * y), sum(&|_, y| y * y));
    let slope = xy / xx;
    (slope, y - slope * x, xy * xy / (xx * yy))
}
