//! Renders with the Sobol sampler: the same image on average as with independent numbers (T13), errors that fall faster (T14), the
//! same bits on every engine, thread and in every order (T3, T21), and not a word of it where it is not asked for (T25).

use jerboa_ir::{Lit, print};
use jerboa_lib_render::host::device::DeviceKind;
use jerboa_lib_render::host::film::{Film, Window};
use jerboa_lib_render::host::generate::{Keep, TracerKind, generic, residual};
use jerboa_lib_render::host::renderer::{Handle, Options, Render, Renderer};
use jerboa_lib_render::host::replay::interpret;
use jerboa_lib_render::host::tables::{Choices, Known, Pass, SamplerKind, Tables};
use jerboa_scenes::{Camera, Scene};
use jerboa_tests::harness::analytic::direct;
use jerboa_tests::harness::bench::number;
use jerboa_tests::harness::stats::{FAMILY, mean, normal_tails, sidak};

const ONE_SEQUENCE: SamplerKind = SamplerKind::Sobol { log_scrambles: 0 };

fn load(name: &str) -> Scene {
    Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{e}"))
}

fn options(sampler: SamplerKind) -> Options {
    Options { choices: Choices { sampler, ..Choices::default() }, ..Options::default() }
}

fn renderer(scene: &Scene, options: Options) -> Renderer {
    Renderer::new(scene, options).unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

fn render(renderer: &Renderer, camera: &Camera, film: &mut Film, job: Render) {
    renderer.render_with(camera, film, job, &Handle::default()).unwrap_or_else(|e| panic!("{e}"));
}

/// Means of the three channels of a render.
fn means(renderer: &Renderer, camera: &Camera, size: [u32; 2], job: Render) -> [f64; 3] {
    let mut film = Film::of_size(size);
    render(renderer, camera, &mut film, job);
    let image = film.mean();
    [0, 1, 2].map(|c| image.pixels.iter().map(|p| f64::from(p[c])).sum::<f64>() / image.pixels.len() as f64)
}

/// Words that differ; every NaN is one value.
fn differences(a: &[u32], b: &[u32]) -> usize {
    let canonical = |w: &u32| Lit::f32(f32::from_bits(*w));
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).filter(|(a, b)| a != b && canonical(a) != canonical(b)).count()
}

/// 64 short renders of each sampler: their means are within the standard errors of each other, in every channel of every
/// scene. Right code fails at 1 % of the seeds.
#[test]
fn the_mean_is_that_of_independent_numbers() {
    const SCENES: [&str; 6] = ["cornell-box", "material-balls", "many-lights", "alpha", "checkerboard", "pebbles"];
    let spp = number("JERBOA_SPP", 4) as u32;
    let limit = sidak(FAMILY, 3 * SCENES.len());
    for name in SCENES {
        let scene = load(name);
        let camera = scene.camera_or_default();
        let found = [SamplerKind::Independent, SamplerKind::SOBOL, ONE_SEQUENCE].map(|sampler| {
            let r = renderer(&scene, options(sampler));
            let job = |seed| Render { sample: 0, spp, seed };
            (0..64).map(|seed| means(&r, &camera, [16, 16], job(7 + seed))).collect::<Vec<_>>()
        });
        for c in 0..3 {
            let [(m, e), others @ ..] = found.each_ref().map(|renders| mean(renders.iter().map(|r| r[c])));
            for (sampler, (other, less)) in ["8 sequences", "1 sequence"].iter().zip(others) {
                let z = (other - m) / e.hypot(less);
                println!("{name}, channel {c}, {sampler}: {other:.6} ± {less:.1e}, not {m:.6} ± {e:.1e}: z = {z:.2}");
                assert!(normal_tails(z) >= limit / 2.0, "{name}, channel {c}, {sampler}: another mean");
            }
        }
    }
}

