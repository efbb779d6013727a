//! Rays at closed shapes (accuracy.md, T9), and trees to trace them in.
//!
//! A row of [`SHAPES`], [`AIMS`] or [`PLACES`] adds a shape, a way to aim or a place to every test of what rays hit. All
//! rays start inside their shape, so a ray that hits nothing has found a hole.

use jerboa_ir::lang::{Bool, Fun, Keep, entry};
use jerboa_lib_render::host::bvh::{Bounds, Bvh, BvhNode, ChildRef, Triangle};
use jerboa_lib_render::host::tables::plane::Plane;
use jerboa_lib_render::ray::{Hit, Ray};
use jerboa_lib_render::schema::{NONE, Primitives, Tree as Words, Vertices};
use jerboa_lib_render::traverse::{AcceptFn, TraverseFn};

use super::bench::{Bench, Random};
use super::probe::{V, random_direction};

/// A closed surface about 0 whose corners are shared to the bit. Everything within 0.7 of 0 lies inside, nothing beyond 2.
pub struct Shape {
    /// What tests call it.
    pub name: &'static str,
    /// Its triangles.
    pub triangles: fn() -> Vec<Triangle>,
}

/// The closed shapes.
pub const SHAPES: [Shape; 3] = [
    Shape { name: "sphere", triangles: || ball(16, |_, _| 1.0) },
    Shape { name: "box", triangles: || cube(3) },
    Shape { name: "displaced sphere", triangles: || ball(16, bumpy) },
];

/// Between 0.75 and 1.25, without a pattern: the fractions of multiples of the golden ratio.
fn bumpy(i: usize, j: usize) -> f64 {
    0.75 + 0.5 * ((16 * i + j) as f64 * 0.618_033_988_749_895).fract()
}

/// A sphere by latitude and longitude, `around` corners on the equator, of a radius that depends on the corner.
pub fn ball(around: usize, radius: impl Fn(usize, usize) -> f64) -> Vec<Triangle> {
    let at = |i: usize, j: usize| {
        let j = if i == 0 || 2 * i == around { 0 } else { j % around };
        let theta = std::f64::consts::PI * i as f64 / (around / 2) as f64;
        let phi = std::f64::consts::TAU * j as f64 / around as f64;
        // At a pole sin θ is rounding noise; the axis is exact.
        let across = if j == 0 && (i == 0 || 2 * i == around) { 0.0 } else { theta.sin() };
        [across * phi.cos(), across * phi.sin(), theta.cos()].map(|x| (x * radius(i, j)) as f32)
    };
    let cells = (0..around / 2).flat_map(|i| (0..around).map(move |j| (i, j)));
    let halves = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    halves.filter(|[a, b, c]| a != b && b != c && c != a).collect()
}

/// The box from -1 to 1, each side cut into `n` by `n` squares.
pub fn cube(n: usize) -> Vec<Triangle> {
    let step = |i: usize| (2.0 * i as f64 / n as f64 - 1.0) as f32;
    let mut triangles = Vec::new();
    for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, n)]) {
        let at = |i: usize, j: usize| {
            let mut p = [0.0; 3];
            (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (step(side), step(i), step(j));
            p
        };
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    triangles
}

/// Where a shape stands, and its size.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// World.
    pub centre: V,
    /// World units per unit of the shape.
    pub scale: f32,
}

impl Place {
    /// From the shape's units to world, rounded as any f32 coordinates are.
    pub fn world(self, p: V) -> V {
        [0, 1, 2].map(|k| p[k] * self.scale + self.centre[k])
    }
}

const fn place(centre: V, scale: f32) -> Place {
    Place { centre, scale }
}

