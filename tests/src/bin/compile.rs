//! What specialisation and code generation cost, as a command; the long form of T24.
//!
//! ```sh
//! cargo run --release -p jerboa-tests --bin compile -- SCENE… [--rounds N] [--many]
//! ```
//!
//! Makes all kernels of each scene on one thread, without the cache of code, and prints the median over rounds of the time
//! that the thread ran for, so another process beside it disturbs little. SCENE is a file or `builtin:NAME`. `--many` does so
//! for walls of more and more materials, structures, lights and textures (`harness::many`), and renders each.

use std::process::ExitCode;

use jerboa_backend_cranelift as clif;
use jerboa_lib_render::host::device::DeviceKind;
use jerboa_lib_render::host::film::Film;
use jerboa_lib_render::host::generate::{Keep, TracerKind, generic, residual};
use jerboa_lib_render::host::renderer::{Handle, Options, Render, Renderer};
use jerboa_lib_render::host::tables::{Choices, Known, Tables};
use jerboa_scenes::Scene;
use jerboa_tests::harness::clock::processor_time;
use jerboa_tests::harness::many::{lights, line, materials, most_shaders, shaders, textures};

fn main() -> ExitCode {
    match run(std::env::args().skip(1)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("compile: {message}");
            ExitCode::FAILURE
        }
    }
}

fn run(mut words: impl Iterator<Item = String>) -> Result<(), String> {
    let (mut scenes, mut rounds, mut many) = (Vec::new(), 5, false);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--rounds" => rounds = words.next().and_then(|n| n.parse().ok()).ok_or("--rounds takes a whole number")?,
            "--many" => many = true,
            _ => scenes.push(word),
        }
    }
    let start = processor_time();
    generic();
    println!("generic program, once per process: {:.1} ms\n", 1e3 * (processor_time() - start));
    println!(
        "| scene | kernels | nodes | bytes of code | specialise, ms | generate code, ms |\n|---|---|---|---|---|---|"
    );
    for name in &scenes {
        let scene = Scene::load(name).map_err(|e| e.to_string())?;
        let cost = Cost::measure(&scene, Known::Structure, rounds)?;
        println!("| {} | {} |", scene.name, cost.text());
    }
    if many { of_many(rounds) } else { Ok(()) }
}

/// What all kernels of a scene cost.
struct Cost {
    kernels: usize,
    nodes: usize,
    bytes: usize,
    specialise: f64,
    codegen: f64,
}

impl Cost {
    fn measure(scene: &Scene, known: Known, rounds: usize) -> Result<Cost, String> {
        let tables = Tables::new(scene, &Choices::default(), known);
        let requests = DeviceKind::Cpu.requests(&tables, TracerKind::Path);
        let (mut specialise, mut codegen) = (Vec::new(), Vec::new());
        let (mut nodes, mut bytes) = (0, 0);
        for _ in 0..rounds.max(1) {
            (nodes, bytes) = (0, 0);
            let start = processor_time();
            let residuals = requests.iter().map(|r| residual(&tables, r, Keep::default()));
            let residuals = residuals.collect::<Result<Vec<_>, _>>().map_err(|e| e.to_string())?;
            specialise.push(processor_time() - start);
            let start = processor_time();
            for r in &residuals {
                let code = clif::compile(&[&r.program], &clif::Options::default()).map_err(|e| e.to_string())?;
                bytes += code.reports().map(|k| k.code_bytes).sum::<usize>();
                nodes += r.program.nodes.len();
            }
            codegen.push(processor_time() - start);
        }
        let [specialise, codegen] = [specialise, codegen].map(|times| 1e3 * median(times));
        Ok(Cost { kernels: requests.len(), nodes, bytes, specialise, codegen })
    }

    fn text(&self) -> String {
        let Cost { kernels, nodes, bytes, specialise, codegen } = self;
        format!("{kernels} | {nodes} | {bytes} | {specialise:.1} | {codegen:.1}")
    }
}

fn median(mut xs: Vec<f64>) -> f64 {
    xs.sort_by(f64::total_cmp);
    xs[xs.len() / 2]
}

/// Walls of more and more of everything.
fn of_many(rounds: usize) -> Result<(), String> {
    for (what, build) in [("materials", materials as fn(usize) -> Scene), ("lights", lights), ("textures", textures)] {
        for n in [1, 8, 64, 512, 4096] {
            println!("| {n} {what} | {} |", Cost::measure(&build(n), Known::Structure, rounds)?.text());
        }
    }
    println!(
        "\n| structures | kernels | nodes | bytes of code | specialise, ms | generate code, ms | render, s | as scalar, s |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let mut points = [Vec::new(), Vec::new(), Vec::new()];
    for n in [1, 2, 4, 8, 16, 32, 48, 60, 64, 65, 68, 80, 96, 128, 192].into_iter().chain([most_shaders()]) {
        let scene = shaders(n);
        let cost = Cost::measure(&scene, Known::Structure, rounds)?;
        let [streams, scalar] = [DeviceKind::Cpu, DeviceKind::CpuScalar].map(|device| render(&scene, device, rounds));
        println!("| {n} | {} | {:.3} | {:.3} |", cost.text(), streams?, scalar?);
        if n <= 64 {
            let [nodes, bytes] = [cost.nodes, cost.bytes].map(|y| (n as f64, y as f64));
            points[0].push(nodes);
            points[1].push(bytes);
            points[2].push((n as f64, cost.specialise + cost.codegen));
        }
    }
    println!();
    for (what, points) in ["nodes", "bytes", "ms"].iter().zip(&points) {
        let (slope, start, share) = line(points);
        println!("{what}: {slope:.1} a structure, {start:.1} besides, R² {share:.4}");
    }
    Ok(())
}

/// Seconds that a thread ran for to render 128x128 pixels of 32 samples: the median.
fn render(scene: &Scene, device: DeviceKind, rounds: usize) -> Result<f64, String> {
    let renderer = Renderer::new(scene, Options { device, ..Options::default() }).map_err(|e| e.to_string())?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(|e| e.to_string())?;
    let once = |_| {
        let mut film = Film::of_size([128, 128]);
        pool.install(|| {
            let start = processor_time();
            let job = Render { sample: 0, spp: 32, seed: 0 };
            renderer
                .render_with(&scene.camera_or_default(), &mut film, job, &Handle::default())
                .map_err(|e| e.to_string())?;
            Ok::<f64, String>(processor_time() - start)
        })
    };
    Ok(median((0..rounds.max(1)).map(once).collect::<Result<_, _>>()?))
}
