//! Drawing from a table of cumulative probabilities, as `host::distribution` lays it out.

use jerboa_ir::lang::{Block, F32, U32};

/// Half a step of the uniform numbers: 2^-25.
const HALF_STEP: f32 = 1.0 / 33_554_432.0;

/// The index below `count` that the uniform number `u` in [0, 1) draws, by bisection: the last one with `cdf(index)` ≤ u.
/// `cdf` has count + 1 entries, from 0 to 1; an index of probability 0 is never drawn.
pub fn invert(b: &mut Block, count: U32, cdf: impl Fn(U32) -> F32, u: F32) -> U32 {
    bisect(b, (0.into(), count.max(1u32) - 1u32), cdf, u)
}

/// The same, where a table says between which indices it lies: what the numbers of each of `count` equal shares of [0, 1)
/// draw lies from `guide(share)` to `guide(share + 1)` (`host::distribution::guide`).
pub fn invert_guided(b: &mut Block, count: U32, cdf: impl Fn(U32) -> F32, guide: impl Fn(U32) -> U32, u: F32) -> U32 {
    let share = (u * count.to_f32()).to_u32().min(count.max(1u32) - 1u32);
    bisect(b, (guide(share), guide(share + 1u32)), cdf, u)
}

/// The last index from `lo` to `hi` with `cdf(index)` ≤ u.
fn bisect(b: &mut Block, (lo, hi): (U32, U32), cdf: impl Fn(U32) -> F32, u: F32) -> U32 {
    let more = |_: &mut Block, (lo, hi): (U32, U32)| lo.lt(hi);
    let halve = |_: &mut Block, (lo, hi): (U32, U32)| {
        let middle = (lo + hi) >> 1u32;
        let above = cdf(middle + 1u32).le(u);
        (above.select(middle + 1u32, lo), above.select(hi, middle))
    };
    b.while_((lo, hi), more, halve).0
}

/// Where in [0, 1] of the drawn cell `u` lies, when `below` and `above` are its cumulative probabilities: the middle of
/// the step of uniform numbers, so that even a cell that one number draws is not always met at its edge.
pub fn remainder(u: F32, below: F32, above: F32) -> F32 {
    (u - below + HALF_STEP) / (above - below)
}
