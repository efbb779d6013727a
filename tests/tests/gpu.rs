//! Accuracy list T3 on the GPU devices: the film of the CPU device, byte for byte, and as many rays. And the budget of a
//! kernel's size.
//!
//! A driver takes seconds to compile a megakernel, so the quick form has fewer scenes.
//! `JERBOA_T3=full cargo test --release -p jerboa-tests --test gpu -- --nocapture` has the matched scenes and five built-ins.

use jerboa_lib_render::host::device::DeviceKind;
use jerboa_lib_render::host::film::Film;
use jerboa_lib_render::host::generate::{Keep, TracerKind, residuals};
use jerboa_lib_render::host::gpu::emit;
use jerboa_lib_render::host::learn::LESSONS;
use jerboa_lib_render::host::renderer::{Options, Renderer, Stats};
use jerboa_lib_render::host::tables::{Choices, Known, SamplerKind, Tables};
use jerboa_scenes::Scene;
use jerboa_tests::harness::many::shaders;
use jerboa_tests::sources::shared_scenes;
use jerboa_tests::spirv::gpu;

/// Built-ins of T3: area light, metals and glass under an environment, every filter, many lights, cut-outs, textures,
/// instances, lights without a surface.
const BUILTINS: [&str; 8] = [
    "cornell-box",
    "material-balls",
    "fine-textures",
    "many-lights",
    "alpha",
    "checkerboard",
    "pebbles",
    "round-lights",
];

/// Matched scenes of T3.
const MATCHED: [&str; 4] = ["cornell-box", "living-room", "staircase", "coffee-maker"];

/// How many of the built-ins and of the matched scenes the quick form has.
const QUICK: [usize; 2] = [4, 2];

/// Side of the image in pixels, and samples of each.
const SIDE: u32 = 64;
const SPP: u32 = 4;

const GPUS: [DeviceKind; 2] = [DeviceKind::GpuMegakernel, DeviceKind::GpuWavefront];

fn load(name: &str) -> Scene {
    Scene::load(name).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Film and counts of a device.
fn render(scene: &Scene, device: DeviceKind, choices: Choices, spp: u32) -> (Film, Stats) {
    let mut film = Film::of_size([SIDE, SIDE]);
    let stats = Renderer::new(scene, Options { device, choices, spp, seed: 7, ..Options::default() })
        .and_then(|renderer| renderer.render(&scene.camera_or_default(), &mut film))
        .unwrap_or_else(|e| panic!("{}, {device:?}: {e}", scene.name));
    (film, stats)
}

/// Both GPU devices leave the film of the CPU device.
fn films_are_the_same(scene: &Scene, sampler: SamplerKind) {
    those_are_the_same(scene, Choices { sampler, ..Choices::default() }, SPP);
}

fn those_are_the_same(scene: &Scene, choices: Choices, spp: u32) {
    let (right, expected) = render(scene, DeviceKind::Cpu, choices, spp);
    for device in GPUS {
        let (film, stats) = render(scene, device, choices, spp);
        let rays = |stats: &Stats| [stats.closest_rays, stats.shadow_rays];
        println!("{}, {device:?}: {:?} rays in {:.2?}", scene.name, rays(&stats), stats.time);
        assert_eq!(rays(&stats), rays(&expected), "{}, {device:?}: rays", scene.name);
        let pixels = (0..SIDE * SIDE).map(|i| [i % SIDE, i / SIDE]);
        let (ours, theirs) = (film.mean(), right.mean());
        let differ = pixels.zip(ours.pixels.iter().zip(&theirs.pixels)).find(|(_, (a, b))| a != b);
        assert_eq!(differ, None, "{}, {device:?}: a pixel", scene.name);
        assert!(film == right, "{}, {device:?}: the films differ", scene.name);
    }
}

/// All scenes, or so many.
fn chosen<'a>(scenes: &'a [&'a str], quick: usize) -> &'a [&'a str] {
    if std::env::var_os("JERBOA_T3").is_some() { scenes } else { &scenes[..quick] }
}

#[test]
fn films_of_built_in_scenes_are_those_of_the_cpu() {
    if gpu("films_of_built_in_scenes_are_those_of_the_cpu").is_none() {
        return;
    }
    for name in chosen(&BUILTINS, QUICK[0]) {
        films_are_the_same(&load(&format!("builtin:{name}")), SamplerKind::Independent);
    }
}

#[test]
fn films_of_sobol_points_are_those_of_the_cpu() {
    if gpu("films_of_sobol_points_are_those_of_the_cpu").is_none() {
        return;
    }
    films_are_the_same(&load("builtin:cornell-box"), SamplerKind::SOBOL);
}

/// The CPU learns for a GPU, whose tables are then others.
#[test]
fn films_led_by_what_was_learned_are_those_of_the_cpu() {
    if gpu("films_led_by_what_was_learned_are_those_of_the_cpu").is_none() {
        return;
    }
    let choices = Choices { learned_roulette: true, ..Choices::default() };
    those_are_the_same(&load("builtin:cornell-box"), choices, LESSONS + SPP);
}

#[test]
fn films_of_matched_scenes_are_those_of_the_cpu() {
    if gpu("films_of_matched_scenes_are_those_of_the_cpu").is_none() {
        return;
    }
    let Some(shared) = shared_scenes() else {
        println!("skipped: films_of_matched_scenes_are_those_of_the_cpu (no shared scenes)");
        return;
    };
    for name in chosen(&MATCHED, QUICK[1]) {
        let file = shared.join(name).join(format!("{name}.matched.glb"));
        films_are_the_same(&load(&file.to_string_lossy()), SamplerKind::Independent);
    }
}

/// A scene of so many shaders that one kernel of all of them is refused, with what to do; the wavefront's are not.
#[test]
fn the_budget_ends_a_kernel_of_too_many_shaders() {
    let scene = shaders(64);
    let tables = Tables::new(&scene, &Choices::default(), Known::Structure);
    let emitted = |device: DeviceKind| {
        let requests = device.requests(&tables, TracerKind::Path);
        let residuals = residuals(&tables, &requests, Keep::default()).unwrap_or_else(|e| panic!("{e}"));
        emit(&tables, &requests, residuals)
    };
    let refused = emitted(DeviceKind::GpuMegakernel).err().expect("64 shaders are too many for one kernel").to_string();
    assert!(refused.contains("more than the budget of") && refused.contains("wavefront"), "{refused}");
    let kernels = emitted(DeviceKind::GpuWavefront).unwrap_or_else(|e| panic!("each kernel has one shader: {e}"));
    let most = kernels.iter().map(|kernel| kernel.words()).max().unwrap_or(0);
    println!("{refused}\nwavefront: {} kernels, {most} words at most", kernels.len());
}
