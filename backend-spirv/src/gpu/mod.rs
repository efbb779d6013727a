//! Kernels on a GPU: adapters, memory, launches, through wgpu (Vulkan, Metal, Direct3D 12).
//!
//! ```text
//! adapters() ─ Choice ─▶ Gpu::open ─▶ Arc<Gpu> ┬─ memory, write, read    words, as the tables of the CPU are
//!                                              ├─ kernel(Module)         a pipeline; several threads may make some
//!                                              └─ run(passes)            one submission; wait, or read, to see its end
//! ```
//!
//! # What a launch binds
//!
//! Storage buffers as [`crate::Module::bindings`] lists them: the launch, what holds the program's buffers, results. All launches
//! of a submission travel in one upload, each at an offset of its own.
//!
//! # Two modes
//!
//! *Exact* hands our SPIR-V to the driver as it is, with `NoContraction` on every float operation, so that a driver of correct
//! arithmetic gives the very bits of the CPU; it needs Vulkan and is the default there. *Portable* hands the `naga::Module` to
//! wgpu, which writes what the system speaks; a driver may then fuse and reorder float operations.
//!
//! # What goes wrong
//!
//! Every failure is an [`Error`] of one line; none is a panic, also where wgpu's own way is to panic: errors are caught in
//! scopes, a lost device is noted by a callback, and the one panic that is left in wgpu 30, that of a wait that finds the
//! device lost, is caught and kept from the panic hook.
//!
//! # Time
//!
//! Making a pipeline is not all of a driver's compilation: Mesa's lavapipe compiles at the first dispatch.
//! [`Gpu::warm`] makes it do so, with nothing to do, so that both times can be told apart from work.

mod error;
mod adapter;
mod device;
mod quiet;
mod memory;
mod kernel;
mod launch;

pub use adapter::{Adapter, Choice, Kind, NONE, adapters};
pub use device::{Gpu, Mode};
pub use error::Error;
pub use kernel::Kernel;
pub use launch::{Bound, Extent, Launch, groups};
pub use memory::Memory;

/// Most workgroups along a side of a grid: what every adapter allows.
pub const MOST_GROUPS: u32 = 65_535;
