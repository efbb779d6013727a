//! Drawing from an alias table (Walker, *An efficient method for generating discrete random variables with general
//! distributions*, 1977), as `host::alias` lays it out.

use jerboa_ir::lang::U32;

/// The index that a random word draws from a table of 2^`log_slots` slots, which is from 1 to 23: its high bits choose a
/// slot, of the 24 bits that a random number has the others decide between the slot's own index and the one that it
/// borrows from.
pub fn draw(word: U32, log_slots: U32, entry: impl Fn(U32) -> U32) -> U32 {
    let slot = word >> (32 - log_slots);
    let part = (word << log_slots) >> (log_slots + 8u32);
    let entry = entry(slot);
    let other = entry & ((U32::from(1) << log_slots) - 1u32);
    part.lt(entry >> log_slots).select(slot, other)
}