/// log of the variance of a pixel over log of the number of samples, for direct light of a lamp: −1 with independent numbers, below
/// −1.2 with Sobol points.
#[test]
fn errors_of_direct_light_fall_faster() {
    let renders = number("JERBOA_RENDERS", 256) as u32;
    let closed = direct().into_iter().find(|c| c.name == "lamp at height 1").expect("a row of the table");
    let (look, _) = &closed.looks[0];
    let variance = |r: &Renderer, spp: u32| {
        let value = |seed| {
            let mut film = Film::crop(look.size, Window { width: 1, height: 1, ..look.window });
            render(r, &look.camera, &mut film, Render { sample: 0, spp, seed });
            f64::from(film.mean().pixels[0][1])
        };
        mean((0..renders).map(value)).1.powi(2)
    };
    for (sampler, first, last, bounds) in [
        (SamplerKind::Independent, 4, 256, [-1.2, -0.8]),
        (ONE_SEQUENCE, 4, 256, [-9.0, -1.2]),
        (SamplerKind::SOBOL, 32, 1024, [-9.0, -1.2]),
    ] {
        let choices = Choices { sampler, ..closed.choices };
        let r = renderer(&closed.scene, Options { choices, ..Options::default() });
        let sizes: Vec<u32> = (0..).map(|k| first << (2 * k)).take_while(|spp| *spp <= last).collect();
        let points: Vec<[f64; 2]> = sizes.iter().map(|n| [f64::from(*n).ln(), variance(&r, *n).ln()]).collect();
        let slope = slope(&points);
        println!("{sampler:?}, {first} to {last} samples: slope {slope:.2}");
        assert!((bounds[0]..=bounds[1]).contains(&slope), "{sampler:?}: slope {slope}");
    }
}

/// In no scene does the variance of pixels fall slower than with independent numbers: a hundredth part of it is left by a hundred
/// times the samples. So it is where the numbers of many vertices meet, or where a hole and each node of a tree of lights has a
/// number of its own: what repeats itself there has another limit for each seed.
#[test]
fn errors_fall_wherever_numbers_meet() {
    const SIDE: u32 = 12;
    let seeds = number("JERBOA_RENDERS", 16) as u32;
    for name in ["cornell-box", "alpha", "many-lights"] {
        let scene = load(name);
        let camera = scene.camera_or_default();
        let r = renderer(&scene, options(ONE_SEQUENCE));
        let variance = |spp: u32| {
            let image = |seed| {
                let mut film = Film::of_size([SIDE, SIDE]);
                render(&r, &camera, &mut film, Render { sample: 0, spp, seed });
                film.mean().pixels
            };
            let images: Vec<_> = (0..seeds).map(image).collect();
            let pixel = |i: usize| mean(images.iter().map(|image| f64::from(image[i][1]))).1.powi(2);
            (0..(SIDE * SIDE) as usize).map(pixel).sum::<f64>()
        };
        let left = variance(400) / variance(4);
        println!("{name}: {left:.5} of the variance is left; seeds 0 to {seeds}");
        assert!(left < 0.013, "{name}: {left} of the variance is left");
    }
}

/// The variance of the mean of all samples of a pixel, over seeds, is what the spread of the means of its eight sequences says; the
/// spread of its samples says much more.
#[test]
fn the_spread_of_eight_sequences_tells_the_variance() {
    const SAMPLES: usize = 128;
    let renders = number("JERBOA_RENDERS", 256) as u32;
    let closed = direct().into_iter().find(|c| c.name == "lamp at height 1").expect("a row of the table");
    let (look, _) = &closed.looks[0];
    let choices = Choices { sampler: SamplerKind::SOBOL, ..closed.choices };
    let r = renderer(&closed.scene, Options { choices, ..Options::default() });
    let window = Window { width: 1, height: 1, ..look.window };
    let (mut all, mut told, mut by_samples) = (vec![], 0.0, 0.0);
    for seed in 0..renders {
        let pass = Pass { size: look.size, window, sample: 0, samples: SAMPLES as u32, seed };
        let words = r.samples(&look.camera, &pass).unwrap_or_else(|e| panic!("{e}"));
        let red: Vec<f64> = words[..SAMPLES].iter().map(|w| f64::from(f32::from_bits(*w))).collect();
        let of = |sequence: usize| red.iter().skip(sequence).step_by(8).sum::<f64>() / (SAMPLES / 8) as f64;
        all.push(red.iter().sum::<f64>() / SAMPLES as f64);
        told += mean((0..8).map(of)).1.powi(2) / f64::from(renders);
        by_samples += mean(red).1.powi(2) / f64::from(renders);
    }
    let variance = mean(all).1.powi(2) * f64::from(renders);
    println!("variance {variance:.3e}, by eight means {told:.3e}, by samples {by_samples:.3e}");
    // The standard error of a variance of 256 values is 9 % of it.
    assert!((0.7..1.4).contains(&(told / variance)), "eight means tell {told}, not {variance}");
    assert!(by_samples > 10.0 * variance, "samples by themselves tell {by_samples}");
}

