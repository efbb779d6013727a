//! What beside light a picture can show: ambient occlusion against closed forms, and the layers of a file (`host::aov`).
//!
//! Each mean is of independent samples with a fixed seed and must lie within 4 standard errors of the truth: right code fails
//! a comparison with probability 6.3e-5 for another seed.

use std::f64::consts::PI;
use std::path::Path;

use glam::{DVec3, Vec3};
use jerboa_lib_render::host::aov::{Layer, channels};
use jerboa_lib_render::host::device::DeviceKind;
use jerboa_lib_render::host::exr::{Channel, read_channels};
use jerboa_lib_render::host::film::{Film, Window};
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::image_io::Image;
use jerboa_lib_render::host::renderer::{Handle, Options, Render, Renderer};
use jerboa_lib_render::host::tables::{Choices, Pass};
use jerboa_scenes::{Camera, Material, Scene};
use jerboa_tests::harness::analytic::{Look, SEED, estimate, place, rectangle};

/// Samples of a comparison.
const SAMPLES: usize = 1 << 14;

fn load(name: &str) -> Scene {
    Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{e}"))
}

fn occlusion(scene: &Scene, occlusion_distance: f32) -> Renderer {
    let choices = Choices { occlusion_distance, ..Choices::default() };
    let options = Options { tracer: TracerKind::Occlusion, choices, ..Options::default() };
    Renderer::new(scene, options).unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

/// A floor at y = 0 and, if asked for, a wall at x = 0, both a thousand metres wide to either side.
fn corner(with_wall: bool) -> Scene {
    const FAR: f32 = 1000.0;
    let mut scene = Scene::default();
    let floor = rectangle(Vec3::new(-FAR, 0.0, -FAR), Vec3::Z * (2.0 * FAR), Vec3::X * (2.0 * FAR));
    place(&mut scene, floor, Material::diffuse("floor", [0.5; 3]), 1.0, DVec3::ZERO);
    if with_wall {
        let wall = rectangle(Vec3::new(0.0, 0.0, -FAR), Vec3::Y * FAR, Vec3::Z * (2.0 * FAR));
        place(&mut scene, wall, Material::diffuse("wall", [0.5; 3]), 1.0, DVec3::ZERO);
    }
    scene
}

/// The floor at this distance from the wall, from above: a thousandth of a metre across.
fn beside_wall(x: f64) -> Look {
    let at = DVec3::new(x, 0.0, 0.0);
    Look::pixel(Camera::look_at("above", at + DVec3::new(0.3, 1.0, 0.0), at, 1e-3), 1, 0, 0)
}

#[test]
fn ambient_occlusion_has_its_closed_forms() {
    let mean =
        |scene: &Scene, distance: f32, x: f64| estimate(&occlusion(scene, distance), &beside_wall(x), SAMPLES, SEED);
    let open = mean(&corner(false), f32::INFINITY, 1.0);
    assert_eq!((open.mean, open.error), (1.0, 0.0), "an open plane");
    // A wall without end hides half of the sky; one of which a cap is within reach, the part of the unit disk beyond x / r.
    let corner = corner(true);
    let cap = |c: f64| 1.0 - (c.acos() - c * (1.0 - c * c).sqrt()) / PI;
    for (x, distance, truth) in [
        (0.01, f32::INFINITY, 0.5),
        (1.0, f32::INFINITY, 0.5 + 0.5 * 1.0 / 1e3),
        (1.0, 2.0, cap(0.5)),
        (1.0, 1.25, cap(0.8)),
        (0.5, 5.0, cap(0.1)),
        (1.0, 0.99, 1.0),
    ] {
        let found = mean(&corner, distance, x);
        println!("{x} from a wall, looking {distance}: {:.5} ± {:.5}, truth {truth:.5}", found.mean, found.error);
        assert!(
            (found.mean - truth).abs() <= 4.0 * found.error + 1e-4,
            "{x}, {distance}: {found:?} instead of {truth}"
        );
    }
}

#[test]
fn nothing_is_open_in_a_closed_box() {
    let scene = load("closed-box-50");
    let look = Look::whole(scene.camera_or_default());
    assert_eq!(estimate(&occlusion(&scene, f32::INFINITY), &look, 1 << 12, SEED).mean, 0.0);
    let near = estimate(&occlusion(&scene, 1e-3), &look, 1 << 12, SEED).mean;
    assert!(near > 0.9, "{near}");
}

const SIZE: [u32; 2] = [24, 16];
const JOB: Render = Render { sample: 0, spp: 5, seed: 9 };
const LAYERS: [Layer; 5] = [Layer::Albedo, Layer::Normal, Layer::Depth, Layer::Material, Layer::Samples];

/// A picture and its layers.
fn layered(scene: &Scene, device: DeviceKind) -> (Film, Vec<Channel>) {
    let options = Options { device, ..Options::default() };
    let renderer = Renderer::new(scene, options).unwrap_or_else(|e| panic!("{}: {e}", scene.name));
    let (camera, mut film) = (scene.camera_or_default(), Film::of_size(SIZE));
    renderer.render_with(&camera, &mut film, JOB, &Handle::default()).unwrap_or_else(|e| panic!("{e}"));
    let channels = channels(&renderer, &camera, &film, JOB, &LAYERS).unwrap_or_else(|e| panic!("{e}"));
    (film, channels)
}

fn values<'a>(channels: &'a [Channel], name: &str) -> &'a [f32] {
    &channels.iter().find(|c| c.name == name).unwrap_or_else(|| panic!("there is no channel {name}")).values
}

