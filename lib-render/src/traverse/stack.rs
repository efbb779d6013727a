//! The children that a walk has still to visit.

use jerboa_ir::lang::{Block, F32, U32};

use super::bvh::Child;
use super::memory::Memory;

/// Entries, a power of two: in no tree do more children wait (`host::bvh`).
pub const STACK_SIZE: u32 = 64;

/// Leave a child, entered at `entry`, for later; gives the new height. What lies above it is never read.
pub fn push(b: &mut Block, memory: Memory, top: U32, child: Child, entry: F32) -> U32 {
    memory.set_entry(b, top, child.word, entry);
    top + 1u32
}

/// The latest child that is entered no later than `limit`, or nothing, and the height after it.
pub fn pop(b: &mut Block, memory: Memory, top: U32, limit: F32) -> (Child, U32) {
    b.loop_(top, |b, top, again, found| {
        let look = |b: &mut Block| {
            let top = top - 1u32;
            let entry = memory.entry_at(b, top);
            let take = |b: &mut Block| {
                let word = memory.child_at(b, top);
                found.take(b, (Child { word }, top))
            };
            b.branch(entry.le(limit), take, |b| again.take(b, top))
        };
        b.branch(top.eq(0), |b| found.take(b, (Child::nothing(), top)), look)
    })
}
