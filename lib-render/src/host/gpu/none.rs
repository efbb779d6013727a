//! What there is in a build without the feature `gpu`: nothing that could be made.

use std::convert::Infallible;
use std::ops::Range;
use std::time::Duration;

use super::{Launch, Machine};
use crate::host::error::Error;
use crate::host::generate::{Keep, Request};
use crate::host::tables::Tables;

/// Is there a GPU that can run kernels?
pub fn is_there() -> bool {
    false
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
