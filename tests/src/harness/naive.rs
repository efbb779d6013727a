//! Intersection as it is often written: what the robust parts of the renderer are measured against, in holes and in time.
//! Only tests use it.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, Exit, F32, Keep, Row, U32, never};
use jerboa_lib_render::core::vec::{Vec3, vec3};
use jerboa_lib_render::ray::{Hit, Ray};
use jerboa_lib_render::schema::{Settings, Triangles};
use jerboa_lib_render::traverse::bvh::{Bounds, Child, Slabs, Span, read_children};
use jerboa_lib_render::traverse::stack::Stack;
use jerboa_lib_render::traverse::triangle::{Shear, read_corners};
use jerboa_lib_render::traverse::{AcceptFn, TraverseFn};

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

/// A traversal made of these parts, otherwise the renderer's. Assumes a usable ray.
pub fn make_traverse(boxes: BoxTest, triangles: TriangleTest) -> TraverseFn {
    TraverseFn::rec(
        "traverse",
        |_| never(),
        move |b: &mut Block, _, (ray, Keep(any_hit), accept): (Ray, Keep<Bool>, AcceptFn)| {
            let slabs = Slabs::new(ray);
            let lines = Lines::new(ray);
            let stack = Stack::new(b);
            Walk { boxes, triangles, ray, any_hit, accept, slabs, shear: Shear::new(ray), lines, stack }.run(b)
        },
    )
}

/// A ray made ready for boxes, without room.
#[derive(Clone, Copy)]
struct Lines {
    org: Vec3,
    inv: Vec3,
    /// o · (1/d)
    start: Vec3,
}
impl_staged!(Lines { org, inv, start });

impl Lines {
    fn new(ray: Ray) -> Lines {
        let inv = ray.dir.map(|d| 1.0 / d);
        Lines { org: ray.org, inv, start: ray.org.zip(inv, |o, i| o * i) }
    }

    fn span(self, test: BoxTest, Bounds { lo, hi }: Bounds) -> Span {
        let (lo, hi) = match test {
            BoxTest::Precomputed => (self.via_start(lo), self.via_start(hi)),
            _ => (self.via_origin(lo), self.via_origin(hi)),
        };
        let (near, far) = match test {
            BoxTest::Unordered => (lo.zip(hi, F32::min), lo.zip(hi, F32::max)),
            _ => {
                let ordered = |a: Vec3, b: Vec3| {
                    let pick = |inv: F32, a: F32, b: F32| inv.lt(0.0).select(b, a);
                    vec3(pick(self.inv.x, a.x, b.x), pick(self.inv.y, a.y, b.y), pick(self.inv.z, a.z, b.z))
                };
                (ordered(lo, hi), ordered(hi, lo))
            }
        };
        // Unordered as it is mostly written: the accumulator first, so that NaN stays.
        match test {
            BoxTest::Unordered => Span {
                entry: F32::from(0.0).max(near.x).max(near.y).max(near.z),
                exit: F32::from(f32::INFINITY).min(far.x).min(far.y).min(far.z),
            },
            _ => Span {
                entry: near.z.max(near.y.max(near.x.max(0.0))),
                exit: far.z.min(far.y.min(far.x.min(f32::INFINITY))),
            },
        }
    }

    fn via_origin(self, plane: Vec3) -> Vec3 {
        (plane - self.org).zip(self.inv, |distance, inv| distance * inv)
    }

    fn via_start(self, plane: Vec3) -> Vec3 {
        plane.zip(self.inv, |p, inv| p * inv) - self.start
    }
}

/// `lib-render`'s walk over interchangeable parts.
#[derive(Clone, Copy)]
struct Walk {
    boxes: BoxTest,
    triangles: TriangleTest,
    ray: Ray,
    any_hit: Bool,
    accept: AcceptFn,
    slabs: Slabs,
    shear: Shear,
    lines: Lines,
    stack: Stack,
}

impl Walk {
    fn run(self, b: &mut Block) -> Hit {
        let start = (Child::root(), U32::from(0), Hit::miss(self.ray.tmax));
        b.loop_(start, |b, (child, top, best), go_on, done| {
            let leaf = |b: &mut Block| (Child::nothing(), top, self.leaf(b, child, best, done));
            let inner = |b: &mut Block| {
                let (child, top) = self.inner(b, child, top, best);
                (child, top, best)
            };
            let (child, top, best) = b.if_(child.is_leaf(), leaf, inner);
            let pop = |b: &mut Block| {
                let (child, top) = self.stack.pop(b, top, best.t);
                b.branch(child.is_nothing(), |b| done.take(b, best), |b| go_on.take(b, (child, top, best)))
            };
            b.branch(child.is_nothing(), pop, |b| go_on.take(b, (child, top, best)))
        })
    }

    fn inner(self, b: &mut Block, node: Child, top: U32, best: Hit) -> (Child, U32) {
        let [first, second] = read_children(b, node).map(|(bounds, child)| {
            let span = match self.boxes {
                BoxTest::Padded => self.slabs.span(bounds),
                test => self.lines.span(test, bounds),
            };
            (child, span.entry, span.entry.le(span.exit.min(best.t)))
        });
        let both = |b: &mut Block| {
            let swap = second.1.lt(first.1);
            let near = swap.select(second.0, first.0);
            let (far, entry) = swap.select((first.0, first.1), (second.0, second.1));
            (near, self.stack.push(b, top, far, entry))
        };
        let one = |_: &mut Block| (first.2.select(first.0, second.2.select(second.0, Child::nothing())), top);
        b.if_(first.2 & second.2, both, one)
    }

