//! Residual programs to GPUs: as SPIR-V and as naga modules, and the machine that runs them ([`gpu`]).
//!
//! ```text
//! residual IR → tree → naga::Module → naga's validator → SPIR-V, made exact → Vulkan
//!                                                      ↘ the module itself    → Metal, Direct3D 12
//! ```
//!
//! The same first-order programs as `backend-cranelift` takes, over the same buffers, laid out word for word alike. So the
//! renderer has no second version for the GPU; a device is another way to schedule the same tracer (paper, section 4.7).
//!
//! | residual | naga | where |
//! |---|---|---|
//! | entry | entry point; its arguments are words of the *launch* | `emit.rs`, `launch.rs`, `function/signature.rs` |
//! | function, call | function, call; callees come first | `emit.rs`, `function/exit.rs` |
//! | control flow | `if`, `switch`, `loop`, `break`, `continue`, from the tree of [`mod@jerboa_ir::structure`] | `flow.rs`, `function.rs` |
//! | block parameters | the values themselves where one block goes on there; else local variables | `function/exit.rs` |
//! | pure nodes | expressions, in the block that [`jerboa_ir::schedule`] chose | `function/value.rs`, `ops.rs` |
//! | vectors | one expression for each lane: GPUs compute with scalars | `function/value.rs` |
//! | tables, streams | words in at most 8 storage buffers ([`Packing`]) | `function/memory.rs`, `function/top.rs` |
//! | `vectorize` | a loop; the GPU's lanes are its invocations ([`Grid`]) | `function/exit.rs` |
//!
//! # An example
//!
//! A search, as in [`mod@jerboa_ir::structure`]. It needs no GPU to be emitted, validated and read.
//!
//! ```
//! use jerboa_backend_spirv::{Grid, Options, emit};
//!
//! let residual = jerboa_ir::parse(
//!     "jerboa-ir 1
//! stream rows by columns
//!   x: f32 bulk
//! entry find = find
//! fun find(x: f32, n: u32, return: fn(u32))
//!   jump head(0u)
//!   loop head(i: u32)
//!     inside = lt i n
//!     branch inside look leave
//!   arm look()
//!     load rows.x i -> compare
//!   rest compare(y: f32)
//!     same = eq x y
//!     branch same leave step
//!   arm step()
//!     j = add i 1u
//!     jump head(j)
//!   label leave()
//!     jump return(i)
//! ",
//! )?;
//! let module = emit(&residual, "find", &Options { grid: Grid::Single, ..Options::default() })?;
//! let text = "\
//! fun find(x: f32, n: u32) -> u32
//!   find:
//!     head(0u)
//!   label leave
//!     loop head
//!       head(i):
//!         inside = lt i n
//!       unless inside
//!         break leave
//!       look:
//!         y = load rows.x i
//!       compare(y):
//!         same = eq x y
//!       if same
//!         break leave
//!       step:
//!         j = add i 1u
//!         head(j)
//!   leave:
//!     return i
//!
//! ";
//! assert_eq!(module.structured(), text);
//! // What is behind the loop is where `break leave` goes; so the label costs nothing.
//! assert!(module.naga().contains("loop {") && !module.naga().contains("switch"));
//! assert!(module.spirv().len() < 400, "{} words", module.spirv().len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Control flow
//!
//! GPUs have no `goto`. A reducible graph becomes a tree without copying a block (Ramsey, *Beyond Relooper*, ICFP 2022); an
//! irreducible one is an error that names the two entries of the loop. Exits from several frames at once hop from frame to
//! frame (`flow.rs`). A value that is used where naga does not see it any more goes through a local variable (`uses.rs`); the
//! renderer's traversals need four.
//!
//! Where invocations run together, those that have left a loop wait for the others. Lavapipe 22.3 computes what stands in the
//! loop for all of them, and lets those that wait keep only what the loop carries; a load gives them 0. So what leaves a loop
//! without being carried lies in an element of a local array.
//!
//! # The same bits
//!
//! Every operation means what [`jerboa_ir::Op::eval`] says, bit for bit, all NaN being one value. Shading languages promise
//! less, and drivers rewrite arithmetic; hence
//!
//! - every float operation, comparisons too, is decorated `NoContraction`. naga cannot say that, so SPIR-V is edited after
//!   it is written (`spirv.rs`). A naga module itself has no exact form: Metal and Direct3D get the right program, with the
//!   liberties that their compilers take;
//! - a literal zero is read from the launch wherever arithmetic could meet it: drivers fold `x·0`, `x + 0` and `0 − x` even
//!   under `NoContraction`. The word of a one is hidden likewise: a choice between it and a zero becomes a conversion;
//! - what SPIR-V leaves open is spelled out: shifts by 32 and more, division by 0 and of the least integer by −1, floats beyond
//!   the integers, minimum and maximum of NaN (`ops.rs`). `fma` is refused: no one promises that it rounds once.
//!
//! On lavapipe 22.3 all operations, on all special values and with each operand a literal in turn, gave the bits of
//! [`jerboa_ir::Op::eval`]: 4,032,561 results. On real GPUs division and square root may be off by 2.5 units in the last place
//! and denormals may be zero; the specification of Vulkan asks for no more.
//!
//! # Memory
//!
//! Loads clamp to the last row, stores out of range are dropped; a stream without rows loads 0. Stores to one row of one
//! buffer that follow each other share the test. Distinct buffers never alias, also where they share a storage buffer.
//! Local arrays are cleared where the program makes them. Their length is free in exact mode; in a naga module each also has
//! an initialiser, for which lavapipe took 0.7 s at 256 words, so keep them to 64 entries there ([`Report::arrays`]).
//!
//! # Size
//!
//! Drivers take time that grows faster than the kernel; [`Budget`] has the figures. A traversal must stand in a kernel once.
//! Calls do not help: Mesa unfolds them all. Of the 22 kernels of the wavefront device for the scene kitchen, 126,000 words
//! together, the largest are the one that traces (14,200), the one for shadows (12,700) and a shader (12,200).
//!
//! # A machine without a GPU
//!
//! It gets one readable error, never a panic:
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
//!
//! # A new operation
//!
//! `ops.rs` has one `match` over [`jerboa_ir::Op`] without a wildcard; the compiler asks for the new row there.

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
