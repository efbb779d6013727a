//! The gallery of hard cases: how fast a scene renders, and how far the picture is from what is right.
//!
//! A scene is rendered in [`BATCHES`] batches of samples. For a pixel p with batch means of variance s_p² the variance of the
//! mean over N pixels is Σ s_p² / ([`BATCHES`] N²), since pixels are independent; so even a few samples per pixel tell the
//! standard error well, except where most of the light comes by rare samples. The error is stated in standard errors, those
//! of the reference included, with [`ROUNDING`] of the reference granted as one more for what single precision rounds. A
//! scene passes if it is at most [`MOST_SIGMAS`] off, no sample was dropped and no pixel is not a number. By chance a right
//! renderer fails a scene in one of 16,000 trials with another seed.

use std::time::Duration;

use jerboa_scenes::builtin::Reference;
use jerboa_scenes::{Camera, Scene};

use super::error::Error;
use super::film::Film;
use super::image_io::{Image, luminance};
use super::renderer::{Handle, Options, Render, Renderer, Stats};

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

/// Renders a scene with `spp` samples per pixel, rounded up to a multiple of [`BATCHES`].
///
/// # Errors
/// As [`Renderer::new`] and [`Renderer::render_with`].
pub fn measure(scene: &Scene, reference: &Reference, spp: u32, seed: u32) -> Result<Outcome, Error> {
    let camera = scene.camera_or_default();
    let renderer = Renderer::new(scene, Options { seed, ..Options::default() })?;
    let size = film_size(&camera);
    let batch_spp = spp.div_ceil(BATCHES);
    let (mut film, mut batches) = (Film::of_size(size), Vec::new());
    let (mut rays, mut time) = (0, Duration::ZERO);
    for batch in 0..BATCHES {
        let mut part = Film::of_size(size);
        let job = Render { sample: batch * batch_spp, spp: batch_spp, seed };
        let Stats { closest_rays, shadow_rays, time: spent, .. } =
            renderer.render_with(&camera, &mut part, job, &Handle::default())?;
        rays += closest_rays + shadow_rays;
        time += spent;
        film.merge(&part)?;
        batches.push(part.mean());
    }
    let picture = film.mean();
    let (mean, standard_error) = estimate(&batches);
    let off = mean - reference.mean;
    Ok(Outcome {
        mean,
        standard_error,
        sigmas: sigmas(off, standard_error, reference),
        relative: if reference.mean == 0.0 { off } else { off / reference.mean },
        samples: u64::from(BATCHES * batch_spp) * picture.pixels.len() as u64,
        rays,
        time,
        dropped: film.dropped(),
        non_finite: picture.pixels.iter().filter(|p| !p.iter().all(|c| c.is_finite())).count(),
        picture,
    })
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
