//! The children that a walk has still to visit.

use jerboa_ir::lang::{Array, Block, F32, U32};

use crate::traverse::bvh::Child;

/// Entries: in no tree do more children wait (`host::bvh`).
pub const STACK_SIZE: u32 = 64;

/// A stack in local memory. Its height travels with the walk.
#[derive(Clone, Copy)]
pub struct Stack {
    children: Array<U32>,
    entries: Array<F32>,
}

impl Stack {
    /// Memory for one walk.
    pub fn new(b: &mut Block) -> Stack {
        Stack { children: b.array(STACK_SIZE), entries: b.array(STACK_SIZE) }
    }

    /// Leave a child, entered at `entry`, for later; gives the new height.
    pub fn push(self, b: &mut Block, top: U32, child: Child, entry: F32) -> U32 {
        b.set(self.children, top, child.word);
        b.set(self.entries, top, entry);
        top + 1u32
    }

    /// The latest child that is entered no later than `limit`, or nothing, and the height after it.
    pub fn pop(self, b: &mut Block, top: U32, limit: F32) -> (Child, U32) {
        b.loop_(top, |b, top, again, found| {
            let look = |b: &mut Block| {
                let top = top - 1u32;
                let entry = b.get(self.entries, top);
                let take = |b: &mut Block| {
                    let word = b.get(self.children, top);
                    found.take(b, (Child { word }, top))
                };
                b.branch(entry.le(limit), take, |b| again.take(b, top))
            };
            b.branch(top.eq(0), |b| found.take(b, (Child::nothing(), top)), look)
        })
    }
}
