//! The long image tests, as a command: T13 on the matched scenes, and its red cases.
//!
//! ```sh
//! cargo run --release -p jerboa-tests --bin acceptance -- [SCENE…] [--seconds S | --spp N] [--renders K]
//!     [--ray-offset X] [--red CASE] [--device cpu|cpu-scalar|gpu-megakernel|gpu-wavefront] [--defaults]
//! ```
//!
//! Each scene is rendered K times (16), each with a seed of its own, at N samples per pixel or at those that S seconds
//! (10) buy (cornell-box: 64), and compared with its reference. Then the same renders are spoiled on purpose, 2 % darker
//! and shifted by a pixel, and the test must fail. With `--red CASE` the scene is spoiled instead, and the test must fail
//! too: `light` (one emitter dropped), `mask` (alpha ignored). Rays leave surfaces with the offset of the references'
//! renderer, which lets light through gaps below a millimetre, unless `--ray-offset 0` asks for exact ones. Prints a row of
//! a table for each comparison; the exit code says whether all came out as they should. `--defaults` renders as `jerboa render` does
//! where nothing is said, by Sobol points and learned roulette, and leaves out the samples that teach; else what the library
//! chooses is rendered.

use std::process::ExitCode;
use std::time::Instant;

use jerboa_lib_render::host::compare::compare;
use jerboa_lib_render::host::device::DeviceKind;
use jerboa_lib_render::host::film::Film;
use jerboa_lib_render::host::image_io::Image;
use jerboa_lib_render::host::learn::LESSONS;
use jerboa_lib_render::host::renderer::{Handle, Options, Render, Renderer};
use jerboa_lib_render::host::tables::{Choices, SamplerKind};
use jerboa_scenes::{AlphaMode, Camera, Scene};
use jerboa_tests::sources::shared_scenes;

/// The matched scenes.
const SCENES: [&str; 8] = [
    "cornell-box",
    "living-room",
    "staircase",
    "coffee-maker",
    "kitchen",
    "bedroom",
    "bathroom-contemporary",
    "breakfast-room",
];

/// How far the references' renderer moves rays off surfaces (SEMANTICS.md beside the scenes, 13).
const REFERENCE_OFFSET: f32 = 8.94e-5;

/// A way to spoil a scene.
#[derive(Clone, Copy, PartialEq)]
enum Red {
    Light,
    Mask,
}

struct Args {
    scenes: Vec<String>,
    seconds: f64,
    spp: Option<u32>,
    renders: u32,
    ray_offset: f32,
    red: Option<Red>,
    device: DeviceKind,
    defaults: bool,
}

