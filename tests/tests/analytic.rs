//! Whole renders against closed forms (T4, in the time of a test).
//!
//! Each mean is of independent samples with a fixed seed and must lie within 4 standard errors of the truth: a correct
//! renderer fails a comparison with probability 6.3e-5 for another seed (some of the 55 here: 1 in 290). Each standard
//! error is bounded too, so that a comparison can fail.

use glam::{DAffine3, DVec3, Vec3};
use jerboa_lib_render::host::film::Window;
use jerboa_lib_render::host::renderer::{Options, Renderer};
use jerboa_lib_render::host::tables::{Choices, Pass};
use jerboa_scenes::{AlphaMode, Camera, Instance, LightKind, Material, Mesh, Scene};

const SEED: u32 = 20_260;

fn load(name: &str) -> Scene {
    println!("{name}, seed {SEED}");
    Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{e}"))
}

fn renderer(scene: &Scene, max_depth: Option<u32>) -> Renderer {
    let choices = Choices { max_depth, ..Choices::default() };
    Renderer::new(scene, Options { choices, ..Options::default() }).unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

/// Radiance of each sample of a window of a square film, red, green and blue.
fn samples(renderer: &Renderer, camera: &Camera, side: u32, window: Window, samples: u32) -> Vec<[f64; 3]> {
    let pass = Pass { size: [side, side], window, sample: 0, samples, seed: SEED };
    let words = renderer.samples(camera, &pass).unwrap_or_else(|e| panic!("{e}"));
    let items = window.area() * samples as usize;
    (0..items).map(|i| [0, 1, 2].map(|c| f64::from(f32::from_bits(words[c * items + i])))).collect()
}

fn square(x: u32, y: u32, side: u32) -> Window {
    Window { x, y, width: side, height: side }
}

/// Mean and standard error.
fn mean(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// The mean is the truth, within 4 standard errors and the roundings of single precision; the standard error is at most
/// `most` of the truth.
fn agree(what: &str, values: &[f64], truth: f64, most: f64) {
    let (mean, error) = mean(values);
    println!("  {what}: {mean:.6} ± {error:.6}, truth {truth:.6}");
    assert!(error <= most * truth, "{what}: {mean} ± {error} says too little about {truth}");
    assert!((mean - truth).abs() <= 4.0 * error + 1e-5 * truth, "{what}: {mean} ± {error}, truth {truth}");
}

/// Green of 2^18 samples over the whole film of a scene.
fn over_the_film(scene: &Scene, max_depth: Option<u32>) -> Vec<f64> {
    let values = samples(&renderer(scene, max_depth), &scene.camera_or_default(), 32, square(0, 0, 32), 256);
    assert!(values.iter().all(|[r, g, b]| r == g && g == b), "{}: it is grey", scene.name);
    values.iter().map(|s| s[1]).collect()
}

#[test]
fn furnaces_are_1_everywhere() {
    for name in ["closed-box-50", "closed-box-80", "closed-box-90", "closed-box-95", "furnace-sphere", "white-furnace"]
    {
        agree(name, &over_the_film(&load(name), None), 1.0, 0.003);
    }
}

/// Paths of at most k edges bring 1 − ρ^k.
#[test]
fn a_closed_box_of_limited_depth_is_a_geometric_sum() {
    for depth in [1, 2, 3, 6] {
        let values = over_the_film(&load("closed-box-50"), Some(depth));
        agree(&format!("{depth} edges"), &values, 1.0 - 0.5_f64.powi(depth as i32), 0.001);
    }
}

/// Mean radiance of each pixel of a small film against the mean of `radiance` over it, where rays meet the plane y = 0.
fn floor_agrees(scene: &Scene, radiance: impl Fn(DVec3) -> f64) {
    const SIDE: u32 = 6;
    let (camera, r) = (scene.camera_or_default(), renderer(scene, Some(2)));
    let half = (camera.yfov / 2.0).tan();
    let meet = |x: f64, y: f64| {
        let [x, y] = [x, y].map(|c| (2.0 * c / f64::from(SIDE) - 1.0) * half);
        let dir = camera.forward() + camera.right() * x - camera.up() * y;
        camera.position() - dir * (camera.position().y / dir.y)
    };
    const CELLS: u32 = 64;
    let inside = |i: u32| (f64::from(i) + 0.5) / f64::from(CELLS);
    for (x, y) in (0..SIDE * SIDE).map(|i| (i % SIDE, i / SIDE)) {
        let at = |i: u32| radiance(meet(f64::from(x) + inside(i % CELLS), f64::from(y) + inside(i / CELLS)));
        let truth = (0..CELLS * CELLS).map(at).sum::<f64>() / f64::from(CELLS * CELLS);
        let values: Vec<f64> = samples(&r, &camera, SIDE, square(x, y, 1), 16_384).iter().map(|s| s[0]).collect();
        if truth > 0.0 {
            agree(&format!("{x},{y}"), &values, truth, 0.02);
        } else {
            assert!(values.iter().all(|v| *v == 0.0), "{x},{y}: light where there is none");
        }
    }
}

/// Radiance of a floor of albedo 1/2 at p, by one candela straight above the origin at height 1: cosine over distance
/// squared is 1 / d³.
fn below_a_candela(p: DVec3) -> f64 {
    0.5 / std::f64::consts::PI / (p - DVec3::Y).length().powi(3)
}

#[test]
fn a_floor_below_a_point_light_falls_with_the_cube() {
    floor_agrees(&load("point-light"), below_a_candela);
}

#[test]
fn a_floor_below_a_spot_has_its_cone() {
    let scene = load("spot");
    let LightKind::Spot { inner, outer } = scene.lights[0].kind else { panic!("a spot") };
    let [inner, outer] = [inner, outer].map(|x| f64::from(x).cos());
    floor_agrees(&scene, |p| {
        let cos = 1.0 / (p - DVec3::Y).length();
        below_a_candela(p) * ((cos - outer) / (inner - outer)).clamp(0.0, 1.0).powi(2)
    });
}

#[test]
fn a_floor_in_the_sun_has_its_radiance() {
    let scene = load("sun");
    let r = renderer(&scene, Some(2));
    // The corner of the film is far from the block and its shadow.
    let values = samples(&r, &scene.camera_or_default(), 32, square(0, 31, 1), 16);
    let truth = 60_f64.to_radians().sin() * 0.5 / std::f64::consts::PI;
    for [red, ..] in values {
        assert!((red / truth - 1.0).abs() < 1e-5, "{red}, truth {truth}");
    }
}

/// A black card that is there with probability 1/4, crossed by the camera's ray and again, the same triangle, by the shadow
/// ray: each decides for itself, so 9/16 of the light comes through.
#[test]
fn a_blended_card_is_crossed_twice() {
    let mut scene = load("sun");
    let black = Material { alpha_mode: AlphaMode::Blend, ..Material::diffuse("card", [0.0; 3]) };
    scene.materials.push(Material { base_color: [0.0, 0.0, 0.0, 0.25], ..black });
    scene.meshes.push(Mesh {
        positions: [[-100.0, 0.01, -100.0], [0.0, 0.01, 200.0], [100.0, 0.01, -100.0]].map(Vec3::from).to_vec(),
        triangles: vec![[0, 1, 2]],
        material: scene.materials.len() - 1,
        ..Mesh::default()
    });
    scene.instances.push(Instance { mesh: scene.meshes.len() - 1, to_world: DAffine3::IDENTITY });
    let values = samples(&renderer(&scene, None), &scene.camera_or_default(), 32, square(0, 31, 1), 65_536);
    let uncovered = 60_f64.to_radians().sin() * 0.5 / std::f64::consts::PI;
    let red: Vec<f64> = values.iter().map(|s| s[0]).collect();
    agree("crossed twice", &red, 0.75 * 0.75 * uncovered, 0.01);
}

/// Straight below the centre of a square lamp of side 1 and radiance 1: the form factor of a parallel rectangle (Howell,
/// A Catalog of Radiation Heat Transfer Configuration Factors, B-3), four times a quarter, times the albedo 1/2.
#[test]
fn a_floor_below_a_square_lamp_at_any_height() {
    for height in [1e-3, 0.05, 0.3, 1.0, 20.0] {
        let mut scene = load("quad-light");
        let lamp = scene.instances.last_mut().expect("the lamp");
        lamp.to_world.translation.y = height - 1.0;
        let x = 0.5 / height;
        let f = 4.0 / std::f64::consts::PI * x / x.hypot(1.0) * (x / x.hypot(1.0)).atan();
        // The camera looks at the origin from below the lamp.
        let eye = DVec3::new(0.0, height / 2.0, height / 2.0);
        let camera = Camera::look_at("below", eye, DVec3::ZERO, 0.01);
        let r = renderer(&scene, Some(2));
        let values: Vec<f64> = samples(&r, &camera, 101, square(50, 50, 1), 16_384).iter().map(|s| s[0]).collect();
        agree(&format!("height {height}"), &values, 0.5 * f, 0.05);
    }
}

#[test]
fn nothing_leaks_into_a_black_room() {
    for name in ["black-box", "black-sphere"] {
        let scene = load(name);
        let values = samples(&renderer(&scene, None), &scene.camera_or_default(), 64, square(0, 0, 64), 16);
        assert_eq!(values.iter().filter(|s| s.iter().any(|c| *c != 0.0)).count(), 0, "{name}");
    }
}
