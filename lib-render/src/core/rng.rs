//! Random numbers: a pure function of (seed, pixel, sample, dimension); no state travels (Law 9).
//!
//! The numbers of one sample are its *stream*. A stream is an arithmetic progression through the 32-bit words, each word
//! hashed: number d is hash(start + d · step), as in SplittableRandom (Steele, Lea & Flood 2014). Start and step are
//! pixel and sample, encrypted together under the seed by a Feistel network (Luby & Rackoff 1988), and the step is made
//! odd. Three things hold whatever the hash is, since both it and the network can be undone:
//!
//! - a stream comes round after 2^32 numbers, no sooner. With a step of k · 2^m it would after 2^(32−m), and one sample
//!   in 2^20 would see the same numbers at every 256th vertex: in a bright closed box some such path never ends;
//! - streams that agree in two successive words have the same start and step, so no three (pixel, sample) have the same
//!   stream, and two have with a chance of 2^-63;
//! - over all (pixel, sample) each start comes with each odd step twice.
//!
//! A key of one word, `hash(hash(hash(seed) ^ pixel) ^ sample)`, has neither: two pixels whose inner hashes share the high
//! bits see the very same streams in another order, and so the same noise. At 64 samples that befell 34 of 2^16 pixels, at
//! 1024 samples 3 % of 2^18. `tests/tests/random_numbers.rs` counts them.
//!
//! An [`Rng`] is a stream and a position. [`Rng::next`] and [`Rng::pair`] give what is there, as the [sampler](crate::sampler)
//! of the render draws it, and the next position; [`Stream::vertex`] starts the block of dimensions of a path vertex, so that
//! what one component draws never shifts what another sees.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Bool, F32, U32};

/// Dimensions set aside for each path vertex. A BSDF draws at most 4, a light at most 4, roulette and holes 1 each.
pub const DIMENSIONS_PER_VERTEX: u32 = 16;
/// First dimension, within a vertex, of the BSDF.
pub const DIM_BSDF: u32 = 0;
/// First dimension, within a vertex, of light sampling.
pub const DIM_LIGHT: u32 = 4;
/// Dimension, within a vertex, of roulette.
pub const DIM_ROULETTE: u32 = 8;
/// Dimension, within a vertex, of the holes in surfaces on the way to it.
pub const DIM_HOLES: u32 = 9;

/// First of the dimensions, within a vertex, in which layers are chosen, one for each layer that a surface may have.
pub const DIM_LAYERS: u32 = 10;
/// Dimension, within a vertex, of the choice between the two materials of a blend.
pub const DIM_BLEND: u32 = 15;

/// 2^32 / golden ratio, rounded to odd (Knuth 1998, section 6.4): its multiples differ in many bits.
const GOLDEN: u32 = 0x9e37_79b9;

/// The random numbers of one sample of one pixel.
#[derive(Clone, Copy)]
pub struct Stream {
    /// Where the progression starts.
    pub start: U32,
    /// How far each dimension steps; odd.
    pub step: U32,
    /// Which point of a sequence the sample is, its bits reversed; 0 where the sampler has no sequences.
    pub index: U32,
}
impl_staged!(Stream { start, step, index });

impl Stream {
    /// The stream under a key of three words.
    pub fn keyed(seed: U32, pixel: U32, sample: U32) -> Stream {
        let seed = hash(seed);
        // Each round can be undone. After three of them a change of either half has reached both, after four twice.
        let round = |(left, right): (U32, U32), n: u32| (right, left ^ hash(right ^ (seed + n.wrapping_mul(GOLDEN))));
        let (start, step) = (1..=4).fold((sample, pixel), round);
        Stream { start, step: step | 1u32, index: 0.into() }
    }

    /// The block of dimensions of path vertex `vertex` (the camera is 0), from `dim` on.
    pub fn vertex(self, vertex: U32, dim: u32) -> Rng {
        let Stream { start, step, index } = self;
        let is_second = Bool::from(dim == DIM_LIGHT);
        Rng { start, step, index, dim: vertex * DIMENSIONS_PER_VERTEX + dim, is_second }
    }
}

/// A position in a stream.
#[derive(Clone, Copy)]
pub struct Rng {
    /// See [`Stream::start`].
    pub start: U32,
    /// See [`Stream::step`].
    pub step: U32,
    /// See [`Stream::index`].
    pub index: U32,
    /// Next dimension.
    pub dim: U32,
    /// Does it belong together with the first numbers of the vertex before, which led here? So do those of a light.
    pub is_second: Bool,
}
impl_staged!(Rng { start, step, index, dim, is_second });

impl Rng {
    /// The first position of a sample's own stream.
    pub fn new(seed: U32, pixel: U32, sample: U32) -> Rng {
        let Stream { start, step, index } = Stream::keyed(seed, pixel, sample);
        Rng { start, step, index, dim: 0.into(), is_second: false.into() }
    }

    /// The hash of this position.
    pub fn word(self) -> U32 {
        hash(self.start + self.dim * self.step)
    }

    /// The position so many dimensions further on.
    pub fn ahead(self, dimensions: u32) -> Rng {
        Rng { dim: self.dim + dimensions, ..self }
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
