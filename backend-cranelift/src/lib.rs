//! Residual programs to machine code, in the process, with Cranelift.

mod abi;
mod code;
mod compile;
mod error;
mod function;
mod memory;
mod ops;
mod target;

pub use abi::{Binding, Status};
pub use code::{Code, Kernel, compile};
pub use compile::KernelReport;
pub use error::Error;
pub use target::{Opt, Options};

/// Recursion of residual functions may be so deep; beyond, the kernel ends with [`Status::Limit`]. Tail calls do not
/// count.
pub const DEPTH_LIMIT: u32 = 1000;

/// A kernel's frames take at most so many bytes of stack, checked when it is compiled: half of what a thread of Rust's
/// standard library has.
pub const STACK_LIMIT: u64 = 1 << 20;
