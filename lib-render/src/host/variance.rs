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
    let pixel = |pixel: Pixel| [0, 1, 2].map(|c| pixel.spread(c, |_| 1.0) as f32);
    Image { width: window.width, height: window.height, pixels: pixels(film).map(pixel).collect() }
}

/// Estimated relative mean squared error of [`Film::mean`]; infinite where fewer than two groups of a pixel have a sample, 0
/// of a black image.
///
/// R is not known, so the deviation of each group is divided by R² as the other groups see it. Divided by R² as all of them
/// see it, what a rare bright sample adds to the error would be divided by its own brightness.
pub fn relative_error(film: &Film) -> f64 {
    let mean = film.mean().pixels;
    let area = mean.len() as f64;
    let eps = (0.1 * mean.into_iter().map(luminance).sum::<f64>() / area).powi(2);
    if eps == 0.0 {
        return 0.0;
    }
    let error = |pixel: Pixel| -> f64 {
        (0..3).map(|c| pixel.spread(c, |group| 1.0 / (pixel.mean_without(group, c).powi(2) + eps))).sum()
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
    /// The groups that have samples.
    fn groups(&self) -> impl Iterator<Item = usize> {
        (0..self.counts.len()).filter(|group| self.counts[*group] > 0.0)
    }

    fn count(&self) -> f64 {
        self.counts.iter().sum()
    }

    /// The mean of a channel over the samples of all groups but one.
    fn mean_without(&self, group: usize, channel: usize) -> f64 {
        let others = || self.groups().filter(|other| *other != group);
        others().map(|other| self.sums[other][channel]).sum::<f64>()
            / others().map(|other| self.counts[other]).sum::<f64>()
    }

    /// The variance of a channel's mean, each group's part of it with a weight; infinite with fewer than two groups.
    fn spread(&self, channel: usize, weight: impl Fn(usize) -> f64) -> f64 {
        let filled = self.groups().count();
        if filled < 2 {
            return f64::INFINITY;
        }
        let mean = self.groups().map(|group| self.sums[group][channel]).sum::<f64>() / self.count();
        let part = |group: usize| {
            let deviation = self.sums[group][channel] / self.counts[group] - mean;
            self.counts[group] * deviation.powi(2) * weight(group)
        };
        self.groups().map(part).sum::<f64>() / (self.count() * (filled - 1) as f64)
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
    fn a_group_is_divided_by_what_the_others_see() {
        // Means 1 and 3: the variance of their mean is 1, and half of it is divided by 3² + eps, half by 1² + eps.
        let mut film = Film::try_grouped([1, 1], ONE).expect("memory");
        film.add_sample([0, 0], 0, [1.0; 3]);
        film.add_sample([0, 0], 1, [3.0; 3]);
        let eps = (0.1f64 * 2.0).powi(2);
        let right = 0.5 / (9.0 + eps) + 0.5 / (1.0 + eps);
        assert!((relative_error(&film) / right - 1.0).abs() < 1e-12, "{} for {right}", relative_error(&film));
    }
}
