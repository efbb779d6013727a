//! The watertight triangle test of Woop, Benthin and Wald (2013), in f32 throughout.
//!
//! The ray is sheared to the z axis; then each edge function depends on its two corners alone, and two triangles at an
//! edge see the very same number with opposite signs. Products are not contracted, the sign test is inclusive, and
//! barycentric weights are normalised before t, so that nothing under- or overflows for triangles of 1e-18 to 1e18
//! (accuracy.md, N2). A needle of zero projected area is a miss.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, F32, U32};

use crate::core::vec::{Vec3, vec3};
use crate::ray::{Hit, Ray};
use crate::schema::Triangles;
use crate::traverse::bvh::{Bounds, Slabs};

/// The corners of the triangle in a slot.
pub fn read_corners(b: &mut Block, slot: U32) -> [Vec3; 3] {
    use Triangles as T;
    let columns = [[T::P0_X, T::P0_Y, T::P0_Z], [T::P1_X, T::P1_Y, T::P1_Z], [T::P2_X, T::P2_Y, T::P2_Z]];
    columns.map(|corner| {
        let [x, y, z] = corner.map(|column| b.read_unchecked::<_, F32>(column, slot));
        vec3(x, y, z)
    })
}

/// The transformation that takes a ray to the z axis: axes in cyclic order, the longest of the direction last, then a
/// shear. (Woop et al. also swap two axes to keep the winding, which only the sign test they use needs.)
#[derive(Clone, Copy)]
pub struct Shear {
    /// Is x the longest?
    x_is_last: Bool,
    /// Is y?
    y_is_last: Bool,
    /// How far x and y move per z.
    x: F32,
    /// See `x`.
    y: F32,
    /// Scale of z to units of the ray's direction.
    z: F32,
}
impl_staged!(Shear { x_is_last, y_is_last, x, y, z });

impl Shear {
    /// Make a ray ready.
    pub fn new(ray: Ray) -> Shear {
        let d = ray.dir.abs();
        let x_is_last = d.x.ge(d.y) & d.x.ge(d.z);
        let y_is_last = !x_is_last & d.y.ge(d.z);
        let d = cycle(x_is_last, y_is_last, ray.dir);
        Shear { x_is_last, y_is_last, x: d.x / d.z, y: d.y / d.z, z: 1.0 / d.z }
    }

    /// The edge functions of a triangle.
    pub fn edges(self, ray: Ray, corners: [Vec3; 3]) -> Edges {
        let [a, b, c] = corners.map(|p| {
            let to = cycle(self.x_is_last, self.y_is_last, p - ray.org);
            vec3(to.x - self.x * to.z, to.y - self.y * to.z, self.z * to.z)
        });
        let edge = |p: Vec3, q: Vec3| p.x * q.y - p.y * q.x;
        Edges { weights: vec3(edge(c, b), edge(a, c), edge(b, a)), t: vec3(a.z, b.z, c.z) }
    }
}

/// Axes in cyclic order, so that the given one comes last.
fn cycle(x_is_last: Bool, y_is_last: Bool, v: Vec3) -> Vec3 {
    x_is_last.select(vec3(v.y, v.z, v.x), y_is_last.select(vec3(v.z, v.x, v.y), v))
}

/// What the shear makes of a triangle.
#[derive(Clone, Copy)]
pub struct Edges {
    /// Edge functions, opposite to each corner: barycentric weights up to a factor.
    weights: Vec3,
    /// t of each corner.
    t: Vec3,
}

impl Edges {
    /// Does the ray's line meet the triangle, edges included?
    pub fn is_inside(self) -> Bool {
        let Vec3 { x, y, z } = self.weights;
        let negative = x.lt(0.0) | y.lt(0.0) | z.lt(0.0);
        let positive = x.gt(0.0) | y.gt(0.0) | z.gt(0.0);
        !(negative & positive)
    }

    /// The hit, and whether it counts: in front of the origin, not edge-on, and within the triangle's own box. Its t is
    /// not before the entry of that box. Both hold of themselves but for rounding; they make the hit independent of the
    /// tree ([`crate::traverse`]).
    pub fn hit(self, slabs: Slabs, corners: [Vec3; 3], primitive: U32) -> (Hit, Bool) {
        let sum = self.weights.x + self.weights.y + self.weights.z;
        let w = self.weights / sum;
        let t = w.x * self.t.x + w.y * self.t.y + w.z * self.t.z;
        let [p0, p1, p2] = corners;
        let bounds = Bounds { lo: p0.zip(p1, F32::min).zip(p2, F32::min), hi: p0.zip(p1, F32::max).zip(p2, F32::max) };
        let own = slabs.span(bounds);
        let counts = sum.ne(0.0) & t.gt(0.0) & t.lt(f32::INFINITY) & own.entry.le(own.exit);
        (Hit { primitive, t: own.entry.max(t), u: w.y, v: w.z }, counts)
    }
}
