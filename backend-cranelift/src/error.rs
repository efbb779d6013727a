//! What can go wrong while compiling, and whose fault it is.

use std::fmt;

use jerboa_ir::cfg::NotFirstOrder;

/// Why there is no code. Nothing in a valid residual causes a panic.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Error {
    /// This machine cannot run the code: its processor lacks something.
    Host(String),
    /// The program is no residual: a fault of whoever made it.
    NotFirstOrder {
        /// The kernel.
        kernel: String,
        /// What, where and what to do.
        fault: NotFirstOrder,
    },
    /// A `vectorize` of the kernel cannot run in lanes.
    Lanes {
        /// The kernel.
        kernel: String,
        /// What, where and what to do.
        fault: crate::lanes::Fault,
    },
    /// The kernel's frames would not fit on a thread's stack: its local arrays are too big, or its recursion is.
    Stack {
        /// The kernel.
        kernel: String,
        /// The function with the largest share.
        function: String,
        /// What the deepest chain of calls needs, in bytes.
        bytes: u64,
    },
    /// Two kernels have the same name; [`crate::Code::kernel`] could not tell them apart.
    SameName(String),
    /// Cranelift refused what we gave it: a mistake of this crate.
    Codegen {
        /// The kernel.
        kernel: String,
        /// The function.
        function: String,
        /// Cranelift's words.
        why: String,
    },
    /// The system gave no memory for code.
    Memory(String),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Host(why) => write!(f, "this machine cannot run the renderer's code: {why}"),
            Error::NotFirstOrder { kernel, fault } => write!(f, "kernel `{kernel}`: {fault}"),
            Error::Lanes { kernel, fault } => write!(f, "kernel `{kernel}`, in lanes: {fault}"),
            Error::Stack { kernel, function, bytes } => write!(
                f,
                "kernel `{kernel}` needs {bytes} bytes of stack, most of them in `{function}`; the limit is {}: make its \
                 local arrays smaller, or keep them out of recursive functions",
                crate::STACK_LIMIT
            ),
            Error::SameName(name) => write!(f, "two kernels are called `{name}`; give one another name"),
            Error::Codegen { kernel, function, why } => {
                write!(f, "kernel `{kernel}`, function `{function}`: code generation failed; please report this: {why}")
            }
            Error::Memory(why) => write!(f, "the system gave no memory for machine code: {why}"),
        }
    }
}

impl std::error::Error for Error {}
