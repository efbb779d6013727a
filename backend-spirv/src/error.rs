//! What can go wrong while emitting, and whose fault it is.

use std::fmt;

use jerboa_ir::cfg::NotFirstOrder;
use jerboa_ir::structure::Unstructured;

/// Why there is no module. Nothing in a valid residual causes a panic.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Error {
    /// The program has no entry of this name.
    NoEntry {
        /// The name.
        kernel: String,
        /// The entries that it has.
        entries: Vec<String>,
    },
    /// The entry's parameters or results do not fit the grid.
    Shape {
        /// The kernel.
        kernel: String,
        /// What does not fit, and what to do.
        why: String,
    },
    /// The program is no residual: a fault of whoever made it.
    NotFirstOrder {
        /// The kernel.
        kernel: String,
        /// What, where and what to do.
        fault: NotFirstOrder,
    },
    /// The control flow of a function has no tree.
    Unstructured {
        /// The kernel.
        kernel: String,
        /// What, where and what to do.
        fault: Box<Unstructured>,
    },
    /// Functions that call each other in a circle; GPUs have no stack for them.
    Recursion {
        /// The kernel.
        kernel: String,
        /// The functions, each called by the one before it; the last is the first.
        chain: Vec<String>,
    },
    /// A node that GPUs do not have.
    Unsupported {
        /// The kernel.
        kernel: String,
        /// What, where and what to do.
        why: String,
    },
    /// The packing does not fit the program.
    Packing {
        /// The kernel.
        kernel: String,
        /// What does not fit.
        why: String,
    },
    /// The kernel is larger than the budget.
    Budget {
        /// The kernel.
        kernel: String,
        /// Words of SPIR-V that it takes.
        words: usize,
        /// Blocks of the residual in it.
        blocks: usize,
        /// Words that it may take.
        budget: usize,
    },
    /// naga refused what we gave it: a mistake of this crate.
    Naga {
        /// The kernel.
        kernel: String,
        /// naga's words.
        why: String,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::NoEntry { kernel, entries } => {
                write!(f, "there is no kernel `{kernel}`; there is {}", entries.join(", "))
            }
            Error::Shape { kernel, why } => write!(f, "kernel `{kernel}`: {why}"),
            Error::NotFirstOrder { kernel, fault } => write!(f, "kernel `{kernel}`: {fault}"),
            Error::Unstructured { kernel, fault } => write!(f, "kernel `{kernel}`: {fault}"),
            Error::Recursion { kernel, chain } => write!(
                f,
                "kernel `{kernel}` recurses, which GPUs cannot: {}; unfold the recursion or write it as a loop",
                chain.join(" calls ")
            ),
            Error::Unsupported { kernel, why } => write!(f, "kernel `{kernel}`: {why}"),
            Error::Packing { kernel, why } => {
                write!(f, "kernel `{kernel}`: the packing does not fit the program: {why}")
            }
            Error::Budget { kernel, words, blocks, budget } => write!(
                f,
                "kernel `{kernel}` takes {words} words of SPIR-V (blocks: {blocks}), more than the budget of {budget}: \
                 drivers' compile time grows faster than the kernel; specialise less, split the kernel (the wavefront \
                 device has one per shader), or raise the budget"
            ),
            Error::Naga { kernel, why } => {
                write!(f, "kernel `{kernel}`: naga refused the module; please report this: {why}")
            }
        }
    }
}

impl std::error::Error for Error {}