fn main() -> ExitCode {
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(message) => {
            eprintln!("acceptance: {message}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<bool, String> {
    let args = parse()?;
    println!(
        "| scene | renders are | spp | renders | rms z | blocks beyond 1 % | max z | mean error, sigmas | verdict |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let mut as_expected = true;
    for scene in &args.scenes {
        as_expected &= t13(scene, &args)?;
    }
    Ok(as_expected)
}

fn parse() -> Result<Args, String> {
    let mut args = Args {
        scenes: Vec::new(),
        seconds: 10.0,
        spp: None,
        renders: 16,
        ray_offset: REFERENCE_OFFSET,
        red: None,
        device: DeviceKind::default(),
        defaults: false,
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "--seconds" => args.seconds = value()?.parse().map_err(|_| "--seconds takes a number")?,
            "--spp" => args.spp = Some(value()?.parse().map_err(|_| "--spp takes a whole number")?),
            "--renders" => args.renders = value()?.parse().map_err(|_| "--renders takes a whole number")?,
            "--ray-offset" => args.ray_offset = value()?.parse().map_err(|_| "--ray-offset takes a number")?,
            "--red" => {
                args.red = Some(match value()?.as_str() {
                    "light" => Red::Light,
                    "mask" => Red::Mask,
                    other => return Err(format!("--red {other}: light or mask")),
                });
            }
            "--defaults" => args.defaults = true,
            "--device" => {
                args.device = match value()?.as_str() {
                    "cpu" => DeviceKind::Cpu,
                    "cpu-scalar" => DeviceKind::CpuScalar,
                    "gpu-megakernel" => DeviceKind::GpuMegakernel,
                    "gpu-wavefront" => DeviceKind::GpuWavefront,
                    other => return Err(format!("--device {other}: cpu, cpu-scalar, gpu-megakernel or gpu-wavefront")),
                };
            }
            scene => args.scenes.push(scene.into()),
        }
    }
    if args.scenes.is_empty() {
        args.scenes = SCENES.map(Into::into).to_vec();
    }
    Ok(args)
}

/// Run T13 on a scene; did each comparison come out as it should?
fn t13(name: &str, args: &Args) -> Result<bool, String> {
    let shared = shared_scenes().ok_or("there are no shared scenes: set JERBOA_SHARED")?;
    let folder = shared.join(name);
    let file = |suffix: &str| folder.join(format!("{name}.{suffix}"));
    let image = |suffix: &str| Image::read(&file(suffix)).map_err(|e| e.to_string());
    let reference = (image("ref.exr")?, image("ref-var.exr")?);
    let mut scene = Scene::load(file("matched.glb")).map_err(|e| e.to_string())?;
    spoil(&mut scene, args.red);
    let camera = scene.camera_or_default();
    let rules =
        Choices { max_depth: Some(16), consistent_normals: false, ray_offset: args.ray_offset, ..Choices::default() };
    let sampler = SamplerKind::Sobol { log_scrambles: 0 };
    let choices = if args.defaults { Choices { sampler, learned_roulette: true, ..rules } } else { rules };
    let renderer = Renderer::new(&scene, Options { choices, device: args.device, ..Options::default() })
        .map_err(|e| e.to_string())?;

    let size = [reference.0.width, reference.0.height];
    let sample = if args.defaults { LESSONS } else { 0 };
    let spp = match args.spp {
        Some(spp) => spp,
        None if name == "cornell-box" => 64,
        None => affordable(&renderer, &camera, size, sample, args.seconds)?,
    };
    let renders: Vec<Image> = (1..=args.renders)
        .map(|seed| render(&renderer, &camera, size, Render { sample, spp, seed }))
        .collect::<Result<_, _>>()?;
    let row = |what: &str, renders: &[Image]| verdict(&format!("{name} | {what} | {spp}"), renders, &reference);
    match args.red {
        Some(Red::Light) => Ok(!row("without one emitter", &renders)?),
        Some(Red::Mask) => Ok(!row("without alpha", &renders)?),
        None => {
            let all = |spoil: fn(&Image) -> Image| renders.iter().map(spoil).collect::<Vec<_>>();
            Ok(row("as they are", &renders)?
                & !row("2 % darker", &all(darker))?
                & !row("shifted by a pixel", &all(shifted))?)
        }
    }
}

/// Compare, print a row, and say whether T13 passes.
fn verdict(what: &str, renders: &[Image], reference: &(Image, Image)) -> Result<bool, String> {
    let c = compare(renders, &reference.0, Some(&reference.1)).map_err(|e| e.to_string())?;
    let t = c.t13.ok_or("T13 needs at least 16 renders")?;
    println!(
        "| {what} | {} | {:.3} | {:.2} % | {:.2} | {:+.2} | {} |",
        renders.len(),
        t.rms_z,
        t.blocks_beyond * 100.0,
        t.max_z,
        t.mean_sigmas,
        if t.pass { "pass" } else { "FAIL" }
    );
    Ok(t.pass)
}

/// Samples per pixel that so many seconds buy, after a warm-up.
fn affordable(renderer: &Renderer, camera: &Camera, size: [u32; 2], sample: u32, seconds: f64) -> Result<u32, String> {
    let of = |spp| render(renderer, camera, size, Render { sample, spp, seed: 0 });
    of(2)?;
    let start = Instant::now();
    of(4)?;
    Ok((seconds / (start.elapsed().as_secs_f64() / 4.0)).max(1.0) as u32)
}

fn render(renderer: &Renderer, camera: &Camera, size: [u32; 2], job: Render) -> Result<Image, String> {
    let mut film = Film::of_size(size);
    renderer.render_with(camera, &mut film, job, &Handle::default()).map_err(|e| e.to_string())?;
    Ok(film.mean())
}

fn spoil(scene: &mut Scene, red: Option<Red>) {
    match red {
        Some(Red::Light) => {
            if let Some(emitter) = scene.materials.iter_mut().find(|m| m.is_emissive()) {
                emitter.emissive = [0.0; 3];
            }
        }
        Some(Red::Mask) => scene.materials.iter_mut().for_each(|m| m.alpha_mode = AlphaMode::Opaque),
        None => {}
    }
}

fn darker(image: &Image) -> Image {
    let pixels = image.pixels.iter().map(|p| p.map(|c| c * 0.98)).collect();
    Image { pixels, ..*image }
}

fn shifted(image: &Image) -> Image {
    let at = |x: u32, y: u32| image.pixels[(y * image.width + x) as usize];
    Image::from_fn(image.width, image.height, |x, y| at(x.saturating_sub(1), y))
}
