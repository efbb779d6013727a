//! Coordinates of a light, in which its density has no jumps but along the lines of a grid: there expected counts are
//! cheap, and the integral of the density is exact to rounding.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec2, DVec3};
use jerboa_scenes::Environment;

use super::super::chi2::{Report, Worst, pearson};
use super::super::probe::{V, normalize};
use super::super::quadrature::nodes;
use super::super::stats::chi2_tail;

/// The unit square laid over a light.
#[derive(Clone)]
pub enum Chart {
    /// A corner and two edges, which are the coordinates.
    Parallelogram([V; 3]),
    /// Half of that: corner + s (u + t v).
    Triangle([V; 3]),
    /// The coordinates of an environment map.
    Map(Environment),
    /// A cone by its axis and its 1 − cos: the share of that, and turns.
    Cone(DVec3, f64),
    /// A disk by its middle, its normal and its radius: the share of its area, and turns.
    Disk(DVec3, DVec3, f64),
}

/// Cells along each edge of an area light.
const CELLS: usize = 8;
/// How well a rounded direction says from which place it was made: some units in the last place of a coordinate of 1.
const ROUNDED: f64 = 1e-6;

impl Chart {
    /// Cells along each coordinate: of a map an even number to a texel, at whose middle its density bends, and several where
    /// there are few.
    fn grid(&self) -> [usize; 2] {
        match self {
            Chart::Map(map) => [map.width, map.height].map(|n| 2 * n as usize * CELLS.div_ceil(2 * n as usize)),
            _ => [CELLS; 2],
        }
    }

    /// The direction at a place, and steradians per unit of the square there.
    fn direction(&self, point: V, [s, t]: [f64; 2]) -> (V, f64) {
        let point = DVec3::from(point.map(f64::from));
        let seen = |[corner, u, v]: &[V; 3], a: f64, b: f64| {
            let [corner, u, v] = [corner, u, v].map(|x| DVec3::from(x.map(f64::from)));
            let to = corner + u * a + v * b - point;
            (normalize(to.to_array()), to.dot(u.cross(v)).abs() / to.length().powi(3))
        };
        match self {
            Chart::Parallelogram(quad) => seen(quad, s, t),
            Chart::Triangle(quad) => {
                let (direction, measure) = seen(quad, s, s * t);
                (direction, measure * s)
            }
            Chart::Map(map) => {
                let (phi, theta) = (TAU * (s - 0.5) - f64::from(map.rotation_deg).to_radians(), PI * t);
                let dir = [theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos()];
                (normalize(dir), 2.0 * PI * PI * theta.sin())
            }
            Chart::Cone(axis, opening) => {
                let (away, turn) = (s * opening, DVec2::from_angle(TAU * t));
                let around = across(*axis) * turn.extend(0.0) * (away * (2.0 - away)).max(0.0).sqrt();
                (normalize((axis * (1.0 - away) + around).to_array()), TAU * opening)
            }
            Chart::Disk(middle, normal, radius) => {
                let around = across(*normal) * DVec2::from_angle(TAU * t).extend(0.0) * (radius * s.max(0.0).sqrt());
                let to = middle + around - point;
                (normalize(to.to_array()), PI * radius * radius * to.dot(*normal).abs() / to.length().powi(3))
            }
        }
    }

    /// Steradians of a cell of a lamp, the sum of two flat triangles (van Oosterom and Strackee 1983).
    fn angle(&self, point: V, [x, y]: [usize; 2], [across, down]: [usize; 2]) -> Option<f64> {
        let (quad, is_triangle) = match self {
            Chart::Parallelogram(quad) => (quad, false),
            Chart::Triangle(quad) => (quad, true),
            Chart::Map(_) | Chart::Cone(..) | Chart::Disk(..) => return None,
        };
        let [origin, u, v] = quad.map(|x| DVec3::from(x.map(f64::from)));
        let origin = origin - DVec3::from(point.map(f64::from));
        let corner = |i: usize, j: usize| {
            let (s, t) = (i as f64 / across as f64, j as f64 / down as f64);
            origin + u * s + v * if is_triangle { s * t } else { t }
        };
        let triangle = |[p, q, r]: [DVec3; 3]| {
            let [a, b, c] = [p, q, r].map(|p| p.length());
            let volume = p.dot((q - p).cross(r - p)).abs();
            2.0 * volume.atan2(a * b * c + p.dot(q) * c + q.dot(r) * a + r.dot(p) * b)
        };
        let [p, q, r, s] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
        Some(triangle([p, q, r]) + triangle([p, r, s]))
    }

    /// The place of a direction.
    fn place(&self, point: V, dir: V) -> [f64; 2] {
        let dir = DVec3::from(dir.map(f64::from));
        let met = |quad: &[V; 3]| {
            let [corner, u, v] = quad.map(|x| DVec3::from(x.map(f64::from)));
            // point + d dir = corner + s u + t v.
            let solved = DMat3::from_cols(u, v, -dir).inverse() * (DVec3::from(point.map(f64::from)) - corner);
            [solved.x, solved.y]
        };
        match self {
            Chart::Parallelogram(quad) => met(quad),
            Chart::Triangle(quad) => {
                let [a, b] = met(quad);
                [a, if a > 0.0 { b / a } else { 0.0 }]
            }
            Chart::Map(map) => {
                let phi = dir.x.atan2(-dir.z) + f64::from(map.rotation_deg).to_radians();
                [(phi / TAU + 0.5).rem_euclid(1.0), dir.y.clamp(-1.0, 1.0).acos() / PI]
            }
            Chart::Cone(axis, opening) => {
                let around = across(*axis).transpose() * dir;
                [(dir - *axis).length_squared() / 2.0 / opening, turns(around)]
            }
            Chart::Disk(middle, normal, radius) => {
                let to = *middle - DVec3::from(point.map(f64::from));
                let off = dir * (normal.dot(to) / normal.dot(dir)) - to;
                [off.length_squared() / (radius * radius), turns(across(*normal).transpose() * off)]
            }
        }
    }