/// Of the line of least squares.
fn slope(points: &[[f64; 2]]) -> f64 {
    let centre = [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / points.len() as f64);
    let sum = |f: fn(f64, f64) -> f64| points.iter().map(|p| f(p[0] - centre[0], p[1] - centre[1])).sum::<f64>();
    sum(|x, y| x * y) / sum(|x, _| x * x)
}

/// Interpreter, residual, machine code of both devices, at every level: the same words.
#[test]
fn engines_agree() {
    let window = Window { x: 13, y: 13, width: 4, height: 4 };
    let pass = Pass { size: [32, 32], window, sample: 9, samples: 1, seed: 7 };
    for name in ["cornell-box", "material-balls", "many-lights", "alpha"] {
        let scene = load(name);
        let camera = scene.camera_or_default();
        let mut first: Option<Vec<u32>> = None;
        for known in [Known::Nothing, Known::Structure, Known::All] {
            let r = |device| renderer(&scene, Options { device, known, ..options(SamplerKind::SOBOL) });
            let words = |r: &Renderer| r.samples(&camera, &pass).unwrap_or_else(|e| panic!("{name}: {e}"));
            let scalar = r(DeviceKind::CpuScalar);
            let compiled = words(&scalar);
            assert_eq!(differences(&compiled, &words(&r(DeviceKind::Cpu))), 0, "{name}, {known:?}: the devices differ");
            let meant =
                |program| interpret(program, "path", scalar.tables(), &camera, &pass, &mut ()).expect("it runs");
            assert_eq!(differences(&compiled, &meant(&scalar.kernels()[0].residual.program)), 0, "{name}, {known:?}");
            let first = first.get_or_insert_with(|| meant(generic().program()));
            assert_eq!(differences(&compiled, first), 0, "{name}, {known:?}: against the generic program");
        }
    }
}

/// Threads, tiles, the order of passes and an interrupted render change no bit.
#[test]
fn a_film_is_a_function_of_its_samples() {
    let scene = load("material-balls");
    let camera = scene.camera_or_default();
    let r = renderer(&scene, options(SamplerKind::SOBOL));
    let size = [23, 11];
    let on = |threads: usize, jobs: &[(u32, u32)]| {
        let mut film = Film::of_size(size);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            jobs.iter().for_each(|(sample, spp)| {
                render(&r, &camera, &mut film, Render { sample: *sample, spp: *spp, seed: 3 })
            })
        });
        film.mean()
    };
    let whole = on(1, &[(0, 21)]);
    assert_eq!(on(2, &[(0, 21)]).pixels, whole.pixels, "threads");
    assert_eq!(on(8, &[(0, 5), (5, 16)]).pixels, whole.pixels, "resumed");
    assert_eq!(on(2, &[(13, 8), (0, 13)]).pixels, whole.pixels, "in another order");
    let mut cut = Film::of_size(size);
    let tiles = renderer(
        &scene,
        Options { cut: jerboa_lib_render::host::renderer::Cut { tile: 5, slots: 64 }, ..options(SamplerKind::SOBOL) },
    );
    render(&tiles, &camera, &mut cut, Render { sample: 0, spp: 21, seed: 3 });
    assert_eq!(cut.mean().pixels, whole.pixels, "tiles");
}

/// A constant of the scrambling is in no residual, but where Sobol points are asked for.
#[test]
fn nothing_of_it_is_where_it_is_not_asked_for() {
    let constant = format!("{}u", 0x3d20_adea);
    for (name, known) in [
        ("cornell-box", Known::Nothing),
        ("cornell-box", Known::Structure),
        ("material-balls", Known::Structure),
        ("many-lights", Known::Structure),
    ] {
        let scene = load(name);
        let count = |sampler| {
            let tables = Tables::new(&scene, &Choices { sampler, ..Choices::default() }, known);
            let requests = DeviceKind::CPU.map(|device| device.requests(&tables, TracerKind::Path)).concat();
            let text = |request| print(&residual(&tables, request, Keep::default()).expect("specialised").program);
            requests.iter().map(|request| text(request).matches(&constant).count()).sum::<usize>()
        };
        assert_eq!(count(SamplerKind::Independent), 0, "{name}, {known:?}");
        assert!(count(SamplerKind::SOBOL) > 0, "{name}, {known:?}: the constant is not found where it should be");
    }
}
