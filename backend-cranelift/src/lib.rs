//! Residual programs to machine code, in this process, with Cranelift.
//!
//! What the evaluator leaves is first-order: functions, blocks, jumps with visible targets. That is nearly CLIF, the input
//! of the code generator Cranelift, and so this crate is a translation, not a compiler:
//!
//! | residual | CLIF | where |
//! |---|---|---|
//! | entry | `extern "C"` function around a function | `compile.rs` |
//! | function, call, tail call | function, `call`, `return_call` | `abi.rs`, `function/exit.rs` |
//! | continuation parameters | block parameters (SSA in functional clothes: Appel, *SSA is functional programming*, 1998) | `function.rs` |
//! | pure nodes | instructions, in the block that [`jerboa_ir::schedule`] chose | `function/value.rs`, `ops.rs` |
//! | tables, streams, local arrays | addresses from [`Binding`]s, stack slots | `buffers.rs`, `memory.rs`, `function/access.rs` |
//! | their vectors | runs, gathers, scatters | `function/run.rs`, `function/rows.rs`, `function/gather.rs` |
//! | `vectorize` | a loop over lanes, made by [`mod@lanes`] before all else, or one iteration after the other | `lanes/mod.rs` |
//! | vector | a value of 128 bits for every four lanes; of `bool` a mask of 0 and −1 | `vector.rs`, `pack.rs`, `simd.rs` |
//!
//! **The code means what the interpreter means**, bit for bit, all NaN being one value. So minimum and maximum are a
//! comparison and a selection, a multiply-add is fused where the program says so and nowhere else (a call of
//! [`f32::mul_add`] where the processor lacks the instruction), denormals are kept. What no machine does with vectors
//! (integer division, shifts by another amount in each lane) is done lane by lane.
//!
//! **Vectors in memory.** A run of rows is one access for every four lanes if all of it is in range. Runs of one buffer at
//! one index share the comparison that says so; if it fails, they go through copies in the frame, lane by lane. A run is
//! stored whole if its mask is all true. Under another mask a local array takes a blend; of a stream only the words under
//! the mask are touched, since another thread may own those beside them. A run is loaded where it is first used. A gather
//! clamps its indices as vectors and shares the addresses with other columns of the same buffer; of a buffer by rows of
//! four columns or more it loads four columns at once, and a run is stored to one four columns at once. Measured per lane
//! at 8 lanes, against scalars (one thread, x86-64 with AVX2, data in L2): a copy by runs 0.16 ns (0.60), a gather 0.31 ns
//! (1.04), four columns of a table by rows 0.60 ns (2.25), a scatter 0.33 ns (0.99).
//!
//! **Width.** A kernel of 380 operations on 16 columns takes 16.2 ns per lane at 4 lanes, 11.7 at 8, 10.4 at 16; its code is
//! made in 1.8, 3.1 and 10.9 ms. [`Opt::Speed`] takes two to five times as long and makes slower code from 8 lanes on (14.8
//! ns): it keeps constants in registers that are not there.
//!
//! **Nothing traps.** Conversions saturate, divisors are replaced where the machine would fault, indices are clamped as the
//! program's rules say. Recursion ends with [`Status::Limit`] at a depth for which the frames, measured after register
//! allocation, fit into [`STACK_LIMIT`]. Only what the program reads *unchecked* is the caller's word; that is why
//! [`Kernel::call`] is unsafe.
//!
//! **Each entry is a kernel of its own**, with the functions it needs, so kernels are compiled in parallel. Cranelift's own
//! optimiser is off by default ([`Opt::None`]): the evaluator has folded and shared already. Code lives as long as its
//! [`Code`].
//!
//! ```
//! use jerboa_backend_cranelift::{Binding, Options, Status, compile};
//!
//! let residual = jerboa_ir::parse(
//!     "jerboa-ir 1
//! stream values by columns
//!   x: f32 bulk
//! entry double = double
//! fun double(i: u32, return: fn(f32))
//!   load values.x i -> got
//!   rest got(x: f32)
//!   y = add x x
//!   store values.x i y -> stored
//!   rest stored()
//!   jump return(y)
//! ",
//! )?;
//! let code = compile(&[&residual], &Options::default())?;
//! let kernel = code.kernel("double").expect("it is an entry");
//!
//! let mut values = [1.0f32, 2.0, 4.0].map(f32::to_bits);
//! let bindings = [Binding::new(&mut values, 3)];
//! let mut result = [0];
//! // Out of range: a load gives the last row, a store is dropped.
//! for i in [1, 9] {
//!     // SAFETY: the only buffer is bound, with one word in each of its three rows.
//!     let status = unsafe { kernel.call(&bindings, &[i], &mut result) };
//!     assert_eq!(status, Status::Done);
//! }
//! assert_eq!(result.map(f32::from_bits), [8.0]);
//! assert_eq!(values.map(f32::from_bits), [1.0, 4.0, 4.0]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # A new operation
//! `ops.rs` (scalars) and `vector.rs` have one `match` each over [`jerboa_ir::Op`] without a wildcard; the compiler asks
//! for the new row there. Tests then compare it with [`jerboa_ir::Op::eval`] on this machine and on the least that will
//! do, which has SSE4.1 and no fused multiply-add.

mod abi;
mod buffers;
mod code;
mod compile;
mod error;
mod function;
pub mod lanes;
mod memory;
mod ops;
mod pack;
mod simd;
mod target;
mod vector;

pub use abi::{Binding, Status};
pub use code::{Code, Kernel, compile};
pub use compile::KernelReport;
pub use error::Error;
pub use target::{Opt, Options};

/// So many frames of recursive functions may exist at once; beyond, the kernel ends with [`Status::Limit`]. Tail calls do
/// not count. A kernel whose frames are so large that they would exceed [`STACK_LIMIT`] has a lower limit, see
/// [`KernelReport::depth`].
pub const DEPTH_LIMIT: u32 = 1000;

/// A kernel's frames take at most so many bytes of stack, checked when it is compiled: half of what a thread of Rust's
/// standard library has.
pub const STACK_LIMIT: u64 = 1 << 20;

/// A recursive kernel that could not even be this deep is an error.
const MIN_DEPTH: u32 = 16;
