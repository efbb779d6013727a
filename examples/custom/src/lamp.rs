//! A lamp without extent that shines forwards, the less the further from its axis.
//!
//! - Tracers: the path tracer and the light tracer; the bidirectional one refuses lights that it does not know.
//! - Numbers: `exponent` n in [0, 100]. Its intensity, W/sr, is that of the axis times cosⁿ of the angle to it, 0 backwards.

use jerboa_ir::lang::{F32, Fun, Row};
use jerboa_lib_render::components::{MakeLight, Numbers, Own, Parameter};
use jerboa_lib_render::core::color::Color;
use jerboa_lib_render::core::math::{exp, log};
use jerboa_lib_render::core::rng::Rng;
use jerboa_lib_render::core::sampling::{UNIFORM_SPHERE_PDF, uniform_sphere};
use jerboa_lib_render::core::vec::{Vec3, vec2};
use jerboa_lib_render::light::point::sample_place;
use jerboa_lib_render::light::{EmissionSample, Light, first_edge, position, strength, unseen};
use jerboa_lib_render::schema::{Lights, NONE};

/// What scenes call it.
pub const NAME: &str = "lamp";

/// The row to register.
pub const LIGHT: Own<MakeLight> = Own {
    name: NAME,
    parameters: &[Parameter { name: "exponent", default: &[1.0], range: (0.0, 100.0) }],
    make: make_lamp,
};

fn make_lamp(row: Row<Lights>, numbers: Numbers) -> Light {
    let intensity = move |dir: Vec3| -> Color {
        let cos = first_edge(row).dot(dir);
        let power = exp(numbers.number(0) * log(cos.max(f32::MIN_POSITIVE)));
        strength(row) * cos.gt(0.0).select(power, F32::from(0.0))
    };
    Light {
        sample_direct: Fun::lam(move |_, (_, point): (Rng, Vec3)| sample_place(row, point, intensity)),
        sample_emission: Fun::lam(move |_, rng: Rng| {
            let ([u, v], _) = rng.pair();
            let dir = uniform_sphere(vec2(u, v));
            EmissionSample {
                pos: position(row),
                dir,
                intensity: intensity(dir),
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