    /// χ² of directions from a point (`None`: there was none) against a density per steradian, over the cells. `by_angle`: it
    /// is constant over a lamp.
    pub fn test(&self, point: V, samples: &[Option<V>], by_angle: bool, mut pdf: impl FnMut(V) -> f64) -> Report {
        let [across, down] = self.grid();
        let (mut seen, mut expected) = (vec![0.0; across * down], vec![0.0; across * down]);
        for (i, cell) in expected.iter_mut().enumerate() {
            let mut whole = 0.0;
            for (x, wx) in nodes::<3>() {
                for (y, wy) in nodes::<3>() {
                    let at = |k: usize, n: usize, x: f64| (k as f64 + (x + 1.0) / 2.0) / n as f64;
                    let place = [at(i % across, across, x), at(i / across, down, y)];
                    let (direction, measure) = self.direction(point, place);
                    let weight = wx * wy / 4.0 * measure / (across * down) as f64;
                    (*cell, whole) = (*cell + weight * pdf(direction), whole + weight);
                }
            }
            // By area the product is smooth; by solid angle the density is constant, and a close lamp's measure far from it.
            if by_angle && whole > 0.0 {
                let exact = self.angle(point, [i % across, i / across], [across, down]);
                *cell *= exact.map_or(1.0, |exact| exact / whole);
            }
        }
        let (mut found, mut stray) = (0, 0);
        for dir in samples.iter().copied().flatten() {
            let cell = |x: f64, n: usize| ((x * n as f64).max(0.0) as usize).min(n - 1);
            let [s, t] = self.place(point, dir);
            found += 1;
            // What was drawn at the rim of a cell may be on the other side as a direction.
            let around = [(ROUNDED, 0.0), (-ROUNDED, 0.0), (0.0, ROUNDED), (0.0, -ROUNDED)];
            let mut is_dark = |dir| pdf(dir) == 0.0;
            let beside = |(ds, dt): (f64, f64)| self.direction(point, [s + ds, t + dt]).0;
            stray += usize::from(is_dark(dir) && around.into_iter().map(beside).all(is_dark));
            seen[cell(t, down) * across + cell(s, across)] += 1.0;
        }
        let integral: f64 = expected.iter().sum();
        let scale = f64::from(found) / integral.max(f64::MIN_POSITIVE);
        expected.iter_mut().for_each(|e| *e *= scale);
        let (chi2, freedom) = pearson(&seen, &expected);
        let part = |i: usize| (seen[i] - expected[i]).powi(2) / expected[i].max(1.0);
        let worst = (0..seen.len()).max_by(|i, j| part(*i).total_cmp(&part(*j))).expect("there is a cell");
        Report {
            p: if freedom == 0 { 1.0 } else { chi2_tail(chi2, freedom) },
            chi2,
            freedom,
            integral,
            lost: 1.0 - f64::from(found) / samples.len() as f64,
            samples: samples.len(),
            stray,
            invalid: None,
            worst: Worst {
                middle: format!("cell {} of {across}, {} of {down}", worst % across, worst / across),
                seen: seen[worst],
                expected: expected[worst],
            },
        }
    }
}

/// A frame whose third axis is this unit vector.
fn across(axis: DVec3) -> DMat3 {
    let (u, v) = axis.any_orthonormal_pair();
    DMat3::from_cols(u, v, axis)
}

/// The angle of x and y, in turns from 0 to 1.
fn turns(v: DVec3) -> f64 {
    (v.y.atan2(v.x) / TAU).rem_euclid(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_directions_are_inverse() {
        let quad = [[0.3, 0.2, 0.1], [0.7, 0.1, -0.2], [0.2, 0.8, 0.5]];
        let texel = vec![[1.0; 3]];
        let map = Environment { width: 1, height: 1, radiance: texel, intensity: 1.0, rotation_deg: 40.0 };
        let axis = DVec3::new(2.0, -3.0, 6.0) / 7.0;
        let round = [Chart::Cone(axis, 0.3), Chart::Disk(DVec3::new(0.1, 1.5, 0.4), axis, 0.5)];
        for chart in [Chart::Parallelogram(quad), Chart::Triangle(quad), Chart::Map(map)].into_iter().chain(round) {
            let point = [0.9, 0.7, 0.2];
            for place in [[0.2, 0.3], [0.9, 0.1], [0.5, 0.75]] {
                let (direction, _) = chart.direction(point, place);
                let back = chart.place(point, direction);
                assert!((0..2).all(|i| (back[i] - place[i]).abs() < 1e-5), "{place:?} {back:?}");
            }
            // The measure is that of directions: a small step spans it.
            let at = |s, t| DVec3::from(chart.direction(point, [s, t]).0.map(f64::from));
            let (u, v) = (at(0.45, 0.4) - at(0.35, 0.4), at(0.4, 0.45) - at(0.4, 0.35));
            let measure = chart.direction(point, [0.4, 0.4]).1;
            assert!((u.cross(v).length() / 0.01 / measure - 1.0).abs() < 0.05, "{measure}");
        }
    }
}
