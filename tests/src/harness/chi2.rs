//! Do samples follow the density that is stated for them? Pearson's χ² over cells of the sphere, the square or the line.
//!
//! The first fifth of the samples only says where to look: cells are cut at their medians, so a lobe a hundredth of a
//! degree wide is divided as finely as a hemisphere. In each cell the density is integrated adaptively; the other samples
//! are counted. Four things can be wrong, and [`Report::fault`] names the first:
//! - a sample fell where the density is 0;
//! - the density integrates to more than 1 + 1e-3, or to less by more than the share of samples that gave no direction
//!   (failed or specular);
//! - the counts are as far from their expectations as happens with a probability below the level asked for;
//! - the density is negative or not finite somewhere.
//!
//! Samples are taken beforehand, so that one probe can be lent to both sides:
//!
//! ```
//! use jerboa_tests::harness::bench::Random;
//! use jerboa_tests::harness::chi2::{self, Report};
//! use jerboa_tests::harness::stats::{FAMILY, sidak};
//!
//! let mut random = Random::new(7);
//! let samples: Vec<Option<f64>> = (0..10_000).map(|_| Some(random.uniform().sqrt())).collect();
//! let level = sidak(FAMILY, 2);
//! assert_eq!(chi2::interval(&samples, |x| 2.0 * x).fault(level), None);
//! let wrong: Report = chi2::interval(&samples, |_| 1.0);
//! assert!(wrong.fault(level).unwrap().contains("χ²"), "{wrong:?}");
//! ```

use std::f64::consts::{PI, TAU};
use std::fmt::Debug;

use super::probe::{V, normalize};
use super::quadrature::rectangle_with_hints;
use super::stats::chi2_tail;

/// How far the integral of a density may be off.
pub const INTEGRAL: f64 = 1e-3;
/// Least expected count of a cell; smaller ones are pooled (Cochran 1954).
const LEAST: f64 = 5.0;
/// Samples per cell.
const PER_CELL: usize = 50;
/// Most cells: about as many as Mitsuba's test has (50 x 101).
const MOST_CELLS: usize = 4096;
/// Cuts along each axis of what holds none of the first samples.
const EMPTY: usize = 3;

/// What a test of samples against a density found.
#[derive(Clone, Debug)]
pub struct Report {
    /// Probability of counts at least this far from the expected ones, if the density is right.
    pub p: f64,
    /// χ².
    pub chi2: f64,
    /// Degrees of freedom.
    pub freedom: usize,
    /// Integral of the density over everything.
    pub integral: f64,
    /// Share of the samples that gave no point.
    pub lost: f64,
    /// Samples counted, lost ones too.
    pub samples: usize,
    /// Samples that fell where the density is 0.
    pub stray: usize,
    /// A value of the density that is negative or not finite, and where.
    pub invalid: Option<String>,
    /// The cell with the largest share of χ².
    pub worst: Worst,
}

/// The cell that disagrees most.
#[derive(Clone, Debug, Default)]
pub struct Worst {
    /// Its middle: a direction, or the point.
    pub middle: String,
    /// Samples that fell into it.
    pub seen: f64,
    /// Samples expected.
    pub expected: f64,
}

impl Report {
    /// What is wrong, where counts may look wrong by chance with probability `level`.
    pub fn fault(&self, level: f64) -> Option<String> {
        let missing = 1.0 - self.integral;
        let noise = 4.0 * (self.lost * (1.0 - self.lost) / self.samples as f64).sqrt();
        if let Some(value) = &self.invalid {
            Some(format!("the density is {value}"))
        } else if self.stray > 0 {
            Some(format!("{} samples fell where the density is 0", self.stray))
        } else if (missing - self.lost).abs() > INTEGRAL + noise {
            Some(format!("the density integrates to {}, {} of the samples are lost", self.integral, self.lost))
        } else if self.p < level {
            let Worst { middle, seen, expected } = &self.worst;
            Some(format!(
                "χ² {:.1} of {} (p = {:.1e}); {seen} samples around {middle} instead of {expected:.1}",
                self.chi2, self.freedom, self.p
            ))
        } else {
            None
        }
    }
}

