//! The texels of the edge go on.

use jerboa_ir::lang::F32;

/// The nearest place of the image.
pub fn fold(x: F32) -> F32 {
    x.max(0.0).min(1.0)
}
