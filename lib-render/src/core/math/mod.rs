//! Elementary functions as programs: every engine computes the same bits (Law 3).
//!
//! Range reduction and polynomials are those of S. Moshier's Cephes library (single precision, 1989); sums and products
//! are plain, never fused. Each function states its range, its error as measured by `tests/math.rs` against f64, and what
//! special values give. Errors in ulp are relative to the spacing of floats at the true value.

use jerboa_ir::lang::F32;

mod exp;
mod trig;

pub use exp::{exp, exp_m1, exp2, log, log1p, log2, pow};
pub use trig::{acos, asin, atan2, sincos, sincos_turns};

/// The polynomial with these coefficients, highest power first.
fn horner(x: F32, coefficients: &[f32]) -> F32 {
    let (first, rest) = coefficients.split_first().expect("a polynomial has a coefficient");
    rest.iter().fold(F32::from(*first), |y, c| y * x + *c)
}
