//! How a kernel sees the tree: nodes of four boxes and blocks of four triangles, in one array of words.
//!
//! ```text
//!  0  corners of the scene's box: lo x y z z, hi x y z z
//!  8  a block without triangles
//! 48  the root, then depth first: a node, the blocks of its leaves, the nodes below it, the larger first
//!
//! node, 32 words    lo x of four boxes, hi x, lo y, hi y, lo z, hi z; four references; four unused
//! block, 40 words   x of four first corners, y, z; of the second corners; of the third; numbers of four primitives
//! ```
//!
//! A reference says at which word a node begins, or a block: then bit 31 is set. What is missing of four triangles has NaN
//! for coordinates. So a ray more often goes on with what lies next in memory, and a leaf lies beside its node: 20 % more
//! bounce rays a second than with blocks in a table of their own.

use super::collapse::Cuts;
use super::pages::with_room;
use super::tree::{NodeId, Tree};
use super::{Bounds, MAX_LEAF, Triangle};
use crate::schema::NONE;

/// Words of a node.
const NODE: usize = 32;
/// Words of a block.
pub(super) const BLOCK: usize = 40;
/// Words of the box around all.
pub(super) const HEADER: usize = 8;
/// Where the empty block is.
const NOTHING: usize = HEADER;
/// Where the root is.
pub(super) const ROOT: usize = NOTHING + BLOCK;
/// Marks a reference to a block.
const LEAF: u32 = 1 << 31;
/// Marks among them a reference to an instance; see `instances`. All begin at multiples of eight.
pub(super) const INSTANCE: u32 = 1;
/// Words that references can reach.
pub(super) const MAX_WORDS: usize = LEAF as usize;

/// What a node's child is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChildRef {
    /// The inner node of this index.
    Inner(u32),
    /// `count` triangles (0 to [`MAX_LEAF`]) in consecutive slots.
    Leaf {
        /// The first slot.
        first: u32,
        /// How many.
        count: u32,
    },
}

impl ChildRef {
    /// A leaf without triangles; its box is [`Bounds::EMPTY`].
    pub const EMPTY: ChildRef = ChildRef::Leaf { first: 0, count: 0 };
}

/// An inner node: its children and their boxes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BvhNode {
    /// Exact bounds of the triangles below each child; [`Bounds::EMPTY`] where there are none.
    pub bounds: [Bounds; 4],
    /// The children, by descending surface.
    pub child: [ChildRef; 4],
}

impl BvhNode {
    /// A node without children.
    pub const EMPTY: BvhNode = BvhNode { bounds: [Bounds::EMPTY; 4], child: [ChildRef::EMPTY; 4] };
}

/// The words of a tree over `triangles`; `order` has the number of the triangle in each slot.
pub(super) fn words(nodes: &[BvhNode], order: &[u32], bounds: &Bounds, triangles: &[Triangle]) -> Vec<u32> {
    let mut words = begin(bounds, size(nodes));
    push_tree(&mut words, nodes, order, of_triangles(triangles));
    words
}

/// How many words a tree takes with what comes before its root.
pub(super) fn size(nodes: &[BvhNode]) -> usize {
    ROOT + nodes.iter().map(size_of_node).sum::<usize>()
}

fn size_of_node(node: &BvhNode) -> usize {
    NODE + BLOCK * node.child.iter().filter(|child| has_block(child)).count()
}

/// The words before the root, with room for so many in all.
pub(super) fn begin(bounds: &Bounds, size: usize) -> Vec<u32> {
    let mut words = with_room(size);
    push_bounds(&mut words, bounds);
    words.extend(block(std::iter::empty()));
    words
}

/// A box around all.
pub(super) fn push_bounds(words: &mut Vec<u32>, bounds: &Bounds) {
    for corner in [bounds.lo, bounds.hi] {
        words.extend([0, 1, 2, 2].map(|k: usize| corner[k].to_bits()));
    }
}

