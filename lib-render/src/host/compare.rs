//! How far images are from a reference, and whether noise explains it.
//!
//! Let A be the mean of K images, R the reference and v the reference's variance of the mean (per pixel and channel, 0
//! where not given). Over all pixels and channels, in linear RGB without clamping (accuracy.md, section 3):
//!
//! * RMSE = sqrt(mean((A - R)² - v)),
//! * relMSE = mean(((A - R)² - v) / (R² + eps)), eps = [`REL_MSE_EPSILON`].
//!
//! Subtracting v removes what the reference's own noise adds to the square; a negative mean is reported as 0.
//!
//! *T13* asks whether independent renders agree with the reference (accuracy.md, amendments). In luminance, over all
//! whole blocks of 15x15 pixels,
//!
//! > z_b = (mean_b - ref_b) / sqrt(s_b²/K + refvar_b + (1e-4·ref_b)²),
//!
//! s_b² being the variance over the K renders *of the block mean*: blocks, because a pixel of a path tracer is far too
//! skewed for its z to follow Student's t. The test passes if at most 3 % of the blocks lie beyond the two-sided 1 %
//! quantile of t(K - 1), the rms of z lies in [0.85, 1.25], no |z| exceeds 8, and the image means differ by no more
//! than four standard errors or 5e-4 of the reference's.

use super::error::Error;
use super::image_io::{Image, luminance};
use super::student::two_sided_quantile;

/// The eps of relMSE: accuracy.md, section 3, chosen there because public tools print figures with it.
pub const REL_MSE_EPSILON: f64 = 0.01;
/// Side of T13's blocks in pixels: there a correct tracer's rms z was .97 to 1.06, per pixel up to 2.9 (accuracy.md, T13).
pub const BLOCK: u32 = 15;
/// Renders that T13 needs at least.
pub const T13_MIN_RENDERS: usize = 16;
/// Largest share of blocks beyond the 1 % quantile: 1 % are expected, 3 % leave room for neighbours that vary together.
const MAX_SHARE_BEYOND: f64 = 0.03;
/// Range of rms z: .97 to 1.06 were measured on correct renders.
const RMS_Z: std::ops::RangeInclusive<f64> = 0.85..=1.25;
/// Largest |z| of a block.
const MAX_Z: f64 = 8.0;
/// The image mean may differ by this many standard errors ...
const MEAN_SIGMAS: f64 = 4.0;
/// ... or by this share of the reference's mean, which is what rounding in the files may cost.
const MEAN_RELATIVE: f64 = 5e-4;
/// Share of a block's reference value that is granted to it as a standard error, for the same reason.
const BLOCK_RELATIVE: f64 = 1e-4;

/// The figures of one comparison; the field names are the keys of `jerboa compare --json`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Root of the mean squared error of the mean image.
    pub rmse: f64,
    /// Mean squared error relative to the squared reference plus [`REL_MSE_EPSILON`].
    pub relmse: f64,
    /// (mean A - mean R) / SE in luminance, SE from the spread of the renders and `v`; `None` for a single render.
    pub mean_sigmas: Option<f64>,
    /// The block test; `None` with fewer than [`T13_MIN_RENDERS`] renders.
    pub t13: Option<T13>,
}

/// The result of T13.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct T13 {
    /// Root mean square of z over the blocks.
    pub rms_z: f64,
    /// Share of blocks (0 to 1) with |z| beyond the two-sided 1 % quantile.
    pub blocks_beyond: f64,
    /// Largest |z|.
    pub max_z: f64,
    /// (mean A - mean R) / SE of the whole image.
    pub mean_sigmas: f64,
    /// Whether all four conditions hold.
    pub pass: bool,
}

