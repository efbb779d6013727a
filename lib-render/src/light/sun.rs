//! Suns: disks of equal radiance in the sky, seen where a ray hits nothing.
//!
//! Sampled uniformly by solid angle. A direction is within the disk if its distance from the middle's, squared, is at most
//! 2 (1 − cos): differences of unit vectors keep their digits where 1 − cos has none. Coordinates of a unit vector are known to
//! 6e-8, so the rim is sharp to that angle: to 1.3e-5 of the radius of the sun as seen from here.

use jerboa_ir::lang::{F32, Fun, Row};

use crate::core::onb::onb;
use crate::core::rng::Rng;
use crate::core::sampling::{uniform_cone, uniform_cone_pdf};
use crate::core::vec::{Vec3, vec2};
use crate::light::environment::behind_scene;
use crate::light::seen::Met;
use crate::light::{DirectLightSample, EmissionSample, Light, first_edge, strength, unseen};
use crate::schema::{Lights, NONE};

/// A disk in the sky.
pub fn make_sun(row: Row<Lights>) -> Light {
    Light {
        sample_direct: Fun::lam(move |_, (rng, point): (Rng, Vec3)| DirectLightSample {
            wi: sample(row, rng).0,
            pos: point,
            distance: F32::from(f32::INFINITY),
            intensity: strength(row),
            pdf_dir: row.get(Lights::PROBABILITY) * uniform_cone_pdf(row.get(Lights::OPENING)),
            is_delta: false.into(),
            primitive: NONE.into(),
            primitive1: NONE.into(),
        }),
        sample_emission: Fun::lam(move |_, rng: Rng| {
            let (from, rng) = sample(row, rng);
            let (pos, pdf_area) = behind_scene(row, rng, from);
            let pdf_dir = uniform_cone_pdf(row.get(Lights::OPENING));
            EmissionSample {
                pos,
                dir: -from,
                intensity: strength(row),
                cos: 1.0.into(),
                pdf_area,
                pdf_dir,
                primitive: NONE.into(),
                primitive1: NONE.into(),
            }
        }),
        emission: unseen(),
        has_area: false.into(),
    }
}

/// A sun behind everything, in a unit direction.
pub fn meet(row: Row<Lights>, dir: Vec3) -> Met {
    let opening = row.get(Lights::OPENING);
    Met {
        is_met: (dir + first_edge(row)).length2().le(2.0 * opening),
        radiance: strength(row),
        pdf_dir: row.get(Lights::PROBABILITY) * uniform_cone_pdf(opening),
        distance: F32::from(f32::INFINITY),
    }
}

/// A direction to the sun, unit.
fn sample(row: Row<Lights>, rng: Rng) -> (Vec3, Rng) {
    let ([u, v], rng) = rng.pair();
    let local = uniform_cone(vec2(u, v), row.get(Lights::OPENING));
    let middle = -first_edge(row);
    let (tangent, bitangent) = onb(middle);
    (tangent * local.x + bitangent * local.y + middle * local.z, rng)
}
