//! The gallery of hard cases: how fast a scene renders, and how far the picture is from what is right.
//!
//! A scene is rendered in [`BATCHES`] batches of samples, each under a seed of its own, so that they are independent whatever the
//! sampler. For a pixel p with batch means of variance s_p² the variance of the
//! mean over N pixels is Σ s_p² / ([`BATCHES`] N²), since pixels are independent; so even a few samples per pixel tell the
//! standard error well, except where most of the light comes by rare samples. The error is stated in standard errors, those
//! of the reference included, with [`ROUNDING`] of the reference granted as one more for what single precision rounds. A
//! scene passes if it is at most [`MOST_SIGMAS`] off, no sample was dropped and no pixel is not a number. By chance a right
//! renderer fails a scene in one of 16,000 trials with another seed.
//!
//! Where what a naive renderer does instead is a choice of ours too ([`naive`]), both are rendered in turn, batch by batch: then
//! the medians of their times say what the remedy costs, and their errors what it buys.

use std::time::Duration;

use jerboa_scenes::builtin::Reference;
use jerboa_scenes::{Camera, Scene};

use super::error::Error;
use super::film::Film;
use super::image_io::{Image, luminance};
use super::renderer::{Handle, Options, Render, Renderer, Stats};
use super::tables::Choices;

/// Batches of samples, whose spread tells the standard error.
pub const BATCHES: u32 = 4;

/// Standard errors that a scene may be off.
pub const MOST_SIGMAS: f64 = 4.0;

/// Share of the reference that is granted as one standard error: 42 roundings to single precision, of paths that multiply
/// and add up dozens of numbers.
pub const ROUNDING: f64 = 2.5e-6;

/// Largest film, in pixels. The films of built-in scenes shrink to whole pixels in it.
pub const FILM: [u32; 2] = [144, 108];

/// What the render of a scene showed.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Mean luminance over the picture.
    pub mean: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// (mean − reference) in standard errors.
    pub sigmas: f64,
    /// (mean − reference) / reference; (mean − reference) where the reference is 0.
    pub relative: f64,
    /// Samples, over all pixels.
    pub samples: u64,
    /// Rays, shadow rays included.
    pub rays: u64,
    /// Time of rendering alone.
    pub time: Duration,
    /// The median of the times of the batches.
    pub batch_time: Duration,
    /// Samples that were not finite or out of the film's range.
    pub dropped: u64,
    /// Pixels with a channel that is not finite.
    pub non_finite: usize,
    /// The picture, linear RGB.
    pub picture: Image,
}

impl Outcome {
    /// Is all as it should be? (A NaN is not.)
    pub fn passes(&self) -> bool {
        self.sigmas.abs() <= MOST_SIGMAS && self.dropped == 0 && self.non_finite == 0
    }

    /// Samples per second of rendering.
    pub fn samples_per_second(&self) -> f64 {
        self.samples as f64 / self.time.as_secs_f64().max(f64::MIN_POSITIVE)
    }

    /// Rays per second of rendering.
    pub fn rays_per_second(&self) -> f64 {
        self.rays as f64 / self.time.as_secs_f64().max(f64::MIN_POSITIVE)
    }
}

/// What a naive renderer does in a scene of the gallery, where it takes no more than other words of `jerboa render`: these words,
/// and the choices that they stand for; all else as in `all`.
pub fn naive(scene: &str, all: Choices) -> Option<(&'static str, Choices)> {
    Some(match scene {
        "tiny" => ("--ray-offset 0.001", Choices { ray_offset: 1e-3, ..all }),
        "closed-box-80" | "facing-mirrors" | "glass-trap" => ("--max-depth 8", Choices { max_depth: Some(8), ..all }),
        "closed-box-90" => ("--rr-depth 1 --rr-cap 0.75", Choices { rr_depth: Some(1), rr_cap: 0.75, ..all }),
        "closed-box-95" => (
            "--rr-depth 1 --rr-cap 0.75 --max-depth 64",
            Choices { rr_depth: Some(1), rr_cap: 0.75, max_depth: Some(64), ..all },
        ),
        "closed-box-99" => ("--rr-cap 0.95", Choices { rr_cap: 0.95, ..all }),
        "white-box" => ("--max-depth 64", Choices { max_depth: Some(64), ..all }),
        _ => return None,
    })
}

/// Renders a scene with `spp` samples per pixel, rounded up to a multiple of [`BATCHES`]: batch by batch, by each of these choices in
/// turn.
///
/// # Errors
/// As [`Renderer::new`] and [`Renderer::render_with`].
pub fn measure<const N: usize>(
    scene: &Scene,
    reference: &Reference,
    spp: u32,
    seed: u32,
    choices: [Choices; N],
) -> Result<[Outcome; N], Error> {
    let camera = scene.camera_or_default();
    let size = film_size(&camera);
    let batch_spp = spp.div_ceil(BATCHES);
    let run = |choices| {
        let renderer = Renderer::new(scene, Options { seed, choices, ..Options::default() })?;
        Ok(Run { renderer, film: Film::of_size(size), batches: Vec::new(), rays: 0, times: Vec::new() })
    };
    let mut runs = choices.into_iter().map(run).collect::<Result<Vec<Run>, Error>>()?;
    for batch in 0..BATCHES {
        for run in &mut runs {
            // Told apart by the highest bits, which nobody uses who counts seeds from 0.
            let seed = seed ^ batch << (u32::BITS - BATCHES.ilog2());
            run.batch(&camera, Render { sample: 0, spp: batch_spp, seed })?;
        }
    }
    let samples = u64::from(BATCHES * batch_spp) * u64::from(size[0]) * u64::from(size[1]);
    let outcomes = runs.into_iter().map(|run| run.outcome(reference, samples)).collect::<Vec<_>>();
    Ok(outcomes.try_into().expect("there is one for each of the choices"))
}

