//! Closed rooms: the Cornell box, and enclosures whose radiance is known.

use super::shapes::{floor, inside_out, panel, quad, sky, solid, sphere, varied};
use crate::{Light, LightKind, Material, Mesh, Scene};
use glam::{DAffine3, DVec3, Vec3, vec3};

/// The box 2 x 2 x 2 about the origin.
const CUBE: (Vec3, [Vec3; 3]) = (Vec3::NEG_ONE, [vec3(2.0, 0.0, 0.0), vec3(0.0, 2.0, 0.0), vec3(0.0, 0.0, 2.0)]);

/// The Cornell box (Goral, Torrance, Greenberg, Battaile 1984; its measured colours in linear sRGB), scaled to 2 x 2 x 2 and
/// open towards the camera: x in -1..1, y in 0..2, z in -1..1.
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
    scene.place(panel(vec3(0.0, 1.98, 0.0), 0.47, 0.38), lamp);
    scene.place(turned_box(vec3(0.33, 0.0, 0.37), 0.6, 0.6, -0.29), white);
    scene.place(turned_box(vec3(-0.34, 0.0, -0.29), 0.6, 1.2, 0.34), white);
    scene.view([0.0, 1.0, 6.8], [0.0, 1.0, 0.0], 0.34, (512, 512));
    scene
}

/// The Cornell box with everything, the camera too, moved by a million along each axis: there single precision steps by
/// 1/16, so that the picture is the same only where positions are taken relative to the camera first.
pub(super) fn far_away() -> Scene {
    let mut scene = cornell_box();
    let away = DAffine3::from_translation(DVec3::splat(1e6));
    scene.instances.iter_mut().for_each(|i| i.to_world = away * i.to_world);
    scene.cameras.iter_mut().for_each(|c| c.to_world = away * c.to_world);
    scene
}

/// The Cornell box with everything, the camera too, `factor` times as large.
fn scaled_box(factor: f64) -> Scene {
    let mut scene = cornell_box();
    let scale = DAffine3::from_scale(DVec3::splat(factor));
    scene.instances.iter_mut().for_each(|i| i.to_world = scale * i.to_world);
    scene.cameras.iter_mut().for_each(|c| c.to_world.translation *= factor);
    scene
}

/// See [`scaled_box`]; 2^20 times as large. Powers of two are exact, so nothing but an absolute number in the renderer can
/// tell it from the Cornell box.
pub(super) fn huge() -> Scene {
    scaled_box(1_048_576.0)
}

/// See [`huge`]; 2^13 times as small.
pub(super) fn tiny() -> Scene {
    scaled_box(1.0 / 8192.0)
}

/// The Cornell box and in it triangles without area, as points and as lines, grey ones and ones that glow.
pub(super) fn crumbs() -> Scene {
    let mut scene = cornell_box();
    let dust = scene.paint(Material::diffuse("dust", [0.5; 3]));
    let spark = scene.paint(Material::emitter("spark", [1e6; 3]));
    for material in [dust, spark] {
        for i in 0..100u32 {
            let [x, y, z] = [3 * i, 3 * i + 1, 3 * i + 2].map(|n| varied(n) * 1.8 - 0.9);
            let (p, q) = (vec3(x, y + 1.0, z), vec3(z, x + 1.0, y));
            let positions = vec![p, q];
            let triangles = vec![[0, 0, 0], [0, 1, 1], [0, 1, 0]];
            scene.place(Mesh { positions, triangles, ..Mesh::default() }, material);
        }
    }
    scene
}

/// A box of a square base, turned about its vertical axis by `angle` radians.
fn turned_box(base: Vec3, side: f32, height: f32, angle: f32) -> Mesh {
    let (sin, cos) = angle.sin_cos();
    let (u, v) = (vec3(cos, 0.0, -sin) * side, vec3(sin, 0.0, cos) * side);
    solid(base - (u + v) / 2.0, [u, Vec3::Y * height, v])
}

/// Seen from inside, a wall of albedo rho that emits 1 - rho: radiance L = (1 - rho) / (1 - rho) = 1 in every direction.
fn furnace(wall: Mesh, albedo: f32) -> Scene {
    let mut scene = Scene::default();
    let emissive = [1.0 - albedo; 3];
    let wall_material = Material { emissive, ..Material::diffuse("wall", [albedo; 3]) };
    let material = scene.paint(wall_material);
    scene.place(inside_out(wall), material);
    scene.view([0.1, 0.2, 0.3], [0.0, 0.0, -1.0], 1.2, (256, 256));
    scene
}

/// See [`furnace`]; albedo 1/2.
pub(super) fn furnace_sphere() -> Scene {
    furnace(sphere(Vec3::ZERO, 1.0, 4), 0.5)
}

/// See [`furnace`]; albedo in per cent.
pub(super) fn closed_box<const PERCENT: u32>() -> Scene {
    furnace(solid(CUBE.0, CUBE.1), PERCENT as f32 / 100.0)
}

/// Walls that absorb nothing: only the lamp ends a path.
pub(super) fn white_box() -> Scene {
    let mut scene = furnace(solid(CUBE.0, CUBE.1), 1.0);
    let lamp = scene.paint(Material::emitter("lamp", [1.0; 3]));
    scene.place(panel(vec3(0.0, 0.9, 0.0), 0.2, 0.2), lamp);
    scene
}

/// A black room and a bright world: nothing may come through the walls.
fn black_room(wall: Mesh) -> Scene {
    let mut scene = Scene::default();
    let black = scene.paint(Material::diffuse("black", [0.0; 3]));
    scene.place(inside_out(wall), black);
    let light = |kind, to_world| Light { name: "outside".into(), kind, intensity: [1e6; 3], to_world };
    scene.lights.push(light(LightKind::Point, DAffine3::from_translation(DVec3::new(0.0, 1.5, 0.0))));
    scene.lights.push(light(LightKind::Directional, DAffine3::IDENTITY));
    scene.environment = Some(sky(16, |_| [1e6; 3]));
    scene.view([0.0, 0.0, 0.0], [0.3, 0.2, -1.0], 1.2, (256, 256));
    scene
}

/// See [`black_room`]; flat walls.
pub(super) fn black_box() -> Scene {
    black_room(solid(CUBE.0, CUBE.1))
}

/// See [`black_room`]; a coarse sphere whose shading normals differ much from its facets.
pub(super) fn black_sphere() -> Scene {
    black_room(sphere(Vec3::ZERO, 1.0, 1))
}

/// Two perfect mirrors face to face with a small lamp between, seen up along their normal: paths are long.
pub(super) fn facing_mirrors() -> Scene {
    let mut scene = Scene::default();
    let mirror = scene.paint(Material::metal("mirror", [1.0; 3], 0.0));
    let lamp = scene.paint(Material::emitter("lamp", [1.0; 3]));
    scene.place(floor(Vec3::NEG_Y, 4.0, 4.0), mirror);
    scene.place(panel(Vec3::Y, 4.0, 4.0), mirror);
    scene.place(sphere(vec3(0.0, 0.0, -1.0), 0.2, 2), lamp);
    scene.view([0.0, -0.5, 1.5], [0.0, 1.0, 0.9], 1.2, (256, 256));
    scene
}
