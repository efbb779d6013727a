//! Piecewise-constant distributions, as flat tables that a kernel inverts by binary search.
//!
//! A table is a cumulative distribution: entry i is the probability of an index below i, so it begins with 0, ends
//! with 1, and index i is drawn by a uniform u in [cdf\[i\], cdf\[i + 1\]). Inversion keeps the order of the numbers
//! it is given, so well distributed samples stay so, which an alias table would destroy.
//!
//! *Probabilities are exact.* A uniform number has 24 bits (accuracy.md, N19), so the entries are rounded to multiples
//! of 2^-24: then each cdf\[i + 1\] - cdf\[i\] is exact in f32, is precisely the share of numbers u that draw i, and
//! these shares add up to exactly 1. Rounding never takes an index away: each positive weight gets at least 2^-24, so
//! the density is positive wherever the weight is. Against the ideal p an entry errs by at most 2^-24·(2 + n·p).
//!
//! ```
//! use jerboa_lib_render::host::distribution::Distribution1D;
//! let lights = Distribution1D::new(&[1.0, 0.0, 3.0]);
//! assert_eq!(lights.cdf, [0.0, 0.25, 0.25, 1.0]);
//! assert_eq!((lights.sample(0.2), lights.sample(0.25)), (0, 2));
//! ```

use super::image_io::{Image, luminance};

/// Parts into which the unit interval is divided: the number of distinct uniform numbers.
pub const PARTS: u32 = 1 << 24;

/// A distribution over the indices 0 .. n, for example over lights by their power.
#[derive(Clone, Debug, PartialEq)]
pub struct Distribution1D {
    /// n + 1 cumulative probabilities: multiples of 2^-24, ascending from 0 to 1.
    pub cdf: Vec<f32>,
}

impl Distribution1D {
    /// Probabilities in proportion to `weights`; uniform if none is positive.
    ///
    /// A weight that is negative, infinite or NaN counts as 0.
    ///
    /// # Panics
    /// If there is no weight, or more than 2^24.
    pub fn new(weights: &[f64]) -> Distribution1D {
        assert!(
            (1..=PARTS as usize).contains(&weights.len()),
            "Distribution1D::new: {} weights; it takes 1 to 2^24",
            weights.len()
        );
        let weight = |w: &f64| if w.is_finite() { w.max(0.0) } else { 0.0 };
        let largest = weights.iter().map(weight).fold(0.0, f64::max);
        if largest == 0.0 {
            return Distribution1D::new(&vec![1.0; weights.len()]);
        }
        // Divided by the largest, the sum cannot overflow. A tiny weight may vanish in it, but not its one part.
        let scaled = |w: &f64| weight(w) / largest;
        let total = weights.iter().map(scaled).sum::<f64>();
        let positive = weights.iter().filter(|w| weight(w) > 0.0).count() as u32;
        // One part for each positive weight, the rest in proportion.
        let (mut below, mut count) = (0.0, 0);
        let mut cdf = vec![0.0];
        for w in weights {
            below += scaled(w);
            count += u32::from(weight(w) > 0.0);
            let parts = (f64::from(PARTS - positive) * (below / total)) as u32 + count;
            cdf.push(parts as f32 / PARTS as f32);
        }
        Distribution1D { cdf }
    }

    /// Number of indices.
    pub fn count(&self) -> usize {
        self.cdf.len() - 1
    }

    /// The index drawn by the uniform number `u` in [0, 1).
    pub fn sample(&self, u: f32) -> usize {
        invert(&self.cdf, u)
    }

    /// The probability that `index` is drawn.
    pub fn probability(&self, index: usize) -> f32 {
        self.cdf[index + 1] - self.cdf[index]
    }
}

/// What of an environment's luminance is to be found by light sampling.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Share {
    /// All of it.
    Whole,
    /// What sampling of BSDFs leaves, for samples that are weighed against those.
    Uncovered,
}

/// A distribution over the cells of a grid: first a row, then a column in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Distribution2D {
    /// Columns.
    pub width: usize,
    /// Which row: `height + 1` cumulative probabilities.
    pub rows: Distribution1D,
    /// Which column, for each row; uniform in a row that is never drawn.
    pub columns: Vec<Distribution1D>,
}

