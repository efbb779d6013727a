//! The watertight triangle test of Woop, Benthin and Wald (2013), in f32 throughout, of four triangles at once.
//!
//! The ray is sheared to the z axis; then each edge function depends on its two corners alone, and two triangles at an
//! edge see the very same number with opposite signs. Products are not contracted, the sign test is inclusive, and
//! barycentric weights are normalised before t, so that nothing under- or overflows for triangles of 1e-18 to 1e18
//! (accuracy.md, N2). A needle of zero projected area is a miss.

use jerboa_ir::lang::{Block, F32, U32, Vector};

use crate::schema::Tree;
use crate::traverse::bvh::span;
use crate::traverse::line::Line;
use crate::traverse::{Bool4, F32x4};

/// Words from a block to its corners, and to the numbers of its primitives; see `host::bvh`.
const CORNERS: [u32; 3] = [0, 12, 24];
/// See [`CORNERS`].
const PRIMITIVES: u32 = 36;

/// Corners of four triangles: corner, then axis.
pub type Corners = [[F32x4; 3]; 3];

/// The corners of the triangles in a block.
pub fn read_corners(b: &mut Block, block: U32, line: Line) -> Corners {
    let read = |b: &mut Block, at: U32| b.read_run::<_, U32, 4>(Tree::WORD, block + at).float_of_bits();
    CORNERS.map(|corner| line.axis.map(|axis| read(b, axis + corner)))
}

/// The corners of one of them, in all lanes.
pub fn read_corners_of(b: &mut Block, slot: U32, line: Line) -> Corners {
    let mut read = |at: U32| -> F32 { b.read_unchecked::<_, U32>(Tree::WORD, slot + at).float_of_bits() };
    CORNERS.map(|corner| line.axis.map(|axis| F32x4::splat(read(axis + corner))))
}

/// The numbers of the primitives in a block.
pub fn read_primitives(b: &mut Block, block: U32) -> Vector<U32, 4> {
    b.read_run(Tree::WORD, block + PRIMITIVES)
}

/// The number of one of them.
pub fn read_primitive(b: &mut Block, slot: U32) -> U32 {
    b.read_unchecked(Tree::WORD, slot + PRIMITIVES)
}

/// Where a line meets four triangles.
#[derive(Clone, Copy)]
pub struct Meeting {
    /// Does it meet the triangle, edges included?
    pub is_inside: Bool4,
    /// And does that count: is it in front of the origin, not edge-on, and within the triangle's own box?
    pub counts: Bool4,
    /// Distance in units of the ray's direction; never less than the entry of the triangle's own box.
    pub t: F32x4,
    /// Barycentric weight of the second corner.
    pub u: F32x4,
    /// Barycentric weight of the third corner.
    pub v: F32x4,
}

/// The test. That a triangle counts within its own box only, and not before it, holds of itself but for rounding; it makes
/// the hit independent of the tree ([`crate::traverse`]).
pub fn meet(line: Line, corners: Corners) -> Meeting {
    let [a, b, c] = corners.map(|corner| sheared(line, corner));
    let edge = |p: [F32x4; 3], q: [F32x4; 3]| p[0] * q[1] - p[1] * q[0];
    let weights = [edge(c, b), edge(a, c), edge(b, a)];
    let sum = weights[0] + weights[1] + weights[2];
    let [w, u, v] = weights.map(|weight| weight / sum);
    let t = w * a[2] + u * b[2] + v * c[2];
    let (entry, is_in_box) = own_box(line, corners);
    let zero = F32x4::splat(0.0);
    let is_whole = sum.lt(zero) | sum.gt(zero);
    let is_ahead = t.gt(zero) & t.lt(F32x4::splat(f32::INFINITY));
    Meeting { is_inside: have_one_sign(weights), counts: is_whole & is_ahead & is_in_box, t: entry.max(t), u, v }
}

/// A corner as the ray sees it that goes along the z axis; z in units of the ray's direction.
fn sheared(line: Line, corner: [F32x4; 3]) -> [F32x4; 3] {
    let [x, y, z]: [F32x4; 3] = std::array::from_fn(|k| corner[k] - line.org[k]);
    [x - line.shear[0] * z, y - line.shear[1] * z, line.shear[2] * z]
}

/// Is none of the weights negative or none positive? (If one is NaN, so is their sum, and nothing counts.)
fn have_one_sign([x, y, z]: [F32x4; 3]) -> Bool4 {
    let zero = F32x4::splat(0.0);
    x.min(y).min(z).ge(zero) | x.max(y).max(z).le(zero)
}

/// The entry of each triangle's own box, and whether the ray passes it.
fn own_box(line: Line, [p, q, r]: Corners) -> (F32x4, Bool4) {
    let each = |f: &dyn Fn(usize) -> F32x4| -> [F32x4; 3] { std::array::from_fn(f) };
    let lo = each(&|k| p[k].min(q[k]).min(r[k]));
    let hi = each(&|k| p[k].max(q[k]).max(r[k]));
    let is_backward = |k: usize| line.inv[k].lt(F32x4::splat(0.0));
    let near = each(&|k| is_backward(k).select(hi[k], lo[k]));
    let far = each(&|k| is_backward(k).select(lo[k], hi[k]));
    let own = span(line, near, far, F32x4::splat(f32::INFINITY));
    (own.entry, own.is_entered())
}
