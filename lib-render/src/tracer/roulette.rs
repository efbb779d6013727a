//! Roulette: paths that carry little end, and the others make up for them.

use jerboa_ir::lang::{Block, F32, U32};

use crate::core::color::Color;
use crate::core::vec::Vec3;
use crate::schema::Settings;
use crate::tracer::learned::{is_learned, worth};
use crate::tracer::settings;

/// Scattering from which on a path survives with probability at most 1 − 4/k, whenever roulette begins: the expected length
/// is finite in every scene, a white closed box too (accuracy.md, N22 as amended).
const LONG_PATH: u32 = 512;

/// Probability of going on: the largest channel of the throughput without the radiance scales of refraction, at most the
/// cap; 1 before roulette begins, but never above the bound of a long path.
pub(super) fn survival(b: &mut Block, scattering: U32, throughput: Color) -> F32 {
    bounded(b, scattering, |_| by_throughput(scattering, throughput))
}

/// Likewise of a path from the camera that goes on from a point in a direction (world): where light was learned, by what is
/// to be found there, from the first scattering on.
pub(super) fn survival_towards(b: &mut Block, scattering: U32, throughput: Color, point: Vec3, dir: Vec3) -> F32 {
    bounded(b, scattering, |b| {
        let learned = |_: &mut Block| capped(throughput.max_channel() * worth(point, dir));
        b.if_(is_learned(), learned, |_| by_throughput(scattering, throughput))
    })
}

fn by_throughput(scattering: U32, throughput: Color) -> F32 {
    let begins = scattering.ge(settings().get(Settings::RR_DEPTH));
    begins.select(capped(throughput.max_channel()), 1.0.into())
}

fn capped(q: F32) -> F32 {
    q.min(settings().get(Settings::RR_CAP))
}

fn bounded(b: &mut Block, scattering: U32, survival: impl Fn(&mut Block) -> F32) -> F32 {
    let roulette = |b: &mut Block| {
        let q = survival(b);
        b.if_(scattering.ge(LONG_PATH), |_| q.min(1.0 - 4.0 / scattering.to_f32()), |_| q)
    };
    b.if_(settings().get(Settings::ROULETTE), roulette, |_| F32::from(1.0))
}