impl Distribution2D {
    /// Probabilities in proportion to `weights`, given row by row in rows of `width`; uniform if none is positive.
    ///
    /// # Panics
    /// If `weights` is not a whole number of rows, at least one, or a side is above 2^24.
    pub fn new(width: usize, weights: &[f64]) -> Distribution2D {
        assert!(
            width > 0 && weights.len().is_multiple_of(width),
            "Distribution2D::new: {} weights do not fill rows of {width}",
            weights.len()
        );
        let rows = weights.chunks(width);
        Distribution2D {
            width,
            rows: Distribution1D::new(&rows.clone().map(|row| row.iter().sum()).collect::<Vec<_>>()),
            columns: rows.map(Distribution1D::new).collect(),
        }
    }

    /// The distribution that draws texels of an environment map, to choose directions around them.
    ///
    /// `map` is in latitude and longitude: row 0 is up, u wraps and v clamps. A kernel looks it up bilinearly with texel
    /// centres at half integers, so its radiance is a sum of one tent for each texel, two texels wide and high. The weight of
    /// a texel is the solid angle of its tent times this share of its luminance.
    ///
    /// A kernel draws a texel and then a point of its tent. With `p` the [`Self::probability`] of a texel, the density of a
    /// point per unit of (u, v) is p·width·height looked up bilinearly: so it is positive wherever the radiance is, and
    /// nearly in proportion to what the weights are made of.
    pub fn environment(map: &Image, share: Share) -> Distribution2D {
        let (width, height) = (map.width as usize, map.height as usize);
        // What is no radiance counts as none.
        let texel = |p: &[f32; 3]| Some(luminance(*p)).filter(|l| l.is_finite()).unwrap_or(0.0).max(0.0);
        let measures = (0..height).map(|y| tent_measure(y, height)).collect::<Vec<_>>();
        let mut weights = map.pixels.iter().map(texel).collect::<Vec<_>>();
        let sum = weights.chunks(width).zip(&measures).map(|(row, m)| m * row.iter().sum::<f64>()).sum::<f64>();
        let mean = sum / (width as f64 * measures.iter().sum::<f64>());
        let weight = |luminance: f64| match share {
            // A black map: uniform over the sphere.
            _ if mean == 0.0 => 1.0,
            Share::Whole => luminance,
            Share::Uncovered => uncovered(luminance, mean),
        };
        for (row, measure) in weights.chunks_mut(width).zip(&measures) {
            row.iter_mut().for_each(|w| *w = measure * weight(*w));
        }
        Distribution2D::new(width, &weights)
    }

    /// Number of rows.
    pub fn height(&self) -> usize {
        self.rows.count()
    }

    /// The cell, `[column, row]`, drawn by two uniform numbers in [0, 1); the second draws the row.
    pub fn sample(&self, [u, v]: [f32; 2]) -> [usize; 2] {
        let row = self.rows.sample(v);
        [self.columns[row].sample(u), row]
    }

    /// The probability that the cell `[column, row]` is drawn: a product of two exact factors, rounded once.
    pub fn probability(&self, [column, row]: [usize; 2]) -> f32 {
        self.rows.probability(row) * self.columns[row].probability(column)
    }
}

/// The last index whose cumulative probability is at most `u`: never one of probability 0, for these end where they begin.
fn invert(cdf: &[f32], u: f32) -> usize {
    cdf[1..cdf.len() - 1].partition_point(|below| *below <= u)
}

/// Smallest share of its luminance that a texel is drawn by: so the density is positive wherever the radiance is, and a sample brings at
/// most eight times the light that it would by luminance. Without it errors are 0.98 and 1.02 of those with it
/// (`tests/runs/lights.txt`).
const LEAST: f64 = 1.0 / 8.0;

/// What sampling of the BSDF leaves to do of a luminance where `mean` is that of the whole map: the even part of a map it finds by
/// chance, and the weights of multiple importance sampling count a direction that both draw twice (Karlík et al. 2019, "MIS
/// compensation: optimizing sampling techniques in multiple importance sampling", section 5). A constant map is as without.
fn uncovered(luminance: f64, mean: f64) -> f64 {
    (luminance - mean).max(LEAST * luminance)
}

