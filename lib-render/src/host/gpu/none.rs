//! What there is in a build without the feature `gpu`: nothing that could be made.

use std::convert::Infallible;
use std::ops::Range;
use std::time::Duration;

use jerboa_peval::Residual;

use super::{Launch, Machine};
use crate::host::error::Error;
use crate::host::generate::{Keep, Request};
use crate::host::tables::Tables;

/// Has this build code for GPUs?
pub const IS_BUILT: bool = false;

/// Is there a GPU that can run kernels?
pub fn is_there() -> bool {
    false
}

/// Is there a GPU that can run kernels, or a driver that does so on the CPU?
pub fn has_driver() -> bool {
    false
}

/// A kernel for GPUs, which no one has made.
pub struct Emitted {
    none: Infallible,
    /// Its name.
    pub name: String,
    /// What specialisation left.
    pub residual: Residual,
    /// Time that a thread ran for its specialisation.
    pub specialize_time: Duration,
    /// Time that a thread ran for its module and SPIR-V.
    pub emit_time: Duration,
}

impl Emitted {
    /// Words of SPIR-V.
    pub fn words(&self) -> usize {
        match self.none {}
    }

    /// Its control flow.
    pub fn structured(&self) -> String {
        match self.none {}
    }

    /// The naga module, as WGSL.
    pub fn naga(&self) -> String {
        match self.none {}
    }

    /// Its SPIR-V.
    pub fn assembly(&self) -> String {
        match self.none {}
    }
}

/// The modules of kernels: none.
///
/// # Errors
/// Always, with what would help.
pub fn emit(_: &Tables, _: &[Request], _: Vec<(Residual, Duration)>) -> Result<Vec<Emitted>, Error> {
    Err(super::without_feature())
}

/// A GPU that is not there.
pub struct RealMachine {
    none: Infallible,
    /// Wall time of specialisation.
    pub specialize_time: Duration,
    /// Wall time of modules and their SPIR-V.
    pub emit_time: Duration,
    /// Wall time of the driver's pipelines.
    pub pipeline_time: Duration,
}

impl RealMachine {
    /// None.
    ///
    /// # Errors
    /// Always, with what would help.
    pub fn new(_: &Tables, _: &[Request], _: Keep) -> Result<RealMachine, Error> {
        Err(super::without_feature())
    }

    /// The kernels, and what the driver took for them.
    ///
    /// # Errors
    /// Never.
    pub fn warmed(&self) -> Result<Vec<(&Emitted, [Duration; 2])>, Error> {
        match self.none {}
    }
}

impl Machine for RealMachine {
    fn most_bytes(&self) -> u64 {
        match self.none {}
    }

    fn reserve(&mut self, _: &[(usize, u32)]) -> Result<(), Error> {
        match self.none {}
    }

    fn set_frame(&mut self, _: &[u32]) -> Result<(), Error> {
        match self.none {}
    }

    fn run(&mut self, _: &[Vec<Launch>]) -> Result<(), Error> {
        match self.none {}
    }

    fn read(&mut self, _: usize, _: Range<u32>) -> Result<Vec<u32>, Error> {
        match self.none {}
    }
}
