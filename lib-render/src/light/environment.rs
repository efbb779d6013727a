//! The environment: radiance from infinitely far away, by a map in latitude and longitude.
//!
//! A direction d, turned by the negative rotation about +Y, is looked up at u = 1/2 + atan2(d.x, −d.z) / 2π,
//! v = acos(d.y) / π (`scenes/SEMANTICS.md`, 11). It is drawn from the table of cell probabilities p of
//! `host::distribution`, uniformly in (u, v) within a cell; du dv = dω / (2π² sin θ), hence its density is
//! p · width · height / (2π² sin θ) per steradian.

use std::f32::consts::{FRAC_1_PI, PI};

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, F32, Fun, Row, U32};

use crate::core::cdf::{invert_guided, remainder};
use crate::core::color::{Color, color};
use crate::core::math::{acos, atan2, sincos_turns};
use crate::core::onb::onb;
use crate::core::rng::Rng;
use crate::core::sampling::concentric_disk;
use crate::core::vec::{Vec2, Vec3, vec2, vec3};
use crate::light::{DirectLightSample, EmissionSample, Light, unseen};
use crate::schema::*;
use crate::traverse::bvh::scene_bounds;

/// 1 / (2π²): the Jacobian above without its sine.
const JACOBIAN: f32 = 0.5 * FRAC_1_PI * FRAC_1_PI;

/// The environment as a light.
pub fn make_environment_light(row: Row<Lights>) -> Light {
    let draw = |b: &mut Block, rng: Rng| {
        let (u, rng) = rng.next();
        let (v, rng) = rng.next();
        (Map::new().sample(b, vec2(u, v)), rng)
    };
    let sample_direct = Fun::lam(move |b: &mut Block, (rng, point): (Rng, Vec3)| {
        let (sample, _) = draw(b, rng);
        DirectLightSample {
            wi: sample.dir,
            pos: point,
            distance: F32::from(f32::INFINITY),
            intensity: Map::new().bilinear(sample.uv),
            pdf_dir: sample.pdf * row.get(Lights::PROBABILITY),
            is_delta: false.into(),
            primitive: NONE.into(),
            primitive1: NONE.into(),
        }
    });
    let sample_emission = Fun::lam(move |b: &mut Block, rng: Rng| {
        let (sample, rng) = draw(b, rng);
        let (pos, pdf_area) = behind_scene(row, rng, sample.dir);
        let intensity = Map::new().bilinear(sample.uv);
        EmissionSample { pos, dir: -sample.dir, intensity, cos: 1.0.into(), pdf_area, pdf_dir: sample.pdf }
    });
    Light { sample_direct, sample_emission, emission: unseen(), has_area: false.into() }
}

/// Radiance that arrives from a unit direction, world.
pub fn environment_radiance(dir: Vec3) -> Color {
    let map = Map::new();
    map.bilinear(map.uv(dir))
}

/// Density with which light sampling finds a unit direction, per steradian, the choice of the light included. The
/// environment is the last of the lights, if it is one (it is not where its intensity is 0).
pub fn environment_pdf(dir: Vec3) -> F32 {
    let map = Map::new();
    let count = Row::<Settings>::at(0u32).get(Settings::LIGHT_COUNT);
    let last = Row::<Lights>::at(count.max(1u32) - 1u32);
    let pdf = map.pdf(map.cell(map.uv(dir)), dir) * last.get(Lights::PROBABILITY);
    (count.gt(0) & last.get(Lights::KIND).eq(LIGHT_ENVIRONMENT)).select(pdf, 0.0.into())
}

