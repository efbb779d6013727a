//! Points that fill a cube evenly: Sobol's, scrambled as Owen does it, by bit operations that lanes share.
//!
//! **Points.** Read a number i as a polynomial over the field of two elements, bit k for x^k. The digits of point i in a
//! dimension are those of this polynomial written in powers of another one, p: i modulo p gives the first ones, the quotient
//! modulo p the next (Niederreiter, "Low-discrepancy and low-dispersion sequences", 1988):
//!
//! | dimension | p | digits |
//! |---|---|---|
//! | 0 | x | i itself |
//! | 1 | x + 1 | [`in_powers_of_x_plus_1`] |
//! | 2 | x² + x + 1 | [`in_powers_of_x2_plus_x_plus_1`] |
//!
//! To the digit these are the first three dimensions of Sobol's sequence ("On the distribution of points in a cube and the
//! approximate evaluation of integrals", 1967) with the direction numbers of Bratley and Fox (ACM algorithm 659, 1988). But writing
//! a polynomial in powers of p takes five steps or eight, since p(x)^s = p(x^s) where s is a power of two; direction numbers take 32.
//!
//! **Why they fill evenly.** The first k digits in dimension j, where k is a multiple of the degree of p, are i modulo p^(k/degree).
//! The p have no common factor. So by the Chinese remainder theorem, of 2^m consecutive numbers from a multiple of 2^m on
//! exactly one has given first digits in all dimensions, m digits together. In dimensions 0 and 1 that is: every box of
//! volume 2^-m whose sides are dyadic intervals has exactly one point.
//!
//! **Scrambling.** [`owen`] flips each digit by a random function of the digits before it (Owen, "Randomly permuted (t,m,s)-nets and
//! (t,s)-sequences", 1995). Each point is then uniform, and boxes keep their points. Numbers i are scrambled too, backwards, before
//! they become points ([`shuffled`]): blocks of 2^m numbers stay together, so points of different sets of dimensions
//! come in orders that have nothing to do with each other (Burley, "Practical hash-based Owen scrambling", 2020).
//!
//! In all of this the first digit is the *lowest* bit, as carries go upwards; [`reversed`] makes a fraction of it.

use jerboa_ir::lang::U32;

/// The bits in reverse order.
pub fn reversed(x: U32) -> U32 {
    let x = (x >> 16) | (x << 16);
    let swapped = |x: U32, n: u32, low: u32| ((x >> n) & low) | ((x & low) << n);
    let x = swapped(x, 8, 0x00ff_00ff);
    let x = swapped(x, 4, 0x0f0f_0f0f);
    let x = swapped(x, 2, 0x3333_3333);
    swapped(x, 1, 0x5555_5555)
}

/// Flips each bit by a hash of the bits below it: a random tree for each key, which should be well mixed itself.
///
/// A product with an even number leaves bit k to the bits below it, so each line can be undone from the lowest bit on. The form is
/// Laine and Karras' ("Stratified sampling for stochastic transparency", 2011); the constants are Vegdahl's ("Building a
/// better LK hash", 2021), found by a search for trees that look random. `tests/tests/sobol.rs` looks at them.
pub fn owen(x: U32, key: U32) -> U32 {
    let x = x ^ (x * 0x3d20_adeau32);
    let x = (x + key) * ((key >> 16) | 1u32);
    let x = x ^ (x * 0x0552_6c56u32);
    x ^ (x * 0x53a2_2864u32)
}

/// The number of a point in an order of its own for each key, from the number with its bits reversed.
pub fn shuffled(reversed_number: U32, key: U32) -> U32 {
    reversed(owen(reversed_number, key))
}

/// Dimension 1. With s a power of two, h x^s + l = h (x + 1)^s + (l + h).
pub fn in_powers_of_x_plus_1(i: U32) -> U32 {
    let i = i ^ (i >> 16);
    let i = i ^ ((i >> 8) & 0x00ff_00ffu32);
    let i = i ^ ((i >> 4) & 0x0f0f_0f0fu32);
    let i = i ^ ((i >> 2) & 0x3333_3333u32);
    i ^ ((i >> 1) & 0x5555_5555u32)
}

/// Dimension 2. With X = x^s and p = x² + x + 1, d X³ + c X² + b X + a = (d X + (c + d)) p^s + (b + c) X + (a + c + d).
pub fn in_powers_of_x2_plus_x_plus_1(i: U32) -> U32 {
    let divided = |i: U32, s: u32, cb: u32, a: u32| {
        let i = i ^ ((i >> s) & cb);
        i ^ ((i >> (2 * s)) & a)
    };
    let i = divided(i, 8, 0x00ff_ff00, 0x0000_00ff);
    let i = divided(i, 4, 0x0ff0_0ff0, 0x000f_000f);
    let i = divided(i, 2, 0x3c3c_3c3c, 0x0303_0303);
    divided(i, 1, 0x6666_6666, 0x1111_1111)
}

/// The number of the point that makes the other half of a set, whose dimensions are again those above.
///
/// Each bit gets only higher ones added, so 2^m numbers from a multiple of 2^m on stay such: in its own three dimensions a half
/// has the very points. The shifts and masks were found by a search, of 22 hill climbs of 4,000 to 6,000 steps: they have the least
/// errors of scrambled nets of 2 to 4,096 points in all six dimensions and in those of both pairs, for products of functions
/// whose Walsh coefficients fall as those of smooth functions, and of edges, do. `tests/tests/sobol.rs` states how good
/// they are.
pub fn second_half(i: U32) -> U32 {
    let i = i ^ ((i >> 7) & 0x5338_96aeu32);
    let i = i ^ ((i >> 8) & 0xea2c_8bc9u32);
    let i = i ^ ((i >> 6) & 0x1e7e_5f30u32);
    let i = i ^ ((i >> 3) & 0xdaed_6dcfu32);
    i ^ ((i >> 5) & 0xfc37_389bu32)
}