/// A tree from its root on. `leaf` gives what marks the reference to the block of some members, and the block.
pub(super) fn push_tree(
    words: &mut Vec<u32>,
    nodes: &[BvhNode],
    order: &[u32],
    leaf: impl Fn(&[u32]) -> (u32, [u32; BLOCK]),
) {
    let mut at = words.len();
    let begins = |node| {
        at += size_of_node(node);
        at - size_of_node(node)
    };
    let starts: Vec<usize> = nodes.iter().map(begins).collect();
    for (node, start) in nodes.iter().zip(&starts) {
        let mut blocks = Vec::new();
        let references = node.child.map(|child| match child {
            ChildRef::Inner(index) => starts[index as usize] as u32,
            ChildRef::Leaf { count: 0, .. } => LEAF | NOTHING as u32,
            ChildRef::Leaf { first, count } => {
                let place = start + NODE + blocks.len();
                let (mark, block) = leaf(&order[first as usize..][..count as usize]);
                blocks.extend(block);
                LEAF | mark | place as u32
            }
        });
        for k in 0..3 {
            words.extend(node.bounds.map(|b| b.lo[k].to_bits()));
            words.extend(node.bounds.map(|b| b.hi[k].to_bits()));
        }
        words.extend(references);
        words.extend([0; 4]);
        words.extend(blocks);
    }
}

fn has_block(child: &ChildRef) -> bool {
    matches!(child, ChildRef::Leaf { count: 1.., .. })
}

/// Leaves of triangles, which the members number.
pub(super) fn of_triangles(triangles: &[Triangle]) -> impl Fn(&[u32]) -> (u32, [u32; BLOCK]) {
    |members| (0, block(members.iter().map(|number| (*number, &triangles[*number as usize]))))
}

/// A block of at most four triangles, and their numbers.
pub(super) fn block<'t>(triangles: impl Iterator<Item = (u32, &'t Triangle)>) -> [u32; BLOCK] {
    let nothing = |at: usize| if at < BLOCK - MAX_LEAF { f32::NAN.to_bits() } else { NONE };
    let mut words: [u32; BLOCK] = std::array::from_fn(nothing);
    for (lane, (number, triangle)) in triangles.enumerate() {
        for (place, x) in triangle.as_flattened().iter().enumerate() {
            words[MAX_LEAF * place + lane] = x.to_bits();
        }
        words[BLOCK - MAX_LEAF + lane] = number;
    }
    words
}

/// A tree, laid out.
pub(super) struct LaidOut {
    pub nodes: Vec<BvhNode>,
    pub order: Vec<u32>,
    pub depth: usize,
    /// Children that wait at most while a walk is anywhere in the tree.
    pub waiting: usize,
}

impl LaidOut {
    /// How many words [`words`] makes of it.
    pub fn size(&self) -> usize {
        size(&self.nodes)
    }

    /// Can a walk's stack hold what waits, and a reference reach every word?
    pub fn fits(&self) -> bool {
        self.waiting <= super::MAX_WAITING && self.size() <= MAX_WORDS
    }
}

/// Makes nodes of four from nodes of two. A subtree of few triangles is a leaf, and so is an instance.
pub(super) fn lay_out(tree: &Tree) -> LaidOut {
    let out = LaidOut { nodes: Vec::new(), order: Vec::new(), depth: 0, waiting: 0 };
    let mut writer = Writer { tree, cuts: Cuts::new(tree), out };
    writer.write(tree.root(), 1, 0);
    writer.out
}

struct Writer<'a> {
    tree: &'a Tree,
    cuts: Cuts<'a, MAX_LEAF>,
    out: LaidOut,
}

impl Writer<'_> {
    /// Writes a node over a subtree, at this depth, while so many children wait; the recursion is as deep as the tree,
    /// which is bounded.
    fn write(&mut self, top: NodeId, depth: usize, waiting: usize) -> u32 {
        let children = self.cuts.children(top);
        let index = self.out.nodes.len();
        self.out.nodes.push(BvhNode::EMPTY);
        let waiting = waiting + children.len().saturating_sub(1);
        self.out.depth = self.out.depth.max(depth);
        self.out.waiting = self.out.waiting.max(waiting);
        for (lane, child) in children.iter().enumerate() {
            self.out.nodes[index].bounds[lane] = self.tree.bounds_of(*child);
            if self.cuts.is_leaf(*child) {
                let first = self.out.order.len() as u32;
                self.tree.members(*child, &mut self.out.order);
                let count = self.out.order.len() as u32 - first;
                self.out.nodes[index].child[lane] = ChildRef::Leaf { first, count };
            }
        }
        for (lane, child) in children.into_iter().enumerate() {
            if !self.cuts.is_leaf(child) {
                let below = self.write(child, depth + 1, waiting);
                self.out.nodes[index].child[lane] = ChildRef::Inner(below);
            }
        }
        index as u32
    }
}
