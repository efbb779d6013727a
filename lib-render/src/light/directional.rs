//! Directional lights (KHR_lights_punctual).

use jerboa_ir::lang::{F32, Fun, Row};

use crate::core::rng::Rng;
use crate::core::vec::Vec3;
use crate::light::environment::behind_scene;
use crate::light::{DirectLightSample, EmissionSample, Light, first_edge, strength, unseen};
use crate::schema::{Lights, NONE};

/// Parallel light, irradiance in W/m² on a facing plane.
pub fn make_directional_light(row: Row<Lights>) -> Light {
    Light {
        sample_direct: Fun::lam(move |_, (_, point): (Rng, Vec3)| DirectLightSample {
            wi: -first_edge(row),
            pos: point,
            distance: F32::from(f32::INFINITY),
            intensity: strength(row),
            pdf_dir: row.get(Lights::PROBABILITY),
            is_delta: true.into(),
            primitive: NONE.into(),
            primitive1: NONE.into(),
        }),
        sample_emission: Fun::lam(move |_, rng: Rng| {
            let dir = first_edge(row);
            let (pos, pdf_area) = behind_scene(row, rng, -dir);
            EmissionSample {
                pos,
                dir,
                intensity: strength(row),
                cos: 1.0.into(),
                pdf_area,
                pdf_dir: 1.0.into(),
                primitive: NONE.into(),
                primitive1: NONE.into(),
            }
        }),
        emission: unseen(),
        has_area: false.into(),
    }
}