#[test]
fn layers_show_what_the_picture_sees() {
    // Balls before a wall: nothing of the sky; then a ball before the sky.
    for name in ["cornell-box", "environment"] {
        let scene = load(name);
        let (_, channels) = layered(&scene, DeviceKind::CpuScalar);
        let (depth, material) = (values(&channels, "depth.Z"), values(&channels, "material.X"));
        let normals = ["normal.X", "normal.Y", "normal.Z"].map(|n| values(&channels, n));
        let camera = scene.camera_or_default();
        let window = Window { x: 0, y: 0, width: SIZE[0], height: SIZE[1] };
        let pass = Pass { size: SIZE, window, sample: 0, samples: 1, seed: JOB.seed };
        let renderer = |tracer| Renderer::new(&scene, Options { tracer, ..Options::default() }).expect("a renderer");
        let distance = renderer(TracerKind::Depth).samples(&camera, &pass).expect("distances of the first samples");
        let mut seen = 0;
        for i in 0..window.area() {
            let length = (0..3).map(|c| f64::from(normals[c][i]).powi(2)).sum::<f64>().sqrt();
            assert!(length <= 1.0 + 1e-6, "{name}, pixel {i}: a mean normal of length {length}");
            let distance = f32::from_bits(distance[i]);
            if material[i] == 0.0 {
                assert_eq!((depth[i], distance), (f32::INFINITY, 0.0), "{name}, pixel {i}");
                continue;
            }
            seen += 1;
            let cos = depth[i] / distance;
            assert!(
                cos <= 1.0 + 1e-6 && cos > (2.0 * camera.half_height().atan() as f32).cos(),
                "{name}, pixel {i}: {} {distance}",
                depth[i]
            );
            let number = material[i] as usize;
            assert!(material[i] == number as f32 && number <= scene.materials.len(), "{name}, pixel {i}: {number}");
        }
        assert!(seen > 50, "{name}: {seen} pixels show a surface");
        assert!(values(&channels, "samples.X").iter().all(|n| *n == JOB.spp as f32));
    }
}

#[test]
fn one_sample_tells_material_albedo_and_normal_of_one_surface() {
    let scene = load("cornell-box");
    let renderer = Renderer::new(&scene, Options::default()).expect("a renderer");
    let (camera, mut film) = (scene.camera_or_default(), Film::of_size(SIZE));
    let job = Render { spp: 1, ..JOB };
    renderer.render_with(&camera, &mut film, job, &Handle::default()).expect("a render");
    let channels = channels(&renderer, &camera, &film, job, &LAYERS).expect("layers");
    let albedo = ["albedo.R", "albedo.G", "albedo.B"].map(|n| values(&channels, n));
    for (i, number) in values(&channels, "material.X").iter().enumerate() {
        let shown = |[r, g, b, _]: [f32; 4]| [r, g, b];
        let expected = (*number as usize).checked_sub(1).map(|m| shown(scene.materials[m].base_color));
        assert_eq!(albedo.map(|c| c[i]), expected.unwrap_or_default(), "pixel {i}");
    }
}

#[test]
fn both_devices_of_the_cpu_give_the_same_layers() {
    let scene = load("material-balls");
    assert!(layered(&scene, DeviceKind::Cpu) == layered(&scene, DeviceKind::CpuScalar));
}

#[test]
fn a_file_holds_the_picture_and_its_layers() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let path = folder.join("layers.exr");
    let (film, channels) = layered(&load("environment"), DeviceKind::Cpu);
    film.mean().write_with(&path, channels.clone()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(Image::read(&path).unwrap_or_else(|e| panic!("{e}")), film.mean());
    let (size, read) = read_channels(&path).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(size, SIZE);
    let mut names: Vec<&str> = read.iter().map(|c| &*c.name).collect();
    names.sort_unstable();
    let layers = "albedo.B albedo.G albedo.R depth.Z material.X normal.X normal.Y normal.Z samples.X";
    assert_eq!(names.join(" "), format!("B G R {layers}"));
    channels.iter().for_each(|c| assert_eq!(values(&read, &c.name), c.values, "{}", c.name));
    let png = film.mean().write_with(&folder.join("layers.png"), channels).expect_err("a PNG has no layers");
    assert!(png.to_string().contains("only an .exr has layers"), "{png}");
}
