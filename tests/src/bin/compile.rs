//! What specialisation and code generation cost, as a command.
//!
//! ```sh
//! cargo run --release -p jerboa-tests --bin compile -- SCENE… [--rounds N]
//! ```
//!
//! Makes all kernels of each scene on one thread, without the cache of code, and prints the median over rounds of the time
//! that the thread ran for (Linux), so another process beside it disturbs little. SCENE is a file or `builtin:NAME`.

use std::process::ExitCode;

use jerboa_backend_cranelift as clif;
use jerboa_lib_render::host::device::DeviceKind;
use jerboa_lib_render::host::generate::{Keep, TracerKind, generic, residual};
use jerboa_lib_render::host::tables::{Choices, Known, Tables};
use jerboa_scenes::Scene;
use jerboa_tests::harness::clock::processor_time;

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
    let (mut scenes, mut rounds) = (Vec::new(), 5);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--rounds" => rounds = words.next().and_then(|n| n.parse().ok()).ok_or("--rounds takes a whole number")?,
            _ => scenes.push(word),
        }
    }
    let start = processor_time();
    generic();
    println!("generic program, once per process: {:.1} ms\n", 1e3 * (processor_time() - start));
    println!(
        "| scene | kernels | nodes | bytes of code | specialise, ms | generate code, ms |\n|---|---|---|---|---|---|"
    );
    scenes.iter().try_for_each(|scene| measure(scene, rounds))
}

fn measure(name: &str, rounds: usize) -> Result<(), String> {
    let scene = Scene::load(name).map_err(|e| e.to_string())?;
    let tables = Tables::new(&scene, &Choices::default(), Known::Structure);
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
    let [specialise, codegen] = [specialise, codegen].map(|mut times| {
        times.sort_by(f64::total_cmp);
        1e3 * times[times.len() / 2]
    });
    println!("| {} | {} | {nodes} | {bytes} | {specialise:.1} | {codegen:.1} |", scene.name, requests.len());
    Ok(())
}
