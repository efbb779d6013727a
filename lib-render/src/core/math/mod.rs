//! Elementary functions as programs: every engine computes the same bits (Law 3).
//!
//! Sums and products are plain, never fused. Most polynomials are those of S. Moshier's Cephes library (single precision,
//! 1989): near-minimax on the interval that is stated with each, found there with Remez' exchange. What a polynomial is off
//! by in exact arithmetic stands beside it.
//!
//! Each function states its range, its largest error against f64 as measured over all 2^32 arguments (10^7 pairs for a
//! function of two) by `cargo run --release -p jerboa-tests --bin sweep`, and what special values give. An ulp is the
//! spacing of floats at the true value, 2^-149 among denormals; an infinity counts as 2^128. A row of the table in
//! `tests/src/harness/functions.rs` adds a function to all tests.

use jerboa_ir::lang::F32;

mod exp;
mod trig;

pub use exp::{exp, exp_m1, exp2, log, log1p, log2, pow};
pub use trig::{acos, asin, atan2, sincos, sincos_turns, tan};

/// The polynomial with these coefficients, highest power first.
fn horner(x: F32, coefficients: &[f32]) -> F32 {
    let (first, rest) = coefficients.split_first().expect("a polynomial has a coefficient");
    rest.iter().fold(F32::from(*first), |y, c| y * x + *c)
}
