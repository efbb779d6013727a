//! Sphere lights: balls that shine, without a surface that a ray could hit.
//!
//! From a point at distance d a ball of radius r fills a cone, sampled uniformly by solid angle. With s = r/d, its
//! 1 − cos is s² / (1 + √(1 − s²)), which keeps its digits however far the ball is (accuracy.md, N8); 1 − s² is
//! (d − r)/d · (1 + s), which keeps them close to it. A ball shines outwards only, so from within nothing is drawn and nothing
//! seen. On one that is seen at less than 1e-7 radians all directions are the same in single precision: a point.

use jerboa_ir::lang::{Bool, F32, Fun, Row};

use crate::core::color::black;
use crate::core::onb::onb;
use crate::core::rng::Rng;
use crate::core::sampling::{
    UNIFORM_SPHERE_PDF, cosine_hemisphere, cosine_hemisphere_pdf, uniform_cone, uniform_cone_pdf, uniform_sphere,
};
use crate::core::vec::{Vec3, vec2};
use crate::light::seen::Met;
use crate::light::{DirectLightSample, EmissionSample, Light, position, strength, unseen};
use crate::schema::{Lights, NONE};

/// A ball whose surface has the same radiance everywhere, in each direction outwards.
pub fn make_sphere_light(row: Row<Lights>) -> Light {
    Light {
        sample_direct: Fun::lam(move |_, (rng, point): (Rng, Vec3)| {
            let ([u, v], _) = rng.pair();
            let ball = Ball::new(row, point);
            let local = uniform_cone(vec2(u, v), ball.opening);
            let (tangent, bitangent) = onb(ball.axis);
            let wi = tangent * local.x + bitangent * local.y + ball.axis * local.z;
            let distance = ball.entry(local.z, local.x * local.x + local.y * local.y);
            DirectLightSample {
                wi,
                pos: point + wi * distance,
                distance,
                intensity: ball.is_outside.select(strength(row), black()),
                pdf_dir: ball.pdf(row),
                is_delta: false.into(),
                primitive: NONE.into(),
                primitive1: NONE.into(),
            }
        }),
        sample_emission: Fun::lam(move |_, rng: Rng| {
            let ([u, v], rng) = rng.pair();
            let normal = uniform_sphere(vec2(u, v));
            let ([u, v], _) = rng.pair();
            let local = cosine_hemisphere(vec2(u, v));
            let (tangent, bitangent) = onb(normal);
            let radius = row.get(Lights::RADIUS);
            EmissionSample {
                pos: position(row) + normal * radius,
                dir: tangent * local.x + bitangent * local.y + normal * local.z,
                intensity: strength(row),
                cos: local.z,
                pdf_area: row.get(Lights::PROBABILITY) * UNIFORM_SPHERE_PDF / radius / radius,
                pdf_dir: cosine_hemisphere_pdf(local.z),
                primitive: NONE.into(),
                primitive1: NONE.into(),
            }
        }),
        emission: unseen(),
        has_area: true.into(),
    }
}

/// Where a ray (its direction unit) enters the ball, if it begins outside.
pub fn meet(row: Row<Lights>, org: Vec3, dir: Vec3) -> Met {
    let ball = Ball::new(row, org);
    let cos = ball.axis.dot(dir);
    // The sine without the loss of 1 − cos² (Haines et al. 2019, "Precision improvements for ray/sphere intersection").
    let sin2 = (dir - ball.axis * cos).length2();
    Met {
        is_met: ball.is_outside & cos.gt(0.0) & sin2.le(ball.s * ball.s),
        radiance: strength(row),
        pdf_dir: ball.pdf(row),
        distance: ball.entry(cos, sin2),
    }
}

/// A ball as a point sees it.
struct Ball {
    /// Towards its middle, unit.
    axis: Vec3,
    /// Of its middle, m.
    distance: F32,
    is_outside: Bool,
    /// Sine of the half angle it is seen at.
    s: F32,
    /// The square of its cosine.
    cos2: F32,
    /// 1 − that cosine.
    opening: F32,
}

impl Ball {
    fn new(row: Row<Lights>, point: Vec3) -> Ball {
        let radius = row.get(Lights::RADIUS);
        let to = position(row) - point;
        let distance = to.length_scaled();
        let is_outside = distance.gt(radius);
        let s = radius / distance;
        let cos2 = is_outside.select((distance - radius) / distance * (1.0 + s), 0.0.into());
        Ball { axis: to / distance, distance, is_outside, s, cos2, opening: s * s / (1.0 + cos2.sqrt()) }
    }

    /// Distance at which a ray enters that makes this angle with the axis.
    fn entry(&self, cos: F32, sin2: F32) -> F32 {
        let root = (self.s * self.s - sin2).max(0.0).sqrt();
        self.distance * (self.cos2 / (cos + root))
    }

    /// Density of a direction within the cone, per steradian, the choice of the light included; 0 from within.
    fn pdf(&self, row: Row<Lights>) -> F32 {
        let pdf = row.get(Lights::PROBABILITY) * uniform_cone_pdf(self.opening);
        self.is_outside.select(pdf, 0.0.into())
    }
}
