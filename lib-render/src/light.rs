//! Lights (paper, section 4.3), one file per kind.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, F32, Fun, Row, Staged, U32};

use crate::components::{Components, Numbers};
use crate::core::cdf::invert;
use crate::core::color::{Color, color};
use crate::core::rng::Rng;
use crate::core::vec::{Vec2, Vec3, vec3};
use crate::light::area::{Shape, by_solid_angle, seen_pdf};
use crate::light::seen::Seen;
use crate::material::EmissionValue;
use crate::ray::Ray;
use crate::schema::*;

pub mod area;
pub mod both_sides;
pub mod directional;
pub mod disk;
pub mod environment;
pub mod point;
pub mod seen;
pub mod sphere;
pub mod spot;
pub mod sun;
pub mod tree;

/// A light as seen from a point: for next event estimation.
#[derive(Clone, Copy)]
pub struct DirectLightSample {
    /// Towards the light, unit, world.
    pub wi: Vec3,
    /// Where a shadow ray ends, world: the point on the light, moved off the light's surface to the side it is seen from.
    /// Unspecified where `distance` is infinite.
    pub pos: Vec3,
    /// Distance to it, m; infinity for the environment and for parallel light.
    pub distance: F32,
    /// Radiance towards the point (area lights, environment); intensity / distance² or irradiance for the others.
    pub intensity: Color,
    /// Density per steradian at the receiving point, choice of the light included; for lights without extent the
    /// probability of the choice. 0 where there is no direction; infinite where the light is seen edge-on.
    pub pdf_dir: F32,
    /// No extent: only light sampling finds it, so its weight is 1.
    pub is_delta: Bool,
    /// Primitives that a shadow ray to it must not hit, or `NONE`.
    pub primitive: U32,
    /// The other half of a quad, or `NONE`.
    pub primitive1: U32,
}
impl_staged!(DirectLightSample { wi, pos, distance, intensity, pdf_dir, is_delta, primitive, primitive1 });

/// A ray that leaves a light: for light tracing.
#[derive(Clone, Copy)]
pub struct EmissionSample {
    /// Where it starts, world.
    pub pos: Vec3,
    /// Where it goes, unit, world.
    pub dir: Vec3,
    /// Radiance, or intensity for lights without extent.
    pub intensity: Color,
    /// Cosine at the light; 1 for lights without extent.
    pub cos: F32,
    /// Density of the point, per square metre, choice of the light included.
    pub pdf_area: F32,
    /// Density of the direction, per steradian; 0 where rounding put the ray on the rim of the hemisphere, `cos` is 0 too, and it
    /// carries nothing.
    pub pdf_dir: F32,
    /// The primitive that it leaves, or `NONE`.
    pub primitive: U32,
    /// The other half of a quad, or `NONE`.
    pub primitive1: U32,
}
impl_staged!(EmissionSample { pos, dir, intensity, cos, pdf_area, pdf_dir, primitive, primitive1 });

impl EmissionSample {
    /// The ray, which does not meet the light that it leaves.
    pub fn ray(self) -> Ray {
        let tmax = F32::from(f32::INFINITY);
        Ray { org: self.pos, dir: self.dir, tmax, skip: self.primitive, skip1: self.primitive1, skip2: NONE.into() }
    }
}

/// A light.
#[derive(Clone, Copy)]
pub struct Light {
    /// (rng, point) → a direction towards the light.
    pub sample_direct: Fun<(Rng, Vec3), DirectLightSample>,
    /// rng → a ray that leaves it.
    pub sample_emission: Fun<Rng, EmissionSample>,
    /// (direction away from the light, unit; barycentric weights or nothing) → emission.
    pub emission: Fun<(Vec3, Vec2), EmissionValue>,
    /// Can a ray hit it?
    pub has_area: Bool,
}
impl_staged!(Light { sample_direct, sample_emission, emission, has_area });