/// Solid angle of the tent of a texel in row `y` of `height`, per radian of azimuth, in rows: ∫ tent(θ) sin θ dθ, where the
/// tent falls from 1 at the middle of the row to 0 at the middles of its neighbours, and stays 1 up to a pole.
fn tent_measure(y: usize, height: usize) -> f64 {
    let step = std::f64::consts::PI / height as f64;
    let middle = |rows: f64| (rows + 0.5) * step;
    let (above, here, below) = (middle(y as f64 - 1.0), middle(y as f64), middle(y as f64 + 1.0));
    let up = if y == 0 { 1.0 - here.cos() } else { (here.sin() - above.sin()) / step - here.cos() };
    let down = if y + 1 == height { 1.0 + here.cos() } else { here.cos() - (below.sin() - here.sin()) / step };
    up + down
}

#[cfg(test)]
mod tests {
    use super::*;

    const ULP: f32 = 1.0 / PARTS as f32;

    /// Every index is drawn by exactly its probability's share of the 2^24 uniform numbers, and these add up to 1.
    fn check(d: &Distribution1D, weights: &[f64]) {
        let total = weights.iter().sum::<f64>();
        assert_eq!((d.cdf[0], d.cdf[weights.len()]), (0.0, 1.0));
        for (i, weight) in weights.iter().enumerate() {
            let (p, ideal) = (d.probability(i), weight / total);
            assert_eq!(p > 0.0, *weight > 0.0, "index {i}");
            let bound = f64::from(ULP) * (2.0 + weights.len() as f64 * ideal);
            assert!((f64::from(p) - ideal).abs() <= bound, "index {i}: {p} against {ideal}");
            if p > 0.0 {
                assert_eq!((d.sample(d.cdf[i]), d.sample(d.cdf[i + 1] - ULP)), (i, i));
            }
        }
        let sum = (0..weights.len()).map(|i| f64::from(d.probability(i))).sum::<f64>();
        assert_eq!(sum, 1.0);
    }

    #[test]
    fn probabilities_are_the_shares_of_the_uniform_numbers() {
        let uneven = (0..1000).map(|i| f64::from(i * i % 97)).collect::<Vec<_>>();
        let extreme = [1e-300, 0.0, 1e308, 1.0, 0.0, 1e-320];
        for weights in [&[1.0][..], &[0.0, 5.0], &[5.0, 0.0], &[1.0, 2.0, 3.0], &uneven, &extreme] {
            check(&Distribution1D::new(weights), weights);
        }
    }

    #[test]
    fn without_a_usable_weight_the_choice_is_uniform() {
        let nothing = [0.0, -1.0, f64::NAN, f64::INFINITY];
        check(&Distribution1D::new(&nothing), &[1.0; 4]);
        check(&Distribution1D::new(&[-1.0, 2.0, f64::NAN]), &[0.0, 2.0, 0.0]);
    }

    /// A map of `width`x`height` that is black but for the given texels.
    fn map(width: u32, height: u32, lit: &[(u32, u32, f32)]) -> Image {
        let value = |x, y| lit.iter().find(|l| (l.0, l.1) == (x, y)).map_or(0.0, |l| l.2);
        Image::from_fn(width, height, |x, y| [value(x, y); 3])
    }

    fn total(d: &Distribution2D) -> f64 {
        let cells = (0..d.height()).flat_map(|y| (0..d.width).map(move |x| [x, y]));
        cells.map(|cell| f64::from(d.probability(cell))).sum()
    }