/// Compares the mean of `renders` with `reference`.
///
/// `reference_variance` is the variance of the reference's mean, per pixel and channel.
///
/// # Errors
/// If there is no render, or the images differ in size, or there is not one whole block for T13.
pub fn compare(renders: &[Image], reference: &Image, reference_variance: Option<&Image>) -> Result<Comparison, Error> {
    check_sizes(renders, reference, reference_variance)?;
    let mean = mean_image(renders);
    let [mse, relmse] = squared_errors(&mean, reference, reference_variance);
    let image = Estimate::of(renders, reference, reference_variance, 0, 0, reference.width, reference.height);
    let enough = renders.len() >= T13_MIN_RENDERS;
    Ok(Comparison {
        rmse: mse.sqrt(),
        relmse,
        mean_sigmas: (renders.len() > 1).then(|| image.sigmas(0.0)),
        t13: if enough { Some(t13(renders, reference, reference_variance, image)?) } else { None },
    })
}

/// The mean of images of one size.
pub fn mean_image(images: &[Image]) -> Image {
    let pixel = |i: usize| [0, 1, 2].map(|c| images.iter().map(|a| f64::from(a.pixels[i][c])).sum::<f64>());
    let mean = |i: usize| pixel(i).map(|sum| (sum / images.len() as f64) as f32);
    Image { pixels: (0..images[0].pixels.len()).map(mean).collect(), ..images[0] }
}

/// A picture of where `a` differs from `reference`: red where it is brighter, blue where it is darker.
///
/// The colour is full (1) where the luminances differ by a tenth of the reference's, or by 0.01 in the dark.
pub fn difference_picture(a: &Image, reference: &Image) -> Image {
    let paint = |(a, r): (&[f32; 3], &[f32; 3])| {
        let r = luminance(*r);
        let tenths = ((luminance(*a) - r) / (0.1 * r.abs()).max(0.01)) as f32;
        [tenths.max(0.0), 0.0, (-tenths).max(0.0)]
    };
    Image { pixels: a.pixels.iter().zip(&reference.pixels).map(paint).collect(), ..*a }
}

fn check_sizes(renders: &[Image], reference: &Image, variance: Option<&Image>) -> Result<(), Error> {
    if renders.is_empty() {
        return Err(Error::new("compare needs at least one image beside the reference"));
    }
    let named = renders.iter().enumerate().map(|(i, image)| (format!("image {}", i + 1), image));
    for (name, image) in named.chain(variance.map(|v| ("the variance".into(), v))) {
        if (image.width, image.height) != (reference.width, reference.height) {
            return Err(Error::new(format!(
                "{name} has {}x{} pixels, the reference {}x{}; render at the reference's size",
                image.width, image.height, reference.width, reference.height
            )));
        }
    }
    Ok(())
}

/// Mean squared error and relMSE over pixels and channels, without the reference's variance, and not below 0.
fn squared_errors(mean: &Image, reference: &Image, variance: Option<&Image>) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for (i, (a, r)) in mean.pixels.iter().zip(&reference.pixels).enumerate() {
        for c in 0..3 {
            let (a, r) = (f64::from(a[c]), f64::from(r[c]));
            let error = (a - r).powi(2) - variance.map_or(0.0, |v| f64::from(v.pixels[i][c]));
            sums[0] += error;
            sums[1] += error / (r * r + REL_MSE_EPSILON);
        }
    }
    sums.map(|sum| (sum / (3 * reference.pixels.len()) as f64).max(0.0))
}

/// Mean luminance of a rectangle, in the renders and in the reference.
#[derive(Clone, Copy)]
struct Estimate {
    mean: f64,
    /// Variance of `mean`: the spread of the renders' rectangle means, divided by K.
    variance: f64,
    reference: f64,
    /// Variance of `reference`.
    reference_variance: f64,
}

impl Estimate {
    fn of(
        renders: &[Image],
        reference: &Image,
        variance: Option<&Image>,
        x: u32,
        y: u32,
        width: u32,
        height: u32,
    ) -> Estimate {
        let rows = || (y..y + height).map(|row| row as usize * reference.width as usize + x as usize);
        let area = f64::from(width) * f64::from(height);
        let sum = |image: &Image, of: fn([f32; 3]) -> f64| -> f64 {
            rows().flat_map(|start| &image.pixels[start..start + width as usize]).map(|p| of(*p)).sum()
        };
        let means = renders.iter().map(|image| sum(image, luminance) / area).collect::<Vec<_>>();
        let k = means.len() as f64;
        let mean = means.iter().sum::<f64>() / k;
        let spread = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>();
        Estimate {
            mean,
            variance: spread / ((k - 1.0).max(1.0) * k),
            reference: sum(reference, luminance) / area,
            reference_variance: variance.map_or(0.0, |v| sum(v, luminance_variance)) / (area * area),
        }
    }