/// Choose a light and sample it from a point: by its share of the scene's power or, where there is a [`tree`], of what may arrive
/// at the point. Draws at most 4 numbers.
pub fn sample_light(b: &mut Block, rng: Rng, point: Vec3) -> DirectLightSample {
    let by_power = |b: &mut Block| {
        let (u, rng) = rng.next();
        let index = choose_light(b, u);
        with_light(b, index, |b, light| light.sample_direct.call(b, (rng, point)))
    };
    let by_tree = |b: &mut Block| {
        let (index, probability) = tree::choose(b, rng, point);
        let rest = rng.ahead(2);
        let sample = with_light(b, index, |b, light| light.sample_direct.call(b, (rest, point)));
        DirectLightSample { pdf_dir: chosen(index, probability, sample.pdf_dir), ..sample }
    };
    b.if_(has_tree(), by_tree, by_power)
}

fn has_tree() -> Bool {
    Row::<Settings>::at(0u32).get(Settings::HAS_LIGHT_TREE)
}

/// A density with the choice of light `index` by its power, with that by another probability instead.
fn chosen(index: U32, probability: F32, pdf: F32) -> F32 {
    let by_power = Row::<Lights>::at(index).get(Lights::PROBABILITY);
    probability.gt(0.0).select(pdf * (probability / by_power), 0.0.into())
}

/// The light that a uniform number draws: each with probability [`Lights::PROBABILITY`], to the bit. A kernel that knows of
/// only one reads that light once for all lanes.
pub fn choose_light(b: &mut Block, u: F32) -> U32 {
    let settings = Row::<Settings>::at(0u32);
    let count = settings.get(Settings::LIGHT_COUNT);
    let search = |b: &mut Block| invert(b, count, |i| Row::at(i).get(LightChoice::CDF), u);
    b.if_(settings.get(Settings::HAS_ONE_LIGHT), |_| U32::from(0), search)
}

/// Do it with the light of a row of `Lights`, whatever its kind.
pub fn with_light<T: Staged>(b: &mut Block, index: U32, body: impl Fn(&mut Block, Light) -> T) -> T {
    b.dispatch(Row::<Lights>::at(index), |b, row| {
        b.switch(
            row.get(Lights::KIND),
            &[
                (LIGHT_POINT, &|b| body(b, point::make_point_light(row))),
                (LIGHT_SPOT, &|b| body(b, spot::make_spot_light(row))),
                (LIGHT_DIRECTIONAL, &|b| body(b, directional::make_directional_light(row))),
                (LIGHT_TRIANGLE, &|b| body(b, area::make_triangle_light(row))),
                (LIGHT_QUAD, &|b| body(b, area::make_quad_light(row))),
            ],
            |b| seen_or_other(b, row, &body),
        )
    })
}

/// Do it with the light of a row that is none of the usual: one that rays see, where the scene has any, or another.
fn seen_or_other<T: Staged>(b: &mut Block, row: Row<Lights>, body: &impl Fn(&mut Block, Light) -> T) -> T {
    let kind = row.get(Lights::KIND);
    let other = |b: &mut Block| own_or_environment(b, row, 0, body);
    let (ball, disk) = (sphere::make_sphere_light, disk::make_disk_light);
    let not_sun = |b: &mut Block| {
        let shape = |b: &mut Block| b.if_(kind.eq(LIGHT_SPHERE), |b| body(b, ball(row)), |b| body(b, disk(row)));
        let is_shape = Seen::Shape.is_used() & (kind.eq(LIGHT_SPHERE) | kind.eq(LIGHT_DISK));
        b.if_(is_shape, shape, other)
    };
    b.if_(Seen::Sun.is_used() & kind.eq(LIGHT_SUN), |b| body(b, sun::make_sun(row)), not_sun)
}

