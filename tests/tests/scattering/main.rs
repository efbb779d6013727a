//! Scattering: every test here runs over all rows of [`rows`](jerboa_tests::harness::scattering::rows), through the
//! shader with nothing known and on machine code; T5 to T8, T12, N4 to N7, N12, N25. Larger numbers for the long versions:
//! - `JERBOA_SAMPLES=1000000` samples for each direction in T5 and T7 instead of 5,000 and 4,000, and T5 from every side
//!   instead of every third;
//! - `JERBOA_PAIRS=100000` pairs of directions for each row in T6, T8 and N25 instead of 1,000;
//! - `JERBOA_COSINES=1000000` cosines for each index in T12 instead of 20,000.

mod density;
mod directions;
mod energy;
mod formulas;
mod fresnel;
mod model;
mod reciprocity;
mod textured;
