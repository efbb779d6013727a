//! Devices: where and in what order paths are traced (paper, section 4.7).
//!
//! A device has two halves. Its IR half, here, is a list of entries over the tracer; its host half owns streams, threads
//! and dispatches.
//!
//! | | one kernel for a whole path | paths sorted by shader |
//! |---|---|---|
//! | CPU | [`cpu`] | [`stream`] |
//! | GPU | [`megakernel`] | [`wavefront`] |
//!
//! Paths from lights have the scalar one, alone or with paths from the camera ([`both`]).

pub mod cpu;
pub mod both;
pub mod stream;
pub mod pixel;
pub mod megakernel;
pub mod wavefront;

use crate::tracer::Tracer;

/// A device, as the paper has it: it schedules what a tracer describes.
pub struct Device {
    /// Declare the kernel of this name that traces the paths of `tracer`.
    pub trace: fn(name: &str, tracer: Tracer),
}
