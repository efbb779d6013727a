//! Which triangles enter the tree.

use super::{Bounds, Triangle};

/// Triangles that were left out, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dropped {
    /// A coordinate is infinite or NaN.
    pub non_finite: usize,
    /// The corners lie on one line or in one point: no ray hits such a triangle, whatever rounding may say.
    pub zero_area: usize,
}

/// The triangles that enter the tree, numbered anew from 0.
pub(in crate::host) struct Usable {
    /// Number in the original slice.
    pub numbers: Vec<u32>,
    /// Exact bounds.
    pub bounds: Vec<Bounds>,
    pub dropped: Dropped,
}

/// Sorts out triangles that no ray can hit.
pub(in crate::host) fn usable(triangles: &[Triangle]) -> Usable {
    let mut usable = Usable { numbers: Vec::new(), bounds: Vec::new(), dropped: Dropped::default() };
    for (number, triangle) in triangles.iter().enumerate() {
        if !triangle.as_flattened().iter().all(|x| x.is_finite()) {
            usable.dropped.non_finite += 1;
        } else if has_zero_area(triangle) {
            usable.dropped.zero_area += 1;
        } else {
            usable.numbers.push(number as u32);
            usable.bounds.push(Bounds::of(triangle));
        }
    }
    usable
}

/// Whether a ray can hit a triangle: it is finite, and its corners do not lie on one line.
pub fn can_be_hit(triangle: &Triangle) -> bool {
    triangle.as_flattened().iter().all(|x| x.is_finite()) && !has_zero_area(triangle)
}

/// Whether the edges' cross product vanishes: in f64 it neither overflows nor underflows for f32 corners.
fn has_zero_area([a, b, c]: &Triangle) -> bool {
    let edge = |to: &[f32; 3]| [0, 1, 2].map(|k| f64::from(to[k]) - f64::from(a[k]));
    let (e, f) = (edge(b), edge(c));
    let cross = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
    cross == [0.0; 3]
}
