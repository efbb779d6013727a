//! Point lights (KHR_lights_punctual).

use jerboa_ir::lang::{F32, Fun, Row};

use crate::core::sampling::{UNIFORM_SPHERE_PDF, uniform_sphere};
use crate::core::vec::{Vec3, vec2};
use crate::core::{color::Color, rng::Rng};
use crate::light::{DirectLightSample, EmissionSample, Light, position, strength, unseen};
use crate::schema::{Lights, NONE};

/// The same intensity, W/sr, in all directions: what arrives falls with the squared distance.
pub fn make_point_light(row: Row<Lights>) -> Light {
    Light {
        sample_direct: Fun::lam(move |_, (_, point): (Rng, Vec3)| sample_place(row, point, |_| strength(row))),
        sample_emission: Fun::lam(move |_, rng: Rng| {
            let ([u, v], _) = rng.pair();
            EmissionSample {
                pos: position(row),
                dir: uniform_sphere(vec2(u, v)),
                intensity: strength(row),
                cos: 1.0.into(),
                pdf_area: row.get(Lights::PROBABILITY),
                pdf_dir: UNIFORM_SPHERE_PDF.into(),
                primitive: NONE.into(),
                primitive1: NONE.into(),
            }
        }),
        emission: unseen(),
        has_area: false.into(),
    }
}

/// The sample of a light that is a point; `intensity` is that in the given direction away from it, W/sr.
pub fn sample_place(row: Row<Lights>, point: Vec3, intensity: impl FnOnce(Vec3) -> Color) -> DirectLightSample {
    let pos = position(row);
    let to = pos - point;
    let distance = to.length_scaled();
    let wi = to / distance;
    DirectLightSample {
        wi,
        pos,
        distance,
        intensity: intensity(-wi) / distance / distance,
        pdf_dir: distance.gt(0.0).select(row.get(Lights::PROBABILITY), F32::from(0.0)),
        is_delta: true.into(),
        primitive: NONE.into(),
        primitive1: NONE.into(),
    }
}
