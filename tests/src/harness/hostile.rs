//! Lists of triangles that are hard on the builder of trees (accuracy.md, T29). A row of [`LISTS`] adds one.

use jerboa_lib_render::host::bvh::Triangle;

use super::bench::Random;
use super::probe::V;

/// A list of triangles.
pub struct List {
    /// What tests call it.
    pub name: &'static str,
    /// So many triangles, or a few where the list is of a few.
    pub make: fn(&mut Random, usize) -> Vec<Triangle>,
}

/// The lists. The first is what the others are measured against.
pub const LISTS: [List; 14] = [
    List { name: "random", make: |random, n| soup(random, n, 0.01) },
    List { name: "none", make: |_, _| Vec::new() },
    List { name: "one", make: |random, _| soup(random, 1, 1.0) },
    List { name: "two", make: |random, _| soup(random, 2, 1.0) },
    List { name: "coincident", make: |random, n| vec![soup(random, 1, 1.0)[0]; n] },
    List { name: "points", make: |random, n| soup(random, n, 0.0) },
    List { name: "half of them coincident", make: half_coincident },
    List { name: "of 3e38", make: |random, n| times(soup(random, n, 0.01), 3e38) },
    List { name: "denormal", make: |random, n| times(soup(random, n, 0.01), 1e-40) },
    List { name: "of exponential sizes", make: exponential },
    List { name: "shrinking about a corner", make: shrinking },
    List { name: "a regular grid", make: |_, n| grid(n) },
    List { name: "1 % of them NaN", make: |random, n| spoiled(random, n, n.div_ceil(100), f32::NAN) },
    List { name: "one infinite", make: |random, n| spoiled(random, n, 1, f32::INFINITY) },
];

/// Triangles of this size at random places of the cube from -1 to 1.
pub fn soup(random: &mut Random, n: usize, size: f32) -> Vec<Triangle> {
    let corner = |at: V, by: V| [0, 1, 2].map(|k| at[k] + size * by[k]);
    let triangle = |_| {
        let at = random.point();
        [0; 3].map(|_| corner(at, random.point()))
    };
    (0..n).map(triangle).collect()
}

fn times(triangles: Vec<Triangle>, by: f32) -> Vec<Triangle> {
    triangles.into_iter().map(|t| t.map(|p| p.map(|x| x * by))).collect()
}

fn half_coincident(random: &mut Random, n: usize) -> Vec<Triangle> {
    let mut triangles = soup(random, n, 0.01);
    let one = triangles[0];
    triangles[..n / 2].fill(one);
    triangles
}

/// From 1e37 down to 1e-37, then again.
fn exponential(random: &mut Random, n: usize) -> Vec<Triangle> {
    let size = |i: usize| 10.0_f32.powf(37.0 - 74.0 * ((i as f32 * 0.001) % 1.0));
    let triangles = soup(random, n, 0.2).into_iter().enumerate();
    triangles.map(|(i, t)| t.map(|p| p.map(|x| (x + 1.0) * size(i)))).collect()
}

/// Each smaller than the last by less than a thousandth, about one corner: builders merge them one at a time.
fn shrinking(_: &mut Random, n: usize) -> Vec<Triangle> {
    let size = |i: usize| (-80.0 * i as f32 / n as f32).exp2();
    (0..n).map(|i| [[0.0; 3], [size(i), 0.0, 0.0], [0.0, size(i), 0.0]]).collect()
}

/// Equal costs everywhere.
fn grid(n: usize) -> Vec<Triangle> {
    let side = (n as f64 / 2.0).sqrt() as usize;
    let at = |x: usize, y: usize| [x as f32, y as f32, 0.0];
    let cells = (0..side).flat_map(|x| (0..side).map(move |y| (x, y)));
    let halves = cells.flat_map(|(x, y)| {
        let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
        [[a, b, c], [a, c, d]]
    });
    halves.collect()
}

/// So many of them with a coordinate replaced.
fn spoiled(random: &mut Random, n: usize, of_them: usize, by: f32) -> Vec<Triangle> {
    let mut triangles = soup(random, n, 0.01);
    for i in 0..of_them {
        triangles[i * n / of_them][i % 3][i % 2] = by;
    }
    triangles
}
