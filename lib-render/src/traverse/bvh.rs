//! Boxes: the nodes of the tree and the slab test.
//!
//! The test is Kay and Kajiya's (1986) in the form (b − o)·(1/d), planes ordered by the sign of 1/d, so that NaN (a ray
//! within the plane of a side) drops out. Entry and exit are monotone in the box, also as they are rounded; the room for
//! errors is in the origins of the [`Line`].

use jerboa_ir::lang::{Block, Bool, Row, U32};

use crate::core::vec::{Vec3, vec3};
use crate::schema::Tree;
use crate::traverse::line::Line;
use crate::traverse::{Bool4, F32x4};

/// Where the root is; see `host::bvh`.
const ROOT: u32 = 48;
/// Words from a node to the references to its children.
const CHILDREN: u32 = 24;
/// Marks a leaf.
const LEAF: u32 = 1 << 31;

/// A box, world.
#[derive(Clone, Copy)]
pub struct Bounds {
    /// Smallest coordinates.
    pub lo: Vec3,
    /// Largest coordinates.
    pub hi: Vec3,
}

/// Marks an instance among leaves.
const INSTANCE: u32 = 1;

/// A child of a node, as `host::bvh` refers to it: bit 31 marks a leaf, bit 0 of a leaf an instance; the others say where in
/// the table it begins.
#[derive(Clone, Copy)]
pub struct Child {
    /// The reference.
    pub word: U32,
}
jerboa_ir::impl_staged!(Child { word });

impl Child {
    /// The root.
    pub fn root() -> Child {
        Child { word: ROOT.into() }
    }

    /// None: where the table begins there is no leaf.
    pub fn nothing() -> Child {
        Child { word: LEAF.into() }
    }

    /// Is it [`Child::nothing`]?
    pub fn is_nothing(self) -> Bool {
        self.word.eq(LEAF)
    }

    /// The way back from an instance: one that begins nowhere.
    pub fn way_back() -> Child {
        Child { word: (LEAF | INSTANCE).into() }
    }

    /// Is it [`Child::way_back`]?
    pub fn is_way_back(self) -> Bool {
        self.word.eq(LEAF | INSTANCE)
    }

    /// Is it an instance, or the way back from one? Asked of leaves.
    pub fn is_instance(self) -> Bool {
        (self.word & INSTANCE).ne(0)
    }

    /// Is it a leaf?
    pub fn is_leaf(self) -> Bool {
        self.word.ge(LEAF)
    }

    /// Where an instance begins.
    pub fn instance(self) -> Child {
        Child { word: self.word & !(LEAF | INSTANCE) }
    }

    /// Where a leaf begins.
    pub fn block(self) -> U32 {
        self.word & !LEAF
    }

    /// Child number `lane` of an inner node.
    pub fn child(self, b: &mut Block, lane: U32) -> Child {
        Child { word: b.read_unchecked(Tree::WORD, self.word + CHILDREN + lane) }
    }

    /// Planes of the four boxes of an inner node, at these distances from it.
    pub fn planes(self, b: &mut Block, at: [U32; 3]) -> [F32x4; 3] {
        at.map(|offset| b.read_run::<_, U32, 4>(Tree::WORD, self.word + offset).float_of_bits())
    }
}

/// The box of all triangles; where there are none, `lo` is +infinity.
pub fn scene_bounds() -> Bounds {
    let word = |at: u32| Row::<Tree>::at(at).get(Tree::WORD).float_of_bits();
    Bounds { lo: vec3(word(0), word(1), word(2)), hi: vec3(word(4), word(5), word(6)) }
}

/// The part of a ray within each of four boxes, up to a limit, in units of its direction.
#[derive(Clone, Copy)]
pub struct Span {
    /// No later than any hit in the box; at least 0.
    pub entry: F32x4,
    /// No earlier than any hit in the box up to the limit.
    pub exit: F32x4,
}

impl Span {
    /// Is the box entered, no later than the limit?
    pub fn is_entered(self) -> Bool4 {
        self.entry.le(self.exit)
    }
}

/// Where the ray enters and leaves four boxes, given the planes on its side and those on the other. Monotone: a larger box
/// is entered no later and left no earlier.
pub fn span(line: Line, near: [F32x4; 3], far: [F32x4; 3], limit: F32x4) -> Span {
    let times = |planes: [F32x4; 3], org: [F32x4; 3]| -> [F32x4; 3] {
        std::array::from_fn(|k| (planes[k] - org[k]) * line.inv[k])
    };
    let (entry, exit) = (times(near, line.org_entry), times(far, line.org_exit));
    // The accumulator comes second: NaN gives it.
    Span {
        entry: entry[2].max(entry[1].max(entry[0].max(F32x4::splat(0.0)))),
        exit: exit[2].min(exit[1].min(exit[0].min(limit))),
    }
}
