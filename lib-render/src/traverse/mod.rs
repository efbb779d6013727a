//! What a ray hits (paper, section 4.6): a walk of the tree of boxes, for the nearest hit and for any hit.
//!
//! A node has four boxes and a leaf four triangles, tested at once ([`bvh`], [`triangle`]); of the boxes that are entered the
//! walk goes on with the nearest, the others wait on the [`stack`].
//!
//! *The hit is a function of the ray, the triangles and `accept`*: of all accepted triangles in range the one of smallest
//! computed t, then of smallest number. No tree can change it. A triangle counts only if the ray passes its own box too,
//! and its t is never less than the entry of that box ([`triangle`]). The entry and exit of a box are monotone: a box
//! around another one is entered no later and left no earlier, in floats as in the reals ([`bvh`]). So every box around
//! a triangle that could win is entered at or before its t, and a box is passed over only if its entry exceeds the best t.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, Exit, F32, Fun, Keep, Left, Row, U32, Vector, never};

use crate::ray::{Hit, Ray};
use crate::schema::{NONE, Settings};

pub mod line;
pub mod bvh;
pub mod triangle;
pub mod stack;
mod lanes;

use bvh::{Child, Span};
use line::Line;
use stack::Stack;
use triangle::{Corners, Meeting};

/// Four floats.
pub type F32x4 = Vector<F32, 4>;
/// Four truth values.
pub type Bool4 = Vector<Bool, 4>;

/// (ray, hit) → does it count? A pure function, asked only where the scene has cut-outs and the hit would win.
pub type AcceptFn = Fun<(Ray, Hit), Bool>;

/// (ray; is any hit as good as the nearest?; accept) → hit. Where any hit is, only [`Hit::is_hit`] has a meaning. A ray
/// with a coordinate that is not finite, or without a direction, hits nothing.
pub type TraverseFn = Fun<(Ray, Keep<Bool>, AcceptFn), Hit>;

/// What is asked of boxes and triangles: see [`bvh::span`] and [`triangle::meet`].
#[derive(Clone, Copy)]
pub struct Tests {
    /// (line, planes on its side, planes on the other) → where it enters and leaves.
    pub span: fn(Line, [F32x4; 3], [F32x4; 3]) -> Span,
    /// (line, corners) → where it meets the triangles.
    pub meet: fn(Line, Corners) -> Meeting,
}

/// The traversal. It stays a call: a kernel has one copy for the nearest hit and one for any hit.
pub fn make_traverse() -> TraverseFn {
    make_traverse_with(Tests { span: bvh::span, meet: triangle::meet })
}

/// The traversal by these tests.
pub fn make_traverse_with(tests: Tests) -> TraverseFn {
    let body = move |b: &mut Block, _, (ray, Keep(any_hit), accept): (Ray, Keep<Bool>, AcceptFn)| {
        let walk = |b: &mut Block| Walk::new(b, tests, ray, any_hit, accept).run(b);
        b.if_(is_usable(ray), walk, |_| Hit::miss(ray.tmax))
    };
    TraverseFn::rec("traverse", |_| never(), body)
}

/// Finite, and with a direction. Sums, since a comparison with NaN would drop it.
fn is_usable(ray: Ray) -> Bool {
    let sum = |v: crate::core::vec::Vec3| v.x + v.y + v.z;
    let (place, direction) = (sum(ray.org.abs()), sum(ray.dir.abs()));
    place.lt(f32::INFINITY) & direction.gt(0.0) & direction.lt(f32::INFINITY)
}

/// The best hit so far. Its weights wait until the walk has ended.
#[derive(Clone, Copy)]
struct Best {
    /// See [`Hit::t`].
    t: F32,
    /// See [`Hit::primitive`].
    primitive: U32,
    /// The first word of the triangle in its block.
    slot: U32,
}
impl_staged!(Best { t, primitive, slot });

/// What stays the same on a walk.
#[derive(Clone, Copy)]
struct Walk {
    tests: Tests,
    ray: Ray,
    any_hit: Bool,
    accept: AcceptFn,
    line: Line,
    stack: Stack,
}

impl Walk {
    fn new(b: &mut Block, tests: Tests, ray: Ray, any_hit: Bool, accept: AcceptFn) -> Walk {
        Walk { tests, ray, any_hit, accept, line: Line::new(b, ray), stack: Stack::new(b) }
    }

    /// Visit children, the nearest one first, until none is left.
    fn run(self, b: &mut Block) -> Hit {
        let none = Best { t: self.ray.tmax, primitive: NONE.into(), slot: 0.into() };
        let best = b.loop_((Child::root(), U32::from(0), none), |b, (child, top, best), go_on, done| {
            let (top, best) = b.label(|b, pop: Exit<(U32, Best)>| {
                let leaf = |b: &mut Block| {
                    let best = self.leaf(b, child.block(), best, done);
                    pop.take(b, (top, best))
                };
                b.branch(child.is_leaf(), leaf, |b| self.inner(b, child, top, best, go_on, pop))
            });
            let (child, top) = self.stack.pop(b, top, best.t);
            b.branch(child.is_nothing(), |b| done.take(b, best), |b| go_on.take(b, (child, top, best)))
        });
        let whole = |b: &mut Block| Hit { t: best.t, ..self.hit(b, best.slot, best.primitive) };
        let Best { t, primitive, .. } = best;
        b.if_(primitive.ne(NONE) & !self.any_hit, whole, |_| Hit { primitive, ..Hit::miss(t) })
    }

