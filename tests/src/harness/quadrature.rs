//! Integrals in f64, to compare with.
//!
//! [`gauss`] for what is smooth, [`rectangle`] for what has peaks and edges: it subdivides where it is not yet sure.
//!
//! ```
//! use jerboa_tests::harness::quadrature::{gauss, rectangle};
//!
//! let square = |x: f64| x * x;
//! assert!((gauss::<8>(0.0, 3.0, square) - 9.0).abs() < 1e-13);
//! let disk = |[x, y]: [f64; 2]| f64::from(u8::from(x * x + y * y < 1.0));
//! assert!((rectangle([-1.0; 2], [1.0; 2], 1e-4, disk) - std::f64::consts::PI).abs() < 1e-4);
//! ```

use std::f64::consts::PI;

/// Nodes in (-1, 1) and weights of Gauss–Legendre quadrature with N nodes: exact for polynomials of degree 2N − 1.
///
/// Newton's method on the Legendre polynomial from Tricomi's first guess (Abramowitz & Stegun 1964, 22.16.6, 25.4.29).
pub fn nodes<const N: usize>() -> [(f64, f64); N] {
    std::array::from_fn(|i| {
        let mut x = (PI * (i as f64 + 0.75) / (N as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..20 {
            let (mut below, mut p) = (1.0, x);
            for k in 2..=N {
                let k = k as f64;
                (below, p) = (p, ((2.0 * k - 1.0) * x * p - (k - 1.0) * below) / k);
            }
            slope = N as f64 * (x * p - below) / (x * x - 1.0);
            x -= p / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    })
}

/// ∫ f over [a, b] with N ≥ 2 nodes.
pub fn gauss<const N: usize>(a: f64, b: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
    let (middle, half) = ((a + b) / 2.0, (b - a) / 2.0);
    nodes::<N>().iter().map(|(x, w)| w * f(middle + half * x)).sum::<f64>() * half
}

/// Nodes along each side of a rectangle.
const SIDE: usize = 4;
/// Most halvings of a rectangle: for a peak a millionth as wide both ways, at its rim.
const DEEPEST: u32 = 40;
/// A peak or a border of the support between the outermost nodes and a side of the rectangle is not seen by the nodes:
/// 0.035 of it, once halved.
const UNSEEN: f64 = 0.035;

/// ∫ f over the rectangle between two corners, with an error of about `tolerance`, if nodes a quarter apart see its peaks.
///
/// Where 16 nodes and twice 16 nodes differ by more than that, it is halved across the axis that tells more, and each half
/// is asked for 1/√2 of the tolerance: two errors add up like random numbers. So it is where f is 0 in a part or much
/// larger at the rim or at a hint, by what may be unseen there.
pub fn rectangle(lo: [f64; 2], hi: [f64; 2], tolerance: f64, f: impl FnMut([f64; 2]) -> f64) -> f64 {
    rectangle_with_hints(lo, hi, tolerance, &[], f)
}

/// As [`rectangle`], and no peak is overlooked that one of the points lies on.
pub fn rectangle_with_hints(
    lo: [f64; 2],
    hi: [f64; 2],
    tolerance: f64,
    hints: &[[f64; 2]],
    mut f: impl FnMut([f64; 2]) -> f64,
) -> f64 {
    let nodes = nodes::<SIDE>();
    let hints: Vec<Hint> = hints.iter().map(|p| (*p, f(*p).abs())).collect();
    let whole = Part::new(&nodes, lo, hi, &hints, &mut f);
    whole.refine(&nodes, tolerance, DEEPEST, f64::INFINITY, &hints, &mut f)
}

/// A point and |f| there.
type Hint = ([f64; 2], f64);

/// A rectangle, and what the nodes see of it.
struct Part {
    lo: [f64; 2],
    hi: [f64; 2],
    integral: f64,
    /// About the most that the nodes may have missed next to a side.
    unseen: f64,
}

impl Part {
    fn new(
        nodes: &[(f64, f64)],
        lo: [f64; 2],
        hi: [f64; 2],
        hints: &[Hint],
        f: &mut impl FnMut([f64; 2]) -> f64,
    ) -> Part {
        let half = [0, 1].map(|i| (hi[i] - lo[i]) / 2.0);
        let mut ask = |x: f64, y: f64| f([(lo[0] + hi[0]) / 2.0 + half[0] * x, (lo[1] + hi[1]) / 2.0 + half[1] * y]);
        let (mut sum, mut inside, mut zeros) = (0.0, 0.0_f64, 0);
        for (x, wx) in nodes {
            for (y, wy) in nodes {
                let value = ask(*x, *y);
                sum += wx * wy * value;
                inside = inside.max(value.abs());
                zeros += usize::from(value == 0.0);
            }
        }
        // Just inside the corners and the middles of the sides, one of which a border or a peak beside it will touch.
        const RIM: f64 = 1.0 - 1e-6;
        let rim =
            [(RIM, RIM), (RIM, 0.0), (RIM, -RIM), (0.0, RIM), (0.0, -RIM), (-RIM, RIM), (-RIM, 0.0), (-RIM, -RIM)];
        let rim = rim.map(|(x, y)| ask(x, y).abs());
        zeros += rim.iter().filter(|value| **value == 0.0).count();
        let known = hints.iter().filter(|(p, _)| (0..2).all(|i| lo[i] <= p[i] && p[i] < hi[i])).map(|hint| hint.1);
        let largest = rim.into_iter().chain(known).fold(inside, f64::max);
        let mixed = zeros > 0 && zeros < nodes.len() * nodes.len() + rim.len();
        let unseen = if mixed || largest > 4.0 * inside { UNSEEN * largest * 4.0 * half[0] * half[1] } else { 0.0 };
        Part { lo, hi, integral: sum * half[0] * half[1], unseen }
    }

    fn refine(
        &self,
        nodes: &[(f64, f64)],
        tolerance: f64,
        depth: u32,
        last_error: f64,
        hints: &[Hint],
        f: &mut impl FnMut([f64; 2]) -> f64,
    ) -> f64 {
        let halves = [0, 1].map(|axis| {
            let middle = (self.lo[axis] + self.hi[axis]) / 2.0;
            let (mut low_hi, mut high_lo) = (self.hi, self.lo);
            (low_hi[axis], high_lo[axis]) = (middle, middle);
            [Part::new(nodes, self.lo, low_hi, hints, f), Part::new(nodes, high_lo, self.hi, hints, f)]
        });
        let sum = |axis: usize| halves[axis][0].integral + halves[axis][1].integral;
        let unseen = |axis: usize| halves[axis][0].unseen + halves[axis][1].unseen;
        let change = [0, 1].map(|axis| (sum(axis) - self.integral).abs());
        // What halving changes, and what it brings to sight.
        let gain = [0, 1].map(|axis| change[axis] + self.unseen - unseen(axis));
        let axis = if gain[0] == gain[1] { depth as usize % 2 } else { usize::from(gain[1] > gain[0]) };
        let error = change[0] + change[1] + unseen(axis);
        // Nodes can agree by chance: the rectangle around must have been nearly right too. No subdivision mends a NaN.
        if (error <= tolerance && last_error <= 100.0 * tolerance) || !error.is_finite() || depth == 0 {
            return sum(axis);
        }
        let tolerance = tolerance * std::f64::consts::FRAC_1_SQRT_2;
        let halve = |part: &Part| {
            let inside = |p: &[f64; 2]| part.lo[axis] <= p[axis] && p[axis] < part.hi[axis];
            let hints: Vec<Hint> = hints.iter().filter(|(p, _)| inside(p)).copied().collect();
            part.refine(nodes, tolerance, depth - 1, error, &hints, f)
        };
        halves[axis].iter().map(halve).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_is_exact_for_polynomials() {
        for power in 0..16 {
            let exact = if power % 2 == 0 { 2.0 / f64::from(power + 1) } else { 0.0 };
            assert!((gauss::<8>(-1.0, 1.0, |x| x.powi(power)) - exact).abs() < 1e-14, "x^{power}");
        }
        assert!((gauss::<64>(0.0, PI, f64::sin) - 2.0).abs() < 1e-13);
    }

    #[test]
    fn rectangles_find_edges_and_peaks() {
        // A Gaussian, a step across the diagonal, and a step just beside two sides.
        let peak = |[x, y]: [f64; 2]| (-((x - 0.3).powi(2) + (y - 0.6).powi(2)) * 1e3).exp();
        let found = rectangle([0.0; 2], [1.0; 2], 1e-9, peak);
        assert!((found / (PI * 1e-3) - 1.0).abs() < 1e-5, "{found}");
        let step = |[x, y]: [f64; 2]| if x + y < 1.0 { 2.0 } else { 0.0 };
        let found = rectangle([0.0; 2], [1.0; 2], 1e-4, step);
        assert!((found - 1.0).abs() < 1e-3, "{found}");
        for x0 in [0.01, 0.99] {
            let found = rectangle([0.0; 2], [1.0; 2], 1e-4, |[x, _]| if x < x0 { 1.0 } else { 0.0 });
            assert!((found - x0).abs() < 1e-3, "{found}");
        }
    }
}
