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
/// Most subdivisions of a rectangle. A jump across a whole side then costs 2^-10 of what it is worth there.
const DEEPEST: u32 = 10;
/// A peak or a border of the support between the outermost nodes and a side of the rectangle is not seen by the nodes:
/// 0.035 of it, once halved.
const UNSEEN: f64 = 0.035;

/// ∫ f over the rectangle between two corners, with an error of about `tolerance`, if nodes a quarter apart see its peaks.
///
/// Where 16 nodes and four times 16 nodes differ by more than that, the quarters are asked, each for half the tolerance:
/// the errors of four add up like random numbers. So they are where f is 0 in a part or much larger at a corner, by what
/// may be unseen there.
pub fn rectangle(lo: [f64; 2], hi: [f64; 2], tolerance: f64, mut f: impl FnMut([f64; 2]) -> f64) -> f64 {
    let nodes = nodes::<SIDE>();
    let whole = Part::new(&nodes, lo, hi, &mut f);
    whole.refine(&nodes, tolerance, DEEPEST, &mut f)
}

/// A rectangle, and what the nodes see of it.
struct Part {
    lo: [f64; 2],
    hi: [f64; 2],
    integral: f64,
    /// About the most that the nodes may have missed next to a side.
    unseen: f64,
}

impl Part {
    fn new(nodes: &[(f64, f64)], lo: [f64; 2], hi: [f64; 2], f: &mut impl FnMut([f64; 2]) -> f64) -> Part {
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
        // Next to the corners, which a straight border cannot pass by.
        const CORNER: f64 = 0.999;
        let corners = [[-CORNER, -CORNER], [CORNER, -CORNER], [-CORNER, CORNER], [CORNER, CORNER]];
        let corners = corners.map(|[x, y]| ask(x, y).abs());
        zeros += corners.iter().filter(|value| **value == 0.0).count();
        let largest = corners.into_iter().fold(inside, f64::max);
        let mixed = zeros > 0 && zeros < nodes.len() * nodes.len() + corners.len();
        let unseen = if mixed || largest > 4.0 * inside { UNSEEN * largest * 4.0 * half[0] * half[1] } else { 0.0 };
        Part { lo, hi, integral: sum * half[0] * half[1], unseen }
    }

    fn refine(&self, nodes: &[(f64, f64)], tolerance: f64, depth: u32, f: &mut impl FnMut([f64; 2]) -> f64) -> f64 {
        let middle = [0, 1].map(|i| (self.lo[i] + self.hi[i]) / 2.0);
        let quarters = [0, 1, 2, 3].map(|q| {
            let upper = [q & 1 == 1, q & 2 == 2];
            let lo = [0, 1].map(|i| if upper[i] { middle[i] } else { self.lo[i] });
            let hi = [0, 1].map(|i| if upper[i] { self.hi[i] } else { middle[i] });
            Part::new(nodes, lo, hi, f)
        });
        let sum: f64 = quarters.iter().map(|part| part.integral).sum();
        let unseen: f64 = quarters.iter().map(|part| part.unseen).sum();
        let error = (sum - self.integral).abs() + unseen;
        // No subdivision mends a NaN.
        if error <= tolerance || !error.is_finite() || depth == 0 {
            return sum;
        }
        quarters.iter().map(|part| part.refine(nodes, tolerance / 2.0, depth - 1, f)).sum()
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
