//! Sums of floats without rounding: 128 bits of fixed point in four words.
//!
//! A number becomes the nearest multiple of 2^-64 (ties to even), and these are added as integers, which is exact: so
//! neither order nor grouping can change a bit of a sum. `host::film` says why a film wants that, and adds the very same.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Bool, F32, U32};

/// Largest magnitude that can be added: 2^31, so that 2^32 of them stay within 2^127.
pub const RANGE: f32 = 2_147_483_648.0;

/// A sum in units of 2^-64, in two's complement.
#[derive(Clone, Copy)]
pub struct Exact {
    /// From the least significant word.
    pub words: [U32; 4],
}
impl_staged!(Exact { words });

impl Exact {
    /// Nothing yet.
    pub fn zero() -> Exact {
        Exact { words: [0; 4].map(U32::from) }
    }

    /// Can this be added? NaN cannot.
    pub fn takes(x: F32) -> Bool {
        x.abs().le(RANGE)
    }

    /// The sum with one more number, at most [`RANGE`] in magnitude.
    #[must_use]
    pub fn with(self, x: F32) -> Exact {
        let sign = x.bits() >> 31;
        let flip = 0u32 - sign;
        let magnitude = magnitude(x);
        let mut carry = sign;
        Exact {
            words: std::array::from_fn(|k| {
                let addend = magnitude[k] ^ flip;
                let part = self.words[k] + addend;
                let whole = part + carry;
                carry = (part.lt(addend) | whole.lt(part)).bits();
                whole
            }),
        }
    }
}

/// |x|·2^64 as an integer, the nearest; ties to even.
fn magnitude(x: F32) -> [U32; 4] {
    // |x|·2^64 = mantissa·2^(exponent − 86). A denormal is far below half, as is everything that moves 25 bits or more.
    let exponent = (x.bits() >> 23) & 255u32;
    let mantissa = (x.bits() & 0x7f_ffffu32) | 0x80_0000u32;
    let right = (86 - exponent.min(86)).min(31);
    let left = exponent.max(86) - 86;
    let half = (U32::from(1) << right) >> 1;
    let is_odd = (mantissa >> right) & 1;
    let rounded = right.eq(0).select(mantissa, (mantissa + half - 1 + is_odd) >> right);
    // It lies in two neighbouring words.
    let (word, shift) = (left >> 5, left & 31);
    let (low, high) = (rounded << shift, (rounded >> 1) >> (31 - shift));
    std::array::from_fn(|k| {
        let k = k as u32;
        let above = (word + 1u32).eq(k).select(high, U32::from(0));
        word.eq(k).select(low, above)
    })
}
