//! Samplers: how the random numbers of a sample are drawn.
//!
//! A component asks its [`Rng`] for a number ([`Rng::next`]) or for two that belong together ([`Rng::pair`]): a point of a square, a
//! direction. Which sampler answers is a column of [`Sampling`], known at every level, so a residual has one sampler in it.
//!
//! - [`independent`]: numbers that have nothing to do with each other. The reference.
//! - [`sobol`]: the samples of a pixel fill the space of their numbers evenly (Burley 2020).
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

use crate::core::rng::{Rng, Stream, uniform};
use crate::sampler::independent::make_independent_sampler;
use crate::sampler::sobol::make_sobol_sampler;
use crate::schema::Sampling;

pub mod independent;
pub mod sobol;

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
