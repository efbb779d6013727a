//! The tree by `obvhs`, where `obvhs` can be trusted with the input.
//!
//! Its builder (PLOC) orders the boxes along a space-filling curve and merges, pass by pass, neighbours that prefer each
//! other. Where few do, because all costs are equal or fall steadily along the curve, each pass merges little: 100,000
//! coincident triangles did not end in 25 s (facts.md, part 3), and a chain of merges is a tree as deep as it is long.
//! So the boxes are scaled to the unit cube first (areas neither overflow nor vanish), the merging is rehearsed in its
//! cheapest form, and what still comes out too deep is rebuilt.

use super::tree::{NodeId, Tree};
use super::{Bounds, MAX_DEPTH, MAX_LEAF, median};
use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::PlocBuilder;
use obvhs::ploc::morton::morton_encode_u64_unorm;

/// Passes that the rehearsal may take: random triangles lose a third in each, so 10^8 need 25.
const PASSES: usize = 64;
/// So few boxes may merge one at a time, which is quadratic: 2,000 shrinking triangles about one corner took 0.14 s.
const FEW: usize = 2048;
/// Levels that median splits need at most: 2^27 boxes in leaves of eight.
const MEDIAN_LEVELS: usize = 24;

/// The tree over `boxes`, more than a leaf of them; `None` if `obvhs` would take too long.
pub(super) fn build(boxes: &[Bounds]) -> Option<Tree> {
    let unit = to_unit_cube(boxes);
    if !merges_evenly(&unit) {
        return None;
    }
    let bvh = run_obvhs(&unit);
    let mut tree = Tree::default();
    let convert = Convert { heights: heights(&bvh), bvh: &bvh, boxes };
    convert.node(&mut tree, 0, 0);
    Some(tree)
}

/// The boxes, moved and scaled (alike on all axes) so that their union just fits into the unit cube.
fn to_unit_cube(boxes: &[Bounds]) -> Vec<Aabb> {
    let all = boxes.iter().fold(Bounds::EMPTY, |all, b| all.union(b));
    let side = all.extent().into_iter().fold(0.0, f64::max);
    let map =
        |p: [f32; 3]| Vec3A::from_array([0, 1, 2].map(|k| ((f64::from(p[k]) - f64::from(all.lo[k])) / side) as f32));
    boxes.iter().map(|b| Aabb::new(map(b.lo), map(b.hi))).collect()
}

/// Whether merging, rehearsed with direct neighbours only, gets down to [`FEW`] boxes within [`PASSES`].
fn merges_evenly(unit: &[Aabb]) -> bool {
    let code = |b: &Aabb| morton_encode_u64_unorm(b.center().as_dvec3());
    let mut sorted = unit.iter().map(|b| (code(b), *b)).collect::<Vec<_>>();
    sorted.sort_by_key(|(code, _)| *code);
    let mut row = sorted.into_iter().map(|(_, b)| b).collect::<Vec<_>>();
    for _ in 0..PASSES {
        if row.len() <= FEW {
            return true;
        }
        row = merge_neighbours(&row);
    }
    false
}

/// One pass: boxes that prefer each other as partners become one. In a tie the next is preferred, as in `obvhs`.
fn merge_neighbours(row: &[Aabb]) -> Vec<Aabb> {
    let cost = |i: usize| row[i].union(&row[i + 1]).half_area();
    let mut merged = Vec::with_capacity(row.len());
    let mut i = 0;
    let mut before = f32::INFINITY;
    while i + 1 < row.len() {
        let with_next = cost(i);
        let after = if i + 2 < row.len() { cost(i + 1) } else { f32::INFINITY };
        if with_next <= before && with_next < after {
            merged.push(row[i].union(&row[i + 1]));
            i += 2;
            before = after;
        } else {
            merged.push(row[i]);
            i += 1;
            before = with_next;
        }
    }
    merged.extend(row.get(i));
    merged
}

/// The steps of `obvhs`' own helper, without the checks that its debug builds add.
fn run_obvhs(unit: &[Aabb]) -> Bvh2 {
    let settings = BvhBuildParams::medium_build();
    let mut bvh = PlocBuilder::with_capacity(unit.len()).build(
        settings.ploc_search_distance,
        unit,
        (0..unit.len() as u32).collect(),
        settings.sort_precision,
        settings.search_depth_threshold,
    );
    let mut reinsertion = ReinsertionOptimizer::default();
    reinsertion.run(&mut bvh, settings.reinsertion_batch_ratio, None);
    collapse(&mut bvh, MAX_LEAF as u32, settings.collapse_traversal_cost);
    let ratio = settings.reinsertion_batch_ratio * settings.post_collapse_reinsertion_batch_ratio_multiplier;
    reinsertion.run(&mut bvh, ratio, None);
    bvh
}

/// For each node, the number of inner nodes on the longest way down. Without recursion: the tree may be very deep.
fn heights(bvh: &Bvh2) -> Vec<u32> {
    let mut top_down = vec![0];
    let mut visited = 0;
    while visited < top_down.len() {
        let node = &bvh.nodes[top_down[visited]];
        if !node.is_leaf() {
            top_down.extend(children(bvh, top_down[visited]));
        }
        visited += 1;
    }
    let mut heights = vec![0; bvh.nodes.len()];
    for &node in top_down.iter().rev() {
        if !bvh.nodes[node].is_leaf() {
            let [a, b] = children(bvh, node);
            heights[node] = 1 + heights[a].max(heights[b]);
        }
    }
    heights
}

fn children(bvh: &Bvh2, node: usize) -> [usize; 2] {
    let first = bvh.nodes[node].first_index as usize;
    [first, first + 1]
}

/// From `obvhs`' nodes to ours.
struct Convert<'a> {
    bvh: &'a Bvh2,
    heights: Vec<u32>,
    boxes: &'a [Bounds],
}

impl Convert<'_> {
    /// Adds the subtree of `node`, which lies `depth` inner nodes below the root.
    fn node(&self, tree: &mut Tree, node: usize, depth: usize) -> NodeId {
        if self.bvh.nodes[node].is_leaf() {
            return tree.leaf(self.leaf(node), self.boxes);
        }
        let too_deep = depth + self.heights[node] as usize > MAX_DEPTH;
        if too_deep && depth == MAX_DEPTH - MEDIAN_LEVELS {
            return median::grow(tree, &mut self.members(node), self.boxes);
        }
        let children = children(self.bvh, node).map(|child| self.node(tree, child, depth + 1));
        tree.inner(children)
    }

    fn leaf(&self, node: usize) -> &[u32] {
        let node = &self.bvh.nodes[node];
        &self.bvh.primitive_indices[node.first_index as usize..][..node.prim_count as usize]
    }

    /// All boxes below `node`. Without recursion: the subtree may be very deep.
    fn members(&self, node: usize) -> Vec<u32> {
        let mut members = Vec::new();
        let mut open = vec![node];
        while let Some(node) = open.pop() {
            if self.bvh.nodes[node].is_leaf() {
                members.extend_from_slice(self.leaf(node));
            } else {
                open.extend(children(self.bvh, node));
            }
        }
        members
    }
}
