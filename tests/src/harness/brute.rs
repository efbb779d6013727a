//! What a ray hits, without a tree and one triangle at a time: the measure for the renderer's walk, which must find the same
//! bits four at a time.

use jerboa_ir::lang::{Block, Bool, F32, Fun, U32, entry};
use jerboa_lib_render::core::vec::{Vec3, vec3};
use jerboa_lib_render::ray::{Hit, Ray};
use jerboa_lib_render::schema::{Primitives, Vertices};
use jerboa_lib_render::traverse::bvh::scene_bounds;

/// Declares the kernel `brute`: (ray; number of slots) → the nearest hit of all triangles, tried one by one, ties to the
/// smaller number. Skips nothing. Slot s has its number in `Primitives::I0` and its corners in `Vertices` from 3s on.
pub fn declare_brute_force() {
    entry(
        "brute",
        Fun::<(Ray, U32), Hit>::lam(|b, (ray, slots)| {
            let line = Line::new(ray);
            let step = |b: &mut Block, (slot, best): (U32, Hit)| {
                let corners = [0, 1, 2].map(|k| {
                    let [x, y, z] =
                        [Vertices::X, Vertices::Y, Vertices::Z].map(|c| b.read_unchecked::<_, F32>(c, slot * 3 + k));
                    vec3(x, y, z)
                });
                let (hit, counts) = line.meet(corners, b.read_unchecked(Primitives::I0, slot));
                let closer = hit.t.lt(best.t) | (hit.t.eq(best.t) & hit.primitive.lt(best.primitive));
                (slot + 1u32, (counts & closer).select(hit, best))
            };
            b.while_((U32::from(0), Hit::miss(ray.tmax)), |_, (slot, _)| slot.lt(slots), step).1
        }),
    );
}

/// A ray made ready.
#[derive(Clone, Copy)]
struct Line {
    org: Vec3,
    inv: Vec3,
    /// The origin, moved forward and backward by the growth of boxes.
    shifted: [Vec3; 2],
    x_is_last: Bool,
    y_is_last: Bool,
    /// Shear of x and y, scale of z.
    shear: Vec3,
}

impl Line {
    fn new(ray: Ray) -> Line {
        let scene = scene_bounds();
        let reach = (scene.lo - ray.org).abs().zip((scene.hi - ray.org).abs(), F32::max).max_element();
        let growth = ray.org.map(|o| reach * (1.0 / 1_048_576.0) + o.abs() * (1.0 / 8_388_608.0));
        let inv = ray.dir.map(|d| 1.0 / d);
        let forward = growth.zip(inv, F32::copysign);
        let d = ray.dir.abs();
        let x_is_last = d.x.ge(d.y) & d.x.ge(d.z);
        let y_is_last = !x_is_last & d.y.ge(d.z);
        let d = cycle(x_is_last, y_is_last, ray.dir);
        let shear = vec3(d.x / d.z, d.y / d.z, 1.0 / d.z);
        Line { org: ray.org, inv, shifted: [ray.org + forward, ray.org - forward], x_is_last, y_is_last, shear }
    }

    /// The hit, and whether it counts.
    fn meet(self, corners: [Vec3; 3], primitive: U32) -> (Hit, Bool) {
        let [a, b, c] = corners.map(|p| {
            let to = cycle(self.x_is_last, self.y_is_last, p - self.org);
            vec3(to.x - self.shear.x * to.z, to.y - self.shear.y * to.z, self.shear.z * to.z)
        });
        let edge = |p: Vec3, q: Vec3| p.x * q.y - p.y * q.x;
        let weights = vec3(edge(c, b), edge(a, c), edge(b, a));
        let negative = weights.x.lt(0.0) | weights.y.lt(0.0) | weights.z.lt(0.0);
        let positive = weights.x.gt(0.0) | weights.y.gt(0.0) | weights.z.gt(0.0);
        let sum = weights.x + weights.y + weights.z;
        let w = weights / sum;
        let t = w.x * a.z + w.y * b.z + w.z * c.z;
        let (entry, exit) = self.own_box(corners);
        let is_ahead = t.gt(0.0) & t.lt(f32::INFINITY);
        let counts = !(negative & positive) & sum.ne(0.0) & is_ahead & entry.le(exit);
        (Hit { primitive, t: entry.max(t), u: w.y, v: w.z }, counts)
    }

    /// Entry and exit of the triangle's own box.
    fn own_box(self, [p, q, r]: [Vec3; 3]) -> (F32, F32) {
        let (lo, hi) = (p.zip(q, F32::min).zip(r, F32::min), p.zip(q, F32::max).zip(r, F32::max));
        let planes = |positive: Vec3, negative: Vec3, org: Vec3| {
            let pick = |inv: F32, a: F32, b: F32| inv.lt(0.0).select(b, a);
            let plane = vec3(
                pick(self.inv.x, positive.x, negative.x),
                pick(self.inv.y, positive.y, negative.y),
                pick(self.inv.z, positive.z, negative.z),
            );
            (plane - org).zip(self.inv, |distance, inv| distance * inv)
        };
        let (entry, exit) = (planes(lo, hi, self.shifted[0]), planes(hi, lo, self.shifted[1]));
        (entry.z.max(entry.y.max(entry.x.max(0.0))), exit.z.min(exit.y.min(exit.x.min(f32::INFINITY))))
    }
}

/// Axes in cyclic order, so that the given one comes last.
fn cycle(x_is_last: Bool, y_is_last: Bool, v: Vec3) -> Vec3 {
    x_is_last.select(vec3(v.y, v.z, v.x), y_is_last.select(vec3(v.z, v.x, v.y), v))
}
