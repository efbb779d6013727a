//! Back faces that a render culls, on every device: a surface that nothing meets from its front leaves no trace in the image,
//! and one that stays is the same with culling and without.

use glam::{DAffine3, DVec3, Vec3, vec3};
use jerboa_lib_render::host::device::{DeviceKind, Traversal};
use jerboa_lib_render::host::film::Film;
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::renderer::{Options, Renderer};
use jerboa_lib_render::host::tables::Choices;
use jerboa_scenes::{Camera, Instance, Light, LightKind, Material, Mesh, Model, Scene};
use jerboa_tests::harness::analytic::rectangle;
use jerboa_tests::spirv::gpu;

/// A floor, and a black corner far above that makes room for what comes between; a point light over all of it and a camera that
/// looks down at the floor from below the light. No light goes down from anything but the lamp.
fn floor() -> Scene {
    let mut scene = Scene { materials: vec![Material::diffuse("floor", [0.5; 3])], ..Scene::default() };
    place(&mut scene, rectangle(vec3(-3.0, 0.0, 3.0), Vec3::X * 6.0, Vec3::Z * -6.0), DAffine3::IDENTITY);
    scene.materials.push(Material::diffuse("corner", [0.0; 3]));
    let corner = Mesh { material: 1, ..rectangle(vec3(3.0, 4.0, 3.0), Vec3::X * 0.01, Vec3::Z * 0.01) };
    place(&mut scene, corner, DAffine3::IDENTITY);
    let to_world = DAffine3::from_translation(DVec3::new(0.0, 6.0, 0.0));
    scene.lights.push(Light { name: "lamp".into(), kind: LightKind::Point, intensity: [30.0; 3], to_world });
    scene.cameras.push(Camera::look_at("low", DVec3::new(0.0, 0.8, 2.9), DVec3::new(0.0, 0.4, 0.0), 1.2));
    scene
}

fn place(scene: &mut Scene, mesh: Mesh, to_world: DAffine3) {
    scene.meshes.push(mesh);
    scene.instances.push(Instance { mesh: scene.meshes.len() - 1, to_world });
}

/// A square over the floor, in column `x`, whose front looks up or down; as it stands or as its own mirror image.
fn hang(scene: &mut Scene, x: f32, material: &Material, looks_up: bool, mirrored: bool) {
    scene.materials.push(material.clone());
    let v = if looks_up { Vec3::Z * -0.8 } else { Vec3::Z * 0.8 };
    let start = if looks_up { 0.4 } else { -0.4 };
    // In a mirror the other side shows the corners counter-clockwise, so the front stays where it looks.
    let x = if mirrored { -x - 0.8 } else { x };
    let square = Mesh { material: scene.materials.len() - 1, ..rectangle(vec3(x, 1.2, start), Vec3::X * 0.8, v) };
    let scale = DVec3::new(if mirrored { -1.0 } else { 1.0 }, 1.0, 1.0);
    place(scene, square, DAffine3::from_scale(scale));
}

/// A device, and who walks the tree there.
type Engine = (DeviceKind, Traversal);

const FIRST: Engine = (DeviceKind::Cpu, Traversal::Native);
const CPUS: [Engine; 3] = [FIRST, (DeviceKind::Cpu, Traversal::Ir), (DeviceKind::CpuScalar, Traversal::Ir)];
const GPUS: [Engine; 2] = [(DeviceKind::GpuWavefront, Traversal::Ir), (DeviceKind::GpuMegakernel, Traversal::Ir)];

fn film(scene: &Scene, (device, traversal): Engine, cull_back_faces: bool) -> Film {
    let choices = Choices { cull_back_faces, ..Choices::default() };
    let options = Options { device, traversal, choices, spp: 4, ..Options::default() };
    let mut film = Film::of_size([32, 24]);
    let rendered = Renderer::new(scene, options).and_then(|r| r.render(&scene.cameras[0], &mut film));
    rendered.unwrap_or_else(|e| panic!("{device:?}: {e}"));
    film
}

/// These engines, back faces culled, make this film.
fn all_make(engines: &[Engine], scene: &Scene, expected: &Film) {
    for engine in engines {
        assert!(film(scene, *engine, true) == *expected, "{engine:?}: the films differ");
    }
}

/// All rays come from below: from the camera, from the floor to the lamp, from the floor on.
#[test]
fn what_is_met_from_behind_alone_leaves_no_trace() {
    let empty = floor();
    let without = film(&empty, FIRST, false);
    let mut scene = floor();
    let blue = Material::diffuse("blue", [0.1, 0.1, 0.8]);
    hang(&mut scene, -1.6, &blue, true, false);
    hang(&mut scene, -0.4, &blue, true, true);
    hang(&mut scene, 0.8, &Material::plastic("shiny", [0.1, 0.8, 0.1], 0.2), true, false);
    all_make(&CPUS, &scene, &without);
    if gpu("what_is_met_from_behind_alone_leaves_no_trace").is_some() {
        all_make(&GPUS, &scene, &without);
    }
    assert!(film(&scene, FIRST, false) != without, "they are in sight, and in the light");
}

#[test]
fn what_can_be_seen_stays() {
    let mut scene = floor();
    let red = Material::diffuse("red", [0.8, 0.1, 0.1]);
    hang(&mut scene, -2.6, &red, false, false);
    hang(&mut scene, -1.6, &red, false, true);
    hang(&mut scene, -0.6, &Material { double_sided: true, ..red.clone() }, true, false);
    hang(&mut scene, 0.4, &Material::glass("glass", 1.5), true, false);
    hang(&mut scene, 1.4, &Material { model: Some(Model::named("mirror")), ..red }, true, false);
    let with = film(&scene, FIRST, false);
    all_make(&CPUS, &scene, &with);
    assert!(film(&floor(), FIRST, false) != with, "they are in sight, and in the light");
}

/// A surface that is there one way only would be another one for paths from the lamp.
#[test]
fn paths_from_lights_are_refused() {
    for tracer in TracerKind::SPLATTING {
        let choices = Choices { cull_back_faces: true, ..Choices::default() };
        let device = DeviceKind::CpuScalar;
        let made = Renderer::new(&floor(), Options { device, tracer, choices, ..Options::default() });
        let error = made.err().expect("it is refused").to_string();
        assert_eq!(error, "back faces are culled for paths from the camera only: choose another tracer");
    }
}
