//! Drawing from a table of cumulative probabilities, as `host::distribution` lays it out.

use jerboa_ir::lang::{Block, F32, U32};

/// Half a step of the uniform numbers: 2^-25.
const HALF_STEP: f32 = 1.0 / 33_554_432.0;

/// The index below `count` that the uniform number `u` in [0, 1) draws, by bisection: the last one with `cdf(index)` ≤ u.
/// `cdf` has count + 1 entries, from 0 to 1; an index of probability 0 is never drawn.
pub fn invert(b: &mut Block, count: U32, cdf: impl Fn(U32) -> F32, u: F32) -> U32 {
    let more = |_: &mut Block, (lo, hi): (U32, U32)| lo.lt(hi);
    let halve = |_: &mut Block, (lo, hi): (U32, U32)| {
        let middle = (lo + hi) >> 1u32;
        let above = cdf(middle + 1u32).le(u);
        (above.select(middle + 1u32, lo), above.select(hi, middle))
    };
    b.while_((U32::from(0), count.max(1u32) - 1u32), more, halve).0
}

/// Where in [0, 1] of the drawn cell `u` lies, when `below` and `above` are its cumulative probabilities: the middle of
/// the step of uniform numbers, so that even a cell that one number draws is not always met at its edge.
pub fn remainder(u: F32, below: F32, above: F32) -> F32 {
    (u - below + HALF_STEP) / (above - below)
}
