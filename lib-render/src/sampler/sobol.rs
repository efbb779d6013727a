//! Scrambled Sobol points, a sequence of them for each set of numbers that belong together; see [`crate::sampler`].

use jerboa_ir::lang::{Row, U32};

use crate::core::rng::{DIMENSIONS_PER_VERTEX, Rng, Stream, hash};
use crate::core::sobol::{in_powers_of_x_plus_1, in_powers_of_x2_plus_x_plus_1, owen, reversed, second_half, shuffled};
use crate::sampler::Sampler;
use crate::schema::Sampling;

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
