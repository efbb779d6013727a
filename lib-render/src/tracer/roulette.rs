//! Roulette: paths that carry little end, and the others make up for them.

use jerboa_ir::lang::{Block, F32, U32};

use crate::core::color::Color;
use crate::schema::Settings;
use crate::tracer::settings;

/// Scattering from which on a path survives with probability at most 1 − 4/k, whenever roulette begins: the expected length
/// is finite in every scene, a white closed box too (accuracy.md, N22 as amended).
const LONG_PATH: u32 = 512;

/// Probability of going on: the largest channel of the throughput without the radiance scales of refraction, at most the
/// cap; 1 before roulette begins, but never above the bound of a long path.
pub(super) fn survival(b: &mut Block, scattering: U32, throughput: Color) -> F32 {
    let roulette = |b: &mut Block| {
        let s = settings();
        let q = throughput.max_channel().min(s.get(Settings::RR_CAP));
        let q = scattering.ge(s.get(Settings::RR_DEPTH)).select(q, 1.0.into());
        b.if_(scattering.ge(LONG_PATH), |_| q.min(1.0 - 4.0 / scattering.to_f32()), |_| q)
    };
    b.if_(settings().get(Settings::ROULETTE), roulette, |_| F32::from(1.0))
}
