//! Closed rooms.

use super::shapes::{quad, solid};
use crate::{Material, Mesh, Scene};
use glam::{Vec3, vec3};

/// The Cornell box (Goral, Torrance, Greenberg, Battaile 1984; measured colours as sRGB approximations), scaled to 2 x 2 x 2
/// and open towards the camera: x in -1..1, y in 0..2, z in -1..1.
pub(super) fn cornell_box() -> Scene {
    let mut scene = Scene::default();
    let white = scene.paint(Material::diffuse("white", [0.725, 0.71, 0.68]));
    let red = scene.paint(Material::diffuse("red", [0.63, 0.065, 0.05]));
    let green = scene.paint(Material::diffuse("green", [0.14, 0.45, 0.091]));
    let lamp = scene.paint(Material::emitter("lamp", [17.0, 12.0, 4.0]));
    let (x, y, z) = (Vec3::X * 2.0, Vec3::Y * 2.0, Vec3::Z * 2.0);
    let corner = vec3(-1.0, 0.0, -1.0);
    scene.place(quad(corner, z, x), white);
    scene.place(quad(corner + y, x, z), white);
    scene.place(quad(corner, x, y), white);
    scene.place(quad(corner, y, z), red);
    scene.place(quad(corner + x, z, y), green);
    scene.place(
        quad(vec3(-0.24, 1.98, -0.22), Vec3::X * 0.47, Vec3::Z * 0.38),
        lamp,
    );
    scene.place(turned_box(vec3(0.33, 0.0, 0.37), 0.6, 0.6, -0.29), white);
    scene.place(turned_box(vec3(-0.34, 0.0, -0.29), 0.6, 1.2, 0.34), white);
    scene.view([0.0, 1.0, 6.8], [0.0, 1.0, 0.0], 0.34, (512, 512));
    scene
}

/// A box of a square base, turned about its vertical axis by `angle` radians.
fn turned_box(base: Vec3, side: f32, height: f32, angle: f32) -> Mesh {
    let (sin, cos) = angle.sin_cos();
    let (u, v) = (vec3(cos, 0.0, -sin) * side, vec3(sin, 0.0, cos) * side);
    solid(base - (u + v) / 2.0, [u, Vec3::Y * height, v])
}
