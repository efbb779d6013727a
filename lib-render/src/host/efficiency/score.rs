//! The error of films, told by the films themselves.
//!
//! K films x_1 … x_K of a contestant, in luminance, have a mean m and in each pixel an unbiased variance. With R the mean of all
//! contestants' means, and per pixel
//!
//! > e_k = K/(K - 1) · (x_k - m)² / (R² + eps),
//!
//! the error is the mean of e_k over pixels and films: the variance relative to the picture. It is told four ways:
//!
//! * with eps = (0.1 · mean of R)², which black pixels do not dominate;
//! * the same without the worst thousandth of the pixels, those whose variance, summed over *all* contestants, is largest: the
//!   same pixels for all, so nobody is helped by his own fireflies;
//! * with eps = 0.01, the public tools' number;
//! * SMAPE, the mean of 2|x_k - m| / (|x_k| + |m|), which no firefly dominates.

use rayon::prelude::*;

/// Share of the pixels that the trimmed error leaves out.
const TRIMMED: f64 = 0.001;
/// Share of all pixel values that count as bright.
const BRIGHT: f64 = 0.001;
/// Share of the mean luminance below which a pixel counts as dark.
const DARK: f64 = 0.1;
/// The public tools' eps.
const PUBLIC_EPSILON: f64 = 0.01;

/// Errors of a film, or their means.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Variance relative to the picture.
    pub relative: f64,
    /// The same without the worst thousandth of the pixels.
    pub trimmed: f64,
    /// With eps = 0.01.
    pub public: f64,
    /// Symmetric mean absolute percentage error, as a share: between 0 and 2.
    pub smape: f64,
}

/// What a contestant's films say.
#[derive(Clone, Debug)]
pub struct Score {
    /// Film by film: what it adds to the mean.
    pub runs: Vec<Errors>,
    /// Share of its light in pixels that are as bright as the brightest thousandth of all contestants' pixels.
    pub bright: f64,
}

/// Scores of contestants, each by its films in luminance, at least two.
///
/// # Panics
/// If there are no contestants, a contestant has fewer than two films, or sizes differ.
pub fn errors(contestants: &[Vec<&[f32]>]) -> Vec<Score> {
    let pixels = contestants[0][0].len();
    assert!(contestants.iter().all(|c| c.len() > 1 && c.iter().all(|film| film.len() == pixels)), "films to compare");
    let means: Vec<Vec<f64>> = contestants.iter().map(|films| mean(films)).collect();
    let picture: Vec<f64> = (0..pixels).map(|p| means.iter().map(|m| m[p]).sum::<f64>() / means.len() as f64).collect();
    let dark = DARK * picture.iter().sum::<f64>() / pixels as f64;
    let kept = all_but_the_worst(contestants, &means, &picture, dark * dark);
    let threshold = brightest(contestants);

    let score = |(films, mean): (&Vec<&[f32]>, &Vec<f64>)| {
        let unbiased = films.len() as f64 / (films.len() - 1) as f64;
        let run = |film: &&[f32]| {
            let mut sums = Errors::default();
            for (p, x) in film.iter().map(|x| f64::from(*x)).enumerate() {
                let square = unbiased * (x - mean[p]).powi(2);
                let relative = square / (picture[p] * picture[p] + dark * dark).max(f64::MIN_POSITIVE);
                sums.relative += relative;
                sums.trimmed += if kept[p] { relative } else { 0.0 };
                sums.public += square / (picture[p] * picture[p] + PUBLIC_EPSILON);
                sums.smape += 2.0 * (x - mean[p]).abs() / (x.abs() + mean[p].abs()).max(f64::MIN_POSITIVE);
            }
            let n = pixels as f64;
            let Errors { relative, trimmed, public, smape } = sums;
            let few = kept.iter().filter(|kept| **kept).count().max(1) as f64;
            Errors { relative: relative / n, trimmed: trimmed / few, public: public / n, smape: smape / n }
        };
        let light = |film: &&[f32], above: f32| film.iter().filter(|x| **x > above).map(|x| f64::from(*x)).sum::<f64>();
        let all: f64 = films.iter().map(|film| light(film, f32::NEG_INFINITY)).sum();
        let bright: f64 = films.iter().map(|film| light(film, threshold)).sum();
        Score { runs: films.par_iter().map(run).collect(), bright: bright / all.max(f64::MIN_POSITIVE) }
    };
    contestants.iter().zip(&means).map(score).collect()
}

