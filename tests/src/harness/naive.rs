//! Intersection as it is often written: what the robust parts of the renderer are measured against, in holes and in time.
//! Only tests use it.

use jerboa_lib_render::traverse::bvh::{Span, span};
use jerboa_lib_render::traverse::line::Line;
use jerboa_lib_render::traverse::triangle::{Corners, Meeting, meet};
use jerboa_lib_render::traverse::{Bool4, F32x4, Tests, TraverseFn, make_traverse_with};

/// A test of boxes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BoxTest {
    /// The renderer's.
    Padded,
    /// (b − o)/d, planes ordered by the sign of d, no room for rounding.
    Plain,
    /// The same with minimum and maximum of both planes, as Kay and Kajiya (1986) write it: NaN may win.
    Unordered,
    /// b·(1/d) − o·(1/d), the second product computed once per ray.
    Precomputed,
}

/// A test of triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TriangleTest {
    /// The renderer's.
    Watertight,
    /// Woop, Benthin & Wald (2013) without the renderer's check of the triangle's own box.
    Woop,
    /// The same with edge functions contracted to one multiply-add.
    Contracted,
    /// Woop's, t from the sums before the division by the determinant.
    LateDivision,
    /// Möller & Trumbore (1997), inclusive.
    MoellerTrumbore,
}

/// The renderer's traversal made of these parts.
pub fn make_traverse(boxes: BoxTest, triangles: TriangleTest) -> TraverseFn {
    let span = match boxes {
        BoxTest::Padded => span,
        BoxTest::Plain => |line, near, far, limit| Planes::via_origin(line, near, far).ordered(limit),
        BoxTest::Unordered => |line, near, far, limit| Planes::via_origin(line, near, far).unordered(limit),
        BoxTest::Precomputed => |line, near, far, limit| Planes::via_start(line, near, far).ordered(limit),
    };
    let meet = match triangles {
        TriangleTest::Watertight => meet,
        TriangleTest::Woop => |line, corners| woop(line, corners, false, false),
        TriangleTest::Contracted => |line, corners| woop(line, corners, true, false),
        TriangleTest::LateDivision => |line, corners| woop(line, corners, false, true),
        TriangleTest::MoellerTrumbore => moeller_trumbore,
    };
    make_traverse_with(Tests { span, meet })
}

/// Where a ray meets the planes of boxes, by axis.
struct Planes {
    near: [F32x4; 3],
    far: [F32x4; 3],
}

impl Planes {
    fn via_origin(line: Line, near: [F32x4; 3], far: [F32x4; 3]) -> Planes {
        let times = |planes: [F32x4; 3]| std::array::from_fn(|k| (planes[k] - line.org[k]) * line.inv[k]);
        Planes { near: times(near), far: times(far) }
    }

    fn via_start(line: Line, near: [F32x4; 3], far: [F32x4; 3]) -> Planes {
        let times = |planes: [F32x4; 3]| std::array::from_fn(|k| planes[k] * line.inv[k] - line.org[k] * line.inv[k]);
        Planes { near: times(near), far: times(far) }
    }

    fn ordered(self, limit: F32x4) -> Span {
        let Planes { near: [nx, ny, nz], far: [fx, fy, fz] } = self;
        Span { entry: nz.max(ny.max(nx.max(zero()))), exit: fz.min(fy.min(fx.min(limit))) }
    }

    /// As it is mostly written: the accumulator first, so that NaN stays.
    fn unordered(self, limit: F32x4) -> Span {
        let [nx, ny, nz] = std::array::from_fn(|k| self.near[k].min(self.far[k]));
        let [fx, fy, fz] = std::array::from_fn(|k| self.near[k].max(self.far[k]));
        Span { entry: zero().max(nx).max(ny).max(nz), exit: limit.min(fx).min(fy).min(fz) }
    }
}

fn zero() -> F32x4 {
    F32x4::splat(0.0)
}

fn is_ahead(t: F32x4) -> Bool4 {
    t.gt(zero()) & t.lt(F32x4::splat(f32::INFINITY))
}

fn sub(a: [F32x4; 3], b: [F32x4; 3]) -> [F32x4; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

fn cross(a: [F32x4; 3], b: [F32x4; 3]) -> [F32x4; 3] {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

fn dot(a: [F32x4; 3], b: [F32x4; 3]) -> F32x4 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Along the direction whose third coordinate is 1; a cyclic order of axes changes no product.
fn moeller_trumbore(line: Line, [a, b, c]: Corners) -> Meeting {
    let one = F32x4::splat(1.0);
    let dir = [line.shear[0], line.shear[1], one];
    let (e1, e2) = (sub(b, a), sub(c, a));
    let p = cross(dir, e2);
    let inv = one / dot(e1, p);
    let s = sub(line.org, a);
    let u = dot(s, p) * inv;
    let q = cross(s, e1);
    let v = dot(dir, q) * inv;
    let t = dot(e2, q) * inv * line.shear[2];
    Meeting { is_inside: u.ge(zero()) & v.ge(zero()) & (u + v).le(one), counts: is_ahead(t), t, u, v }
}

fn woop(line: Line, corners: Corners, contracted: bool, late: bool) -> Meeting {
    let [a, b, c] = corners.map(|p| {
        let [x, y, z] = sub(p, line.org);
        [x - line.shear[0] * z, y - line.shear[1] * z, line.shear[2] * z]
    });
    let edge = |p: [F32x4; 3], q: [F32x4; 3]| match contracted {
        true => p[0].fma(q[1], zero() - p[1] * q[0]),
        false => p[0] * q[1] - p[1] * q[0],
    };
    let weights = [edge(c, b), edge(a, c), edge(b, a)];
    let [x, y, z] = weights;
    let negative = x.lt(zero()) | y.lt(zero()) | z.lt(zero());
    let positive = x.gt(zero()) | y.gt(zero()) | z.gt(zero());
    let sum = x + y + z;
    let shares = weights.map(|w| w / sum);
    let ts = [a[2], b[2], c[2]];
    let t = if late { dot(weights, ts) / sum } else { dot(shares, ts) };
    let is_inside = (negative & positive).select(Bool4::splat(false), Bool4::splat(true));
    let counts = (sum.lt(zero()) | sum.gt(zero())) & is_ahead(t);
    Meeting { is_inside, counts, t, u: shares[1], v: shares[2] }
}
