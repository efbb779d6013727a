//! Area lights: emissive triangles, alone or two as a parallelogram. Sampled uniformly by area; Lambertian.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, F32, Fun, Row};

use crate::core::color::{Color, black};
use crate::core::onb::onb;
use crate::core::rng::Rng;
use crate::core::sampling::{cosine_hemisphere, cosine_hemisphere_pdf, uniform_triangle};
use crate::core::vec::{Vec2, Vec3, vec2, vec3};
use crate::geometry::offset::offset_point;
use crate::geometry::triangle::{GAMMA_7, Triangle};
use crate::light::{DirectLightSample, EmissionSample, Light, first_edge, position, strength};
use crate::material::{EmissionValue, emitted_radiance};
use crate::ray::Hit;
use crate::schema::Lights;

/// An emissive triangle.
pub fn make_triangle_light(row: Row<Lights>) -> Light {
    make_area_light(row, uniform_triangle)
}

/// An emissive parallelogram. Never textured (`host::tables` pairs no textured triangles).
pub fn make_quad_light(row: Row<Lights>) -> Light {
    make_area_light(row, |u| u)
}

/// `warp` takes the unit square to the weights of both edges.
fn make_area_light(row: Row<Lights>, warp: fn(Vec2) -> Vec2) -> Light {
    let draw = move |rng: Rng| {
        let (u, rng) = rng.next();
        let (v, rng) = rng.next();
        (warp(vec2(u, v)), rng)
    };
    let sample_direct = Fun::lam(move |b: &mut Block, (rng, point): (Rng, Vec3)| {
        let (weights, _) = draw(rng);
        let place = Place::new(row, weights);
        let to = place.point - point;
        let distance = to.length_scaled();
        let wi = to / distance;
        let cos = -place.normal.dot(wi);
        let shines = shines(row, cos);
        DirectLightSample {
            wi,
            pos: place.seen_from(-to),
            distance,
            intensity: b.if_(shines, |b| radiance(b, row, weights), |_| black()),
            pdf_dir: shines.select(point_pdf(row) * (distance * distance / cos.abs()), F32::from(0.0)),
            is_delta: false.into(),
            primitive: row.get(Lights::PRIMITIVE),
            primitive1: row.get(Lights::PRIMITIVE1),
        }
    });
    let sample_emission = Fun::lam(move |b: &mut Block, rng: Rng| {
        let (weights, rng) = draw(rng);
        let (u, rng) = rng.next();
        let (v, rng) = rng.next();
        let (side, _) = rng.next();
        let place = Place::new(row, weights);
        let both = row.get(Lights::DOUBLE_SIDED);
        let normal = (both & side.lt(0.5)).select(-place.normal, place.normal);
        let local = cosine_hemisphere(vec2(u, v));
        let (tangent, bitangent) = onb(normal);
        let dir = tangent * local.x + bitangent * local.y + normal * local.z;
        EmissionSample {
            pos: place.seen_from(dir),
            dir,
            intensity: radiance(b, row, weights),
            cos: local.z,
            pdf_area: point_pdf(row),
            pdf_dir: emission_pdf(row, local.z),
        }
    });
    let emission = Fun::lam(move |b: &mut Block, (dir, weights): (Vec3, Vec2)| {
        let cos = Place::new(row, weights).normal.dot(dir);
        EmissionValue {
            intensity: b.if_(shines(row, cos), |b| radiance(b, row, weights), |_| black()),
            pdf_area: point_pdf(row),
            pdf_dir: emission_pdf(row, cos),
        }
    });
    Light { sample_direct, sample_emission, emission, has_area: true.into() }
}

/// Density of a point, per square metre, the choice of the light included.
fn point_pdf(row: Row<Lights>) -> F32 {
    row.get(Lights::PROBABILITY) / row.get(Lights::AREA)
}

/// Does light leave the side of this cosine to the normal? Not where it is NaN.
fn shines(row: Row<Lights>, cos: F32) -> Bool {
    cos.gt(0.0) | (row.get(Lights::DOUBLE_SIDED) & cos.lt(0.0))
}

/// Density of a direction under emission sampling, per steradian.
fn emission_pdf(row: Row<Lights>, cos: F32) -> F32 {
    let front = cosine_hemisphere_pdf(cos);
    row.get(Lights::DOUBLE_SIDED).select(cosine_hemisphere_pdf(cos.abs()) * 0.5, front)
}

/// Radiance from the sides that emit, W/(m² sr), at these weights of the edges.
fn radiance(b: &mut Block, row: Row<Lights>, weights: Vec2) -> Color {
    let textured = |b: &mut Block| {
        let primitive = row.get(Lights::PRIMITIVE);
        let hit = Hit { primitive, t: 0.0.into(), u: weights.x, v: weights.y };
        let triangle = Triangle::of(b, hit);
        let uv = b.dispatch(triangle.geometry(), |b, geometry| triangle.uv(b, geometry));
        emitted_radiance(b, row.get(Lights::MATERIAL), uv)
    };
    b.if_(row.get(Lights::TEXTURED), textured, |_| strength(row))
}

/// A point on the light.
#[derive(Clone, Copy)]
struct Place {
    /// World.
    point: Vec3,
    /// Bound on the error of each coordinate.
    error: Vec3,
    /// Unit normal of the front, world.
    normal: Vec3,
}
impl_staged!(Place { point, error, normal });

impl Place {
    fn new(row: Row<Lights>, weights: Vec2) -> Place {
        let e2 = vec3(row.get(Lights::E2_X), row.get(Lights::E2_Y), row.get(Lights::E2_Z));
        let (corner, e1) = (position(row), first_edge(row));
        let (a, b) = (e1 * weights.x, e2 * weights.y);
        let scale = e1.abs().max_element().max(e2.abs().max_element());
        Place {
            point: corner + a + b,
            error: (corner.abs() + a.abs() + b.abs()) * F32::from(GAMMA_7),
            normal: (e1 / scale).cross(e2 / scale).normalize_scaled(),
        }
    }

    /// The point, moved off the surface to the side of a direction away from it.
    fn seen_from(self, direction: Vec3) -> Vec3 {
        offset_point(self.point, self.error, self.normal, direction)
    }
}