/// Do it with the light of a user's crate whose row it is, from this one on, or else the environment.
fn own_or_environment<T: Staged>(
    b: &mut Block,
    row: Row<Lights>,
    own: u32,
    body: &impl Fn(&mut Block, Light) -> T,
) -> T {
    let Some(light) = Components::current().lights().get(own as usize).copied() else {
        return body(b, environment::make_environment_light(row));
    };
    b.if_(
        row.get(Lights::KIND).eq(LIGHT_OWN + own),
        |b| body(b, (light.make)(row, Numbers(row.get(Lights::NUMBERS)))),
        |b| own_or_environment(b, row, own + 1, body),
    )
}

/// Density with which emission sampling, and light sampling by area, find a point of an area light (a row of `Lights`), per
/// square metre, the choice of the light included; 0 for `NONE`.
pub fn area_pdf(light: U32) -> F32 {
    let is_light = light.ne(NONE);
    let row = Row::<Lights>::at(is_light.select(light, 0u32.into()));
    is_light.select(row.get(Lights::PROBABILITY) / row.get(Lights::AREA), 0.0.into())
}

/// Density per steradian with which light sampling finds what a ray hits of an area light (a row of `Lights`), the choice of
/// the light included; 0 for `NONE`. `distance` is that along the ray, whose direction makes this cosine with the face normal.
///
/// A path knows the origin of its ray, which was moved off the surface by some roundings of its coordinates (or by what the
/// render asks for), where sampling is given the point itself. So the two weights of a direction add to 1 up to that step
/// over the distance of the light.
pub fn hit_pdf(b: &mut Block, light: U32, from: Vec3, distance: F32, cos: F32) -> F32 {
    let by_angle = |b: &mut Block| {
        let seen = |b: &mut Block| {
            b.dispatch(Row::<Lights>::at(light), |b, row| {
                let of = |shape| move |_: &mut Block| seen_pdf(row, shape, from);
                let (triangle, quad) = (of(Shape::Triangle), of(Shape::Parallelogram));
                let kind = row.get(Lights::KIND);
                b.switch(kind, &[(LIGHT_TRIANGLE, &triangle), (LIGHT_QUAD, &quad)], |_| F32::from(0.0))
            })
        };
        b.if_(light.ne(NONE), seen, |_| F32::from(0.0))
    };
    let pdf = b.if_(by_solid_angle(), by_angle, |_| area_pdf(light) * distance * distance / cos.abs());
    let in_tree =
        |b: &mut Block| b.if_(light.ne(NONE), |b| with_choice_by_tree(b, light, from, pdf), |_| F32::from(0.0));
    b.if_(has_tree(), in_tree, |_| pdf)
}

/// The density of a light that has a place, as a point's light sampling has it, from that with the choice by its power.
pub fn with_choice(b: &mut Block, light: U32, from: Vec3, pdf: F32) -> F32 {
    b.if_(has_tree(), |b| with_choice_by_tree(b, light, from, pdf), |_| pdf)
}

fn with_choice_by_tree(b: &mut Block, light: U32, from: Vec3, pdf: F32) -> F32 {
    let probability = tree::probability(b, light, from);
    chosen(light, probability, pdf)
}

/// Position, middle, or first corner.
pub fn position(row: Row<Lights>) -> Vec3 {
    vec3(row.get(Lights::P_X), row.get(Lights::P_Y), row.get(Lights::P_Z))
}

/// First edge, or direction.
pub fn first_edge(row: Row<Lights>) -> Vec3 {
    vec3(row.get(Lights::E1_X), row.get(Lights::E1_Y), row.get(Lights::E1_Z))
}

/// Radiance, intensity or irradiance.
pub fn strength(row: Row<Lights>) -> Color {
    color(row.get(Lights::R), row.get(Lights::G), row.get(Lights::B))
}

/// The `emission` of a light that no ray hits.
pub fn unseen() -> Fun<(Vec3, Vec2), EmissionValue> {
    Fun::lam(|_, _| EmissionValue { intensity: crate::core::color::black(), pdf_area: 0.0.into(), pdf_dir: 0.0.into() })
}
