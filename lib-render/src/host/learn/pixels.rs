//! What light counts in each pixel: the weight of its variance in the error of the image, and what that error and the samples
//! cost.

use std::sync::atomic::Ordering;

use super::{PixelSums, real};
use crate::host::tables::memory::{Memory, Table};
use crate::schema::LearnedPixels;

/// A pixel's light is the median over columns of the medians along rows of a square that reaches so far beyond it: a few samples tell
/// little of one, and a lamp in the square is nothing to its neighbours. A pixel that is brighter itself is a lamp's, or its mean is
/// a chance that says little of its error: that counts the less.
const REACH: usize = 3;
/// Error counts relative to the square of a pixel's light plus that of this share of the image's mean, as where renderers are compared
/// (accuracy.md, amendments).
const DARK: f64 = 0.1;

/// Probabilities are so many times what theory says, which takes what was learned for the truth; but a path that is worth more than it
/// seems costs much when it ends. With 1.5 staircase and kitchen take 1.05 and 1.07 times the work for the same error
/// (`tests/runs/roulette.txt`).
const CAUTION: f64 = 1.1;

/// 1 / √(w C / E) of each pixel of a film of this size, from so many samples of each; nothing where there is no noise.
pub fn scales(pixels: &[PixelSums], [width, height]: [u32; 2], samples: u32) -> Option<Memory> {
    let n = f64::from(samples);
    let means: Vec<f64> = pixels.iter().map(|p| real(&p.sum) / n).collect();
    let image = means.iter().sum::<f64>() / means.len() as f64;
    let smooth = transposed(
        &medians(&transposed(&medians(&means, width as usize), width as usize), height as usize),
        height as usize,
    );
    let weight = |(around, own): (&f64, &f64)| 1.0 / (around.max(*own).powi(2) + (DARK * image).powi(2));
    let weights: Vec<f64> = smooth.iter().zip(&means).map(weight).collect();
    let variance = |(pixel, mean): (&PixelSums, &f64)| (real(&pixel.squares) - n * mean * mean) / (n - 1.0);
    let variances = pixels.iter().zip(&means).map(variance);
    let error = variances.zip(&weights).map(|(variance, weight)| variance * weight).sum::<f64>();
    let rays: u64 = pixels.iter().map(|p| p.rays.load(Ordering::Relaxed)).sum();
    let scale = (rays as f64 / n / error).sqrt();
    if !(scale.is_finite() && scale > 0.0) {
        return None;
    }
    let mut table = Table::<LearnedPixels>::with_rows(weights.len());
    for weight in weights {
        table.push().set(LearnedPixels::SCALE, (1.0 / (CAUTION * scale * weight.sqrt())) as f32);
    }
    Some(table.finish())
}

/// Medians along rows of this width, of what lies within [`REACH`].
fn medians(values: &[f64], width: usize) -> Vec<f64> {
    let row = |row: &[f64]| -> Vec<f64> {
        let median = |x: usize| {
            let mut around = row[x.saturating_sub(REACH)..(x + REACH + 1).min(row.len())].to_vec();
            let middle = around.len() / 2;
            *around.select_nth_unstable_by(middle, f64::total_cmp).1
        };
        (0..row.len()).map(median).collect()
    };
    values.chunks(width).flat_map(row).collect()
}

/// Columns as rows.
fn transposed(values: &[f64], width: usize) -> Vec<f64> {
    (0..width).flat_map(|x| values.iter().skip(x).step_by(width).copied()).collect()
}
