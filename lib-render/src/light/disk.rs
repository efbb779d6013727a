//! Disk lights: spots with a size, without a surface that a ray could hit.
//!
//! In each direction a disk has the intensity of its spot, I. So its radiance is I / (A cos θ), and where it is sampled uniformly
//! by area that cosine cancels: each point of the disk gives I / (A d²), and the weight of a sample varies with the distance
//! alone. Sampling by solid angle would take this variance away too, but the disk is an ellipse from elsewhere, whose inversion
//! takes elliptic integrals (Guillén et al. 2017, "Area-preserving parameterizations for spherical ellipses"), and Gamito's (2016)
//! rejection has no bound on its draws: it would pay at points nearer than a radius only, where BSDF sampling has its share.

use std::f32::consts::PI;

use jerboa_ir::lang::{F32, Fun, Row};

use crate::core::color::black;
use crate::core::onb::onb;
use crate::core::rng::Rng;
use crate::core::sampling::{concentric_disk, uniform_cone, uniform_cone_pdf};
use crate::core::vec::{Vec2, Vec3, vec2};
use crate::geometry::offset::offset_point;
use crate::geometry::plane::HIT_ERROR;
use crate::geometry::triangle::GAMMA_7;
use crate::light::seen::Met;
use crate::light::spot::intensity;
use crate::light::{DirectLightSample, EmissionSample, Light, first_edge, position, unseen};
use crate::schema::{Lights, NONE};

/// A disk across its axis that shines to the front, within a spot's cone.
pub fn make_disk_light(row: Row<Lights>) -> Light {
    Light {
        sample_direct: Fun::lam(move |_, (rng, point): (Rng, Vec3)| {
            let ([u, v], _) = rng.pair();
            let place = place(row, vec2(u, v));
            let to = place - point;
            let distance = to.length_scaled();
            let wi = to / distance;
            let seen = seen(row, wi, distance);
            DirectLightSample {
                wi,
                pos: offset_point(place, error(row), first_edge(row), -to),
                distance,
                intensity: seen.is_met.select(seen.radiance, black()),
                pdf_dir: seen.is_met.select(seen.pdf_dir, F32::from(0.0)),
                is_delta: false.into(),
                primitive: NONE.into(),
                primitive1: NONE.into(),
            }
        }),
        sample_emission: Fun::lam(move |_, rng: Rng| {
            let ([u, v], rng) = rng.pair();
            let pos = place(row, vec2(u, v));
            let ([u, v], _) = rng.pair();
            let axis = first_edge(row);
            let (opening, radius) = (1.0 - row.get(Lights::COS_OUTER), row.get(Lights::RADIUS));
            let local = uniform_cone(vec2(u, v), opening);
            let (tangent, bitangent) = onb(axis);
            let dir = tangent * local.x + bitangent * local.y + axis * local.z;
            EmissionSample {
                pos,
                dir,
                intensity: intensity(row, dir) / local.z,
                cos: local.z,
                pdf_area: row.get(Lights::PROBABILITY) / (PI * radius * radius),
                pdf_dir: uniform_cone_pdf(opening),
                primitive: NONE.into(),
                primitive1: NONE.into(),
            }
        }),
        emission: unseen(),
        has_area: true.into(),
    }
}

/// Where a ray (its direction unit) meets the disk from its front. In the plane of a surface that is before the surface, as it is
/// for light sampling: what only one of the two saw would have the weight of both.
pub fn meet(row: Row<Lights>, org: Vec3, dir: Vec3) -> Met {
    let axis = first_edge(row);
    let to = position(row) - org;
    let cos = axis.dot(dir);
    let distance = axis.dot(to) / cos;
    let radius = row.get(Lights::RADIUS);
    let off = (dir * distance - to) / radius;
    let met = seen(row, dir, distance);
    let before = distance + axis.abs().dot(error(row)) / cos;
    Met { is_met: met.is_met & off.length2().le(1.0), distance: before.max(0.0), ..met }
}

/// Bound on the rounding of each coordinate of its points, and on how far off a ray finds a well-shaped triangle in its plane, m: a
/// triangle of the scene, and the way to it from a point there, is no longer than the scene is across.
fn error(row: Row<Lights>) -> Vec3 {
    let own = position(row).abs().map(|x| x + row.get(Lights::RADIUS)) * F32::from(GAMMA_7);
    let of_others = row.get(Lights::SCENE_RADIUS) * (2.0 * HIT_ERROR);
    own.map(|x| x + of_others)
}

/// A point of the disk at this distance in this direction; met where it shines.
fn seen(row: Row<Lights>, dir: Vec3, distance: F32) -> Met {
    let cos = -first_edge(row).dot(dir);
    let away = distance / row.get(Lights::RADIUS);
    let radiance = intensity(row, -dir) / cos;
    Met {
        is_met: cos.gt(0.0) & distance.gt(0.0) & !radiance.is_black(),
        radiance,
        pdf_dir: row.get(Lights::PROBABILITY) * (away * away) / (PI * cos),
        distance,
    }
}

/// A point of the disk, uniform.
fn place(row: Row<Lights>, u: Vec2) -> Vec3 {
    let on_disk = concentric_disk(u) * row.get(Lights::RADIUS);
    let (tangent, bitangent) = onb(first_edge(row));
    position(row) + tangent * on_disk.x + bitangent * on_disk.y
}
