//! T19: no light comes through a closed wall, not a single sample of it, wherever the camera aims.
//!
//! `JERBOA_PATHS=10000000 cargo test --release -p jerboa-tests --test leaks -- --nocapture` sends that many paths into
//! each room instead of 20,000.

use glam::{DAffine3, DVec3, Vec3};
use jerboa_lib_render::host::bvh::Triangle;
use jerboa_lib_render::host::film::Window;
use jerboa_lib_render::host::renderer::{Options, Renderer};
use jerboa_lib_render::host::tables::{Choices, Pass};
use jerboa_scenes::{Camera, Environment, Instance, Light, LightKind, Material, Mesh, Scene};
use jerboa_tests::harness::bench::number;
use jerboa_tests::harness::rays::{ball, cube};

/// A closed mesh, its front inside, with the normals of a sphere if it is to be smooth.
fn wall(triangles: &[Triangle], smooth: bool) -> Mesh {
    let positions: Vec<Vec3> = triangles.iter().flatten().map(|p| Vec3::from(*p)).collect();
    let inwards = |[a, b, c]: [u32; 3]| {
        let [p, q, r] = [a, b, c].map(|i| positions[i as usize]);
        if (q - p).cross(r - p).dot(p + q + r) < 0.0 { [a, b, c] } else { [a, c, b] }
    };
    let triangles = (0..triangles.len() as u32).map(|i| inwards([3 * i, 3 * i + 1, 3 * i + 2])).collect();
    let normals = smooth.then(|| positions.iter().map(|p| -p.normalize()).collect());
    Mesh { positions, triangles, normals, ..Mesh::default() }
}

/// A room of this wall in a world of a million: a sky, a sun, a lamp, and glowing walls a hair behind.
fn room(wall: Mesh, material: Material) -> Scene {
    let mut scene = Scene { name: material.name.clone(), ..Scene::default() };
    let glow = Material::emitter("glow", [1e6; 3]);
    scene.materials = vec![material, glow];
    let behind = DAffine3::from_scale(DVec3::splat(1.0 + 2.0_f64.powi(-14)));
    for (material, to_world) in [DAffine3::IDENTITY, behind].into_iter().enumerate() {
        scene.meshes.push(Mesh { material, ..wall.clone() });
        scene.instances.push(Instance { mesh: material, to_world });
    }
    let light = |kind, to_world| Light { name: "outside".into(), kind, intensity: [1e6; 3], to_world };
    scene.lights.push(light(LightKind::Point, DAffine3::from_translation(DVec3::new(0.3, 1.00003, 0.2))));
    scene.lights.push(light(LightKind::Point, DAffine3::from_translation(DVec3::new(3.0, 2.0, 1.0))));
    scene.lights.push(light(LightKind::Directional, DAffine3::IDENTITY));
    scene.environment =
        Some(Environment { width: 2, height: 1, radiance: vec![[1e6; 3]; 2], intensity: 1.0, rotation_deg: 0.0 });
    scene
}

/// Cameras that look at large, and at the corners and edges of a triangle so closely that every path begins within some
/// ulps of them.
fn cameras(wall: &Mesh) -> Vec<(String, Camera)> {
    let eye = DVec3::new(0.1, 0.2, 0.3);
    let at = |name: &str, target, yfov| (name.to_string(), Camera::look_at(name, eye, target, yfov));
    let t = wall.triangles[wall.triangles.len() / 2].map(|i| wall.positions[i as usize].as_dvec3());
    let mut cameras = vec![at("wide", DVec3::NEG_Z, 1.5)];
    for i in 0..3 {
        let (p, q) = (t[i], t[(i + 1) % 3]);
        cameras.push(at(&format!("corner {i}"), p, 1e-6));
        cameras.push(at(&format!("edge {i}"), p.lerp(q, 0.4), 1e-6));
    }
    cameras
}

/// The renderer of a room.
fn renderer(scene: &Scene, consistent_normals: bool) -> Renderer {
    let choices = Choices { consistent_normals, ..Choices::default() };
    Renderer::new(scene, Options { choices, ..Options::default() }).unwrap_or_else(|e| panic!("{e}"))
}

/// Of so many paths, those that are not black.
fn lit(renderer: &Renderer, camera: &Camera, paths: usize) -> usize {
    const SIDE: u32 = 16;
    let samples = paths.div_ceil((SIDE * SIDE) as usize) as u32;
    let window = Window { x: 0, y: 0, width: SIDE, height: SIDE };
    let lit = |sample: u32| {
        let pass = Pass { size: [SIDE; 2], window, sample, samples: (samples - sample).min(1024), seed: 19 };
        let words = renderer.samples(camera, &pass).unwrap_or_else(|e| panic!("{e}"));
        let items = window.area() * pass.samples as usize;
        // Shifted by one, both zeros are 0.
        (0..items).filter(|i| (0..3).any(|c| words[c * items + i] << 1 != 0)).count()
    };
    (0..samples).step_by(1024).map(lit).sum()
}

/// The rooms: what the wall is, its mesh, its material.
fn rooms() -> Vec<(&'static str, Mesh, Material)> {
    let black = Material::diffuse("black", [0.0; 3]);
    let grey = Material::diffuse("grey", [0.8; 3]);
    let shiny = Material::plastic("shiny", [0.8; 3], 0.3);
    let sphere = || ball(8, |_, _| 1.0);
    vec![
        ("black box", wall(&cube(1), false), black.clone()),
        ("grey box", wall(&cube(1), false), grey.clone()),
        ("shiny cut box", wall(&cube(3), false), shiny.clone()),
        ("black smooth sphere", wall(&sphere(), true), black),
        ("grey smooth sphere", wall(&sphere(), true), grey.clone()),
        ("shiny smooth sphere", wall(&sphere(), true), shiny),
        ("grey sphere", wall(&sphere(), false), grey),
    ]
}

#[test]
fn nothing_comes_through_a_closed_wall() {
    let paths = number("JERBOA_PATHS", 1500);
    let mut leaks = Vec::new();
    for (name, wall, material) in rooms() {
        let cameras = cameras(&wall);
        let scene = room(wall, material);
        let consistent = renderer(&scene, true);
        for (view, camera) in &cameras {
            let lit = lit(&consistent, camera, paths);
            println!("{name}, {view}: {lit} of {paths} paths see light");
            if lit > 0 {
                leaks.push(format!("{name}, {view}: {lit}"));
            }
        }
    }
    assert!(leaks.is_empty(), "of {paths} paths see light:\n{}", leaks.join("\n"));
}

/// The free setting, which the matched references have, is not held to that: a smooth normal may send a path through the
/// facet. Flat walls do not leak there either.
#[test]
fn free_normals_leak_where_they_are_smooth() {
    let paths = number("JERBOA_PATHS", 20_000);
    for (name, wall, material) in rooms() {
        let is_smooth = wall.normals.is_some() && name != "black smooth sphere";
        let view = cameras(&wall).swap_remove(0).1;
        let lit = lit(&renderer(&room(wall, material), false), &view, paths);
        println!("{name}, free normals: {lit} of {paths} paths see light");
        assert_eq!(lit > 0, is_smooth, "{name}: {lit} of {paths}");
    }
}
