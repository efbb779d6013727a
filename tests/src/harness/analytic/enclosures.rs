//! Closed rooms, and convex bodies in a uniform sky.

use std::f64::consts::PI;

use glam::DVec3;
use jerboa_lib_render::host::tables::Choices;
use jerboa_scenes::{Camera, Environment, LightKind, Material, Mesh, Scene};

use super::{Closed, Look, inradius, inside_out, light, place, sphere};

/// Albedos of the list (T4).
const ALBEDOS: [f32; 4] = [0.1, 0.5, 0.8, 0.95];
/// Level of the spheres with point lights: 81,920 triangles, and the list asks for 80,000.
const FINE: u32 = 6;

/// Closed surfaces with point lights or glowing walls, radiance 1, and convex bodies under a uniform sky: each point of
/// one sees half of the sky and nothing else, so its radiance is its albedo.
///
/// The first three are those of pbrt's tests: a sphere of albedo .5 with one point light, with four, and one that glows.
/// In a sphere of triangles whose planes are at least d from the middle, a point light there gives between d and 1/d² of
/// what it would give a round one, and by the sum of reflections the same bounds hold for the radiance.
pub fn enclosures() -> Vec<Closed> {
    let round = inside_out(sphere(FINE));
    let facets = inradius(&round).powi(-2) - 1.0;
    let mut all = Vec::new();
    for (lights, albedo) in ALBEDOS.map(|a| (1, a)).into_iter().chain([(4, 0.5)]) {
        let mut scene = Scene::default();
        place(&mut scene, round.clone(), Material::diffuse("wall", [albedo; 3]), 1.0, DVec3::ZERO);
        // Direct radiance rho I / pi = 1 − rho.
        let intensity = PI as f32 * (1.0 - albedo) / albedo;
        scene.lights = vec![light(LightKind::Point, intensity / lights as f32, 0.0); lights];
        all.push(inside(&format!("sphere with {lights} point lights"), albedo, scene, facets));
    }
    for albedo in ALBEDOS {
        all.push(inside("glowing sphere", albedo, glowing(inside_out(sphere(4)), albedo), 0.0));
        all.push(glowing_box(albedo));
        for (name, mesh) in [("ball in the sky", sphere(4)), ("box in the sky", cube())] {
            let mut scene = Scene::default();
            place(&mut scene, mesh, Material::diffuse("body", [albedo; 3]), 1.0, DVec3::ZERO);
            scene.environment = Some(uniform_sky());
            all.push(outside(name, albedo, scene));
        }
    }
    all
}

/// The inside of a box of this albedo that emits 1 − albedo: radiance 1.
pub fn glowing_box(albedo: f32) -> Closed {
    inside("glowing box", albedo, glowing(inside_out(cube()), albedo), 0.0)
}

fn glowing(wall: Mesh, albedo: f32) -> Scene {
    let mut scene = Scene::default();
    let material = Material { emissive: [1.0 - albedo; 3], ..Material::diffuse("wall", [albedo; 3]) };
    place(&mut scene, wall, material, 1.0, DVec3::ZERO);
    scene
}

/// A camera near the middle, one close to the wall that looks along it, and a narrow one in a corner.
pub(super) fn inside(name: &str, albedo: f32, scene: Scene, facets: f64) -> Closed {
    let views = [
        (DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.0, 0.0, -1.0), 1.2),
        (DVec3::new(0.02, 0.01, 0.97), DVec3::new(0.0, 1.0, 0.9), 2.5),
        (DVec3::new(-0.5, 0.5, -0.5), DVec3::new(0.57, -0.57, 0.57), 0.3),
    ];
    let looks = views.map(|(eye, at, yfov)| (Look::whole(Camera::look_at("inside", eye, at, yfov)), 1.0));
    Closed {
        name: format!("{name}, albedo {albedo}"),
        scene,
        looks: looks.into(),
        facets,
        choices: Choices::default(),
        is_near: false,
        effort: 1,
    }
}

/// Three cameras that see the body and nothing else.
pub(super) fn outside(name: &str, albedo: f32, scene: Scene) -> Closed {
    let looks = [DVec3::new(0.0, 0.1, 4.0), DVec3::new(2.0, 3.0, -2.0), DVec3::new(0.1, -3.5, 0.1)].map(|eye| {
        let camera = Camera::look_at("outside", eye, DVec3::ZERO, 0.2);
        (Look::whole(camera), f64::from(albedo))
    });
    Closed {
        name: format!("{name}, albedo {albedo}"),
        scene,
        looks: looks.into(),
        facets: 0.0,
        choices: Choices::default(),
        is_near: false,
        effort: 1,
    }
}

/// Radiance 1 from everywhere, by a map of 8 x 4.
pub(super) fn uniform_sky() -> Environment {
    Environment { width: 8, height: 4, radiance: vec![[1.0; 3]; 32], intensity: 1.0, rotation_deg: 0.0 }
}

/// The box from -1 to 1, front outside. Corners are shared, so that it is watertight to the bit.
pub(super) fn cube() -> Mesh {
    use glam::vec3;
    let positions = (0..8).map(|i| vec3(i as f32, (i >> 1) as f32, (i >> 2) as f32) % 2.0 * 2.0 - 1.0);
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let halves = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    Mesh { positions: positions.collect(), triangles: halves.collect(), ..Mesh::default() }
}
