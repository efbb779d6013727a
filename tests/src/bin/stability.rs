//! Figures of stability that a test does not assert, as a command: what consistent shading normals cost, and how long a
//! render takes to end when it is asked to.
//!
//! ```sh
//! cargo run --release -p jerboa-tests --bin stability -- normals [--spp N]
//! cargo run --release -p jerboa-tests --bin stability -- cancel
//! ```
//!
//! `normals` (N25) renders three scenes with consistent and with free shading normals, the same random numbers for both,
//! and prints the share of the image's mean luminance that is lost; FlightHelmet.gltf and NormalTangentTest.glb have no light
//! and get an environment of radiance 1. The standard error is that of the difference, by the spread of eight batches. (Free
//! normals also let light through surfaces, so the difference is more than what ended paths would have brought.) `cancel`
//! starts renders whose paths are long, ends each 20 times at different moments, and prints the longest wait and the median.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use jerboa_lib_render::host::film::Film;
use jerboa_lib_render::host::image_io::luminance;
use jerboa_lib_render::host::renderer::{Handle, Options, Render, Renderer};
use jerboa_lib_render::host::tables::Choices;
use jerboa_scenes::{Environment, Scene};
use jerboa_tests::sources::shared_scenes;

/// Scenes of N25, below the shared ones.
const NORMALS: [&str; 3] = [
    "living-room/living-room.matched.glb",
    "flight-helmet/FlightHelmet.gltf",
    "khronos-shared/NormalTangentTest/NormalTangentTest.glb",
];

/// Built-in scenes with the longest paths, and one of usual length.
const LONG: [&str; 5] = ["white-box", "closed-box-99", "facing-mirrors", "glass-trap", "many-lights"];

/// Batches whose spread gives the standard error.
const BATCHES: u32 = 8;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let done = match words[..] {
        ["normals"] => normals(64),
        ["normals", "--spp", spp] => spp.parse().map_err(|_| "--spp takes a whole number".into()).and_then(normals),
        ["cancel"] => cancel(),
        _ => Err("`normals [--spp N]` or `cancel`".into()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("stability: {message}");
            ExitCode::FAILURE
        }
    }
}

fn normals(spp: u32) -> Result<(), String> {
    let shared = shared_scenes().ok_or("there are no shared scenes")?;
    println!("| scene | consistent | free | lost | standard error |\n|---|---|---|---|---|");
    for file in NORMALS {
        let mut scene = Scene::load(shared.join(file)).map_err(|e| e.to_string())?;
        if scene.all_warnings().iter().any(|w| w.to_string().contains("no light")) {
            let radiance = vec![[1.0; 3]; 8];
            scene.environment = Some(Environment { width: 4, height: 2, radiance, intensity: 1.0, rotation_deg: 0.0 });
        }
        let consistent = batch_means(&scene, spp, true)?;
        let free = batch_means(&scene, spp, false)?;
        let differences: Vec<f64> = free.iter().zip(&consistent).map(|(f, c)| f - c).collect();
        let (all, kept, lost) = (mean(&free), mean(&consistent), mean(&differences));
        let spread: f64 = differences.iter().map(|d| (d - lost).powi(2)).sum();
        let error = (spread / f64::from(BATCHES * (BATCHES - 1))).sqrt();
        let per_cent = |x: f64| 100.0 * x / all;
        println!("| {file} | {kept:.5} | {all:.5} | {:.3} % | {:.3} % |", per_cent(lost), per_cent(error));
    }
    Ok(())
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Mean luminance of each batch of samples, on a film of at most 240 pixels' width.
fn batch_means(scene: &Scene, spp: u32, consistent_normals: bool) -> Result<Vec<f64>, String> {
    let choices = Choices { consistent_normals, max_depth: Some(16), ..Choices::default() };
    let renderer = Renderer::new(scene, Options { choices, ..Options::default() }).map_err(|e| e.to_string())?;
    let camera = scene.camera_or_default();
    let (width, height) = camera.film_or_default();
    let size = [240, (240 * height / width).max(1)];
    let batch = |i: u32| {
        let mut film = Film::of_size(size);
        let job = Render { sample: i * spp.div_ceil(BATCHES), spp: spp.div_ceil(BATCHES), seed: 0 };
        renderer.render_with(&camera, &mut film, job, &Handle::default()).map_err(|e| e.to_string())?;
        Ok(mean(&film.mean().pixels.iter().map(|p| luminance(*p)).collect::<Vec<_>>()))
    };
    (0..BATCHES).map(batch).collect()
}

fn cancel() -> Result<(), String> {
    println!("| scene | longest wait | median | rays per sample, shadow rays aside |\n|---|---|---|---|");
    for name in LONG {
        let scene = Scene::load(format!("builtin:{name}")).map_err(|e| e.to_string())?;
        let renderer = Renderer::new(&scene, Options::default()).map_err(|e| e.to_string())?;
        let camera = scene.camera_or_default();
        let (mut waits, mut rays, mut samples) = (Vec::new(), 0, 0);
        for trial in 0..20 {
            // So small that the passes have reached their full length when the render is ended.
            let (mut film, handle) = (Film::of_size([32, 32]), Handle::default());
            let job = Render { sample: 0, spp: 1 << 20, seed: trial };
            let (stats, asked) = std::thread::scope(|scope| {
                let watch = scope.spawn(|| {
                    std::thread::sleep(Duration::from_millis(100 + 37 * u64::from(trial)));
                    handle.cancel();
                    Instant::now()
                });
                let stats = renderer.render_with(&camera, &mut film, job, &handle);
                (stats.map(|s| (s, Instant::now())), watch.join().expect("it only waits"))
            });
            let (stats, ended) = stats.map_err(|e| e.to_string())?;
            waits.push(ended.saturating_duration_since(asked).as_secs_f64() * 1e3);
            rays += stats.closest_rays;
            samples += handle.samples_done();
        }
        waits.sort_by(f64::total_cmp);
        let (median, longest) = (waits[waits.len() / 2], waits[waits.len() - 1]);
        println!("| {name} | {longest:.1} ms | {median:.1} ms | {:.1} |", rays as f64 / samples as f64);
    }
    Ok(())
}
