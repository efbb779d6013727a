//! Splits where the surface area heuristic is least: a good tree in time n · log n at most n · depth, on any input.
//!
//! A ray meets a box within a box with the probability of the ratio of their surfaces, so a split into two boxes of areas A and
//! B that hold a and b blocks of triangles costs A·a + B·b (MacDonald & Booth 1990). It is looked for between the bins of each
//! axis only (Wald, *On fast construction of SAH-based bounding volume hierarchies*, 2007).

use super::tree::{NodeId, Tree};
use super::{Bounds, MAX_DEPTH, MAX_LEAF, median};

/// Bins along each axis, as Wald has them.
const BINS: usize = 16;
/// Levels that median splits need at most: 2^26 boxes in leaves of four.
const MEDIAN_LEVELS: usize = 24;

/// Builds the whole tree over `boxes`.
pub(super) fn build(boxes: &[Bounds]) -> Tree {
    let mut tree = Tree::default();
    let mut members = (0..boxes.len() as u32).collect::<Vec<_>>();
    grow(&mut tree, &mut members, boxes, 0);
    tree
}

/// Adds a subtree over `members`, numbers in `boxes`, that lies `depth` inner nodes below the root.
fn grow(tree: &mut Tree, members: &mut [u32], boxes: &[Bounds], depth: usize) -> NodeId {
    if members.len() <= MAX_LEAF {
        return tree.leaf(members, boxes);
    }
    let best = if depth < MAX_DEPTH - MEDIAN_LEVELS { Bins::new(members, boxes).best() } else { None };
    let Some(plane) = best else { return median::grow(tree, members, boxes) };
    let mut first = 0;
    for at in 0..members.len() {
        if plane.is_first(&boxes[members[at] as usize]) {
            members.swap(first, at);
            first += 1;
        }
    }
    let (left, right) = members.split_at_mut(first);
    let children = [grow(tree, left, boxes, depth + 1), grow(tree, right, boxes, depth + 1)];
    tree.inner(children)
}

/// A plane between two boxes of centres: those in bins up to `last` are first.
struct Plane {
    scale: Scale,
    last: usize,
}

impl Plane {
    fn is_first(&self, b: &Bounds) -> bool {
        self.scale.bin(b) <= self.last
    }
}

/// From the centre of a box to its bin along an axis.
#[derive(Clone, Copy)]
struct Scale {
    axis: usize,
    start: f64,
    bins_per_length: f64,
}

impl Scale {
    fn bin(&self, b: &Bounds) -> usize {
        // A conversion that saturates: whatever rounding does, it is a bin.
        (((b.doubled_centre()[self.axis] - self.start) * self.bins_per_length) as usize).min(BINS - 1)
    }
}

/// The members of a node by bins along each axis on which their centres differ.
struct Bins {
    axes: Vec<(Scale, [(Bounds, usize); BINS])>,
}

impl Bins {
    fn new(members: &[u32], boxes: &[Bounds]) -> Bins {
        let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for &i in members {
            let centre = boxes[i as usize].doubled_centre();
            lo = [0, 1, 2].map(|k| lo[k].min(centre[k]));
            hi = [0, 1, 2].map(|k| hi[k].max(centre[k]));
        }
        let scale = |axis: usize| Scale { axis, start: lo[axis], bins_per_length: BINS as f64 / (hi[axis] - lo[axis]) };
        let axes = (0..3).filter(|k| lo[*k] < hi[*k]).map(|k| (scale(k), [(Bounds::EMPTY, 0); BINS]));
        let mut bins = Bins { axes: axes.collect() };
        for &i in members {
            let member = &boxes[i as usize];
            for (scale, bins) in &mut bins.axes {
                let (bounds, count) = &mut bins[scale.bin(member)];
                *bounds = bounds.union(member);
                *count += 1;
            }
        }
        bins
    }

    /// The cheapest plane with members on both sides; none if all centres are in one place.
    fn best(&self) -> Option<Plane> {
        let mut best: Option<(f64, Plane)> = None;
        for (scale, bins) in &self.axes {
            let behind = sums(bins.iter().rev());
            for (last, before) in sums(bins.iter()).into_iter().enumerate().take(BINS - 1) {
                let sides = [before, behind[BINS - 2 - last]];
                let cost = sides.map(|(bounds, count)| bounds.half_area() * count.div_ceil(MAX_LEAF) as f64);
                let cost = cost[0] + cost[1];
                let divides = sides.iter().all(|(_, count)| *count > 0);
                if divides && best.as_ref().is_none_or(|(least, _)| cost < *least) {
                    best = Some((cost, Plane { scale: *scale, last }));
                }
            }
        }
        best.map(|(_, plane)| plane)
    }
}

/// What the first, the first two, … the first all of the bins hold together.
fn sums<'b>(bins: impl Iterator<Item = &'b (Bounds, usize)>) -> Vec<(Bounds, usize)> {
    let mut all = (Bounds::EMPTY, 0);
    let add = |(bounds, count): &(Bounds, usize)| {
        all = (all.0.union(bounds), all.1 + count);
        all
    };
    bins.map(add).collect()
}
