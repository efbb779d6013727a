//! Machine code for the GPU: residual IR to SPIR-V, and the machine that runs it ([`gpu`]).
//!
//! ```text
//! residual IR → structure tree → naga::Module → naga's validator → SPIR-V (naga::back::spv) → wgpu
//! ```
//!
//! # What it takes
//!
//! The same first-order programs as `backend-cranelift`, with the same buffers under the same binding numbers (eight are
//! enough), laid out word for word alike: a table is uploaded as it stands. So the renderer has no second version for the
//! GPU; a device is another way to schedule the same tracer (paper, section 4.7).
//!
//! # What is different there
//!
//! - *Control flow is structured.* The residual's control flow graph is turned into sequences, ifs, loops and breaks along
//!   its dominator tree (Ramsey, *Beyond Relooper*, ICFP 2022). An irreducible graph is an error that names the two entries
//!   of the loop.
//! - *No recursion.* A residual that recurses is refused, with the chain of calls. The renderer's entries do not.
//! - *The same bits.* Every operation keeps the meaning that [`jerboa_ir::Op`] states. Where a driver rewrites arithmetic, the
//!   text it sees is chosen so that it cannot (a literal zero operand of a sum or product is read from a buffer). `fma` is
//!   refused: SPIR-V does not promise that it rounds once.
//! - *A machine without a GPU* gets one readable error, never a panic.
//!
//! ```
//! use jerboa_backend_spirv::gpu::{Choice, Gpu, adapters};
//!
//! for adapter in adapters() {
//!     println!("{} ({}), driver {}", adapter.name(), adapter.kind().name(), adapter.driver());
//! }
//! if let Err(error) = Gpu::open(&Choice::Any) {
//!     println!("{error}");
//! }
//! ```

mod code;
mod emit;
mod error;
mod flow;
mod function;
pub mod gpu;
mod launch;
mod module;
mod ops;
mod options;
mod spirv;
mod text;
mod uses;

pub use emit::emit;
pub use error::Error;
pub use launch::Binding;
pub use module::{Array, Module, Report};
pub use options::{Budget, Grid, Options, Packing, STORAGE_BUFFERS, WORKGROUP};