    /// The difference in standard errors, `relative`·reference being granted as one more standard error.
    fn sigmas(&self, relative: f64) -> f64 {
        let difference = self.mean - self.reference;
        let squared = self.variance + self.reference_variance + (relative * self.reference).powi(2);
        // Equal values without any spread agree; 0/0 would say nothing.
        if difference == 0.0 { 0.0 } else { difference / squared.sqrt() }
    }
}

/// Variance of the luminance, given the variance of each channel.
///
/// The channels of a path's contribution rise and fall together, so standard deviations add, which is the upper bound.
fn luminance_variance(variance: [f32; 3]) -> f64 {
    luminance(variance.map(|v| v.max(0.0).sqrt())).powi(2)
}

fn t13(renders: &[Image], reference: &Image, variance: Option<&Image>, image: Estimate) -> Result<T13, Error> {
    let (columns, rows) = (reference.width / BLOCK, reference.height / BLOCK);
    if columns == 0 || rows == 0 {
        return Err(Error::new(format!("the block test needs images of at least {BLOCK}x{BLOCK} pixels")));
    }
    let blocks = (0..rows).flat_map(|row| (0..columns).map(move |column| (column * BLOCK, row * BLOCK)));
    let z = blocks
        .map(|(x, y)| Estimate::of(renders, reference, variance, x, y, BLOCK, BLOCK).sigmas(BLOCK_RELATIVE))
        .collect::<Vec<_>>();
    let quantile = two_sided_quantile(renders.len() as u32 - 1, 0.99);
    let count = z.len() as f64;
    let rms_z = (z.iter().map(|z| z * z).sum::<f64>() / count).sqrt();
    // A NaN is beyond everything: written so that it fails each condition.
    let blocks_beyond = z.iter().filter(|z| z.is_nan() || z.abs() > quantile).count() as f64 / count;
    let max_z = z.iter().map(|z| z.abs()).fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a });
    let mean_sigmas = image.sigmas(0.0);
    let mean_agrees = mean_sigmas.abs() <= MEAN_SIGMAS
        || (image.mean - image.reference).abs() <= MEAN_RELATIVE * image.reference.abs();
    let pass = blocks_beyond <= MAX_SHARE_BEYOND && RMS_Z.contains(&rms_z) && max_z <= MAX_Z && mean_agrees;
    Ok(T13 { rms_z, blocks_beyond, max_z, mean_sigmas, pass })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::random::Random;

    const WIDTH: u32 = 150;
    const HEIGHT: u32 = 105;
    const SEED: u64 = 0x6a65_7262_6f61;

    /// The true picture: a smooth gradient under stripes of eight pixels.
    fn truth(x: u32, y: u32) -> f64 {
        let stripe = if (x / 8).is_multiple_of(2) { 1.0 } else { 0.3 };
        stripe * (0.2 + f64::from(y) / f64::from(HEIGHT))
    }

    /// A skewed, unbiased estimate of `picture`: each pixel is exponentially distributed around it, mean of 16.
    fn render(random: &mut Random, picture: impl Fn(u32, u32) -> f64) -> Image {
        Image::from_fn(WIDTH, HEIGHT, |x, y| {
            let mean = (0..16).map(|_| -(1.0 - random.uniform()).ln()).sum::<f64>() / 16.0;
            [(picture(x, y) * mean) as f32; 3]
        })
    }

    fn test(picture: impl Fn(u32, u32) -> f64) -> T13 {
        println!("seed {SEED:#x}");
        let mut random = Random(SEED);
        let renders = (0..16).map(|_| render(&mut random, &picture)).collect::<Vec<_>>();
        let reference = Image::from_fn(WIDTH, HEIGHT, |x, y| [truth(x, y) as f32; 3]);
        let result = compare(&renders, &reference, None).unwrap().t13.unwrap();
        println!("{result:?}");
        result
    }

    #[test]
    fn t13_passes_a_correct_sampler() {
        assert!(test(truth).pass);
    }

    #[test]
    fn t13_is_red_on_two_percent_darker() {
        let result = test(|x, y| 0.98 * truth(x, y));
        assert!(!result.pass && result.mean_sigmas < -4.0);
    }

    #[test]
    fn t13_is_red_on_one_pixel_shifted() {
        assert!(!test(|x, y| truth(x + 1, y)).pass);
    }

    #[test]
    fn t13_is_red_on_a_nan() {
        assert!(!test(|x, y| if (x, y) == (20, 20) { f64::NAN } else { truth(x, y) }).pass);
    }

    #[test]
    fn t13_counts_the_references_own_noise() {
        let mut random = Random(SEED);
        println!("seed {SEED:#x}");
        let renders = (0..16).map(|_| render(&mut random, truth)).collect::<Vec<_>>();
        let reference = render(&mut random, truth);
        // An exponential variable's variance is its mean squared; the mean of 16 has a sixteenth of it.
        let variance = Image::from_fn(WIDTH, HEIGHT, |x, y| [(truth(x, y).powi(2) / 16.0) as f32; 3]);
        let with = compare(&renders, &reference, Some(&variance)).unwrap();
        assert!(with.t13.unwrap().pass);
        let without = compare(&renders, &reference, None).unwrap();
        assert!(!without.t13.unwrap().pass);
        // What is left of the error is the renders' own: truth²/16/16.
        let own = (0..WIDTH * HEIGHT).map(|i| truth(i % WIDTH, i / WIDTH).powi(2) / 256.0).sum::<f64>();
        let own = (own / f64::from(WIDTH * HEIGHT)).sqrt();
        assert!((with.rmse / own - 1.0).abs() < 0.2 && without.rmse > 3.0 * own);
    }

    #[test]
    fn the_figures_are_those_of_their_formulas() {
        let flat = |value: f32| Image { width: 2, height: 1, pixels: vec![[value; 3]; 2] };
        let one = compare(&[flat(1.5)], &flat(1.0), Some(&flat(0.05))).unwrap();
        assert!((one.rmse - 0.2_f64.sqrt()).abs() < 1e-7 && (one.relmse - 0.2 / 1.01).abs() < 1e-7);
        assert_eq!((one.mean_sigmas, one.t13), (None, None));
        // Means 1 and 2: spread 1/2, variance of the mean 1/4, so 1.5 lies 1 standard error above 1.
        let two = compare(&[flat(1.0), flat(2.0)], &flat(1.0), None).unwrap();
        assert!((two.mean_sigmas.unwrap() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn unequal_sizes_are_refused() {
        let image = |width| Image::from_fn(width, 1, |_, _| [0.0; 3]);
        assert!(
            compare(&[image(2)], &image(3), None)
                .unwrap_err()
                .to_string()
                .contains("image 1 has 2x1 pixels, the reference 3x1")
        );
        assert!(compare(&[], &image(3), None).is_err());
    }

    #[test]
    fn the_difference_picture_is_red_where_brighter_and_blue_where_darker() {
        let image = |values: [f32; 3]| Image { width: 3, height: 1, pixels: values.map(|v| [v; 3]).to_vec() };
        let picture = difference_picture(&image([1.1, 0.9, 0.005]), &image([1.0, 1.0, 0.0]));
        let close = |a: f32, b: f32| (a - b).abs() < 1e-5;
        assert!(close(picture.pixels[0][0], 1.0) && picture.pixels[0][2] == 0.0);
        assert!(close(picture.pixels[1][2], 1.0) && picture.pixels[1][0] == 0.0);
        assert!(close(picture.pixels[2][0], 0.5));
    }
}