/// Directions against a density per steradian over the whole sphere; `None` is a sample that gave no direction. Cells are
/// cut in cos θ and φ, the first of them at the horizon z = 0, where densities jump.
pub fn sphere(samples: &[Option<V>], pdf: impl FnMut(V) -> f64) -> Report {
    Domain { axes: 2, measure: 4.0 * PI, flat: from_direction, point: to_direction }.test(samples, pdf)
}

/// Points against a density over the unit square.
pub fn square(samples: &[Option<[f64; 2]>], pdf: impl FnMut([f64; 2]) -> f64) -> Report {
    Domain { axes: 2, measure: 1.0, flat: |p| p, point: |p| p }.test(samples, pdf)
}

/// Numbers against a density over [0, 1].
pub fn interval(samples: &[Option<f64>], pdf: impl FnMut(f64) -> f64) -> Report {
    Domain { axes: 1, measure: 1.0, flat: |x| [x, 0.5], point: |p| p[0] }.test(samples, pdf)
}

/// χ² of counts against expected counts of the same sum, and its degrees of freedom. What is expected less than five
/// times is pooled, the least first.
pub fn pearson(seen: &[f64], expected: &[f64]) -> (f64, usize) {
    let mut pairs: Vec<(f64, f64)> = expected.iter().copied().zip(seen.iter().copied()).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut chi2, mut groups, mut pool) = (0.0, 0_usize, (0.0, 0.0));
    for (e, s) in pairs {
        pool = (pool.0 + e, pool.1 + s);
        if pool.0 >= LEAST {
            chi2 += (pool.1 - pool.0).powi(2) / pool.0;
            groups += 1;
            pool = (0.0, 0.0);
        }
    }
    (chi2, groups.saturating_sub(1))
}

/// To the unit square: half of 1 − cos θ, and turns. By the sine near the poles, where the cosine has no digits.
fn from_direction(w: V) -> [f64; 2] {
    let [x, y, z] = w.map(f64::from);
    let length2 = x * x + y * y + z * z;
    let near = (x * x + y * y) / (length2 + length2.sqrt() * z.abs()) / 2.0;
    [if z > 0.0 { near } else { 1.0 - near }, y.atan2(x).rem_euclid(TAU) / TAU]
}

fn to_direction([u, v]: [f64; 2]) -> V {
    let (sin, phi) = (2.0 * (u * (1.0 - u)).sqrt(), TAU * v);
    normalize([sin * phi.cos(), sin * phi.sin(), 1.0 - 2.0 * u])
}

/// Where points lie, laid out on the unit square such that area goes with measure.
struct Domain<T> {
    /// Axes of the square that are used.
    axes: usize,
    measure: f64,
    flat: fn(T) -> [f64; 2],
    point: fn([f64; 2]) -> T,
}

impl<T: Copy + Debug> Domain<T> {
    fn test(&self, samples: &[Option<T>], mut pdf: impl FnMut(T) -> f64) -> Report {
        let mut invalid = None;
        let mut density = |point: T| {
            let x = pdf(point);
            if !(0.0..f64::INFINITY).contains(&x) {
                invalid = Some(format!("{x} at {point:?}"));
            }
            x
        };
        let (pilot, counted) = samples.split_at(samples.len() / 5);
        let mut pilot: Vec<_> = pilot.iter().copied().flatten().map(self.flat).collect();
        let cells = Cells::new(&mut pilot, (counted.len() / PER_CELL).clamp(4, MOST_CELLS), self.axes);
        let (mut found, mut stray, mut seen) = (0, 0, vec![0.0; cells.leaves.len()]);
        for point in counted.iter().copied().flatten() {
            found += 1;
            stray += usize::from(density(point) == 0.0);
            seen[cells.find((self.flat)(point))] += 1.0;
        }
        // A thousandth of what a cell holds on average: even a million samples cannot see that.
        let tolerance = 1e-3 / cells.leaves.len() as f64;
        let mut share = |Leaf { lo, hi, points }: &Leaf| {
            rectangle_with_hints(*lo, *hi, tolerance, points, |p| density((self.point)(p)) * self.measure)
        };
        let shares: Vec<f64> = cells.leaves.iter().map(&mut share).collect();
        let integral: f64 = shares.iter().sum();
        // Given that a sample was found at all.
        let scale = f64::from(found) / integral.max(f64::MIN_POSITIVE);
        let expected: Vec<f64> = shares.iter().map(|share| share * scale).collect();
        let (chi2, freedom) = pearson(&seen, &expected);
        let part = |i: usize| (seen[i] - expected[i]).powi(2) / expected[i].max(LEAST);
        let worst = (0..seen.len()).max_by(|i, j| part(*i).total_cmp(&part(*j))).expect("there is a cell");
        let Leaf { lo, hi, .. } = cells.leaves[worst];
        let middle = (self.point)([0, 1].map(|i| (lo[i] + hi[i]) / 2.0));
        Report {
            p: if freedom == 0 { 1.0 } else { chi2_tail(chi2, freedom) },
            chi2,
            freedom,
            integral,
            lost: 1.0 - f64::from(found) / counted.len() as f64,
            samples: counted.len(),
            stray,
            invalid,
            worst: Worst { middle: format!("{middle:?}"), seen: seen[worst], expected: expected[worst] },
        }
    }
}

