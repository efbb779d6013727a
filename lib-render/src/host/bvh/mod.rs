//! Builds the bounding volume hierarchy: a binary tree of boxes over triangles, as flat tables.
//!
//! Only the *build* is here; kernels traverse. The steps, a file each:
//!
//! 1. `prefilter` drops triangles that no ray can hit, counted, and bounds the others;
//! 2. `agglomerate` lets `obvhs` build the tree (PLOC: Meister & Bittner 2018, with reinsertion: Meister & Bittner
//!    2017) where a rehearsal says that it will make progress;
//! 3. `median` splits at the median where it would not: coincident triangles, sizes over many magnitudes;
//! 4. `layout` writes the nodes depth first, the larger child first.
//!
//! So the build ends on every input, in time n·log n but for `obvhs`' own, and its depth never exceeds [`MAX_DEPTH`].
//!
//! What a ray hits is a function of the ray and the triangles, not of the tree (Law 9): boxes are the exact bounds of
//! the f32 vertices, and ties in t go to the smallest primitive number. A traversal gives its slab test room on *both*
//! planes, far ×1.0000004 (accuracy.md, N3) and near ×0.9999996: with an exact near plane 269 of 200,000 rays at
//! overlapping coplanar triangles missed the smallest number among equal t, with the padded one none did.
//!
//! ```
//! use jerboa_lib_render::host::bvh::{Bvh, ChildRef};
//! let triangle = [[0.0, 0.0, 5.0], [1.0, 0.0, 5.0], [0.0, 1.0, 5.0]];
//! let point = [[2.0; 3]; 3];
//! let bvh = Bvh::build(&[point, triangle]);
//! assert_eq!(bvh.order, [1]);
//! assert_eq!(bvh.dropped.zero_area, 1);
//! assert_eq!(bvh.nodes[0].child.map(ChildRef::decode), [ChildRef::Leaf { first: 0, count: 1 }, ChildRef::EMPTY]);
//! ```

mod agglomerate;
mod bounds;
mod layout;
mod median;
mod prefilter;
#[cfg(test)]
mod reference;
#[cfg(test)]
mod tests;
mod tree;

pub use bounds::Bounds;
pub use layout::{BvhNode, ChildRef};
pub use prefilter::{Dropped, can_be_hit};

/// A triangle's three corners in world space.
pub type Triangle = [[f32; 3]; 3];

/// Most triangles in a leaf: the preset of `obvhs` collapses to at most this many.
pub const MAX_LEAF: usize = 8;

/// Largest depth of a tree: inner nodes on the way from the root to a leaf, and so the entries a traversal's stack needs.
///
/// Median splits need at most 24 levels for the 2^27 slots that a reference can name; the rest is for better trees.
pub const MAX_DEPTH: usize = 60;

/// A binary tree of boxes over triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct Bvh {
    /// Inner nodes, depth first, the root first. Never empty: a root with two empty children stands for no triangles.
    pub nodes: Vec<BvhNode>,
    /// For each slot of the leaves, the number of the triangle in the slice that was given.
    pub order: Vec<u32>,
    /// Bounds of all triangles; [`Bounds::EMPTY`] if there are none.
    pub bounds: Bounds,
    /// Inner nodes on the longest way from the root to a leaf; at most [`MAX_DEPTH`].
    pub depth: usize,
    /// Triangles that are not in the tree.
    pub dropped: Dropped,
}

impl Bvh {
    /// Builds the tree over `triangles`, any number of them and whatever their coordinates.
    ///
    /// The result depends on the triangles and their order only, not on threads or time.
    ///
    /// # Panics
    /// If more than 2^27 triangles are given; the loader's limits lie below.
    pub fn build(triangles: &[Triangle]) -> Bvh {
        assert!(triangles.len() <= layout::MAX_SLOTS, "Bvh::build: more than 2^27 triangles; split the scene");
        let usable = prefilter::usable(triangles);
        let tree = if usable.bounds.len() <= MAX_LEAF {
            median::build(&usable.bounds)
        } else {
            agglomerate::build(&usable.bounds).unwrap_or_else(|| median::build(&usable.bounds))
        };
        let laid_out = layout::lay_out(&tree);
        Bvh {
            nodes: laid_out.nodes,
            order: laid_out.order.iter().map(|&i| usable.numbers[i as usize]).collect(),
            bounds: tree.bounds(),
            depth: laid_out.depth,
            dropped: usable.dropped,
        }
    }
}