    #[test]
    fn texels_count_by_the_solid_angle_of_their_tents() {
        for height in [1, 2, 4, 1000] {
            let d = Distribution2D::environment(&Image::from_fn(2, height, |_, _| [2.0; 3]), Share::Uncovered);
            for y in 0..height as usize {
                // By the trapezoidal rule. The tents of all rows add up to 1 everywhere.
                let n = 4000;
                let tent = |v: f64| {
                    let at = (v * f64::from(height)).clamp(0.5, f64::from(height) - 0.5);
                    (1.0 - (at - y as f64 - 0.5).abs()).max(0.0) * (std::f64::consts::PI * v).sin()
                };
                let (from, to) = ((y as f64 - 1.0) / f64::from(height), (y as f64 + 2.0) / f64::from(height));
                let (from, to) = (from.max(0.0), to.min(1.0));
                let at = |i: usize| tent(from + (to - from) * i as f64 / n as f64);
                let sum: f64 = (1..n).map(at).sum::<f64>() + (at(0) + at(n)) / 2.0;
                let ideal = sum * (to - from) / n as f64 * std::f64::consts::PI;
                assert!((tent_measure(y, height as usize) / ideal - 1.0).abs() < 1e-5, "row {y} of {height}");
                let (p, ideal) = (f64::from(d.rows.probability(y)), ideal / 2.0);
                let bound = f64::from(ULP) * (2.0 + f64::from(height) * ideal) + 1e-5 * ideal;
                assert!((p - ideal).abs() <= bound, "row {y} of {height}");
            }
            assert!((total(&d) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn a_texel_is_drawn_if_it_is_lit() {
        let d = Distribution2D::environment(&map(8, 6, &[(0, 2, 5.0), (3, 0, 1.0)]), Share::Whole);
        for (y, x) in (0..6).flat_map(|y| (0..8).map(move |x| (y, x))) {
            assert_eq!(d.probability([x, y]) > 0.0, [(0, 2), (3, 0)].contains(&(x, y)), "column {x}, row {y}");
        }
        let (lit, pole) = (5.0 * tent_measure(2, 6), tent_measure(0, 6));
        assert!((f64::from(d.probability([0, 2])) / (lit / (lit + pole)) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn what_is_dimmer_than_the_mean_is_drawn_by_an_eighth() {
        // Rows at the same distance from the equator, so with tents of the same size.
        let halves = Image::from_fn(4, 2, |_, y| [if y == 0 { 3.0 } else { 1.0 }; 3]);
        let d = Distribution2D::environment(&halves, Share::Uncovered);
        assert!((d.rows.probability(1) / d.rows.probability(0) - 0.125).abs() < 1e-5);
    }

    #[test]
    fn a_sun_of_1e6_leaves_the_sky_drawable() {
        let sky = Image::from_fn(64, 32, |x, y| [if (x, y) == (40, 9) { 1e6 } else { 1e-3 }; 3]);
        let d = Distribution2D::environment(&sky, Share::Uncovered);
        assert!((0..32).all(|y| (0..64).all(|x| d.probability([x, y]) > 0.0)));
        assert!(d.probability([40, 9]) > 0.999);
        assert!((total(&d) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_single_texel_is_always_drawn() {
        for value in [0.0, 3.0, f32::NAN] {
            let d = Distribution2D::environment(&map(1, 1, &[(0, 0, value)]), Share::Uncovered);
            assert_eq!((d.probability([0, 0]), d.sample([0.999, 0.0])), (1.0, [0, 0]));
        }
    }

    #[test]
    fn a_black_map_is_uniform_over_the_sphere() {
        let d = Distribution2D::environment(&map(4, 8, &[]), Share::Whole);
        for y in 0..8 {
            let ideal = tent_measure(y, 8) / 8.0;
            assert!((f64::from(d.probability([2, y])) / ideal - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn a_cell_is_drawn_as_often_as_its_probability_says() {
        let sky = Image::from_fn(4, 3, |x, y| [(x * x + 3 * y) as f32; 3]);
        let d = Distribution2D::environment(&sky, Share::Uncovered);
        let n = 512;
        let mut drawn = [[0_u32; 4]; 3];
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let [x, y] = d.sample([i, j].map(|k| (k as f32 + 0.5) / n as f32));
            drawn[y][x] += 1;
        }
        for (y, x) in (0..3).flat_map(|y| (0..4).map(move |x| (y, x))) {
            let share = f64::from(drawn[y][x]) / f64::from(n * n);
            // On a regular grid of points each of a cell's two extents is off by at most one point in n.
            assert!((share - f64::from(d.probability([x, y]))).abs() <= 2.0 / f64::from(n));
        }
    }
}
