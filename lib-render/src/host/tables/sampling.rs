//! Kinds of samplers.

use super::memory::{Memory, Table};
use crate::schema::Sampling;

/// log2 of how many sequences the samples of a pixel belong to. The variance of eight means has a standard error of √(2/7) of it.
const LOG_SCRAMBLES: u32 = 3;

/// How random numbers are drawn; see [`crate::sampler`]. The default is the reference, of which every statistic of samples is right;
/// `jerboa render` draws Sobol points.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum SamplerKind {
    /// Each by itself.
    #[default]
    Independent,
    /// As scrambled Sobol points.
    Sobol {
        /// log2 of how many independent sequences the samples of a pixel belong to, at most 31.
        log_scrambles: u32,
    },
}

impl SamplerKind {
    /// Sobol points in eight sequences.
    pub const SOBOL: SamplerKind = SamplerKind::Sobol { log_scrambles: LOG_SCRAMBLES };

    /// The table by which kernels know it.
    pub(super) fn row(self) -> Memory {
        let (is_sobol, log_scrambles) = match self {
            SamplerKind::Independent => (false, 0),
            SamplerKind::Sobol { log_scrambles } => (true, log_scrambles.min(31)),
        };
        let mut table = Table::<Sampling>::new();
        table.push().set(Sampling::IS_SOBOL, is_sobol).set(Sampling::LOG_SCRAMBLES, log_scrambles);
        table.finish()
    }
}
