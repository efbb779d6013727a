//! How a kernel sees the tree.

use super::Bounds;
use super::tree::{Kind, NodeId, Tree};

/// Bits of a reference that name a slot.
const SLOT_BITS: u32 = 27;
/// Slots that a reference can tell apart.
pub(super) const MAX_SLOTS: usize = 1 << SLOT_BITS;
/// Marks a reference to a leaf.
const LEAF: u32 = 1 << 31;

/// What a node's child is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChildRef {
    /// The inner node of this index.
    Inner(u32),
    /// `count` triangles (0 to [`super::MAX_LEAF`]) in consecutive slots.
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

    /// The word in a node: bit 31 marks a leaf, whose count stands in bits 27 to 30 and its first slot below; else an index.
    pub fn encode(self) -> u32 {
        match self {
            ChildRef::Inner(index) => index,
            ChildRef::Leaf { first, count } => LEAF | count << SLOT_BITS | first,
        }
    }

    /// What the word of a node says.
    pub fn decode(word: u32) -> ChildRef {
        if word & LEAF == 0 {
            return ChildRef::Inner(word);
        }
        ChildRef::Leaf { first: word & (MAX_SLOTS as u32 - 1), count: (word & !LEAF) >> SLOT_BITS }
    }
}

/// An inner node: both children's boxes and references.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BvhNode {
    /// Exact bounds of the triangles below each child; [`Bounds::EMPTY`] where there are none.
    pub bounds: [Bounds; 2],
    /// References, as [`ChildRef::decode`] reads them. The first child has the larger surface; if it is an inner node, it
    /// is the next one.
    pub child: [u32; 2],
}

impl BvhNode {
    /// Words of a node in memory: 64 bytes, a cache line.
    pub const WORDS: usize = 16;

    /// The node in memory: lo and hi of child 0 (words 0 to 5) and of child 1 (6 to 11) as f32 bits, x y z each; the two
    /// references (12, 13); two zeros.
    pub fn words(&self) -> [u32; BvhNode::WORDS] {
        let mut words = [0; BvhNode::WORDS];
        let corners = self.bounds.iter().flat_map(|b| b.lo.into_iter().chain(b.hi));
        words.iter_mut().zip(corners).for_each(|(word, x)| *word = x.to_bits());
        words[12..14].copy_from_slice(&self.child);
        words
    }
}

/// A tree, laid out.
pub(super) struct LaidOut {
    pub nodes: Vec<BvhNode>,
    pub order: Vec<u32>,
    pub depth: usize,
}

/// Writes `tree` depth first, the larger child first: a ray more often goes on with what lies next in memory.
pub(super) fn lay_out(tree: &Tree) -> LaidOut {
    let mut writer = Writer { tree, out: LaidOut { nodes: Vec::new(), order: Vec::new(), depth: 0 } };
    let root = tree.root();
    if let ChildRef::Inner(_) = writer.write(root, 0) {
        return writer.out;
    }
    // A root that is a leaf becomes the only child of a node.
    let LaidOut { order, .. } = writer.out;
    let child = [ChildRef::Leaf { first: 0, count: order.len() as u32 }, ChildRef::EMPTY];
    let node = BvhNode { bounds: [tree.bounds_of(root), Bounds::EMPTY], child: child.map(ChildRef::encode) };
    LaidOut { nodes: vec![node], order, depth: 1 }
}

struct Writer<'a> {
    tree: &'a Tree,
    out: LaidOut,
}

impl Writer<'_> {
    /// Writes the subtree of `node`, below `depth` inner nodes; the recursion is as deep as the tree, which is bounded.
    fn write(&mut self, node: NodeId, depth: usize) -> ChildRef {
        match self.tree.kind_of(node) {
            Kind::Leaf(range) => {
                let first = self.out.order.len() as u32;
                self.out.order.extend_from_slice(&self.tree.order[range.clone()]);
                ChildRef::Leaf { first, count: range.len() as u32 }
            }
            Kind::Inner(children) => {
                let index = self.out.nodes.len();
                let mut children = *children;
                let area = |child: NodeId| self.tree.bounds_of(child).half_area();
                if area(children[1]) > area(children[0]) {
                    children.swap(0, 1);
                }
                let bounds = children.map(|child| self.tree.bounds_of(child));
                self.out.nodes.push(BvhNode { bounds, child: [0; 2] });
                self.out.nodes[index].child = children.map(|child| self.write(child, depth + 1).encode());
                self.out.depth = self.out.depth.max(depth + 1);
                ChildRef::Inner(index as u32)
            }
        }
    }
}
