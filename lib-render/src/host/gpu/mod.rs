//! The GPU devices, host half: which kernels are launched over which rows, and what becomes of the sums they leave.
//!
//! A pass is cut into *pieces*, consecutive pixels of its window, each with all of the pass's samples. The device leaves the
//! exact sums of a piece's pixels in the stream [`Pixels`], and the film adds them: so neither cut nor device changes a bit.
//! A piece grows while it takes less than a tenth of a second, and shrinks when it takes more than two: a driver's watchdog
//! ends a launch that takes too long, and a render that is cancelled ends with the piece.
//!
//! * [`megakernel`] launches one kernel over the piece until all is done,
//! * [`wavefront`] takes its paths from vertex to vertex.
//!
//! Both only say what to launch. A [`Machine`] does it: a GPU, or in tests whatever runs one invocation after the other.

pub mod megakernel;
pub mod wavefront;
pub mod packing;
#[cfg(feature = "gpu")]
mod real;
#[cfg(not(feature = "gpu"))]
#[path = "none.rs"]
mod real;

use std::ops::Range;
use std::time::{Duration, Instant};

use super::device::DeviceKind;
use super::error::Error;
use super::film::{Film, sums};
use super::generate::Request;
use super::renderer::Handle;
use super::tables::Pass;
use crate::device::wavefront::entry_name;
use crate::schema::{Pixels, binding};
pub use real::*;
use wavefront::Shading;

/// One launch of a kernel.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Launch {
    /// The kernel, as [`super::device::DeviceKind::requests`] lists them.
    pub kernel: usize,
    /// Its arguments after the number of the invocation.
    pub arguments: Vec<u32>,
    /// How many invocations.
    pub extent: Extent,
    /// Do the streams `Paths` and `Next` stand for each other?
    pub swapped: bool,
}

/// How many invocations; rounded up to whole groups of [`crate::device::wavefront::GROUP`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Extent {
    /// So many.
    Items(u32),
    /// As the grid in this row of the stream `Ranges` says when the launch begins.
    Range(u32),
}

/// What runs kernels of one scene, and holds its tables and their streams.
pub trait Machine {
    /// Most bytes of a memory; several streams share one.
    fn most_bytes(&self) -> u64;

    /// Have at least so many rows in these streams, by binding number. What they hold may be lost.
    ///
    /// # Errors
    /// When there is no memory.
    fn reserve(&mut self, rows: &[(usize, u32)]) -> Result<(), Error>;

    /// Set the words of the table `Frame`.
    ///
    /// # Errors
    /// When the device is lost.
    fn set_frame(&mut self, words: &[u32]) -> Result<(), Error>;

    /// Launch these, one after the other, each list in a pass of its own.
    ///
    /// # Errors
    /// When the device is lost.
    fn run(&mut self, passes: &[Vec<Launch>]) -> Result<(), Error>;

    /// The words of rows of a stream that lies row by row.
    ///
    /// # Errors
    /// When the device is lost.
    fn read(&mut self, stream: usize, rows: Range<u32>) -> Result<Vec<u32>, Error>;
}

/// How a device schedules.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Schedule {
    /// See [`crate::device::megakernel`].
    Megakernel,
    /// See [`crate::device::wavefront`].
    Wavefront(Shading),
}

impl Schedule {
    /// Of a device on a GPU that has these kernels.
    pub fn of(kind: DeviceKind, kernels: &[Request]) -> Schedule {
        if kind != DeviceKind::GpuWavefront {
            return Schedule::Megakernel;
        }
        let asks = kernels.last().is_some_and(|kernel| kernel.name == entry_name("shadow"));
        let classes = kernels.len() - wavefront::STAGES.len() - usize::from(asks);
        Schedule::Wavefront(Shading { classes: classes as u32, asks })
    }
}

/// Consecutive pixels of a pass.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Piece {
    /// The first, counted row by row in the window.
    pub first: u32,
    /// How many.
    pub pixels: u32,
    /// Samples of each.
    pub samples: u32,
}