    /// An inner node: goes on with the child that is entered first, or pops if none is; the others wait on the stack.
    fn inner(
        self,
        b: &mut Block,
        node: Child,
        top: U32,
        best: Best,
        go_on: Exit<(Child, U32, Best)>,
        pop: Exit<(U32, Best)>,
    ) -> Left {
        let [near, far] = [self.line.near, self.line.far].map(|at| node.planes(b, at));
        let span = (self.tests.span)(self.line, near, far);
        let entered = span.is_entered(F32x4::splat(best.t));
        let ballot = entered.ballot();
        let others = lanes::without_lowest(ballot);
        let one = |b: &mut Block| {
            let child = node.child(b, lanes::lowest(ballot));
            go_on.take(b, (child, top, best))
        };
        // The lane in the two lowest bits of its entry; whoever compares the entry rounds it down again.
        let keys = (span.entry.bits() & Vector::splat(!3)) | Vector::new([0, 1, 2, 3].map(U32::from));
        let or_last = entered.select(keys, Vector::splat(u32::MAX));
        let two = |b: &mut Block| {
            let near = node.child(b, lanes::smallest(or_last) & 3);
            let top = self.push(b, node, top, lanes::largest(entered.select(keys, Vector::splat(0))));
            go_on.take(b, (near, top, best))
        };
        let more = |b: &mut Block| {
            let [first, second, third, fourth] = lanes::sorted(or_last);
            let top = b.if_(fourth.ne(u32::MAX), |b| self.push(b, node, top, fourth), |_| top);
            let top = self.push(b, node, top, third);
            let top = self.push(b, node, top, second);
            let child = node.child(b, first & 3);
            go_on.take(b, (child, top, best))
        };
        let some =
            |b: &mut Block| b.branch(others.eq(0), one, |b| b.branch(lanes::without_lowest(others).eq(0), two, more));
        b.branch(ballot.eq(0), |b| pop.take(b, (top, best)), some)
    }

    /// Leave the child of this key for later.
    fn push(self, b: &mut Block, node: Child, top: U32, key: U32) -> U32 {
        let child = node.child(b, key & 3);
        self.stack.push(b, top, child, (key & !3).float_of_bits())
    }

    /// A leaf: the best hit after its triangles; leaves by `done` where any hit will do.
    fn leaf(self, b: &mut Block, block: U32, best: Best, done: Exit<Best>) -> Best {
        let corners = triangle::read_corners(b, block, self.line);
        let meeting = (self.tests.meet)(self.line, corners);
        let meets = |b: &mut Block| {
            let primitives = triangle::read_primitives(b, block);
            let wins = meeting.is_inside & meeting.counts & self.is_better(meeting.t, primitives, best);
            let ballot = wins.ballot();
            let some = |b: &mut Block| {
                let has_cutouts = Row::at(0u32).get(Settings::HAS_CUTOUTS);
                let nearest = |_: &mut Block| nearest(block, wins, meeting.t, primitives);
                let best = b.if_(has_cutouts, |b| self.accepted(b, block, ballot, best), nearest);
                b.when(self.any_hit & best.primitive.ne(NONE), |b| done.take(b, best));
                best
            };
            b.if_(ballot.ne(0), some, |_| best)
        };
        b.if_(meeting.is_inside.ballot().ne(0), meets, |_| best)
    }

    /// Are they in range, not to be skipped, and better than the best: nearer, or as near and of smaller number?
    fn is_better(self, t: F32x4, primitives: Vector<U32, 4>, best: Best) -> Bool4 {
        let Ray { tmax, skip, skip1, skip2, .. } = self.ray;
        let is = |number: U32| primitives.eq(Vector::splat(number));
        let limit = F32x4::splat(best.t);
        let closer = t.lt(limit) | (t.eq(limit) & primitives.lt(Vector::splat(best.primitive)));
        let skipped = is(skip) | is(skip1) | is(skip2);
        skipped.select(Vector::splat(false), closer & t.lt(F32x4::splat(tmax)))
    }

    /// The best hit after those of a ballot, one by one, where they may not count.
    fn accepted(self, b: &mut Block, block: U32, ballot: U32, best: Best) -> Best {
        let step = |b: &mut Block, (ballot, best): (U32, Best)| {
            let slot = block + lanes::lowest(ballot);
            let primitive = triangle::read_primitive(b, slot);
            let hit = self.hit(b, slot, primitive);
            let closer = hit.t.lt(best.t) | (hit.t.eq(best.t) & primitive.lt(best.primitive));
            let counts = b.if_(closer, |b| self.accept.call(b, (self.ray, hit)), |_| Bool::from(false));
            (lanes::without_lowest(ballot), counts.select(Best { t: hit.t, primitive, slot }, best))
        };
        b.while_((ballot, best), |_, (ballot, _)| ballot.ne(0), step).1
    }

    /// All of the hit on one triangle.
    fn hit(self, b: &mut Block, slot: U32, primitive: U32) -> Hit {
        let corners = triangle::read_corners_of(b, slot, self.line);
        let Meeting { t, u, v, .. } = (self.tests.meet)(self.line, corners);
        Hit { primitive, t: t.extract(0), u: u.extract(0), v: v.extract(0) }
    }
}

/// The nearest of some hits, of equally near ones that of smallest number.
fn nearest(block: U32, among: Bool4, t: F32x4, primitives: Vector<U32, 4>) -> Best {
    // Distances are positive, so their bits are in the same order.
    let bits = lanes::smallest(among.select(t.bits(), Vector::splat(u32::MAX)));
    let ties = among & t.bits().eq(Vector::splat(bits));
    let primitive = lanes::smallest(ties.select(primitives, Vector::splat(NONE)));
    let lane = lanes::lowest((ties & primitives.eq(Vector::splat(primitive))).ballot());
    Best { t: bits.float_of_bits(), primitive, slot: block + lane }
}
