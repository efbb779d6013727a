//! A ray made ready for four boxes or four triangles at once: each number in all four lanes.
//!
//! Coordinates are in cyclic order, the longest of the direction last, as the triangle test wants them (Woop, Benthin and
//! Wald 2013; they also swap two axes to keep the winding, which only the sign test they use needs). Boxes and corners are
//! read in that order too: an axis is a distance in memory, so nothing is exchanged per box or triangle.
//!
//! Boxes grow by a length that covers every error of the triangle test: its sheared corners are off by at most 8 · 2^-24
//! of their distance from the origin of the ray. (Ize 2013 widens the exit by ulps, which measures errors by the distance
//! of the box alone.) That length is one number per ray, so it is added to the origin and costs nothing per box.

use jerboa_ir::lang::{Block, U32, Vector};

use crate::core::vec::Vec3;
use crate::ray::Ray;
use crate::schema::Tree;
use crate::traverse::{Bool4, F32x4};

/// Growth of boxes, in parts of the farthest corner of the scene's box: 16 · 2^-24, twice the bound of the triangle test.
const GROWTH: f32 = 1.0 / 1_048_576.0;
/// And in parts of the origin's coordinate, so that the sum is never rounded back: 2^-23.
const ULP: f32 = 1.0 / 8_388_608.0;
/// The sign of a float.
const SIGN: u32 = 1 << 31;

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
    /// Make a ray ready.
    pub fn new(b: &mut Block, ray: Ray) -> Line {
        let d = ray.dir.abs();
        let x_is_last = d.x.ge(d.y) & d.x.ge(d.z);
        let y_is_last = !x_is_last & d.y.ge(d.z);
        let cycle = |v: F32x4| {
            let by_y = Bool4::splat(y_is_last).select(v.shuffle([2, 0, 1, 1]), v);
            Bool4::splat(x_is_last).select(v.shuffle([1, 2, 0, 0]), by_y)
        };
        let axis =
            |x: u32, y: u32, z: u32| -> U32 { x_is_last.select(U32::from(x), y_is_last.select(y.into(), z.into())) };
        let axes = [axis(1, 2, 0), axis(2, 0, 1), axis(0, 1, 2)];

        // How much boxes grow.
        let place = lanes(ray.org);
        let [lo, hi] = [0, 4].map(|at| b.read_run::<_, U32, 4>(Tree::WORD, at).float_of_bits());
        let reach = largest(abs(lo - place).max(abs(hi - place)));
        let (org, dir) = (cycle(place), cycle(lanes(ray.dir)));
        let growth = reach * F32x4::splat(GROWTH) + abs(org) * F32x4::splat(ULP);
        let inv = F32x4::splat(1.0) / dir;
        let forward = with_sign(growth, inv);
        let (org_entry, org_exit) = (org + forward, org - forward);

        let backward = inv.lt(F32x4::splat(0.0)).ballot();
        let near = std::array::from_fn(|k| axes[k] * 8 + ((backward >> k as u32) & 1) * 4);
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
            axis: axes.map(|axis| axis * 4),
        }
    }
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

/// The first's absolute values with the second's signs.
fn with_sign(v: F32x4, sign: F32x4) -> F32x4 {
    ((v.bits() & Vector::splat(!SIGN)) | (sign.bits() & Vector::splat(SIGN))).float_of_bits()
}