/// Batches by one of the choices.
struct Run {
    renderer: Renderer,
    film: Film,
    batches: Vec<Image>,
    rays: u64,
    times: Vec<Duration>,
}

impl Run {
    /// Renders one more.
    fn batch(&mut self, camera: &Camera, job: Render) -> Result<(), Error> {
        let mut part = Film::of_size(film_size(camera));
        let Stats { closest_rays, shadow_rays, time, .. } =
            self.renderer.render_with(camera, &mut part, job, &Handle::default())?;
        self.rays += closest_rays + shadow_rays;
        self.times.push(time);
        self.film.merge(&part)?;
        self.batches.push(part.mean());
        Ok(())
    }

    /// What all of them showed.
    fn outcome(mut self, reference: &Reference, samples: u64) -> Outcome {
        let picture = self.film.mean();
        let (mean, standard_error) = estimate(&self.batches);
        let off = mean - reference.mean;
        self.times.sort_unstable();
        let middle = self.times.len() / 2;
        Outcome {
            mean,
            standard_error,
            sigmas: sigmas(off, standard_error, reference),
            relative: if reference.mean == 0.0 { off } else { off / reference.mean },
            samples,
            rays: self.rays,
            time: self.times.iter().sum(),
            batch_time: (self.times[(self.times.len() - 1) / 2] + self.times[middle]) / 2,
            dropped: self.film.dropped(),
            non_finite: picture.pixels.iter().filter(|p| !p.iter().all(|c| c.is_finite())).count(),
            picture,
        }
    }
}

/// The largest film within [`FILM`] that has the camera's aspect.
fn film_size(camera: &Camera) -> [u32; 2] {
    let (width, height) = camera.film_or_default();
    let [width, height] = [width, height].map(f64::from);
    let scale = (f64::from(FILM[0]) / width).min(f64::from(FILM[1]) / height);
    [width, height].map(|side| (side * scale).round().max(1.0) as u32)
}

/// Mean luminance of pictures of independent pixels, and its standard error.
fn estimate(batches: &[Image]) -> (f64, f64) {
    let (count, pixels) = (batches.len() as f64, batches[0].pixels.len());
    let (mut sum, mut variance) = (0.0, 0.0);
    for p in 0..pixels {
        let values = batches.iter().map(|b| luminance(b.pixels[p]));
        let mean = values.clone().sum::<f64>() / count;
        sum += mean;
        variance += values.map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0) / count;
    }
    (sum / pixels as f64, variance.sqrt() / pixels as f64)
}

/// The difference in standard errors; infinite where there is one without any spread.
fn sigmas(off: f64, standard_error: f64, reference: &Reference) -> f64 {
    let rounding = ROUNDING * reference.mean;
    let squared = standard_error.powi(2) + reference.standard_error.powi(2) + rounding.powi(2);
    if off == 0.0 { 0.0 } else { off / squared.sqrt() }
}

#[cfg(test)]
mod tests {
    use jerboa_scenes::builtin::{Source, gallery};

    use super::*;

    fn reference(mean: f64, standard_error: f64) -> Reference {
        Reference { mean, standard_error, source: Source::ClosedForm }
    }

    #[test]
    fn the_error_of_the_mean_comes_from_the_spread_of_the_batches() {
        let picture = |a: f32, b: f32| Image { width: 2, height: 1, pixels: vec![[a; 3], [b; 3]] };
        // Variances 2 and 0 of the batches, so 1 and 0 of the means, and 1/4 of the mean over two pixels.
        let (mean, error) = estimate(&[picture(1.0, 5.0), picture(3.0, 5.0)]);
        assert!((mean - 3.5).abs() < 1e-12 && (error - 0.5).abs() < 1e-12, "{mean} ± {error}");
    }

    #[test]
    fn errors_count_in_standard_errors() {
        assert!((sigmas(0.5, 0.3, &reference(1.0, 0.4)) - 1.0).abs() < 1e-6);
        assert!((sigmas(1e-5, 0.0, &reference(1.0, 0.0)) - 4.0).abs() < 1e-9);
        assert_eq!(sigmas(0.0, 0.0, &reference(0.0, 0.0)), 0.0);
        assert_eq!(sigmas(1e-30, 0.0, &reference(0.0, 0.0)), f64::INFINITY);
    }

    /// A name that the gallery has no more would be measured against nothing.
    #[test]
    fn what_is_naive_belongs_to_the_gallery() {
        let all = Choices::default();
        let with_words = gallery().filter_map(|(b, _)| naive(b.name, all)).count();
        assert_eq!(with_words, 8);
        assert!(gallery().filter_map(|(b, _)| naive(b.name, all)).all(|(_, choices)| choices != all));
    }

    /// A reference is a mean over a picture of one shape.
    #[test]
    fn films_keep_the_aspect_exactly() {
        for (builtin, _) in gallery() {
            let camera =
                Scene::load(format!("builtin:{}", builtin.name)).expect("a built-in loads").camera_or_default();
            let (width, height) = camera.film_or_default();
            let [w, h] = film_size(&camera);
            assert_eq!(w * height, h * width, "{}: {w}x{h} for {width}x{height}", builtin.name);
            assert!(w == FILM[0] || h == FILM[1], "{}: {w}x{h}", builtin.name);
        }
    }
}
