//! Samplers: how the random numbers of a sample are drawn.
//!
//! A component asks its [`Rng`] for a number ([`Rng::next`]) or for two that belong together ([`Rng::pair`]): a point of a square, a
//! direction. Which sampler answers is a column of [`Sampling`], known at every level, so a residual has one sampler in it.
//!
//! - [`make_independent_sampler`]: numbers that have nothing to do with each other. The reference.
//! - [`make_sobol_sampler`]: the samples of a pixel fill the space of their numbers evenly (Burley 2020).
//!
//! **Dimensions.** Each vertex of a path has its block of positions, each purpose its place in it ([`crate::core::rng`]). Sobol
//! points have few dimensions that are good together, so each *set* of numbers has points in an order of its own. In a set
//! belong together: a choice and the pair after it that lead to a vertex (the place on the film, or lobe and direction), and the
//! choice and the pair that ask there for light. So light that comes straight to what is seen is a matter of one set. An
//! order is a hash of a position: what a scene does not draw costs nothing, and moves nothing.
//!
//! **Scrambles.** Samples of a pixel belong to 2^[`Sampling::LOG_SCRAMBLES`] sequences that are independent of each other: sample s to
//! sequence s mod 8, where it is number s div 8. The spread of the eight means tells the variance of their mean, which the spread
//! of samples does not. By turns, since how many samples there will be need not be known, and a render may go on.

use jerboa_ir::lang::{F32, Row, Staged, U32};

use crate::core::rng::{DIMENSIONS_PER_VERTEX, Rng, Stream, hash, uniform};
use crate::core::sobol::{in_powers_of_x_plus_1, in_powers_of_x2_plus_x_plus_1, owen, reversed, second_half, shuffled};
use crate::schema::Sampling;

/// Where random numbers come from. All of it is arithmetic: no state, no branch.
#[derive(Clone, Copy)]
pub struct Sampler {
    /// (seed, pixel, sample) → the stream of the sample.
    pub stream: fn(U32, U32, U32) -> Stream,
    /// A word at a position. Each fourth position's belongs together with the pair after it.
    pub number: fn(Rng) -> U32,
    /// The words of a position and the next, which belong together.
    pub pair: fn(Rng) -> [U32; 2],
    /// A word for a thing at a position, which is no position of its own.
    pub of: fn(Rng, U32) -> U32,
}

/// Each word is the hash of its position.
pub fn make_independent_sampler() -> Sampler {
    Sampler {
        stream: Stream::keyed,
        number: Rng::word,
        pair: |rng| [rng.word(), rng.ahead(1).word()],
        of: |rng, thing| hash(rng.word() ^ thing),
    }
}

/// Scrambled Sobol points; hashes of positions are the keys. A fraction has 16 digits of its point in a pair, the other bits are
/// hashes of these digits: so many samples no pixel has.
pub fn make_sobol_sampler() -> Sampler {
    Sampler {
        stream: |seed, pixel, sample| {
            let log = Row::<Sampling>::at(0u32).get(Sampling::LOG_SCRAMBLES);
            let scramble = sample & ((U32::from(1) << log) - 1u32);
            Stream { index: reversed(sample >> log), ..Stream::keyed(seed, pixel, scramble) }
        },
        number: |rng| {
            let is_alone = (rng.dim & 3u32).ne(0);
            let i = point(rng, is_alone.select(rng.dim + ALONE, order(rng)));
            reversed(owen(in_powers_of_x2_plus_x_plus_1(i), rng.word()))
        },
        pair: |rng| {
            let i = point(rng, order(rng));
            let (a, b) = (owen(i, rng.word()), owen(in_powers_of_x_plus_1(i), rng.ahead(1).word()));
            let both = reversed((a & 0xffffu32) | (b << 16));
            [(both & 0xffff_0000u32) | (a >> 16), (both << 16) | (b >> 16)]
        },
        of: |rng, thing| hash(hash(rng.word() ^ rng.index) ^ thing),
    }
}

/// First of the positions that no component draws at: those of the orders of sets.
const ORDERS: u32 = 1 << 31;
/// A number at another position than each fourth is in a set of its own, whose order is this far behind.
const ALONE: u32 = 1 << 30;

/// The order of the set that the numbers of a position are in: that of the position's half, or, of those of a light, that of
/// the first positions of the vertex before.
fn order(rng: Rng) -> U32 {
    let before = ((rng.dim >> DIMENSIONS_PER_VERTEX.ilog2()) - 1u32) * (DIMENSIONS_PER_VERTEX / 2);
    rng.is_second.select(before, rng.dim >> 1)
}

/// Which point a sample has in a set.
fn point(rng: Rng, order: U32) -> U32 {
    let i = shuffled(rng.index, Rng { dim: order + ORDERS, ..rng }.word());
    rng.is_second.select(second_half(i), i)
}

/// What the sampler of the render gives.
fn drawn<T: Staged>(draw: impl Fn(Sampler) -> T) -> T {
    let is_sobol = Row::<Sampling>::at(0u32).get(Sampling::IS_SOBOL);
    is_sobol.select(draw(make_sobol_sampler()), draw(make_independent_sampler()))
}

impl Stream {
    /// That of a sample. `pixel` counts over the whole film, so that a crop sees the very same.
    pub fn of(seed: U32, pixel: U32, sample: U32) -> Stream {
        drawn(|sampler| (sampler.stream)(seed, pixel, sample))
    }
}

impl Rng {
    /// A number in [0, 1) and the position after it.
    pub fn next(self) -> (F32, Rng) {
        (uniform(drawn(|sampler| (sampler.number)(self))), self.ahead(1))
    }

    /// Two numbers in [0, 1) that belong together, and the position after them.
    pub fn pair(self) -> ([F32; 2], Rng) {
        (drawn(|sampler| (sampler.pair)(self)).map(uniform), self.ahead(1).ahead(1))
    }

    /// Three words, all bits of them random, the first two of which belong together, and the position after them.
    pub fn words(self) -> ([U32; 3], Rng) {
        let [u, v] = drawn(|sampler| (sampler.pair)(self));
        ([u, v, drawn(|sampler| (sampler.number)(self.ahead(2)))], self.ahead(3))
    }

    /// A number in [0, 1) for `thing`, the same whenever and however often it is asked for at this position.
    pub fn of(self, thing: U32) -> F32 {
        uniform(drawn(|sampler| (sampler.of)(self, thing)))
    }
}
