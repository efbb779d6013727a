//! A renderer in this process: used from several threads, ended early, watched, its renders put together.

use std::sync::atomic::{AtomicBool, Ordering};

use jerboa_lib_render::host::film::{Film, Window};
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::renderer::{Handle, Options, Render, Renderer, Stats};
use jerboa_lib_render::host::tables::Choices;
use jerboa_scenes::{Camera, Scene};

/// Size of the films, no multiple of a tile.
const SIZE: [u32; 2] = [37, 21];

const WHOLE: Window = Window { x: 0, y: 0, width: SIZE[0], height: SIZE[1] };

fn load(name: &str) -> (Renderer, Camera) {
    let scene = Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{e}"));
    let camera = scene.camera_or_default();
    (Renderer::new(&scene, Options::default()).unwrap_or_else(|e| panic!("{name}: {e}")), camera)
}

fn job(sample: u32, spp: u32, seed: u32) -> Render {
    Render { sample, spp, seed }
}

fn film(renderer: &Renderer, camera: &Camera, window: Window, job: Render) -> (Film, Stats) {
    let mut film = Film::crop(SIZE, window);
    let stats = renderer.render_with(camera, &mut film, job, &Handle::default()).unwrap_or_else(|e| panic!("{e}"));
    (film, stats)
}

#[test]
fn a_renderer_can_be_shared_by_threads() {
    fn shared<T: Send + Sync>() {}
    shared::<Renderer>();
    shared::<Handle>();

    let (renderer, camera) = load("cornell-box");
    let alone = [0, 1, 2].map(|seed| film(&renderer, &camera, WHOLE, job(0, 3, seed)).0);
    let together = std::thread::scope(|scope| {
        let start = |seed| {
            let (renderer, camera) = (&renderer, &camera);
            scope.spawn(move || film(renderer, camera, WHOLE, job(0, 3, seed)).0)
        };
        [0, 1, 2].map(start).map(|thread| thread.join().expect("it renders"))
    });
    assert!(alone == together);
}

#[test]
fn ranges_of_samples_add_up_to_the_whole() {
    let (renderer, camera) = load("material-balls");
    let (whole, stats) = film(&renderer, &camera, WHOLE, job(0, 40, 5));
    let mut sum = Film::new(WHOLE);
    let mut rays = 0;
    for (sample, spp) in [(20, 20), (0, 3), (3, 17)] {
        let (part, stats) = film(&renderer, &camera, WHOLE, job(sample, spp, 5));
        rays += stats.closest_rays;
        sum.merge(&part).expect("the same window");
    }
    assert!(sum == whole);
    assert_eq!((rays, stats.spp), (stats.closest_rays, 40));
    // Rendering twice into one film is the same as merging.
    let mut twice = Film::new(WHOLE);
    for sample in [20, 0] {
        let job = job(sample, 20, 5);
        renderer.render_with(&camera, &mut twice, job, &Handle::default()).unwrap_or_else(|e| panic!("{e}"));
    }
    assert!(twice == whole);
}

#[test]
fn rendering_again_goes_on() {
    let scene = Scene::load("builtin:cornell-box").unwrap_or_else(|e| panic!("{e}"));
    let options = Options { spp: 3, seed: 9, ..Options::default() };
    let renderer = Renderer::new(&scene, options).unwrap_or_else(|e| panic!("{e}"));
    let camera = scene.camera_or_default();
    let mut twice = Film::of_size(SIZE);
    for _ in 0..2 {
        renderer.render(&camera, &mut twice).unwrap_or_else(|e| panic!("{e}"));
    }
    assert_eq!(twice.next_sample(), 6);
    assert!(twice == film(&renderer, &camera, WHOLE, job(0, 6, 9)).0);
}

#[test]
fn neither_windows_nor_threads_change_a_bit() {
    let (renderer, camera) = load("alpha");
    let (whole, _) = film(&renderer, &camera, WHOLE, job(0, 4, 1));
    let mut windows = Film::new(WHOLE);
    for (x, y, width, height) in [(0, 0, 37, 5), (0, 5, 20, 16), (20, 5, 17, 16)] {
        windows
            .merge(&film(&renderer, &camera, Window { x, y, width, height }, job(0, 4, 1)).0)
            .expect("it lies within");
    }
    assert!(windows == whole);
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        assert!(pool.install(|| film(&renderer, &camera, WHOLE, job(0, 4, 1)).0) == whole, "{threads} threads");
    }
}

#[test]
fn another_seed_gives_another_image_of_the_same_mean() {
    let (renderer, camera) = load("cornell-box");
    let images = [1, 2].map(|seed| film(&renderer, &camera, WHOLE, job(0, 64, seed)).0.mean());
    let differ = images[0].pixels.iter().zip(&images[1].pixels).filter(|(a, b)| a != b && a[0] > 0.0).count();
    assert!(differ > WHOLE.area() / 2, "{differ} pixels differ");
    let [a, b] = images.map(|i| i.pixels.iter().flatten().sum::<f32>());
    // Such a mean has a standard deviation of 3 % (of 19 seeds): four of the difference's.
    assert!((a / b - 1.0).abs() < 0.17, "{a} and {b}");
}

