//! How far a render is from what it converges to, told from itself.
//!
//! A film that keeps 8 groups of samples apart ([`Film::try_grouped`], sample s in group s mod 8) holds 8 images that are
//! independent of each other, whatever the samples of one group have to do with each other. With x_g the mean of the n_g
//! samples of a pixel in group g, and x that of all n, the variance of x is estimated without bias by
//!
//! > v = Σ n_g (x_g − x)² / (n (G − 1)),
//!
//! G being the number of groups that have a sample: the variance of the 8 means over 8, where groups are equal. Sums are
//! exact, so v is the same whatever threads, tiles, passes and merged parts they came from.
//!
//! The *relative mean squared error* is the mean, over pixels and channels, of (x − R)² / (R² + eps), with R what the render
//! converges to and eps = (0.1 · the mean luminance of R)² for the sake of the dark. [`relative_error`] estimates it.

use super::film::{Film, GROUPS};
use super::image_io::{Image, luminance};

/// Estimated variance of each pixel and channel of [`Film::mean`]; infinite where fewer than two groups have a sample.
pub fn variance(film: &Film) -> Image {
    let window = film.window();
    let channel = |pixel: &Pixel, c: usize| {
        let (_, spread) = pixel.moments(c, None);
        if pixel.groups(None).count() < 2 { f32::INFINITY } else { (spread / pixel.count()) as f32 }
    };
    let pixel = |pixel: Pixel| [0, 1, 2].map(|c| channel(&pixel, c));
    Image { width: window.width, height: window.height, pixels: pixels(film).map(pixel).collect() }
}

/// Estimated relative mean squared error of [`Film::mean`]; infinite where fewer than three groups of a pixel have a sample,
/// 0 of a black image.
///
/// R is not known. With x in its place, what a rare bright sample adds to the error would be divided by its own brightness:
/// at 16 samples of the Cornell box that makes the error 0.69 of what it is. Such a bias falls with the number of samples,
/// so its first order follows from the same quotient with a group left out, each in turn: the jackknife (Quenouille,
/// Biometrika 43, 1956). `tests/tests/noise.rs` measures what is left.
pub fn relative_error(film: &Film) -> f64 {
    let mean = film.mean().pixels;
    let area = mean.len() as f64;
    let eps = (0.1 * mean.into_iter().map(luminance).sum::<f64>() / area).powi(2);
    if eps == 0.0 {
        return 0.0;
    }
    let channel = |pixel: &Pixel, c: usize, filled: f64| {
        let quotient = |without: Option<usize>| {
            let (mean, spread) = pixel.moments(c, without);
            spread / (mean * mean + eps)
        };
        let without_one = pixel.groups(None).map(|group| quotient(Some(group))).sum::<f64>() / filled;
        (filled * quotient(None) - (filled - 1.0) * without_one) / pixel.count()
    };
    let error = |pixel: Pixel| match pixel.groups(None).count() {
        0..3 => f64::INFINITY,
        filled => (0..3).map(|c| channel(&pixel, c, filled as f64)).sum(),
    };
    pixels(film).map(error).sum::<f64>() / (3.0 * area)
}

/// A pixel in groups of samples: sums of radiance and numbers of samples.
struct Pixel {
    sums: [[f64; 3]; GROUPS as usize],
    counts: [f64; GROUPS as usize],
}

/// The pixels of a film; one that keeps no groups apart has all samples in the first.
fn pixels(film: &Film) -> impl Iterator<Item = Pixel> {
    let mut groups: Vec<_> = (0..film.groups()).map(|group| film.group(group)).collect();
    (0..film.window().area()).map(move |_| {
        let mut pixel = Pixel { sums: [[0.0; 3]; GROUPS as usize], counts: [0.0; GROUPS as usize] };
        for (place, (sum, count)) in groups.iter_mut().filter_map(Iterator::next).enumerate() {
            pixel.sums[place] = sum.map(|s| s as f64 * (-64f64).exp2());
            pixel.counts[place] = count.into();
        }
        pixel
    })
}

impl Pixel {
    /// The groups that have samples, but for one.
    fn groups(&self, without: Option<usize>) -> impl Iterator<Item = usize> {
        (0..self.counts.len()).filter(move |group| self.counts[*group] > 0.0 && Some(*group) != without)
    }

    fn count(&self) -> f64 {
        self.counts.iter().sum()
    }

    /// A channel's mean over the samples of all groups but one, and its variance times the number of samples.
    fn moments(&self, channel: usize, without: Option<usize>) -> (f64, f64) {
        let groups = || self.groups(without);
        let count: f64 = groups().map(|group| self.counts[group]).sum();
        let mean = groups().map(|group| self.sums[group][channel]).sum::<f64>() / count;
        let square =
            |group: usize| self.counts[group] * (self.sums[group][channel] / self.counts[group] - mean).powi(2);
        (mean, groups().map(square).sum::<f64>() / (groups().count() as f64 - 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::film::Window;

    const ONE: Window = Window { x: 0, y: 0, width: 1, height: 1 };

    fn film(samples: &[f32]) -> Film {
        let mut film = Film::try_grouped([1, 1], ONE).expect("memory");
        for (number, x) in (0..).zip(samples) {
            film.add_sample([0, 0], number, [*x, 2.0 * x, 0.0]);
        }
        film
    }

    #[test]
    fn the_variance_is_that_of_the_means_of_groups() {
        // Groups of two samples: their means are 1 to 8, with variance 6 and that of their mean 6/8.
        let samples: Vec<f32> = (0..16).map(|i| (i % 8 + 1) as f32 + if i < 8 { 0.5 } else { -0.5 }).collect();
        assert_eq!(variance(&film(&samples)).pixels, [[0.75, 3.0, 0.0]]);
        // Groups of 2 and 1 samples: (2·(1 − 2)² + (4 − 2)²) / (3·1).
        let mut uneven = film(&[1.0, 4.0]);
        uneven.add_sample([0, 0], 8, [1.0, 2.0, 0.0]);
        assert_eq!(variance(&uneven).pixels, [[2.0, 8.0, 0.0]]);
    }

    #[test]
    fn one_group_says_nothing_and_black_is_without_error() {
        assert_eq!(variance(&film(&[1.0])).pixels, [[f32::INFINITY; 3]]);
        assert_eq!(relative_error(&film(&[1.0])), f64::INFINITY);
        assert_eq!(relative_error(&film(&[0.0; 8])), 0.0);
        assert_eq!(relative_error(&film(&[3.0; 8])), 0.0);
    }

    #[test]
    fn the_bias_of_the_quotient_is_taken_off() {
        let mut film = Film::try_grouped([1, 1], ONE).expect("memory");
        for (number, x) in [1.0, 3.0, 5.0].into_iter().enumerate() {
            film.add_sample([0, 0], number as u32, [x; 3]);
        }
        let eps = 0.3f64.powi(2);
        let without = [2.0 / (16.0 + eps), 8.0 / (9.0 + eps), 2.0 / (4.0 + eps)];
        let right = (3.0 * 4.0 / (9.0 + eps) - 2.0 * without.iter().sum::<f64>() / 3.0) / 3.0;
        assert!((relative_error(&film) / right - 1.0).abs() < 1e-6, "{} for {right}", relative_error(&film));
    }
}
