//! The image is repeated, every other one mirrored.

use jerboa_ir::lang::{F32, I32};

use super::beyond;

/// The distance from the nearest even integer.
pub fn fold(x: F32) -> F32 {
    let m = x - 2.0 * (x * 0.5).floor();
    m.lt(1.0).select(m, 2.0 - m).max(0.0)
}

/// The index in the mirror image, for i beyond either end.
pub fn index(i: I32, size: I32) -> I32 {
    let (before, behind) = beyond(i, size);
    before.select(-1 - i, behind.select(size + size - 1 - i, i))
}
