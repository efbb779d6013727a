//! The image is repeated.

use jerboa_ir::lang::{F32, I32};

use super::beyond;

/// x − ⌊x⌋. It is 1 for a tiny negative x: there the last texel ends.
pub fn fold(x: F32) -> F32 {
    (x - x.floor()).max(0.0)
}

/// The index on a ring of this size, for i from −1 to size.
pub fn index(i: I32, size: I32) -> I32 {
    let (before, behind) = beyond(i, size);
    before.select(i + size, behind.select(i - size, i))
}
