//! What samplers cost and bring, as a command.
//!
//! ```sh
//! cargo run --release -p jerboa-tests --bin samplers -- SCENE… [--renders K] [--spp N] [--size W]
//! ```
//!
//! Renders each scene with each sampler, in turn, K times with seeds of their own, on one thread, W pixels wide, by the rules of
//! comparison with other renderers (free shading normals, paths of 16 edges). The error is the mean over pixels of the
//! variance of luminance over the K renders, over R² + (0.1 mean of R)², where R is the mean of all renders, of all pixels and
//! without the worst thousandth of them by all samplers. Times are those that the thread ran for (Linux). SCENE is a file
//! or `builtin:NAME`.

use std::path::Path;
use std::process::ExitCode;

use jerboa_lib_render::host::film::Film;
use jerboa_lib_render::host::renderer::{Handle, Options, Render, Renderer};
use jerboa_lib_render::host::tables::{Choices, SamplerKind};
use jerboa_scenes::Scene;
use jerboa_tests::harness::clock::processor_time;

/// The first is what the others are compared with.
const SAMPLERS: [(&str, SamplerKind); 3] = [
    ("independent", SamplerKind::Independent),
    ("sobol, 8 sequences", SamplerKind::SOBOL),
    ("sobol, 1 sequence", SamplerKind::Sobol { log_scrambles: 0 }),
];

/// Sums of a sampler's renders: of luminance and of its square in each pixel, and time.
#[derive(Clone, Default)]
struct Sums {
    sum: Vec<f64>,
    squares: Vec<f64>,
    time: f64,
}

/// What is rendered.
struct Job {
    scenes: Vec<String>,
    renders: u32,
    spp: u32,
    width: u32,
}

fn main() -> ExitCode {
    let done = read(std::env::args().skip(1)).and_then(|job| {
        let ratios = job.scenes.iter().map(|scene| measure(scene, &job)).collect::<Result<Vec<_>, _>>()?;
        for (i, (name, _)) in SAMPLERS.iter().enumerate().skip(1) {
            let mean = |k: usize| (ratios.iter().map(|r| r[i][k].ln()).sum::<f64>() / ratios.len() as f64).exp();
            println!(
                "geometric mean, {name}: error {:.3}, trimmed {:.3}, time {:.3}, efficiency {:.3}, trimmed {:.3}",
                mean(0),
                mean(1),
                mean(2),
                1.0 / (mean(0) * mean(2)),
                1.0 / (mean(1) * mean(2))
            );
        }
        Ok(())
    });
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("samplers: {message}");
            ExitCode::FAILURE
        }
    }
}

fn read(mut words: impl Iterator<Item = String>) -> Result<Job, String> {
    let mut job = Job { scenes: Vec::new(), renders: 16, spp: 16, width: 100 };
    while let Some(word) = words.next() {
        let mut number =
            || words.next().and_then(|n| n.parse::<u32>().ok()).ok_or(format!("{word} takes a whole number"));
        match word.as_str() {
            "--renders" => job.renders = number()?.max(2),
            "--spp" => job.spp = number()?.max(1),
            "--size" => job.width = number()?.max(1),
            _ => job.scenes.push(word),
        }
    }
    if job.scenes.is_empty() { Err("a scene is missing".into()) } else { Ok(job) }
}

/// Of each sampler the ratios of error, trimmed error and time to those of the first.
fn measure(name: &str, job: &Job) -> Result<Vec<[f64; 3]>, String> {
    let scene = Scene::load(name).map_err(|e| e.to_string())?;
    let camera = scene.camera_or_default();
    let renderer = |sampler| {
        let choices = Choices { sampler, consistent_normals: false, max_depth: Some(16), ..Choices::default() };
        Renderer::new(&scene, Options { choices, ..Options::default() }).map_err(|e| e.to_string())
    };
    let renderers = SAMPLERS.iter().map(|(_, sampler)| renderer(*sampler)).collect::<Result<Vec<_>, _>>()?;
    let (width, height) = camera.film_or_default();
    let size = [job.width, (job.width * height).div_ceil(width)];
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(|e| e.to_string())?;
    let pixels = (size[0] * size[1]) as usize;
    let mut sums = vec![Sums { sum: vec![0.0; pixels], squares: vec![0.0; pixels], time: 0.0 }; SAMPLERS.len()];
    for seed in 0..job.renders {
        for (i, (renderer, sums)) in renderers.iter().zip(&mut sums).enumerate() {
            let mut film = Film::of_size(size);
            // Seeds differ, so that samplers are compared by renders that have nothing to do with each other.
            let work = Render { sample: 0, spp: job.spp, seed: seed * SAMPLERS.len() as u32 + i as u32 };
            sums.time += pool.install(|| {
                let start = processor_time();
                renderer.render_with(&camera, &mut film, work, &Handle::default()).map_err(|e| e.to_string())?;
                Ok::<f64, String>(processor_time() - start)
            })?;
            for (pixel, [r, g, b]) in film.mean().pixels.iter().map(|p| p.map(f64::from)).enumerate() {
                let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
                sums.sum[pixel] += luminance;
                sums.squares[pixel] += luminance * luminance;
            }
        }
    }
    let of_file = Path::new(name).file_stem().map_or(name.into(), |stem| stem.to_string_lossy());
    Ok(report(&of_file, job, &sums))
}

fn report(name: &str, job: &Job, sums: &[Sums]) -> Vec<[f64; 3]> {
    let k = f64::from(job.renders);
    let pixels = sums[0].sum.len();
    let mean = |p: usize| sums.iter().map(|s| s.sum[p]).sum::<f64>() / (k * sums.len() as f64);
    let epsilon = (0.1 * (0..pixels).map(mean).sum::<f64>() / pixels as f64).powi(2);
    let error = |s: &Sums, p: usize| {
        let variance = (s.squares[p] - s.sum[p] * s.sum[p] / k) / (k - 1.0);
        variance / (mean(p).powi(2) + epsilon)
    };
    let mut worst: Vec<usize> = (0..pixels).collect();
    let all = |p: &usize| sums.iter().map(|s| error(s, *p)).sum::<f64>();
    worst.sort_by(|a, b| all(b).total_cmp(&all(a)));
    let over = |s: &Sums, pixels: &[usize]| pixels.iter().map(|p| error(s, *p)).sum::<f64>() / pixels.len() as f64;
    let figures: Vec<[f64; 3]> =
        sums.iter().map(|s| [over(s, &worst), over(s, &worst[pixels / 1000..]), s.time / k]).collect();
    let image = |s: &Sums| s.sum.iter().sum::<f64>() / (k * pixels as f64);
    println!(
        "| {name}, {} spp | mean | error | trimmed | s | error ratio | trimmed | time ratio | efficiency |",
        job.spp
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let ratios: Vec<[f64; 3]> = figures.iter().map(|f| [0, 1, 2].map(|i| f[i] / figures[0][i])).collect();
    for (((sampler, _), s), (f, r)) in SAMPLERS.iter().zip(sums).zip(figures.iter().zip(&ratios)) {
        let efficiency = 1.0 / (r[1] * r[2]);
        println!(
            "| {sampler} | {:.5} | {:.3e} | {:.3e} | {:.3} | {:.3} | {:.3} | {:.3} | {efficiency:.3} |",
            image(s),
            f[0],
            f[1],
            f[2],
            r[0],
            r[1],
            r[2]
        );
    }
    ratios
}
