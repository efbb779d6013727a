//! Area lights: emissive triangles, alone or two as a parallelogram; Lambertian, but for what a clear coat keeps. Sampled
//! uniformly by area or, if the render asks for it, from a point uniformly by solid angle ([`SeenTriangle`]), a parallelogram by
//! its halves: then neither distance nor cosine is left in the weight of a sample, and a point that a lamp nearly touches has no
//! more variance than another. In rooms that is not worth its time (`tests/runs/lights.txt`).

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, F32, Fun, Row, U32};

use crate::core::color::{Color, black};
use crate::core::onb::onb;
use crate::core::rng::Rng;
use crate::core::sampling::cosine_hemisphere;
use crate::core::spherical::SeenTriangle;
use crate::core::triangle::uniform_triangle;
use crate::core::vec::{Vec2, Vec3, vec2, vec3};
use crate::geometry::offset::offset_point;
use crate::geometry::triangle::{GAMMA_7, Triangle};
use crate::light::both_sides::{draws_back, emission_pdf, shines_behind};
use crate::light::{DirectLightSample, EmissionSample, Light, first_edge, position, strength};
use crate::lobes::through_coat;
use crate::material::{EmissionValue, emitted_radiance};
use crate::ray::Hit;
use crate::schema::{Lights, NONE, Settings};

/// An emissive triangle.
pub fn make_triangle_light(row: Row<Lights>) -> Light {
    make_area_light(row, Shape::Triangle)
}

/// An emissive parallelogram.
pub fn make_quad_light(row: Row<Lights>) -> Light {
    make_area_light(row, Shape::Parallelogram)
}

/// Density per steradian with which light sampling by solid angle at a point finds what a ray from there hits of an area light,
/// the choice of the light included. The very sum that sampling divides by, of the same operations.
pub fn seen_pdf(row: Row<Lights>, shape: Shape, from: Vec3) -> F32 {
    row.get(Lights::PROBABILITY) / Seen::new(row, shape, from).solid_angle()
}

/// What the two edges of an area light span.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Half of the parallelogram.
    Triangle,
    /// All of it.
    Parallelogram,
}

impl Shape {
    /// Weights of both edges, uniform by area, from the unit square.
    fn uniform(self, u: Vec2) -> Vec2 {
        if self == Shape::Triangle { uniform_triangle(u) } else { u }
    }

    /// The primitive that is the other half, or `NONE`.
    fn second(self, row: Row<Lights>) -> U32 {
        if self == Shape::Triangle { NONE.into() } else { row.get(Lights::PRIMITIVE1) }
    }

    /// The point with these weights of the edges, as a hit of the primitive it is on.
    fn hit(self, row: Row<Lights>, weights: Vec2) -> Hit {
        let of = |primitive, weights: Vec2| Hit { primitive, t: 0.0.into(), u: weights.x, v: weights.y };
        let first = row.get(Lights::PRIMITIVE);
        if self == Shape::Triangle {
            return of(first, weights);
        }
        // The other half: its edges leave from the opposite corner, towards the same two.
        let beyond = vec2(1.0 - weights.x, 1.0 - weights.y);
        let second = of(self.second(row), turned(beyond, row.get(Lights::TURN1)));
        (weights.x + weights.y).le(1.0).select(of(first, turned(weights, row.get(Lights::TURN))), second)
    }
}

/// Weights of a triangle's second and third corner, where these are those of the two that follow the corner of this number.
fn turned(weights: Vec2, corner: U32) -> Vec2 {
    let (after, last) = (weights.x, weights.y);
    let own = 1.0 - after - last;
    let turned = corner.eq(1u32).select(vec2(own, after), vec2(last, own));
    corner.eq(0u32).select(weights, turned)
}

/// Are lamps sampled by solid angle, not by area?
pub fn by_solid_angle() -> Bool {
    Row::<Settings>::at(0u32).get(Settings::BY_SOLID_ANGLE)
}

/// An area light as a point sees it.
struct Seen {
    first: SeenTriangle,
    /// The other half of a parallelogram: its edges leave from the opposite corner.
    second: Option<SeenTriangle>,
}

impl Seen {
    fn new(row: Row<Lights>, shape: Shape, point: Vec3) -> Seen {
        let (corner, e1, e2) = (position(row) - point, first_edge(row), second_edge(row));
        let scale = [e1, e2].iter().fold(corner.abs().max_element(), |m, e| m.max(e.abs().max_element()));
        let [corner, e1, e2] = [corner, e1, e2].map(|v| v / scale);
        let opposite = || SeenTriangle::new(corner + e1 + e2, -e1, -e2);
        let second = (shape == Shape::Parallelogram).then(opposite);
        Seen { first: SeenTriangle::new(corner, e1, e2), second }
    }

    /// Of all of it, sr.
    fn solid_angle(&self) -> F32 {
        self.second.map_or(self.first.solid_angle, |s| self.first.solid_angle + s.solid_angle)
    }

