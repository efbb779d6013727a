//! The environment: radiance from infinitely far away, by a map in latitude and longitude.
//!
//! A direction d, turned by the negative rotation about +Y, is looked up at u = 1/2 + atan2(d.x, −d.z) / 2π,
//! v = acos(d.y) / π (`scenes/SEMANTICS.md`, 11), bilinearly: so radiance is a sum of tents, one for each texel. A direction
//! is drawn by drawing a texel, from the alias tables of `host::alias`, and then a point of its tent. So its density is
//! looked up like radiance, from the fourth word of the texels: the probability p of a texel is a density of
//! p · width · height per unit of (u, v), and du dv = dω / (2π² sin θ). What is drawn is read where it is weighed.

use std::f32::consts::{FRAC_1_PI, PI};

use jerboa_ir::lang::{F32, Fun, Row, U32};

use crate::core::alias::draw;
use crate::core::color::{Color, color};
use crate::core::math::{acos, atan2, sincos_turns};
use crate::core::onb::onb;
use crate::core::rng::Rng;
use crate::core::sampling::{concentric_disk, tent};
use crate::core::vec::{Vec2, Vec3, vec2, vec3};
use crate::light::{DirectLightSample, EmissionSample, Light, unseen};
use crate::schema::*;
use crate::traverse::bvh::scene_bounds;

/// The environment as a light.
pub fn make_environment_light(row: Row<Lights>) -> Light {
    let sample_direct = Fun::lam(move |_, (rng, point): (Rng, Vec3)| {
        let (sample, _) = Map::new().sample(rng);
        DirectLightSample {
            wi: sample.dir,
            pos: point,
            distance: F32::from(f32::INFINITY),
            intensity: sample.radiance,
            pdf_dir: sample.pdf * row.get(Lights::PROBABILITY),
            is_delta: false.into(),
            primitive: NONE.into(),
            primitive1: NONE.into(),
        }
    });
    let sample_emission = Fun::lam(move |_, rng: Rng| {
        let (sample, rng) = Map::new().sample(rng);
        let (pos, pdf_area) = behind_scene(row, rng, sample.dir);
        EmissionSample {
            pos,
            dir: -sample.dir,
            intensity: sample.radiance,
            cos: 1.0.into(),
            pdf_area,
            pdf_dir: sample.pdf,
            primitive: NONE.into(),
            primitive1: NONE.into(),
        }
    });
    Light { sample_direct, sample_emission, emission: unseen(), has_area: false.into() }
}

/// Radiance that arrives from a unit direction, world, and the density with which light sampling finds the direction, per
/// steradian, the choice of the light included. The environment is the last of the lights, if it is one (it is not where
/// its intensity is 0).
pub fn seen_environment(dir: Vec3) -> (Color, F32) {
    let map = Map::new();
    let (radiance, density) = map.look_up(map.footprint(map.uv(dir)));
    let count = Row::<Settings>::at(0u32).get(Settings::LIGHT_COUNT);
    let last = Row::<Lights>::at(count.max(1u32) - 1u32);
    let is_light = count.gt(0) & last.get(Lights::KIND).eq(LIGHT_ENVIRONMENT);
    let probability = is_light.select(last.get(Lights::PROBABILITY), 0.0.into());
    let sin_theta = (dir.x * dir.x + dir.z * dir.z).sqrt();
    (radiance, pdf_dir(density * probability, sin_theta))
}

/// Density per steradian from that times sin θ; infinite at a pole, but for what is never drawn.
fn pdf_dir(density: F32, sin_theta: F32) -> F32 {
    density.gt(0.0).select(density / sin_theta, 0.0.into())
}

/// For light from infinitely far away that comes from `from` (unit): a point of the disk that the scene's bounding sphere
/// fills, outside of the scene, and its density per square metre, the choice of the light included.
pub fn behind_scene(row: Row<Lights>, rng: Rng, from: Vec3) -> (Vec3, F32) {
    let ([u, v], _) = rng.pair();
    let disk = concentric_disk(vec2(u, v));
    let bounds = scene_bounds();
    let radius = row.get(Lights::SCENE_RADIUS);
    let (tangent, bitangent) = onb(from);
    let pos = (bounds.lo + bounds.hi) * F32::from(0.5) + (from + tangent * disk.x + bitangent * disk.y) * radius;
    (pos, row.get(Lights::PROBABILITY) / (PI * radius * radius))
}

/// The map and how it is turned.
#[derive(Clone, Copy)]
struct Map {
    width: U32,
    height: U32,
    intensity: F32,
    cos: F32,
    sin: F32,
}

/// The four texels around a point, and where it lies between their centres.
#[derive(Clone, Copy)]
struct Footprint {
    columns: [U32; 2],
    rows: [U32; 2],
    /// In [0, 1], from the first to the second.
    between: Vec2,
}

/// A drawn direction.
#[derive(Clone, Copy)]
struct Drawn {
    dir: Vec3,
    radiance: Color,
    /// Per steradian.
    pdf: F32,
}

