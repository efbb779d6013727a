//! What walks remember, in local memory: there is more of it than registers, and an operation takes it from memory itself.

use jerboa_ir::lang::{Array, Block, F32, U32};

use super::F32x4;
use super::stack::STACK_SIZE;

/// Words and floats of a walk.
pub const WALK: u32 = 128;

/// Places among the words: the children that wait come last, so that a single walk needs no more.
pub mod word {
    /// Three distances to planes, see [`crate::traverse::line::Line::near`].
    pub const NEAR: u32 = 0;
    /// Three distances to coordinates, see [`crate::traverse::line::Line::axis`].
    pub const AXIS: u32 = 3;
    /// The child to visit next.
    pub const CHILD: u32 = 6;
    /// The height of the stack.
    pub const TOP: u32 = 7;
    /// The best hit's primitive.
    pub const PRIMITIVE: u32 = 8;
    /// And where it lies.
    pub const SLOT: u32 = 9;
    /// The row that asks.
    pub const ROW: u32 = 10;
    /// What a look has seen.
    pub const LOOK: u32 = 11;
    /// In the memory of the first of some walks: the next row.
    pub const NEXT: u32 = 12;
    /// And how many have had their answer, counted from the first row.
    pub const ANSWERED: u32 = 13;
    /// The instance that the walk is in, where it begins; 0 for none.
    pub const INSTANCE: u32 = 14;
    /// And that of the best hit.
    pub const BEST_INSTANCE: u32 = 15;
    /// Children on the stack.
    pub const CHILDREN: u32 = 16;
    /// All of them.
    pub const END: u32 = CHILDREN + super::STACK_SIZE;
}

/// Places among the floats; vectors are in a row.
pub mod float {
    /// Three vectors, see [`crate::traverse::line::Line::org`].
    pub const ORG: u32 = 0;
    /// Three vectors, see [`crate::traverse::line::Line::inv`].
    pub const INV: u32 = 12;
    /// Three vectors, see [`crate::traverse::line::Line::org_entry`].
    pub const ORG_ENTRY: u32 = 24;
    /// Three vectors, see [`crate::traverse::line::Line::org_exit`].
    pub const ORG_EXIT: u32 = 36;
    /// Two vectors, see [`crate::traverse::line::Line::shear`].
    pub const SHEAR: u32 = 48;
    /// The best hit's distance.
    pub const T: u32 = 56;
    /// Where the instance is entered that the walk is in; 0 for none.
    pub const FLOOR: u32 = 57;
    /// Where children on the stack are entered.
    pub const ENTRIES: u32 = 64;
    /// All of them.
    pub const END: u32 = ENTRIES + super::STACK_SIZE;
}

/// The memory of a walk.
#[derive(Clone, Copy)]
pub struct Memory {
    words: Array<U32>,
    floats: Array<F32>,
    /// Where it begins.
    start: U32,
}

impl Memory {
    /// Memory for so many walks; this is the first one's.
    pub fn new(b: &mut Block, walks: u32) -> Memory {
        let before = (walks - 1) * WALK;
        Memory { words: b.array(before + word::END), floats: b.array(before + float::END), start: 0.into() }
    }

    /// The memory of the walk that begins here: a multiple of [`WALK`] that is surely within.
    pub fn starting(self, start: U32) -> Memory {
        Memory { start, ..self }
    }

    /// A word.
    pub fn word(self, b: &mut Block, place: u32) -> U32 {
        b.get(self.words, self.start + place)
    }

    /// Set a word.
    pub fn set_word(self, b: &mut Block, place: u32, x: impl Into<U32>) {
        b.set(self.words, self.start + place, x);
    }

    /// A float.
    pub fn float(self, b: &mut Block, place: u32) -> F32 {
        b.get(self.floats, self.start + place)
    }

    /// Set a float.
    pub fn set_float(self, b: &mut Block, place: u32, x: F32) {
        b.set(self.floats, self.start + place, x);
    }

    /// Vectors from a place on.
    pub fn vectors<const N: usize>(self, b: &mut Block, place: u32) -> [F32x4; N] {
        std::array::from_fn(|i| b.get_run(self.floats, self.start + (place + 4 * i as u32)))
    }

    /// Set vectors from a place on.
    pub fn set_vectors(self, b: &mut Block, place: u32, vectors: &[F32x4]) {
        for (i, v) in vectors.iter().enumerate() {
            b.set_run(self.floats, self.start + (place + 4 * i as u32), *v);
        }
    }

    /// This word of an entry of the stack. A tree never asks for one that does not exist, so it may be any other.
    pub fn child_at(self, b: &mut Block, at: U32) -> U32 {
        let at = self.entry(at);
        b.get(self.words, at + word::CHILDREN)
    }

    /// Its float.
    pub fn entry_at(self, b: &mut Block, at: U32) -> F32 {
        let at = self.entry(at);
        b.get(self.floats, at + float::ENTRIES)
    }

    /// Set both.
    pub fn set_entry(self, b: &mut Block, at: U32, child: U32, entry: F32) {
        let at = self.entry(at);
        b.set(self.words, at + word::CHILDREN, child);
        b.set(self.floats, at + float::ENTRIES, entry);
    }

    fn entry(self, at: U32) -> U32 {
        self.start + (at & (STACK_SIZE - 1))
    }
}
