//! What the tests of the whole share: random decisions that shrink, special values, random programs.
//!
//! The law they serve is Law 3: the interpreter, the residual in the interpreter and the machine code give the same
//! bits. `tests/conformance.rs` checks each operation on every engine over all special values (accuracy list, T2);
//! `tests/random.rs` checks random programs (T1, T23), and `tests/divergence.rs` that specialisation ends (T23). The
//! renderer's parts are asked and judged by [`harness`]. The checkout's own text is in [`sources`], for the tests of its
//! habits; [`mutations`] spoils it, to see whether all these tests notice (T32).
//!
//! ```
//! use jerboa_ir::interp::{Limits, run};
//! use jerboa_tests::choices::Choices;
//!
//! let mut c = Choices::random(1);
//! let case = jerboa_tests::programs::case(&mut c);
//! let args = case.arguments(&mut c);
//! run(&case.program, case.main, &args, &mut case.memory.clone(), Limits::default()).expect("it ends");
//! ```

pub mod choices;
pub mod coverage;
pub mod engine;
pub mod forms;
pub mod golden;
pub mod graphs;
pub mod harness;
pub mod knowledge;
pub mod machine;
pub mod mutations;
pub mod programs;
pub mod refold;
pub mod sources;
pub mod spirv;
pub mod sweep;
pub mod trial;
pub mod values;

/// The examples of the page at the root.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
mod readme {}
