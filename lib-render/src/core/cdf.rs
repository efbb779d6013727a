//! Drawing from a table of cumulative probabilities, as `host::distribution` lays it out; and the search for it.

use jerboa_ir::lang::{Block, Bool, F32, U32};

/// The index below `count` that the uniform number `u` in [0, 1) draws, by bisection: the last one with `cdf(index)` ≤ u.
/// `cdf` has count + 1 entries, from 0 to 1; an index of probability 0 is never drawn.
pub fn invert(b: &mut Block, count: U32, cdf: impl Fn(U32) -> F32, u: F32) -> U32 {
    last(b, count, |index| cdf(index).le(u))
}

/// The last index below `count` that `reaches`, by bisection: if one does, so do those before it. 0 where none does.
pub fn last(b: &mut Block, count: U32, reaches: impl Fn(U32) -> Bool) -> U32 {
    let more = |_: &mut Block, (lo, hi): (U32, U32)| lo.lt(hi);
    let halve = |_: &mut Block, (lo, hi): (U32, U32)| {
        let middle = (lo + hi) >> 1u32;
        let above = reaches(middle + 1u32);
        (above.select(middle + 1u32, lo), above.select(hi, middle))
    };
    b.while_((0.into(), count.max(1u32) - 1u32), more, halve).0
}