/// Sizes from 1e-15 to 1e15 about 0; and places away from 0, among them the one that Embree's tests use.
pub const PLACES: [Place; 12] = [
    place([0.0; 3], 1.0),
    place([0.0; 3], 1e-15),
    place([0.0; 3], 1e-10),
    place([0.0; 3], 1e-5),
    place([0.0; 3], 1e-3),
    place([0.0; 3], 1e3),
    place([0.0; 3], 1e6),
    place([0.0; 3], 1e15),
    place([1.37, -2.21, 0.5], 1.0),
    place([148_376.0, 1234.0, -223_423.0], 1.0),
    place([1e6; 3], 1.0),
    place([1.0; 3], 1e-3),
];

/// A way to aim at a shape from inside.
pub struct Aim {
    /// What tests call it.
    pub name: &'static str,
    /// (random numbers, where the shape stands, its triangles there) → origin and direction, not unit, world.
    pub ray: fn(&mut Random, Place, &[Triangle]) -> (V, V),
}

/// The ways to aim.
pub const AIMS: [Aim; 5] = [
    Aim { name: "vertices", ray: at_vertex },
    Aim { name: "edges", ray: at_edge },
    Aim { name: "random", ray: anywhere },
    Aim { name: "within a plane", ray: within_plane },
    Aim { name: "along an axis", ray: along_axis },
];

fn inside(random: &mut Random, place: Place) -> V {
    place.world(random.point().map(|x| 0.4 * x))
}