/// A partition of the unit square.
struct Cells {
    /// Axes that are cut.
    axes: usize,
    /// Cuts at medians above each leaf.
    depth: usize,
    /// The root is the last.
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
}

/// A cell, and the points that showed it.
struct Leaf {
    lo: [f64; 2],
    hi: [f64; 2],
    points: Vec<[f64; 2]>,
}

enum Node {
    /// What is below `at` along `axis` is in node `low`, the rest in `high`.
    Cut {
        axis: usize,
        at: f64,
        low: usize,
        high: usize,
    },
    Leaf(usize),
}

impl Cells {
    /// About `number` cells, which hold about as many of the points each.
    fn new(points: &mut [[f64; 2]], number: usize, axes: usize) -> Cells {
        let depth = number.ilog2() as usize;
        let mut cells = Cells { axes, depth, nodes: Vec::new(), leaves: Vec::new() };
        cells.divide([0.0; 2], [1.0; 2], points, 0);
        cells
    }

    fn divide(&mut self, lo: [f64; 2], hi: [f64; 2], points: &mut [[f64; 2]], level: usize) -> usize {
        let axis = level % self.axes;
        points.sort_by(|p, q| p[axis].total_cmp(&q[axis]));
        match self.cut([lo[axis], hi[axis]], points, level) {
            Some((at, level)) if lo[axis] < at && at < hi[axis] => {
                let (below, above) = points.split_at_mut(points.partition_point(|p| p[axis] < at));
                let (mut low_hi, mut high_lo) = (hi, lo);
                (low_hi[axis], high_lo[axis]) = (at, at);
                let low = self.divide(lo, low_hi, below, level);
                let high = self.divide(high_lo, hi, above, level);
                self.nodes.push(Node::Cut { axis, at, low, high });
            }
            _ => {
                self.leaves.push(Leaf { lo, hi, points: points.to_vec() });
                self.nodes.push(Node::Leaf(self.leaves.len() - 1));
            }
        }
        self.nodes.len() - 1
    }

    /// Where to cut a range that holds these points, sorted, and the level of its parts.
    fn cut(&self, [lo, hi]: [f64; 2], points: &[[f64; 2]], level: usize) -> Option<(f64, usize)> {
        let axis = level % self.axes;
        let half = (hi - lo) / 2.0;
        let first_of_all = level < self.axes;
        let (Some(first), Some(last), false) = (points.first(), points.last(), first_of_all) else {
            // No sample guides; or the horizon of the sphere is to be a border.
            return (level < EMPTY * self.axes).then_some((lo + half, level + 1));
        };
        // What is far from all points goes first: in a cell of mostly nothing the quadrature would not see the peak.
        let (least, most) = (2.0 * first[axis] - last[axis], 2.0 * last[axis] - first[axis]);
        if level >= self.depth {
            None
        } else if least < most && hi - most > half {
            Some((most, level))
        } else if least < most && least - lo > half {
            Some((least, level))
        } else {
            Some((points[points.len() / 2][axis], level + 1))
        }
    }

