//! Spot lights (KHR_lights_punctual).

use jerboa_ir::lang::{F32, Fun, Row};

use crate::core::color::Color;
use crate::core::onb::onb;
use crate::core::rng::Rng;
use crate::core::sampling::{uniform_cone, uniform_cone_pdf};
use crate::core::vec::{Vec3, vec2};
use crate::light::point::sample_place;
use crate::light::{EmissionSample, Light, first_edge, position, strength, unseen};
use crate::schema::{Lights, NONE};

/// The smallest difference of cosines that the edge of a spot is spread over: the text of the extension.
const SMALLEST_EDGE: f32 = 0.001;

/// A point light within a cone: the full intensity within the inner angle, none beyond the outer one.
pub fn make_spot_light(row: Row<Lights>) -> Light {
    Light {
        sample_direct: Fun::lam(move |_, (_, point): (Rng, Vec3)| sample_place(row, point, |dir| intensity(row, dir))),
        sample_emission: Fun::lam(move |_, rng: Rng| {
            let ([u, v], _) = rng.pair();
            let axis = first_edge(row);
            let opening = 1.0 - row.get(Lights::COS_OUTER);
            let local = uniform_cone(vec2(u, v), opening);
            let (tangent, bitangent) = onb(axis);
            let dir = tangent * local.x + bitangent * local.y + axis * local.z;
            EmissionSample {
                pos: position(row),
                dir,
                intensity: intensity(row, dir),
                cos: 1.0.into(),
                pdf_area: row.get(Lights::PROBABILITY),
                pdf_dir: uniform_cone_pdf(opening),
                primitive: NONE.into(),
                primitive1: NONE.into(),
            }
        }),
        emission: unseen(),
        has_area: false.into(),
    }
}

/// Intensity in a direction away from the light, W/sr (of a disk, over its area): falls with the square of a ramp in the cosine (KHR_lights_punctual,
/// "Inner and Outer Cone Angles").
pub fn intensity(row: Row<Lights>, dir: Vec3) -> Color {
    let (outer, inner) = (row.get(Lights::COS_OUTER), row.get(Lights::COS_INNER));
    let edge = (inner - outer).max(SMALLEST_EDGE);
    let ramp = ((first_edge(row).dot(dir) - outer) / edge).max(F32::from(0.0)).min(1.0);
    strength(row) * (ramp * ramp)
}