impl Map {
    fn new() -> Map {
        let row = Row::<Environment>::at(0u32);
        Map {
            width: row.get(Environment::WIDTH),
            height: row.get(Environment::HEIGHT),
            intensity: row.get(Environment::INTENSITY),
            cos: row.get(Environment::ROTATION_COS),
            sin: row.get(Environment::ROTATION_SIN),
        }
    }

    /// Coordinates of a unit direction in the map, both in [0, 1].
    fn uv(self, dir: Vec3) -> Vec2 {
        let (x, z) = (self.cos * dir.x - self.sin * dir.z, self.sin * dir.x + self.cos * dir.z);
        let height = dir.y.max(-1.0).min(1.0);
        vec2(0.5 + atan2(x, -z) * (0.5 * FRAC_1_PI), acos(height) * FRAC_1_PI)
    }

    /// The texels around a point of [0, 1]²; u wraps, v clamps.
    fn footprint(self, uv: Vec2) -> Footprint {
        let (x, y) = (uv.x * self.width.to_f32() - 0.5, uv.y * self.height.to_f32() - 0.5);
        let (left, top) = (x.floor(), y.floor());
        // One more than the first column and row, so that it is not negative.
        self.beside((left + 1.0).to_u32(), (top + 1.0).to_u32(), vec2(x - left, y - top))
    }

    /// The footprint whose second column is this one, or the first of the next turn, and whose second row is this one, or
    /// beyond the last.
    fn beside(self, column: U32, row: U32, between: Vec2) -> Footprint {
        let second = column.lt(self.width).select(column, 0.into());
        let first = column.eq(0u32).select(self.width, column) - 1u32;
        let rows = [row.max(1u32) - 1u32, row.min(self.height - 1u32)];
        Footprint { columns: [first, second], rows, between }
    }

    /// Radiance, and density times sin θ.
    fn look_up(self, at: Footprint) -> (Color, F32) {
        let [top, bottom] = at.rows.map(|row| {
            let [left, right] = at.columns.map(|column| {
                let texel = Row::<EnvironmentTexels>::at(row * self.width + column);
                let [r, g, b] =
                    [EnvironmentTexels::R, EnvironmentTexels::G, EnvironmentTexels::B].map(|c| texel.get(c));
                (color(r, g, b), texel.get(EnvironmentTexels::DENSITY))
            });
            mix(left, right, at.between.x)
        });
        let (radiance, density) = mix(top, bottom, at.between.y);
        (radiance * self.intensity, density)
    }

    /// A direction, by three random words.
    fn sample(self, rng: Rng) -> (Drawn, Rng) {
        let ([u, v, w], rng) = rng.words();
        let table = Row::<Environment>::at(0u32);
        let row = draw(v, table.get(Environment::LOG_ROW_SLOTS), |i| Row::at(i).get(EnvironmentRows::SLOT));
        let log_slots = table.get(Environment::LOG_COLUMN_SLOTS);
        let column = draw(u, log_slots, |i| Row::at((row << log_slots) + i).get(EnvironmentColumns::SLOT));
        // A point of the texel's tent. Beyond a pole, its mirror image: the texels around it are the same.
        let (x, y) = (tent(half_word(w >> 16u32)), tent(half_word(w & 0xffffu32)));
        let place = |i: U32, offset: F32, count: U32| (i.to_f32() + 0.5 + offset) / count.to_f32();
        let v = place(row, y, self.height).abs();
        let uv = vec2(place(column, x, self.width), v.min(2.0 - v));
        let second = |i: U32, offset: F32| offset.lt(0.0).select(i, i + 1u32);
        let between = |offset: F32| offset.lt(0.0).select(offset + 1.0, offset);
        let at = self.beside(second(column, x), second(row, y), vec2(between(x), between(y)));
        let (radiance, density) = self.look_up(at);
        let (dir, sin_theta) = self.direction(uv);
        (Drawn { dir, radiance, pdf: pdf_dir(density, sin_theta) }, rng)
    }

    /// The direction at these coordinates, and sin θ.
    fn direction(self, uv: Vec2) -> (Vec3, F32) {
        let (sin_phi, cos_phi) = sincos_turns(uv.x - 0.5);
        let (sin_theta, cos_theta) = sincos_turns(uv.y * 0.5);
        let (x, z) = (sin_theta * sin_phi, -(sin_theta * cos_phi));
        (vec3(self.cos * x + self.sin * z, cos_theta, self.cos * z - self.sin * x), sin_theta)
    }
}

/// Between two texels.
fn mix(a: (Color, F32), b: (Color, F32), k: F32) -> (Color, F32) {
    (a.0.lerp(b.0, k), a.1 * (1.0 - k) + b.1 * k)
}

/// 16 bits as a number in (0, 1): the middle of its step, so that no point is on the rim of a tent.
fn half_word(bits: U32) -> F32 {
    (bits.to_f32() + 0.5) * (1.0 / 65_536.0)
}
