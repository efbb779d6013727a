//! Special values: where arithmetic goes wrong if it does.

use jerboa_ir::{Lit, Scalar};

use crate::choices::Choices;

/// Floats: zeros, ones and their neighbours, ties of rounding, the ends of the integers and of the format, denormals,
/// infinities, NaN.
pub const FLOATS: [f32; 31] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -0.5,
    1.5,
    2.5,
    -2.5,
    0.999_999_94, // 1 − ulp
    1.000_000_1,  // 1 + ulp
    8_388_607.5,  // the largest number with a fraction
    16_777_215.0, // 2^24 − 1
    16_777_216.0,
    16_777_218.0,    // the float after 2^24
    2_147_483_520.0, // the float before 2^31
    2_147_483_648.0,
    -2_147_483_648.0,
    -2_147_483_904.0, // the float before −2^31
    4_294_967_040.0,  // the float before 2^32
    4_294_967_296.0,
    f32::MAX,
    f32::MIN,
    f32::MIN_POSITIVE,
    1.175_494_2e-38, // the largest denormal
    1e-45,           // the smallest
    -1e-45,
    1e-30,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
];

/// Signed integers: the ends, and where floats stop being exact.
pub const SIGNED: [i32; 16] =
    [0, 1, -1, 2, -2, 7, 31, 32, -7, 16_777_215, 16_777_216, 16_777_217, -16_777_217, i32::MAX, i32::MIN, i32::MIN + 1];

/// Unsigned integers: the ends, shift amounts around 32, the bits of infinities and of NaN of all kinds.
pub const UNSIGNED: [u32; 20] = [
    0,
    1,
    2,
    3,
    7,
    31,
    32,
    33,
    16_777_215,
    16_777_217,
    0x7fff_ffff,
    0x8000_0000,
    0x8000_0001,
    0xffff_ffff,
    0x3f80_0000,
    0x7f80_0000,
    0xff80_0000,
    0x7f80_0001, // a signalling NaN
    0x7fc0_0000,
    0xffc1_2345,
];

/// All special values of a scalar type; the first is its zero.
pub fn specials(scalar: Scalar) -> Vec<Lit> {
    match scalar {
        Scalar::Bool => vec![Lit::Bool(false), Lit::Bool(true)],
        Scalar::I32 => SIGNED.map(Lit::I32).to_vec(),
        Scalar::U32 => UNSIGNED.map(Lit::U32).to_vec(),
        Scalar::F32 => FLOATS.map(Lit::f32).to_vec(),
    }
}

/// A random value: special in two of five cases, small in two, any bits in one.
pub fn random(scalar: Scalar, c: &mut Choices) -> Lit {
    match c.below(5) {
        0 | 1 => {
            let small = c.below(17);
            match scalar {
                Scalar::Bool => Lit::Bool(small % 2 == 1),
                Scalar::I32 => Lit::I32(small as i32 / 2 * if small % 2 == 1 { -1 } else { 1 }),
                Scalar::U32 => Lit::U32(small),
                Scalar::F32 => Lit::f32((small / 2) as f32 * if small % 2 == 1 { -0.375 } else { 0.75 }),
            }
        }
        2 | 3 => c.pick(&specials(scalar)),
        _ => Lit::from_word(scalar, c.below(u32::MAX)),
    }
}
