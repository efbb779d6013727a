//! Surfaces that fade (glTF's alpha mode BLEND): a stochastic hole.

use jerboa_ir::lang::{Bool, F32, U32};

use crate::core::rng::{DIM_HOLES, Stream};

/// Is there a surface of this alpha? With that probability, by a number that depends on pixel and sample (the `stream`), path
/// vertex and primitive alone, so that every traversal order sees the same holes (Law 9).
pub fn blended_is_there(alpha: F32, stream: Stream, vertex: U32, primitive: U32) -> Bool {
    alpha.gt(stream.vertex(vertex, DIM_HOLES).of(primitive))
}
