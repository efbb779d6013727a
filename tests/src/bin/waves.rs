//! What the cuts of the device of streams cost, as a command: paths in flight and sides of tiles, beside the scalar device.
//! With `--walks`: the native walk of its tree beside the kernel.
//!
//! ```sh
//! cargo run --release -p jerboa-tests --bin waves -- SCENE… [--walks] [--rounds N] [--size W] [--spp N]
//! ```
//!
//! Renders each scene in each way, in turn, on one thread, and prints the median time and the median of the ratio to the
//! first way in the same round. Times are those that the thread ran for (Linux), so another process beside it disturbs
//! them little. SCENE is a file or `builtin:NAME`.

use std::process::ExitCode;

use jerboa_lib_render::host::device::{DeviceKind, Traversal};
use jerboa_lib_render::host::film::Film;
use jerboa_lib_render::host::renderer::{Cut, Handle, Options, Render, Renderer};
use jerboa_lib_render::host::tables::Choices;
use jerboa_scenes::Scene;
use jerboa_tests::harness::clock::processor_time;

/// Paths in flight.
const SLOTS: [u32; 5] = [256, 1024, 2048, 4096, 16384];

/// Sides of tiles.
const TILES: [u32; 3] = [8, 32, 64];

/// What is rendered.
struct Job {
    walks: bool,
    scenes: Vec<String>,
    rounds: usize,
    width: u32,
    spp: u32,
}

fn main() -> ExitCode {
    let done = read(std::env::args().skip(1)).and_then(|job| job.scenes.iter().try_for_each(|s| measure(s, &job)));
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("waves: {message}");
            ExitCode::FAILURE
        }
    }
}

fn read(mut words: impl Iterator<Item = String>) -> Result<Job, String> {
    let mut job = Job { walks: false, scenes: Vec::new(), rounds: 3, width: 320, spp: 16 };
    while let Some(word) = words.next() {
        let mut number =
            || words.next().and_then(|n| n.parse::<u32>().ok()).ok_or(format!("{word} takes a whole number"));
        match word.as_str() {
            "--walks" => job.walks = true,
            "--rounds" => job.rounds = number()?.max(1) as usize,
            "--size" => job.width = number()?.max(1),
            "--spp" => job.spp = number()?.max(1),
            _ => job.scenes.push(word),
        }
    }
    if job.scenes.is_empty() { Err("a scene is missing".into()) } else { Ok(job) }
}

/// The scalar device, and every cut of the other one.
fn cuts() -> Vec<(String, Options)> {
    let of = |cut: Cut| Options { cut, ..Options::default() };
    let usual = Cut::default();
    let mut all = vec![("scalar".into(), Options { device: DeviceKind::CpuScalar, ..Options::default() })];
    all.extend(SLOTS.map(|slots| (format!("{slots} in flight"), of(Cut { slots, ..usual }))));
    all.extend(TILES.map(|tile| (format!("tiles of {tile}"), of(Cut { tile, ..usual }))));
    all
}

/// Who may walk the tree.
fn walks() -> Vec<(String, Options)> {
    let of = |traversal: Traversal| Options { traversal, ..Options::default() };
    vec![("kernel".into(), of(Traversal::Ir)), ("native".into(), of(Traversal::Native))]
}

fn measure(name: &str, job: &Job) -> Result<(), String> {
    let scene = Scene::load(name).map_err(|e| e.to_string())?;
    let camera = scene.camera_or_default();
    // Rules of comparison with other renderers: their roulette.
    let choices = Choices { rr_depth: Some(5), rr_cap: 0.95, ..Choices::default() };
    let renderer = |(_, options): &(String, Options)| {
        Renderer::new(&scene, Options { choices, ..*options }).map_err(|e| e.to_string())
    };
    let variants = if job.walks { walks() } else { cuts() };
    let renderers = variants.iter().map(renderer).collect::<Result<Vec<_>, _>>()?;
    let mut times = vec![Vec::new(); variants.len()];
    let mut first: Option<Film> = None;
    for _ in 0..job.rounds {
        for (renderer, times) in renderers.iter().zip(&mut times) {
            let mut film = Film::of_size([job.width, job.width * 9 / 16]);
            let work = Render { sample: 0, spp: job.spp, seed: 0 };
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(|e| e.to_string())?;
            let time = pool.install(|| {
                let start = processor_time();
                renderer.render_with(&camera, &mut film, work, &Handle::default()).map_err(|e| e.to_string())?;
                Ok::<f64, String>(processor_time() - start)
            })?;
            times.push(time);
            if *first.get_or_insert_with(|| film.clone()) != film {
                return Err(format!("{name}: the images differ"));
            }
        }
    }
    println!("| {name} | median, s | median of the ratio to {} |\n|---|---|---|", variants[0].0);
    for ((variant, _), own) in variants.iter().zip(&times) {
        let ratios: Vec<f64> = own.iter().zip(&times[0]).map(|(t, first)| t / first).collect();
        println!("| {variant} | {:.3} | {:.3} |", median(own), median(&ratios));
    }
    Ok(())
}

fn median(xs: &[f64]) -> f64 {
    let mut xs = xs.to_vec();
    xs.sort_by(f64::total_cmp);
    xs[xs.len() / 2]
}