/// For light from infinitely far away that comes from `from` (unit): a point of the disk that the scene's bounding sphere
/// fills, outside of the scene, and its density per square metre, the choice of the light included.
pub fn behind_scene(row: Row<Lights>, rng: Rng, from: Vec3) -> (Vec3, F32) {
    let (u, rng) = rng.next();
    let (v, _) = rng.next();
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

/// A cell of the distribution.
#[derive(Clone, Copy)]
struct Cell {
    column: U32,
    row: U32,
}

/// A drawn direction.
#[derive(Clone, Copy)]
struct Drawn {
    dir: Vec3,
    uv: Vec2,
    pdf: F32,
}
impl_staged!(Drawn { dir, uv, pdf });

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

    /// The direction at these coordinates.
    fn direction(self, uv: Vec2) -> Vec3 {
        let (sin_phi, cos_phi) = sincos_turns(uv.x - 0.5);
        let (sin_theta, cos_theta) = sincos_turns(uv.y * 0.5);
        let (x, z) = (sin_theta * sin_phi, -(sin_theta * cos_phi));
        vec3(self.cos * x + self.sin * z, cos_theta, self.cos * z - self.sin * x)
    }

    /// Radiance between the four texel centres around a point; u wraps, v clamps.
    fn bilinear(self, uv: Vec2) -> Color {
        let (width, height) = (self.width.to_f32(), self.height.to_f32());
        let (x, y) = (uv.x * width - 0.5, uv.y * height - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let wrap = |x: F32| x.lt(0.0).select(x + width, x.ge(width).select(x - width, x)).to_u32();
        let clamp = |y: F32| y.to_u32().min(self.height - 1u32);
        let at = |x: F32, y: F32| {
            let texel = Row::<EnvironmentTexels>::at(clamp(y) * self.width + wrap(x));
            color(texel.get(EnvironmentTexels::R), texel.get(EnvironmentTexels::G), texel.get(EnvironmentTexels::B))
        };
        let line = |y: F32| at(left, y).lerp(at(left + 1.0, y), x - left);
        line(top).lerp(line(top + 1.0), y - top) * self.intensity
    }

    /// The cell that a point lies in.
    fn cell(self, uv: Vec2) -> Cell {
        let index = |x: F32, n: U32| (x * n.to_f32()).to_u32().min(n - 1u32);
        Cell { column: index(uv.x, self.width), row: index(uv.y, self.height) }
    }

    /// Density of a unit direction in a cell, per steradian; infinite at a pole.
    fn pdf(self, cell: Cell, dir: Vec3) -> F32 {
        let row = row_cdf(cell.row + 1u32) - row_cdf(cell.row);
        let column = self.column_cdf(cell.row, cell.column + 1u32) - self.column_cdf(cell.row, cell.column);
        let sin_theta = (dir.x * dir.x + dir.z * dir.z).sqrt();
        let p = row * column;
        // A cell that is never drawn has density 0 at a pole too.
        let pdf = p * self.width.to_f32() * self.height.to_f32() * JACOBIAN / sin_theta;
        p.gt(0.0).select(pdf, 0.0.into())
    }

    /// Cumulative probability within a row.
    fn column_cdf(self, row: U32, column: U32) -> F32 {
        self.column_entry(row, column).get(EnvironmentColumns::CDF)
    }

    /// An entry of the table of a row.
    fn column_entry(self, row: U32, column: U32) -> Row<EnvironmentColumns> {
        Row::at(row * (self.width + 1u32) + column)
    }

    /// A direction, by two uniform numbers.
    fn sample(self, b: &mut Block, u: Vec2) -> Drawn {
        let row = invert_guided(b, self.height, row_cdf, |share| Row::at(share).get(EnvironmentRows::GUIDE), u.y);
        let guide = |share| self.column_entry(row, share).get(EnvironmentColumns::GUIDE);
        let column = invert_guided(b, self.width, |column| self.column_cdf(row, column), guide, u.x);
        let x = remainder(u.x, self.column_cdf(row, column), self.column_cdf(row, column + 1u32));
        let y = remainder(u.y, row_cdf(row), row_cdf(row + 1u32));
        let uv = vec2((column.to_f32() + x) / self.width.to_f32(), (row.to_f32() + y) / self.height.to_f32());
        let dir = self.direction(uv);
        Drawn { dir, uv, pdf: self.pdf(Cell { column, row }, dir) }
    }
}

/// Cumulative probability of the rows.
fn row_cdf(row: U32) -> F32 {
    Row::at(row).get(EnvironmentRows::CDF)
}
