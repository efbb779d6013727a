//! Builds the bounding volume hierarchy: a tree of boxes over triangles, four to a node, as an array of words.
//!
//! Only the *build* is here; kernels traverse. The steps, a file each:
//!
//! 1. `prefilter` drops triangles that no ray can hit, counted, and bounds the others;
//! 2. `agglomerate` lets `obvhs` build the tree (PLOC: Meister & Bittner 2018, with reinsertion: Meister & Bittner
//!    2017) where a rehearsal says that it will make progress;
//! 3. `sah` splits where it would not, or where the tree came out too deep for the stack of a walk (the matched kitchen);
//! 4. `median` splits at the median where that does not help: coincident triangles, sizes over many magnitudes;
//! 5. `collapse` makes wide nodes of nodes of two, four children each for kernels, eight for the native walk;
//! 6. `layout` writes them depth first, the larger child first;
//! 7. `instances` puts trees into the leaves of a tree, where instances share their triangles.
//!
//! So the build ends on every input, in time n·log n but for `obvhs`' own, and its depth never exceeds [`MAX_DEPTH`].
//!
//! What a ray hits is a function of the ray and the triangles, not of the tree (Law 9): boxes are the exact bounds of
//! the f32 vertices, and ties in t go to the smallest primitive number. A traversal gives its slab test room on both sides
//! (`crate::traverse::line`).
//!
//! ```
//! use jerboa_lib_render::host::bvh::{Bvh, ChildRef};
//! let triangle = [[0.0, 0.0, 5.0], [1.0, 0.0, 5.0], [0.0, 1.0, 5.0]];
//! let point = [[2.0; 3]; 3];
//! let bvh = Bvh::build(&[point, triangle]);
//! assert_eq!(bvh.order, [1]);
//! assert_eq!(bvh.dropped.zero_area, 1);
//! assert_eq!(bvh.nodes[0].child[..2], [ChildRef::Leaf { first: 0, count: 1 }, ChildRef::EMPTY]);
//! ```

mod agglomerate;
mod bounds;
pub(super) mod collapse;
mod instances;
mod layout;
mod median;
pub(super) mod pages;
pub(super) mod prefilter;
#[cfg(test)]
mod reference;
mod sah;
#[cfg(test)]
mod tests;
pub(super) mod tree;

pub use bounds::Bounds;
pub use instances::{Instanced, MeshTree, Placement};
pub use layout::{BvhNode, ChildRef};
pub use prefilter::{Dropped, can_be_hit};
use tree::Tree;

/// A triangle's three corners in world space.
pub type Triangle = [[f32; 3]; 3];

/// Most triangles in a leaf: a block of them is tested at once.
pub const MAX_LEAF: usize = 4;

/// Most triangles: halved at the median they take at most 25 words each, and 2^31 words are in reach.
const MAX_TRIANGLES: usize = 1 << 26;

/// Largest depth of a binary tree: inner nodes on the way from the root to a leaf.
///
/// Median splits need at most 24 levels for as many triangles as a reference can name; the rest is for better trees.
pub const MAX_DEPTH: usize = 60;

/// Most children that wait while a walk is anywhere in a tree: the entries of a traversal's stack. Median splits need 39.
pub const MAX_WAITING: usize = crate::traverse::stack::STACK_SIZE as usize;

/// A tree of boxes over triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct Bvh {
    /// Inner nodes, depth first, the root first. Never empty: a root with four empty children stands for no triangles.
    pub nodes: Vec<BvhNode>,
    /// For each slot of the leaves, the number of the triangle in the slice that was given.
    pub order: Vec<u32>,
    /// Bounds of all triangles; [`Bounds::EMPTY`] if there are none.
    pub bounds: Bounds,
    /// Inner nodes on the longest way from the root to a leaf; at most [`MAX_DEPTH`].
    pub depth: usize,
    /// Children that wait at most while a walk is anywhere in the tree; at most [`MAX_WAITING`].
    pub waiting: usize,
    /// Triangles that are not in the tree.
    pub dropped: Dropped,
}

impl Bvh {
    /// Builds the tree over `triangles`, any number of them and whatever their coordinates.
    ///
    /// The result depends on the triangles and their order only, not on threads or time.
    ///
    /// # Panics
    /// If more than 2^26 triangles are given; the loader's limits lie below.
    pub fn build(triangles: &[Triangle]) -> Bvh {
        assert!(triangles.len() <= MAX_TRIANGLES, "Bvh::build: more than 2^26 triangles; split the scene");
        let usable = prefilter::usable(triangles);
        let lay_out = |tree: &Tree| (layout::lay_out(tree), tree.bounds());
        let (laid_out, bounds) = first_that_fits(&usable.bounds, lay_out, |(laid_out, _)| laid_out.fits());
        Bvh {
            nodes: laid_out.nodes,
            order: laid_out.order.iter().map(|&i| usable.numbers[i as usize]).collect(),
            bounds,
            depth: laid_out.depth,
            waiting: laid_out.waiting,
            dropped: usable.dropped,
        }
    }

    /// Boxes around all triangles: at most 16, those of two levels of the tree.
    pub fn parts(&self) -> Vec<Bounds> {
        let Some(root) = self.nodes.first() else { return Vec::new() };
        let below = root.child.iter().zip(root.bounds).flat_map(|(child, own)| match *child {
            ChildRef::Inner(node) => self.nodes[node as usize].bounds.to_vec(),
            ChildRef::Leaf { .. } => vec![own],
        });
        below.filter(|part| *part != Bounds::EMPTY).collect()
    }

    /// Words of the tree in memory.
    pub(super) fn size(&self) -> usize {
        layout::size(&self.nodes)
    }

    /// The tree in memory, with the corners of `triangles`, those it was built over: see `layout`.
    pub fn words(&self, triangles: &[Triangle]) -> Vec<u32> {
        layout::words(&self.nodes, &self.order, &self.bounds, triangles)
    }
}

/// Lays out the first tree over boxes that fits, of those by `obvhs`, by surface and at medians.
pub(super) fn first_that_fits<L>(boxes: &[Bounds], lay_out: impl Fn(&Tree) -> L, fits: impl Fn(&L) -> bool) -> L {
    let by_obvhs = if boxes.len() > MAX_LEAF { agglomerate::build(boxes) } else { None };
    by_obvhs
        .map(|tree| lay_out(&tree))
        .filter(&fits)
        .or_else(|| Some(lay_out(&sah::build(boxes))).filter(&fits))
        .unwrap_or_else(|| lay_out(&median::build(boxes)))
}