    fn leaf(self, b: &mut Block, leaf: Child, best: Hit, done: Exit<Hit>) -> Hit {
        let (first, end) = leaf.slots();
        let more = |_: &mut Block, (slot, _): (U32, Hit)| slot.lt(end);
        let step = |b: &mut Block, (slot, best): (U32, Hit)| {
            let best = self.triangle(b, slot, best);
            b.when(self.any_hit & best.is_hit(), |b| done.take(b, best));
            (slot + 1u32, best)
        };
        b.while_((first, best), more, step).1
    }

    fn triangle(self, b: &mut Block, slot: U32, best: Hit) -> Hit {
        let corners = read_corners(b, slot);
        let consider = |b: &mut Block, primitive: U32, hit: Hit, counts: Bool| {
            let Ray { skip, skip1, skip2, .. } = self.ray;
            let skipped = primitive.eq(skip) | primitive.eq(skip1) | primitive.eq(skip2);
            let closer = hit.t.lt(best.t) | (hit.t.eq(best.t) & primitive.lt(best.primitive));
            let wins = counts & !skipped & hit.t.lt(self.ray.tmax) & closer;
            b.if_(wins, |b| self.is_accepted(b, hit).select(hit, best), |_| best)
        };
        let number = |b: &mut Block| b.read_unchecked::<Triangles, U32>(Triangles::PRIMITIVE, slot);
        match self.triangles {
            TriangleTest::Watertight => {
                let edges = self.shear.edges(self.ray, corners);
                let meets = |b: &mut Block| {
                    let primitive = number(b);
                    let (hit, counts) = edges.hit(self.slabs, corners, primitive);
                    consider(b, primitive, hit, counts)
                };
                b.if_(edges.is_inside(), meets, |_| best)
            }
            TriangleTest::MoellerTrumbore => {
                let (inside, t, u, v) = moeller_trumbore(self.ray, corners);
                let meets = |b: &mut Block| {
                    let primitive = number(b);
                    consider(b, primitive, Hit { primitive, t, u, v }, is_ahead(t))
                };
                b.if_(inside, meets, |_| best)
            }
            test => {
                let (weights, z) = woop(self.ray, corners, test == TriangleTest::Contracted);
                let negative = weights.x.lt(0.0) | weights.y.lt(0.0) | weights.z.lt(0.0);
                let positive = weights.x.gt(0.0) | weights.y.gt(0.0) | weights.z.gt(0.0);
                let meets = |b: &mut Block| {
                    let primitive = number(b);
                    let sum = weights.x + weights.y + weights.z;
                    let w = weights / sum;
                    let t = match test {
                        TriangleTest::LateDivision => weights.dot(z) / sum,
                        _ => w.dot(z),
                    };
                    consider(b, primitive, Hit { primitive, t, u: w.y, v: w.z }, sum.ne(0.0) & is_ahead(t))
                };
                b.if_(!(negative & positive), meets, |_| best)
            }
        }
    }

    fn is_accepted(self, b: &mut Block, hit: Hit) -> Bool {
        let has_cutouts = Row::at(0u32).get(Settings::HAS_CUTOUTS);
        b.if_(has_cutouts, |b| self.accept.call(b, (self.ray, hit)), |_| Bool::from(true))
    }
}

fn is_ahead(t: F32) -> Bool {
    t.gt(0.0) & t.lt(f32::INFINITY)
}

/// Is it inside; t, u, v.
fn moeller_trumbore(ray: Ray, [a, b, c]: [Vec3; 3]) -> (Bool, F32, F32, F32) {
    let (e1, e2) = (b - a, c - a);
    let p = ray.dir.cross(e2);
    let inv = 1.0 / e1.dot(p);
    let s = ray.org - a;
    let u = s.dot(p) * inv;
    let q = s.cross(e1);
    let v = ray.dir.dot(q) * inv;
    (u.ge(0.0) & v.ge(0.0) & (u + v).le(1.0), e2.dot(q) * inv, u, v)
}

/// Edge functions, and t of each corner.
fn woop(ray: Ray, corners: [Vec3; 3], contracted: bool) -> (Vec3, Vec3) {
    let d = ray.dir.abs();
    let x_is_last = d.x.ge(d.y) & d.x.ge(d.z);
    let y_is_last = !x_is_last & d.y.ge(d.z);
    let cycle = |v: Vec3| x_is_last.select(vec3(v.y, v.z, v.x), y_is_last.select(vec3(v.z, v.x, v.y), v));
    let d = cycle(ray.dir);
    let (shear_x, shear_y, scale) = (d.x / d.z, d.y / d.z, 1.0 / d.z);
    let [a, b, c] = corners.map(|p| {
        let to = cycle(p - ray.org);
        vec3(to.x - shear_x * to.z, to.y - shear_y * to.z, scale * to.z)
    });
    let edge = |p: Vec3, q: Vec3| match contracted {
        true => p.x.fma(q.y, -(p.y * q.x)),
        false => p.x * q.y - p.y * q.x,
    };
    (vec3(edge(c, b), edge(a, c), edge(b, a)), vec3(a.z, b.z, c.z))
}