/// A piece should not take less, and not take twice as long again.
const BRISK: Duration = Duration::from_millis(100);
/// Samples of the first piece: a tenth of a second on a slow machine.
const FIRST_SAMPLES: u32 = 1 << 14;
/// Most samples of a piece, and most paths in flight: enough to fill a large GPU some times over.
const MOST_SAMPLES: u32 = 1 << 20;
/// Bytes of a memory for each sample of a piece: no less than samples, pixels and paths in flight take in any one of them.
const BYTES: u64 = 256;

/// A machine with a way to schedule.
pub struct Device<M> {
    machine: M,
    schedule: Schedule,
    /// Samples of the next piece.
    samples: u32,
}

impl<M: Machine> Device<M> {
    /// One that has done nothing.
    pub fn new(machine: M, schedule: Schedule) -> Device<M> {
        Device { machine, schedule, samples: FIRST_SAMPLES }
    }

    /// The machine.
    pub fn machine(&self) -> &M {
        &self.machine
    }

    /// Add a pass to the film, whose window is the pass's; a film that keeps groups of samples apart takes all of them for
    /// samples of the first one's group. `frame` is what [`super::tables::frame`] makes of it. Says whether
    /// it was completed, and how many closest-hit and shadow rays it took.
    ///
    /// # Errors
    /// When the device has no memory or is lost.
    pub fn pass(
        &mut self,
        film: &mut Film,
        pass: &Pass,
        frame: &[u32],
        handle: &Handle,
    ) -> Result<(bool, [u64; 2]), Error> {
        self.machine.set_frame(frame)?;
        let (area, samples, mut rays) = (pass.window.area() as u32, pass.samples, [0; 2]);
        let mut first = 0;
        while first < area {
            let room = (self.machine.most_bytes() / BYTES).min(MOST_SAMPLES.into()) as u32;
            let pixels = (self.samples.min(room) / samples).clamp(1, area - first);
            let piece = Piece { first, pixels, samples };
            let start = Instant::now();
            if handle.is_cancelled() || !self.trace(piece, handle)? {
                return Ok((false, rays));
            }
            let sums = self.machine.read(binding::<Pixels>(), 0..pixels)?;
            for (pixel, words) in (first..).zip(sums.as_chunks().0) {
                add(film, pass, pixel, words, &mut rays);
            }
            handle.add_done(u64::from(pixels * samples));
            self.samples = match start.elapsed() {
                time if time < BRISK => (2 * self.samples).min(MOST_SAMPLES),
                time if time > 2 * BRISK => (self.samples / 2).max(1),
                _ => self.samples,
            };
            first += pixels;
        }
        Ok((true, rays))
    }

    /// Have the sums of a piece's pixels in the first rows of [`Pixels`]; says whether that was completed.
    fn trace(&mut self, piece: Piece, handle: &Handle) -> Result<bool, Error> {
        match self.schedule {
            Schedule::Megakernel => megakernel::trace(&mut self.machine, piece, handle),
            Schedule::Wavefront(shading) => wavefront::trace(&mut self.machine, shading, piece, handle),
        }
    }
}

/// Why a build without the feature `gpu` cannot do what it is asked for.
#[cfg(not(feature = "gpu"))]
fn without_feature() -> Error {
    Error::new("this build has no code for GPUs: build it with the cargo feature `gpu`")
}

/// Add a row of [`Pixels`] to the film.
fn add(film: &mut Film, pass: &Pass, pixel: u32, row: &[u32; 16], rays: &mut [u64; 2]) {
    let at = |column: jerboa_ir::lang::Col<Pixels, jerboa_ir::lang::U32>| row[column.0 as usize];
    let window = pass.window;
    let place = [window.x + pixel % window.width, window.y + pixel / window.width];
    film.add_sum(place, pass.sample, sums(row), at(Pixels::COUNT), at(Pixels::DROPPED));
    rays[0] += u64::from(at(Pixels::CLOSEST));
    rays[1] += u64::from(at(Pixels::SHADOW));
}
