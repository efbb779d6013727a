//! What can go wrong with a GPU, and what to do about it.

use std::fmt;

/// Why nothing ran. A line for a human.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Error {
    /// No adapter of the kind that is asked for: what there is instead, and what would help.
    NoAdapter(String),
    /// The adapter cannot run our kernels.
    Unfit {
        /// Its name.
        adapter: String,
        /// What it lacks.
        why: String,
    },
    /// More words in one buffer than the adapter allows.
    TooLarge {
        /// The adapter's name.
        adapter: String,
        /// Bytes that are asked for.
        bytes: u64,
        /// Bytes that it allows.
        most: u64,
    },
    /// The GPU's memory is full.
    OutOfMemory {
        /// What was being done.
        doing: String,
    },
    /// The device is gone: unplugged, its driver reset it, or it was destroyed. What was in its memory is lost.
    Lost(String),
    /// A launch does not fit its kernel, or words their memory: a fault of whoever made it.
    Misfit {
        /// Which launch, write or read.
        what: String,
        /// What does not fit.
        why: String,
    },
    /// wgpu or the driver refused what we gave it: a mistake of this crate, or of the driver.
    Refused {
        /// What was being done.
        doing: String,
        /// Their words.
        why: String,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::NoAdapter(what) => f.write_str(what),
            Error::Unfit { adapter, why } => write!(f, "the GPU `{adapter}` cannot run the renderer's kernels: {why}"),
            Error::TooLarge { adapter, bytes, most } => write!(
                f,
                "a buffer of {} is too large for the GPU `{adapter}`, which allows {} in one; use a smaller scene or film, or a \
                 CPU device",
                size(*bytes),
                size(*most)
            ),
            Error::OutOfMemory { doing } => write!(
                f,
                "the GPU is out of memory ({doing}): close other programs, use a smaller scene or film, or a CPU device"
            ),
            Error::Lost(why) => {
                write!(
                    f,
                    "the GPU was lost ({why}); try again, with fewer samples in a dispatch if its driver reset it"
                )
            }
            Error::Misfit { what, why } => write!(f, "{what} does not fit: {why}"),
            Error::Refused { doing, why } => write!(f, "the GPU's driver refused ({doing}); please report this: {why}"),
        }
    }
}

impl std::error::Error for Error {}

/// Bytes as people read them: in MiB from 10 MiB on.
fn size(bytes: u64) -> String {
    match bytes >> 20 {
        0..10 => format!("{bytes} bytes"),
        mib => format!("{mib} MiB"),
    }
}

/// A text of several lines as one.
pub(super) fn one_line(text: &str) -> String {
    text.lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join("; ")
}
