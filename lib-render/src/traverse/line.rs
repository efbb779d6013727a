//! A ray made ready for four boxes or four triangles at once: each number in all four lanes.
//!
//! Coordinates are in cyclic order, the longest of the direction last, as the triangle test wants them (Woop, Benthin and
//! Wald 2013; they also swap two axes to keep the winding, which only the sign test they use needs). Boxes and corners are
//! read in that order too: an axis is a distance in memory, so nothing is exchanged per box or triangle.
//!
//! Boxes grow by a length that covers every error of the triangle test: its sheared corners are off by at most 8 · 2^-24
//! of their distance from the origin of the ray. (Ize 2013 widens the exit by ulps, which measures errors by the distance
//! of the box alone.) That length is one number per ray, so it is added to the origin and costs nothing per box.

use jerboa_ir::lang::{Block, Bool, F32, U32};

use crate::core::vec::Vec3;
use crate::ray::Ray;
use crate::schema::Tree;
use crate::traverse::memory::{Memory, float, word};
use crate::traverse::{Bool4, F32x4};

/// Growth of boxes, in parts of the farthest corner of the box around all: 16 · 2^-24, twice the bound of the triangle test.
pub const GROWTH: f32 = 1.0 / 1_048_576.0;
/// And in parts of the origin's coordinate, so that the sum is never rounded back: 2^-23.
const ULP: f32 = 1.0 / 8_388_608.0;

/// A ray made ready. Arrays go by axis, in cyclic order.
#[derive(Clone, Copy)]
pub struct Line {
    /// The origin.
    pub org: [F32x4; 3],
    /// 1/d.
    pub inv: [F32x4; 3],
    /// The origin, moved forward by the growth of boxes: for planes where the ray enters.
    pub org_entry: [F32x4; 3],
    /// And moved backward: for planes where it leaves.
    pub org_exit: [F32x4; 3],
    /// How far the first two coordinates move per unit of the third, and the scale of the third to units of the direction.
    pub shear: [F32x4; 3],
    /// Words from a node to the planes where the ray enters its boxes.
    pub near: [U32; 3],
    /// And to those where it leaves.
    pub far: [U32; 3],
    /// Words from a corner to its coordinates.
    pub axis: [U32; 3],
}

impl Line {
    /// Make a ray ready for the tree around whose box begins at this word, and whose boxes grow so much.
    pub fn new(b: &mut Block, ray: Ray, around: U32, growth: F32) -> Line {
        let (place, direction) = (lanes(ray.org), lanes(ray.dir));
        let d = abs(direction);
        let [x, y, z] = [0, 1, 2].map(|k| d.extract(k));
        let x_is_last = x.ge(y) & x.ge(z);
        let y_is_last = !x_is_last & y.ge(z);
        let cycle = |v: F32x4| {
            let by_y = Bool4::splat(y_is_last).select(v.shuffle([2, 0, 1, 1]), v);
            Bool4::splat(x_is_last).select(v.shuffle([1, 2, 0, 0]), by_y)
        };
        let distance =
            |x: u32, y: u32, z: u32| -> U32 { x_is_last.select(U32::from(x), y_is_last.select(y.into(), z.into())) };
        let axis = [distance(4, 8, 0), distance(8, 0, 4), distance(0, 4, 8)];

        // How much boxes grow.
        let [lo, hi] = [0, 4].map(|at| b.read_run::<_, U32, 4>(Tree::WORD, around + at).float_of_bits());
        let reach = largest((place - lo).max(hi - place));
        let (org, dir) = (cycle(place), cycle(direction));
        let growth = reach * F32x4::splat(growth) + abs(org) * F32x4::splat(ULP);
        let inv = F32x4::splat(1.0) / dir;
        let forward = with_sign(growth, inv);
        let (org_entry, org_exit) = (org + forward, org - forward);

        let backward = inv.lt(F32x4::splat(0.0)).ballot();
        let near = std::array::from_fn(|k| axis[k] + axis[k] + ((backward << (2 - k as u32)) & 4));
        let [shear_x, shear_y, _] = each(dir / F32x4::splat(dir.extract(2)));
        let inv = each(inv);
        Line {
            org: each(org),
            inv,
            org_entry: each(org_entry),
            org_exit: each(org_exit),
            shear: [shear_x, shear_y, inv[2]],
            near,
            far: near.map(|offset| offset ^ 4),
            axis,
        }
    }

    /// Keep it in memory.
    pub fn keep(self, b: &mut Block, memory: Memory) {
        memory.set_vectors(b, float::ORG, &self.org);
        memory.set_vectors(b, float::INV, &self.inv);
        memory.set_vectors(b, float::ORG_ENTRY, &self.org_entry);
        memory.set_vectors(b, float::ORG_EXIT, &self.org_exit);
        memory.set_vectors(b, float::SHEAR, &self.shear[..2]);
        for k in 0..3 {
            memory.set_word(b, word::NEAR + k, self.near[k as usize]);
            memory.set_word(b, word::AXIS + k, self.axis[k as usize]);
        }
    }

    /// Have it from memory. What of it is not used is not loaded.
    pub fn kept(b: &mut Block, memory: Memory) -> Line {
        let inv = memory.vectors(b, float::INV);
        let [x, y] = memory.vectors(b, float::SHEAR);
        let near = [0, 1, 2].map(|k| memory.word(b, word::NEAR + k));
        Line {
            org: memory.vectors(b, float::ORG),
            inv,
            org_entry: memory.vectors(b, float::ORG_ENTRY),
            org_exit: memory.vectors(b, float::ORG_EXIT),
            shear: [x, y, inv[2]],
            near,
            far: near.map(|offset| offset ^ 4),
            axis: [0, 1, 2].map(|k| memory.word(b, word::AXIS + k)),
        }
    }
}

/// Is the ray finite, and does it have a direction? Sums, since a comparison with NaN would drop it.
pub fn is_usable(ray: Ray) -> Bool {
    let sum = |v: Vec3| -> F32 {
        let v = abs(lanes(v));
        v.extract(0) + v.extract(1) + v.extract(2)
    };
    let (place, direction) = (sum(ray.org), sum(ray.dir));
    place.lt(f32::INFINITY) & direction.gt(0.0) & direction.lt(f32::INFINITY)
}

/// The coordinates, the last one twice.
fn lanes(v: Vec3) -> F32x4 {
    F32x4::new([v.x, v.y, v.z, v.z])
}

/// The first three lanes, each in four lanes.
fn each(v: F32x4) -> [F32x4; 3] {
    [0, 1, 2].map(|k| F32x4::splat(v.extract(k)))
}

/// Absolute values; the sign of a zero may be any.
fn abs(v: F32x4) -> F32x4 {
    v.max(F32x4::splat(0.0) - v)
}

/// The largest lane, in all lanes.
fn largest(v: F32x4) -> F32x4 {
    let v = v.max(v.shuffle([2, 3, 0, 1]));
    v.max(v.shuffle([1, 0, 3, 2]))
}

/// The first, which is not negative, with the second's signs; zeros count as positive.
fn with_sign(v: F32x4, sign: F32x4) -> F32x4 {
    let zero = F32x4::splat(0.0);
    sign.lt(zero).select(zero - v, v)
}