/// The mean of films, pixel by pixel.
fn mean(films: &[&[f32]]) -> Vec<f64> {
    let pixel = |p: usize| films.iter().map(|film| f64::from(film[p])).sum::<f64>() / films.len() as f64;
    (0..films[0].len()).into_par_iter().map(pixel).collect()
}

/// For each pixel, is it none of the worst?
fn all_but_the_worst(contestants: &[Vec<&[f32]>], means: &[Vec<f64>], picture: &[f64], epsilon: f64) -> Vec<bool> {
    let of_one = |films: &Vec<&[f32]>, mean: f64, p: usize| {
        let squares = films.iter().map(|film| (f64::from(film[p]) - mean).powi(2)).sum::<f64>();
        squares / (films.len() - 1) as f64
    };
    let pooled = |p: usize| {
        let sum: f64 = contestants.iter().zip(means).map(|(films, mean)| of_one(films, mean[p], p)).sum();
        sum / (picture[p] * picture[p] + epsilon).max(f64::MIN_POSITIVE)
    };
    let variances: Vec<f64> = (0..picture.len()).into_par_iter().map(pooled).collect();
    let mut order: Vec<usize> = (0..picture.len()).collect();
    order.sort_by(|a, b| variances[*b].total_cmp(&variances[*a]));
    let mut kept = vec![true; picture.len()];
    order[..(TRIMMED * picture.len() as f64) as usize].iter().for_each(|p| kept[*p] = false);
    kept
}

/// The value that a thousandth of all pixels of all films exceed, or fewer where many have it.
fn brightest(contestants: &[Vec<&[f32]>]) -> f32 {
    let mut all: Vec<f32> = contestants.iter().flatten().flat_map(|film| film.iter().copied()).collect();
    let rank = all.len() - 1 - (BRIGHT * all.len() as f64) as usize;
    *all.select_nth_unstable_by(rank, f32::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn total(score: &Score, of: impl Fn(&Errors) -> f64) -> f64 {
        score.runs.iter().map(of).sum::<f64>() / score.runs.len() as f64
    }

    #[test]
    fn the_error_is_the_relative_variance() {
        // Two pixels, 1 and 3 in turn (mean 2, variance 2), and 2 always. The mean luminance is 2, eps = 0.04.
        let films: [&[f32]; 2] = [&[1.0, 2.0], &[3.0, 2.0]];
        let score = &errors(&[films.to_vec()])[0];
        assert!((total(score, |e| e.relative) - 0.5 * 2.0 / 4.04).abs() < 1e-12);
        assert!((total(score, |e| e.public) - 0.5 * 2.0 / 4.01).abs() < 1e-12);
        assert!((total(score, |e| e.smape) - 0.5 * (2.0 / 3.0 + 2.0 / 5.0) / 2.0).abs() < 1e-12);
        assert_eq!(total(score, |e| e.trimmed), total(score, |e| e.relative), "a thousandth of two pixels is none");
    }

    #[test]
    fn the_same_pixels_are_trimmed_for_all() {
        // A firefly of one contestant is the worst of a thousand pixels: neither is charged for that pixel.
        let (mut noisy, mut other) = ([vec![1.0_f32; 1000], vec![1.0; 1000]], [vec![1.0_f32; 1000], vec![1.0; 1000]]);
        noisy[0][7] = 1000.0;
        other[1][7] = 2.0;
        let scores = errors(&[noisy.iter().map(|f| &f[..]).collect(), other.iter().map(|f| &f[..]).collect()]);
        for score in &scores {
            assert!(total(score, |e| e.relative) > 0.0);
            assert_eq!(total(score, |e| e.trimmed), 0.0);
        }
        assert!(scores[0].bright > 0.3 && scores[1].bright < 0.01, "only one has the firefly's light");
    }

    #[test]
    fn black_films_have_no_error() {
        let films: [&[f32]; 2] = [&[0.0; 4], &[0.0; 4]];
        let score = &errors(&[films.to_vec()])[0];
        assert_eq!(score.runs, [Errors::default(); 2]);
        assert_eq!(score.bright, 0.0);
    }
}
