//! Random numbers: a pure function of (seed, pixel, sample, dimension); no state travels (Law 9).
//!
//! An [`Rng`] is a key and a position. [`Rng::next`] gives the number there and the next position; [`Rng::vertex`] starts
//! the block of dimensions of a path vertex, so that what one component draws never shifts what another sees.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{F32, U32};

/// Dimensions set aside for each path vertex. A BSDF draws at most 4, a light at most 4, roulette 1.
pub const DIMENSIONS_PER_VERTEX: u32 = 16;
/// First dimension, within a vertex, of the BSDF.
pub const DIM_BSDF: u32 = 0;
/// First dimension, within a vertex, of light sampling.
pub const DIM_LIGHT: u32 = 4;
/// Dimension, within a vertex, of roulette.
pub const DIM_ROULETTE: u32 = 8;

/// A position in the random numbers of one sample of one pixel.
#[derive(Clone, Copy)]
pub struct Rng {
    /// Hash of seed, pixel and sample.
    pub key: U32,
    /// Next dimension.
    pub dim: U32,
}
impl_staged!(Rng { key, dim });

impl Rng {
    /// The numbers of one sample. `pixel` counts over the whole film, so that a crop sees the very same.
    pub fn new(seed: U32, pixel: U32, sample: U32) -> Rng {
        let key = hash(hash(hash(seed) ^ pixel) ^ sample);
        Rng { key, dim: 0.into() }
    }

    /// A number in [0, 1) and the position after it.
    pub fn next(self) -> (F32, Rng) {
        let u = uniform(hash(self.key ^ hash(self.dim)));
        (u, Rng { dim: self.dim + 1u32, ..self })
    }

    /// The block of dimensions of path vertex `vertex` (the camera is 0), from `dim` on.
    pub fn vertex(self, vertex: U32, dim: u32) -> Rng {
        Rng { dim: vertex * DIMENSIONS_PER_VERTEX + dim, ..self }
    }
}

/// A bijection of 32 bits without visible structure: "triple32", found by Wellons' search (2018), bias 0.0208 of 1 ideal.
/// Its shifts are fixed, so lanes share them.
pub fn hash(x: U32) -> U32 {
    let x = (x ^ (x >> 17)) * 0xed5a_d4bbu32;
    let x = (x ^ (x >> 11)) * 0xac4c_1b51u32;
    let x = (x ^ (x >> 15)) * 0x3184_8babu32;
    x ^ (x >> 14)
}

/// 24 bits as a number in [0, 1): never 1, unlike x · 2^-32 (N19).
pub fn uniform(x: U32) -> F32 {
    (x >> 8).to_f32() * (1.0 / 16_777_216.0)
}