    /// The leaf that holds a point.
    fn find(&self, p: [f64; 2]) -> usize {
        let mut node = self.nodes.len() - 1;
        loop {
            match self.nodes[node] {
                Node::Leaf(leaf) => return leaf,
                Node::Cut { axis, at, low, high } => node = if p[axis] < at { low } else { high },
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::harness::bench::Random;

    /// cosⁿ around z, (n + 1)/2π of it.
    fn lobe(n: f64, axis: V, random: &mut Random) -> Option<V> {
        let (u, turn) = (random.uniform(), TAU * random.uniform());
        let cos = (u.ln() / (n + 1.0)).exp();
        let sin = (-(2.0 * u.ln() / (n + 1.0)).exp_m1()).sqrt();
        let local = [sin * turn.cos(), sin * turn.sin(), cos];
        // About x, when that is the axis.
        Some(normalize(if axis[0] == 1.0 { [local[2], local[0], local[1]] } else { local }))
    }

    fn density(n: f64, axis: V, w: V) -> f64 {
        let off: f64 = (0..3).map(|i| (f64::from(w[i]) - f64::from(axis[i])).powi(2)).sum();
        if off >= 2.0 { 0.0 } else { (n + 1.0) / TAU * (n * (-off / 2.0).ln_1p()).exp() }
    }

    #[test]
    fn peaks_are_divided_and_integrated() {
        let mut random = Random::new(0xc2);
        for n in [0.0, 1.0, 100.0, 1e4, 1e6] {
            for axis in [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]] {
                let samples: Vec<_> = (0..20_000).map(|_| lobe(n, axis, &mut random)).collect();
                let right = sphere(&samples, |w| density(n, axis, w));
                assert_eq!(right.fault(1e-3), None, "{n} {axis:?}: {right:?}");
                assert!((right.integral - 1.0).abs() < 1e-4 && right.freedom > 100, "{n} {axis:?}: {right:?}");
                let wider = sphere(&samples, |w| density(n * 0.9 + 0.3, axis, w));
                assert!(wider.fault(1e-6).is_some_and(|f| f.contains("χ²")), "{n} {axis:?}: {wider:?}");
            }
        }
    }

    /// Peaks in the light of everything else, where few samples help.
    #[test]
    fn peaks_among_others_are_found() {
        let mut random = Random::new(0xc4);
        for n in [100.0, 1e4, 1e6] {
            for axis in [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]] {
                let samples: Vec<_> =
                    (0..5000).map(|k| lobe(if k % 3 == 0 { 0.0 } else { n }, axis, &mut random)).collect();
                let both = |w| density(0.0, axis, w) / 3.0 + density(n, axis, w) / 1.5;
                let report = sphere(&samples, both);
                assert_eq!(report.fault(1e-3), None, "{n} {axis:?}: {report:?}");
            }
        }
    }

    #[test]
    fn each_fault_has_its_name() {
        let mut random = Random::new(0xc3);
        let samples: Vec<_> = (0..10_000).map(|_| Some([random.uniform(), random.uniform()])).collect();
        let half: Vec<_> = samples.iter().map(|p| p.filter(|p| p[0] < 0.5)).collect();
        let names = |report: Report, part: &str| {
            let fault = report.fault(1e-4);
            assert!(fault.as_ref().is_some_and(|f| f.contains(part)), "{fault:?} is not about `{part}`");
        };
        assert_eq!(square(&samples, |_| 1.0).fault(1e-4), None);
        // A half is lost, and nothing is stated there.
        assert_eq!(square(&half, |p| f64::from(u8::from(p[0] < 0.5))).fault(1e-4), None);
        names(square(&samples, |p| if p[0] < 0.9 { 1.0 / 0.9 } else { 0.0 }), "where the density is 0");
        names(square(&samples, |_| 1.01), "integrates to 1.01");
        names(square(&half, |_| 1.0), "are lost");
        names(square(&samples, |p| 0.75 + 0.5 * p[1]), "χ²");
        names(square(&samples, |p| if p[0] < 0.9 { 1.0 } else { f64::NAN }), "the density is NaN");
    }

    #[test]
    fn rare_cells_are_pooled() {
        assert_eq!(pearson(&[12.0, 8.0], &[10.0, 10.0]), (0.8, 1));
        assert_eq!(pearson(&[1.0, 2.0, 8.0, 9.0], &[2.0, 3.0, 7.0, 8.0]).1, 2);
    }
}