#[test]
fn a_handle_counts_samples() {
    let (renderer, camera) = load("cornell-box");
    let handle = Handle::default();
    let mut done = Film::new(WHOLE);
    let stats = renderer.render_with(&camera, &mut done, job(0, 21, 0), &handle).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(handle.samples_done(), WHOLE.area() as u64 * 21);
    assert_eq!((stats.spp, done.count([0, 0]), done.count([36, 20])), (21, 21, 21));
    assert!(stats.closest_rays >= handle.samples_done(), "{stats:?}");
    assert!(!handle.is_cancelled());
}

#[test]
fn a_cancelled_render_ends_with_whole_passes() {
    let (renderer, camera) = load("cornell-box");
    let (handle, ended) = (Handle::default(), AtomicBool::new(false));
    let mut done = Film::new(WHOLE);
    // So many samples would take hours.
    let stats = std::thread::scope(|scope| {
        scope.spawn(|| {
            while handle.samples_done() < 10 * WHOLE.area() as u64 && !ended.load(Ordering::Relaxed) {
                std::thread::yield_now();
            }
            handle.cancel();
        });
        let stats = renderer.render_with(&camera, &mut done, job(0, u32::MAX, 0), &handle);
        ended.store(true, Ordering::Relaxed);
        stats.unwrap_or_else(|e| panic!("{e}"))
    });
    let pixels = || (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y]));
    let counts: Vec<u32> = pixels().map(|p| done.count(p)).collect();
    let (least, most) = (*counts.iter().min().expect("pixels"), *counts.iter().max().expect("pixels"));
    assert!(stats.spp >= 1 && least == stats.spp && most - least <= 16, "{least} to {most} samples, {stats:?}");
    assert_eq!(counts.iter().map(|c| u64::from(*c)).sum::<u64>(), handle.samples_done());
    // What is there is what a render of so many samples has.
    let (same, _) = film(&renderer, &camera, WHOLE, job(0, least, 0));
    let mean = (done.mean(), same.mean());
    for (i, _) in counts.iter().enumerate().filter(|(_, count)| **count == least) {
        assert_eq!(mean.0.pixels[i], mean.1.pixels[i]);
    }
    // A handle that is cancelled before the render starts leaves the film empty.
    let mut empty = Film::new(WHOLE);
    let stats = renderer.render_with(&camera, &mut empty, job(0, 4, 0), &handle).unwrap_or_else(|e| panic!("{e}"));
    assert!((stats.spp, &empty) == (0, &Film::new(WHOLE)));
}

/// N22: roulette alone ends paths where nothing is absorbed and where light cannot get out, even when it is asked to begin
/// after the bound of long paths.
#[test]
fn paths_end_where_light_does_not() {
    for name in ["white-box", "facing-mirrors", "glass-trap"] {
        let scene = Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{e}"));
        for rr_depth in [3, u32::MAX] {
            let choices = Choices { rr_depth: Some(rr_depth), ..Choices::default() };
            let renderer =
                Renderer::new(&scene, Options { choices, ..Options::default() }).unwrap_or_else(|e| panic!("{e}"));
            let (film, stats) = film(&renderer, &scene.camera_or_default(), WHOLE, job(0, 2, 0));
            let mean = stats.closest_rays as f64 / (2 * WHOLE.area()) as f64;
            println!("{name}, roulette from {rr_depth}: {mean:.1} rays a path");
            assert!(mean <= 800.0, "{name}, roulette from {rr_depth}: {mean} rays a path");
            assert_eq!(film.dropped(), 0, "{name}");
        }
    }
}

#[test]
fn every_tracer_renders_an_empty_scene_black() {
    let scene = Scene::load("builtin:empty").unwrap_or_else(|e| panic!("{e}"));
    for tracer in TracerKind::ALL {
        let renderer =
            Renderer::new(&scene, Options { tracer, ..Options::default() }).unwrap_or_else(|e| panic!("{e}"));
        let image = film(&renderer, &scene.camera_or_default(), WHOLE, job(0, 1, 0)).0.mean();
        assert!(image.pixels.iter().all(|p| *p == [0.0; 3]), "{}: {:?}", tracer.kernel(), image.pixels[0]);
    }
}

#[test]
fn samples_beyond_their_numbers_are_an_error() {
    let (renderer, camera) = load("empty");
    let (job, handle) = (job(u32::MAX, 2, 0), Handle::default());
    let error = renderer.render_with(&camera, &mut Film::new(WHOLE), job, &handle).expect_err("there are 2^32");
    assert_eq!(error.to_string(), "2 samples from number 4294967295 on reach beyond 2^32: ask for fewer");
}
