//! Does a render know its own error? The estimates of [`jerboa_lib_render::host::variance`] against errors that are measured:
//! K independent renders of a scene, compared with each other and with a long render of another seed.
//!
//! `JERBOA_RENDERS` renders, 16 otherwise, of `JERBOA_SAMPLES` samples, 64 otherwise; seeds are 1 to K, and 1000 for the long
//! render. Windows of so many matched scenes as `JERBOA_MATCHED` says, 1 otherwise, are compared with their references.
//! `tests/runs/noise.txt` has runs.

use jerboa_lib_render::host::compare::mean_image;
use jerboa_lib_render::host::film::{Film, Window};
use jerboa_lib_render::host::image_io::{Image, luminance};
use jerboa_lib_render::host::renderer::{Handle, Options, Render, Renderer};
use jerboa_lib_render::host::tables::Choices;
use jerboa_lib_render::host::variance::{relative_error, variance};
use jerboa_scenes::Scene;
use jerboa_tests::harness::bench::number;
use jerboa_tests::harness::stats;
use jerboa_tests::sources::shared_scenes;

/// Scenes of all kinds of noise: lamps, lamps behind glass, many lamps, environments, caustics, textures.
const SCENES: [&str; 6] = ["cornell-box", "material-balls", "many-lights", "glass", "layered", "environment"];

const SIZE: [u32; 2] = [32, 24];
const WHOLE: Window = Window { x: 0, y: 0, width: SIZE[0], height: SIZE[1] };

fn film(renderer: &Renderer, scene: &Scene, spp: u32, seed: u32) -> Film {
    rendered(renderer, scene, Film::try_grouped(SIZE, WHOLE).expect("memory"), spp, seed)
}

fn rendered(renderer: &Renderer, scene: &Scene, mut film: Film, spp: u32, seed: u32) -> Film {
    let job = Render { sample: 0, spp, seed };
    renderer
        .render_with(&scene.camera_or_default(), &mut film, job, &Handle::default())
        .unwrap_or_else(|e| panic!("{e}"));
    film
}

/// Mean over pixels and channels of `error`(pixel, channel) over the reference squared, as the estimate has it.
fn relative(reference: &Image, error: impl Fn(usize, usize) -> f64) -> f64 {
    let area = reference.pixels.len();
    let eps = (0.1 * reference.pixels.iter().map(|p| luminance(*p)).sum::<f64>() / area as f64).powi(2);
    let square = |i: usize, c: usize| f64::from(reference.pixels[i][c]).powi(2) + eps;
    (0..3 * area).map(|at| (at / 3, at % 3)).map(|(i, c)| error(i, c) / square(i, c)).sum::<f64>() / (3 * area) as f64
}

#[test]
fn the_estimated_error_is_the_measured_one() {
    let renders = number("JERBOA_RENDERS", 16) as u32;
    let spp = number("JERBOA_SAMPLES", 64) as u32;
    for name in SCENES {
        let scene = Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{e}"));
        let renderer = Renderer::new(&scene, Options::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
        let long = film(&renderer, &scene, 2048, 1000).mean();
        let films: Vec<Film> = (1..=renders).map(|seed| film(&renderer, &scene, spp, seed)).collect();
        let images: Vec<Image> = films.iter().map(Film::mean).collect();
        // Without bias, whatever the long render is: variances of pixels, against those between the renders.
        let mean = mean_image(&images);
        let off = |image: &Image, i: usize, c: usize| f64::from(image.pixels[i][c]) - f64::from(mean.pixels[i][c]);
        let errors: Vec<f64> = images
            .iter()
            .map(|image| relative(&long, |i, c| off(image, i, c).powi(2)) * f64::from(renders) / f64::from(renders - 1))
            .collect();
        let (measured, of_measured) = stats::mean(errors.iter().copied());
        let told: Vec<f64> = films
            .iter()
            .map(|film| {
                let variance = variance(film);
                relative(&long, |i, c| variance.pixels[i][c].into())
            })
            .collect();
        let (unbiased, of_unbiased) = stats::mean(told.iter().copied());
        let error = of_measured.hypot(of_unbiased);
        let (estimated, of_estimated) = stats::mean(films.iter().map(relative_error));
        println!(
            "{name}, {spp} spp: measured {measured:.3e} ± {of_measured:.0e}, by variance {unbiased:.3e} ± {of_unbiased:.0e}, estimated {estimated:.3e} ± {of_estimated:.0e}, ratio {:.3}",
            estimated / measured
        );
        assert!((unbiased - measured).abs() <= 4.0 * error, "{name}, {spp} spp");
        // With fewer samples what is rare is not known yet.
        if spp >= 64 {
            assert!((0.8..1.2).contains(&(estimated / measured)), "{name}, {spp} spp");
        }
    }
}

/// The matched scenes.
const MATCHED: [&str; 8] = [
    "cornell-box",
    "kitchen",
    "living-room",
    "staircase",
    "coffee-maker",
    "bedroom",
    "bathroom-contemporary",
    "breakfast-room",
];

/// The middle third of each side of an image.
fn middle(image: &Image) -> Window {
    let (width, height) = (image.width / 3, image.height / 3);
    Window { x: width, y: height, width, height }
}

/// The pixels of an image in a window.
fn cut(image: &Image, window: Window) -> Image {
    let at = |x: u32, y: u32| image.pixels[((window.y + y) * image.width + window.x + x) as usize];
    Image::from_fn(window.width, window.height, at)
}

#[test]
fn references_confirm_the_estimated_error() {
    let Some(shared) = shared_scenes() else { return };
    for name in MATCHED.into_iter().take(number("JERBOA_MATCHED", 1)) {
        let file = |suffix: &str| shared.join(name).join(format!("{name}.{suffix}"));
        let image = |suffix: &str| Image::read(&file(suffix)).unwrap_or_else(|e| panic!("{e}"));
        let (reference, of_reference) = (image("ref.exr"), image("ref-var.exr"));
        let (size, window) = ([reference.width, reference.height], middle(&reference));
        let (right, noise) = (cut(&reference, window), cut(&of_reference, window));
        let scene = Scene::load(file("matched.glb")).unwrap_or_else(|e| panic!("{e}"));
        let choices =
            Choices { max_depth: Some(16), consistent_normals: false, ray_offset: 8.94e-5, ..Choices::default() };
        let renderer =
            Renderer::new(&scene, Options { choices, ..Options::default() }).unwrap_or_else(|e| panic!("{name}: {e}"));
        for spp in [16, 64] {
            let empty = || Film::try_grouped(size, window).expect("memory");
            let films: Vec<Film> = (1..=4).map(|seed| rendered(&renderer, &scene, empty(), spp, seed)).collect();
            let (measured, of_measured) = stats::mean(films.iter().map(|film| {
                let mean = film.mean();
                let off = |i: usize, c: usize| f64::from(mean.pixels[i][c]) - f64::from(right.pixels[i][c]);
                relative(&right, |i, c| off(i, c).powi(2) - f64::from(noise.pixels[i][c]))
            }));
            let (estimated, of_estimated) = stats::mean(films.iter().map(relative_error));
            println!(
                "{name}, {spp} spp: measured {measured:.3e} ± {of_measured:.0e}, estimated {estimated:.3e} ± {of_estimated:.0e}, ratio {:.3}",
                estimated / measured
            );
            assert!(name != "cornell-box" || (0.7..1.3).contains(&(estimated / measured)), "{spp} spp");
        }
    }
}