    /// Weights of both edges from the first corner, uniform by solid angle.
    fn sample(&self, u: Vec2) -> Vec2 {
        let Some(second) = self.second else { return self.first.sample(u) };
        let share = u.x * self.solid_angle();
        let in_first = share.lt(self.first.solid_angle);
        let half = in_first.select(self.first, second);
        let rest = in_first.select(share, share - self.first.solid_angle) / half.solid_angle;
        let weights = half.sample(vec2(rest.min(1.0), u.y));
        in_first.select(weights, vec2(1.0 - weights.x, 1.0 - weights.y))
    }
}

fn make_area_light(row: Row<Lights>, shape: Shape) -> Light {
    let draw = move |rng: Rng| {
        let ([u, v], rng) = rng.pair();
        (vec2(u, v), rng)
    };
    let sample_direct = Fun::lam(move |b: &mut Block, (rng, point): (Rng, Vec3)| {
        let square = draw(rng).0;
        let by_angle = by_solid_angle();
        let seen = |_: &mut Block| {
            let seen = Seen::new(row, shape, point);
            (seen.sample(square), row.get(Lights::PROBABILITY) / seen.solid_angle())
        };
        let (weights, pdf) = b.if_(by_angle, seen, |_| (shape.uniform(square), F32::from(0.0)));
        let place = Place::new(row, weights);
        let to = place.point - point;
        let distance = to.length_scaled();
        let wi = to / distance;
        let cos = -place.normal.dot(wi);
        let by_area = point_pdf(row) * (distance * distance / cos.abs());
        let shines = shines(row, cos);
        DirectLightSample {
            wi,
            pos: place.seen_from(-to),
            distance,
            intensity: b.if_(shines, |b| radiance(b, row, shape, weights, cos), |_| black()),
            pdf_dir: shines.select(by_angle.select(pdf, by_area), F32::from(0.0)),
            is_delta: false.into(),
            primitive: row.get(Lights::PRIMITIVE),
            primitive1: shape.second(row),
        }
    });
    let sample_emission = Fun::lam(move |b: &mut Block, rng: Rng| {
        let (square, rng) = draw(rng);
        let weights = shape.uniform(square);
        let ([u, v], rng) = rng.pair();
        let (side, _) = rng.next();
        let place = Place::new(row, weights);
        let both = row.get(Lights::DOUBLE_SIDED);
        let normal = (both & draws_back(side)).select(-place.normal, place.normal);
        let local = cosine_hemisphere(vec2(u, v));
        let (tangent, bitangent) = onb(normal);
        let dir = tangent * local.x + bitangent * local.y + normal * local.z;
        EmissionSample {
            pos: place.seen_from(dir),
            dir,
            intensity: radiance(b, row, shape, weights, place.normal.dot(dir)),
            cos: local.z,
            pdf_area: point_pdf(row),
            pdf_dir: emission_pdf(both, local.z),
            primitive: row.get(Lights::PRIMITIVE),
            primitive1: shape.second(row),
        }
    });
    let emission = Fun::lam(move |b: &mut Block, (dir, weights): (Vec3, Vec2)| {
        let cos = Place::new(row, weights).normal.dot(dir);
        let pdf_dir = emission_pdf(row.get(Lights::DOUBLE_SIDED), cos);
        let intensity = b.if_(shines(row, cos), |b| radiance(b, row, shape, weights, cos), |_| black());
        EmissionValue { intensity, pdf_area: point_pdf(row), pdf_dir }
    });
    Light { sample_direct, sample_emission, emission, has_area: true.into() }
}

fn second_edge(row: Row<Lights>) -> Vec3 {
    vec3(row.get(Lights::E2_X), row.get(Lights::E2_Y), row.get(Lights::E2_Z))
}

/// Density of a point under emission sampling, per square metre, the choice of the light included.
fn point_pdf(row: Row<Lights>) -> F32 {
    row.get(Lights::PROBABILITY) / row.get(Lights::AREA)
}

/// Does light leave the side of this cosine to the normal? Not where it is NaN.
fn shines(row: Row<Lights>, cos: F32) -> Bool {
    cos.gt(0.0) | (row.get(Lights::DOUBLE_SIDED) & shines_behind(cos))
}

/// Radiance from the sides that emit, W/(m² sr), at these weights of the edges, in a direction of this cosine to the front.
fn radiance(b: &mut Block, row: Row<Lights>, shape: Shape, weights: Vec2, cos: F32) -> Color {
    let material = row.get(Lights::MATERIAL);
    let textured = |b: &mut Block| {
        let triangle = Triangle::of(b, shape.hit(row, weights));
        let uv = b.dispatch(triangle.geometry(), |b, geometry| triangle.uv(b, geometry));
        let radiance = emitted_radiance(b, material, uv);
        through_coat(b, material, uv, cos, radiance)
    };
    let plain = |b: &mut Block| through_coat(b, material, [vec2(0.0, 0.0); 2], cos, strength(row));
    b.if_(row.get(Lights::TEXTURED), textured, plain)
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
        let (corner, e1, e2) = (position(row), first_edge(row), second_edge(row));
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
