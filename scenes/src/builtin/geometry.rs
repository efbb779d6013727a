//! Geometry that is hard on intersection and on shading frames.

use super::shapes::{floor, panel, quad, sky, solid, sphere, varied};
use crate::{Instance, Material, Mesh, Scene};
use glam::{DAffine3, DQuat, DVec3, EulerRot, Vec3, Vec4, vec3};

/// No triangles, no light: a black picture and two warnings.
pub(super) fn empty() -> Scene {
    let mut scene = Scene::default();
    scene.view([0.0, 0.0, 1.0], [0.0, 0.0, 0.0], 0.7, (64, 64));
    scene
}

/// A floor a kilometre wide seen from a hand's breadth above, rough metal, with low lamps: every angle is grazing.
pub(super) fn grazing() -> Scene {
    let mut scene = Scene { environment: Some(sky(16, |_| [0.2; 3])), ..Scene::default() };
    let metal = scene.paint(Material::metal("steel", [0.7; 3], 0.4));
    let lamp = scene.paint(Material::emitter("lamp", [5.0, 4.0, 3.0]));
    scene.place(floor(Vec3::ZERO, 1000.0, 1000.0), metal);
    for i in 0..5 {
        scene.place(solid(vec3(i as f32 - 2.0, 0.05, -3.0), [Vec3::X * 0.2, Vec3::Y * 0.1, Vec3::Z * 0.2]), lamp);
    }
    scene.view([0.0, 0.1, 2.0], [0.0, 0.09, 0.0], 0.8, (512, 256));
    scene
}

/// A floor with a band of needle triangles a million times longer than wide, and blades as thin above it.
pub(super) fn needles() -> Scene {
    let mut scene = Scene::default();
    let grey = scene.paint(Material::diffuse("floor", [0.5; 3]));
    let blade = scene.paint(Material::diffuse("blade", [0.2, 0.5, 0.1]));
    let lamp = scene.paint(Material::emitter("lamp", [10.0; 3]));
    scene.place(striped_floor(), grey);
    let blades = (0..200u32).flat_map(|i| {
        let foot = vec3(i as f32 * 0.005 - 0.5, 0.0, 0.1);
        [foot, foot + Vec3::X * 1e-6, foot + Vec3::Y]
    });
    let triangles = (0..200).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    scene.place(Mesh { positions: blades.collect(), triangles, ..Mesh::default() }, blade);
    scene.place(panel(vec3(0.0, 2.0, 0.0), 0.5, 0.5), lamp);
    scene.view([0.0, 1.0, 3.0], [0.0, 0.2, 0.0], 0.6, (256, 256));
    scene
}

/// A unit square floor of strips that share their edges: 64 of a millionth at the middle, the rest in two.
fn striped_floor() -> Mesh {
    let xs = std::iter::once(-0.5).chain((0..=64).map(|i| i as f32 * 1e-6)).chain(std::iter::once(0.5));
    let positions: Vec<Vec3> = xs.flat_map(|x| [vec3(x, 0.0, -0.5), vec3(x, 0.0, 0.5)]).collect();
    let strips = positions.len() as u32 / 2 - 1;
    let triangles =
        (0..strips).flat_map(|s| [0, 1].map(|t| if t == 0 { [0, 1, 3] } else { [0, 3, 2] }.map(|i| i + 2 * s)));
    Mesh { triangles: triangles.collect(), positions, ..Mesh::default() }
}

/// Two squares in the same place with different materials: the one of the smaller primitive number, red, is seen; and a
/// ball of doubled triangles.
pub(super) fn coincident() -> Scene {
    let mut scene = Scene { environment: Some(sky(16, |_| [1.0; 3])), ..Scene::default() };
    let red = scene.paint(Material::diffuse("red", [0.8, 0.1, 0.1]));
    let blue = scene.paint(Material::diffuse("blue", [0.1, 0.1, 0.8]));
    for material in [red, blue] {
        scene.place(quad(vec3(-1.2, -0.5, 0.0), Vec3::X, Vec3::Y), material);
        scene.place(sphere(vec3(0.7, 0.0, 0.0), 0.5, 3), material);
    }
    scene.view([0.0, 0.0, 4.0], [0.0, 0.0, 0.0], 0.5, (256, 128));
    scene
}

/// Balls whose shading normals are zero, 1e-20 long, turned inside, or mirrored with their mesh (a negative determinant),
/// with zero tangents.
pub(super) fn odd_normals() -> Scene {
    let mut scene = Scene { environment: Some(sky(16, |d| [0.5 + 0.5 * d.y; 3])), ..Scene::default() };
    let plastic = scene.paint(Material::plastic("plastic", [0.7; 3], 0.3));
    let bends: [fn(Vec3) -> Vec3; 4] = [|_| Vec3::ZERO, |n| n * 1e-20, |n| -n, |n| n];
    for (i, bend) in bends.into_iter().enumerate() {
        let mut ball = sphere(vec3(i as f32 * 1.1 - 1.65, 0.0, 0.0), 0.5, 3);
        ball.normals.iter_mut().flatten().for_each(|n| *n = bend(*n));
        ball.tangents = Some(vec![Vec4::ZERO; ball.positions.len()]);
        scene.place(ball, plastic);
    }
    let mirrored = DAffine3::from_scale(DVec3::new(1.0, -1.0, 1.0));
    scene.instances.pop();
    scene.instances.push(Instance { mesh: 3, to_world: mirrored });
    scene.view([0.0, 0.0, 5.0], [0.0, 0.0, 0.0], 0.5, (384, 128));
    scene
}

/// A beach of 512 pebbles, turned, squeezed and mirrored, that are one mesh of 1,280 triangles.
pub(super) fn pebbles() -> Scene {
    let mut scene = Scene { environment: Some(sky(16, |d| [0.4 + 0.4 * d.y, 0.5, 0.6])), ..Scene::default() };
    let sand = scene.paint(Material::diffuse("sand", [0.6, 0.5, 0.4]));
    let stone = scene.paint(Material::plastic("stone", [0.4, 0.4, 0.45], 0.3));
    scene.place(floor(Vec3::ZERO, 40.0, 40.0), sand);
    scene.place(sphere(Vec3::ZERO, 1.0, 3), stone);
    scene.instances.truncate(1);
    for i in 0..512_u32 {
        let [a, b, c] = [0, 1, 2].map(|k| f64::from(varied(3 * i + k)));
        let at = DVec3::new(f64::from(i % 32) + b - 16.0, 0.15, f64::from(i / 32) + c - 14.0);
        let mirrored = if i % 5 == 0 { -1.0 } else { 1.0 };
        let size = DVec3::new(mirrored * (0.25 + 0.2 * a), 0.15 + 0.1 * b, 0.3 + 0.2 * c);
        let turned = DQuat::from_euler(EulerRot::YXZ, std::f64::consts::TAU * c, 0.4 * a, 0.4 * b);
        scene
            .instances
            .push(Instance { mesh: 1, to_world: DAffine3::from_scale_rotation_translation(size, turned, at) });
    }
    scene.view([0.0, 2.5, 6.0], [0.0, 0.0, -2.0], 0.7, (256, 128));
    scene
}
