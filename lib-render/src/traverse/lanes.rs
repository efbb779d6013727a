//! Four lanes at once: bits of a ballot, extremes, order.

use jerboa_ir::lang::{U32, Vector};

/// For each ballot of four lanes, twice its number of bits to the left, the lane of its lowest bit.
const LOWEST: u32 = {
    let (mut table, mut ballot) = (0, 1_u32);
    while ballot < 16 {
        table |= ballot.trailing_zeros() << (2 * ballot);
        ballot += 1;
    }
    table
};

/// The lowest lane in a ballot of four, which has one.
pub fn lowest(ballot: U32) -> U32 {
    (U32::from(LOWEST) >> (ballot + ballot)) & 3
}

/// The ballot without its lowest lane.
pub fn without_lowest(ballot: U32) -> U32 {
    ballot & (ballot - 1u32)
}

/// The smallest lane.
pub fn smallest(v: Vector<U32, 4>) -> U32 {
    let v = v.min(v.shuffle([2, 3, 0, 1]));
    v.min(v.shuffle([1, 0, 3, 2])).extract(0)
}

/// The largest lane.
pub fn largest(v: Vector<U32, 4>) -> U32 {
    let v = v.max(v.shuffle([2, 3, 0, 1]));
    v.max(v.shuffle([1, 0, 3, 2])).extract(0)
}

/// The lanes in ascending order, by the network of Batcher (1968).
pub fn sorted(v: Vector<U32, 4>) -> [U32; 4] {
    let v = exchange(v, [1, 0, 3, 2]);
    let v = exchange(v, [2, 3, 0, 1]);
    exchange(v, [0, 2, 1, 3]).elems()
}

/// Each lane with its partner: the smaller one goes to the lower lane.
fn exchange(v: Vector<U32, 4>, partner: [usize; 4]) -> Vector<U32, 4> {
    let other = v.shuffle(partner);
    let (lo, hi) = (v.min(other).elems(), v.max(other).elems());
    Vector::new(std::array::from_fn(|lane| if lane <= partner[lane] { lo[lane] } else { hi[lane] }))
}