fn sub(a: V, b: V) -> V {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn at_vertex(random: &mut Random, place: Place, triangles: &[Triangle]) -> (V, V) {
    let org = inside(random, place);
    (org, sub(triangles[random.below(triangles.len())][random.below(3)], org))
}

fn at_edge(random: &mut Random, place: Place, triangles: &[Triangle]) -> (V, V) {
    let org = inside(random, place);
    let (t, i) = (triangles[random.below(triangles.len())], random.below(3));
    let (p, q, weight) = (t[i], t[(i + 1) % 3], random.uniform() as f32);
    (org, [0, 1, 2].map(|k| p[k] + weight * (q[k] - p[k]) - org[k]))
}

fn anywhere(random: &mut Random, place: Place, _: &[Triangle]) -> (V, V) {
    (inside(random, place), random_direction(random))
}

/// A corner, and those of its coordinates that are so near the centre's that an origin may share them.
fn shared(random: &mut Random, place: Place, triangles: &[Triangle], least: usize) -> (V, Vec<usize>) {
    loop {
        let v = triangles[random.below(triangles.len())][random.below(3)];
        let near: Vec<usize> = (0..3).filter(|&k| (v[k] - place.centre[k]).abs() < 0.4 * place.scale).collect();
        if near.len() >= least {
            return (v, near);
        }
    }
}

/// Towards a corner from an origin with one of its coordinates: in the plane of the sides of boxes, 0 · ∞ in a slab.
fn within_plane(random: &mut Random, place: Place, triangles: &[Triangle]) -> (V, V) {
    let mut org = inside(random, place);
    let (v, near) = shared(random, place, triangles, 1);
    org[near[0]] = v[near[0]];
    (org, sub(v, org))
}

/// Towards a corner along an axis: two coordinates shared.
fn along_axis(random: &mut Random, place: Place, triangles: &[Triangle]) -> (V, V) {
    let mut org = inside(random, place);
    let (v, near) = shared(random, place, triangles, 2);
    near[..2].iter().for_each(|&k| org[k] = v[k]);
    (org, sub(v, org))
}

/// The direction of length 1.
pub fn unit(dir: V) -> V {
    super::probe::normalize(dir.map(f64::from))
}

/// Arguments of a kernel that takes a [`Ray`]: without end, and skipping nothing.
pub fn ray(org: V, dir: V) -> [u32; 10] {
    let floats = [org[0], org[1], org[2], dir[0], dir[1], dir[2], f32::INFINITY].map(f32::to_bits);
    std::array::from_fn(|i| floats.get(i).copied().unwrap_or(NONE))
}

/// A tree for the same triangles, by another way.
pub struct Tree {
    /// What tests call it.
    pub name: &'static str,
    /// From the triangles; numbers are those of the slice.
    pub build: fn(&mut Random, &[Triangle]) -> Bvh,
}

/// Trees that have nothing in common but their triangles.
pub const TREES: [Tree; 3] = [
    Tree { name: "as built", build: |_, triangles| Bvh::build(triangles) },
    Tree { name: "of shuffled triangles", build: shuffled },
    Tree { name: "quartered by number", build: |_, triangles| by_number(triangles) },
];

fn shuffled(random: &mut Random, triangles: &[Triangle]) -> Bvh {
    let mut numbers: Vec<u32> = (0..triangles.len() as u32).collect();
    for i in (1..numbers.len()).rev() {
        numbers.swap(i, random.below(i + 1));
    }
    let mixed: Vec<Triangle> = numbers.iter().map(|n| triangles[*n as usize]).collect();
    let mut bvh = Bvh::build(&mixed);
    bvh.order.iter_mut().for_each(|slot| *slot = numbers[*slot as usize]);
    bvh
}

/// Without regard to where triangles are: boxes that overlap as much as they can.
fn by_number(triangles: &[Triangle]) -> Bvh {
    let mut bvh = Bvh::build(triangles);
    bvh.order.sort_unstable();
    bvh.nodes.clear();
    quarter(&mut bvh.nodes, &bvh.order, triangles, 0);
    bvh
}

fn quarter(nodes: &mut Vec<BvhNode>, order: &[u32], triangles: &[Triangle], first: u32) -> ChildRef {
    let index = nodes.len();
    nodes.push(BvhNode::EMPTY);
    let mut node = BvhNode::EMPTY;
    let mut first = first;
    for (lane, part) in order.chunks(order.len().div_ceil(4).max(1)).enumerate() {
        let bounds = part.iter().fold(Bounds::EMPTY, |b, n| b.union(&Bounds::of(&triangles[*n as usize])));
        let count = part.len() as u32;
        let leaf = ChildRef::Leaf { first, count };
        node.bounds[lane] = bounds;
        node.child[lane] = if part.len() <= 2 { leaf } else { quarter(nodes, part, triangles, first) };
        first += count;
    }
    nodes[index] = node;
    ChildRef::Inner(index as u32)
}

/// Put a tree on the bench, and its triangles for brute force.
pub fn load(bench: &mut Bench, bvh: &Bvh, triangles: &[Triangle]) {
    let words = bvh.words(triangles);
    bench.rows::<Words>(words.len());
    words.into_iter().enumerate().for_each(|(row, word)| bench.set(Words::WORD, row, word));
    bench.rows::<Primitives>(bvh.order.len().max(1));
    bench.rows::<Vertices>(3 * bvh.order.len().max(1));
    for (slot, &number) in bvh.order.iter().enumerate() {
        bench.set(Primitives::I0, slot, number);
        for (k, corner) in triangles[number as usize].iter().enumerate() {
            let columns = [Vertices::X, Vertices::Y, Vertices::Z];
            columns.into_iter().zip(corner).for_each(|(column, x)| bench.set(column, 3 * slot + k, *x));
        }
    }
}

/// Put what hits need of a triangle's plane on the bench.
pub fn set_plane(bench: &mut Bench, primitive: usize, triangle: &Triangle) {
    Plane::of(triangle).columns().into_iter().for_each(|(column, x)| bench.set(column, primitive, x));
}

/// Declares kernels `nearest` and `any` (ray → hit) of a traversal that accepts every hit.
pub fn declare_traversal(traverse: TraverseFn) {
    let all = AcceptFn::lam(|_, _| Bool::from(true));
    let kind = |any: bool| Fun::<Ray, Hit>::lam(move |b, ray| traverse.call(b, (ray, Keep(Bool::from(any)), all)));
    entry("nearest", kind(false));
    entry("any", kind(true));
}
