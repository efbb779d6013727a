//! What a ray hits (paper, section 4.6): a walk of the tree of boxes, for the nearest hit and for any hit.
//!
//! *The hit is a function of the ray, the triangles and `accept`*: of all accepted triangles in range the one of smallest
//! computed t, then of smallest number. No tree can change it. A triangle counts only if the ray passes its own box too,
//! and its t is never less than the entry of that box ([`triangle`]). The entry and exit of a box are monotone: a box
//! around another one is entered no later and left no earlier, in floats as in the reals ([`bvh`]). So every box around
//! a triangle that could win is entered at or before its t, and a box is passed over only if its entry exceeds the best t.

use jerboa_ir::lang::{Block, Bool, Exit, Fun, Keep, Row, U32, never};

use crate::ray::{Hit, Ray};
use crate::schema::{Settings, Triangles};

pub mod bvh;
pub mod stack;
pub mod triangle;

use bvh::{Child, Slabs};
use stack::Stack;
use triangle::Shear;

/// (ray, hit) → does it count? A pure function, asked only where the scene has cut-outs and the hit would win.
pub type AcceptFn = Fun<(Ray, Hit), Bool>;

/// (ray; is any hit as good as the nearest?; accept) → hit. Where any hit is, only [`Hit::is_hit`] has a meaning. A ray
/// with a coordinate that is not finite, or without a direction, hits nothing.
pub type TraverseFn = Fun<(Ray, Keep<Bool>, AcceptFn), Hit>;

/// The traversal. It stays a call: a kernel has one copy for the nearest hit and one for any hit.
pub fn make_traverse() -> TraverseFn {
    let body = |b: &mut Block, _, (ray, Keep(any_hit), accept): (Ray, Keep<Bool>, AcceptFn)| {
        let walk = |b: &mut Block| Walk::new(b, ray, any_hit, accept).run(b);
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

/// What stays the same on a walk.
#[derive(Clone, Copy)]
struct Walk {
    ray: Ray,
    any_hit: Bool,
    accept: AcceptFn,
    slabs: Slabs,
    shear: Shear,
    stack: Stack,
}

impl Walk {
    fn new(b: &mut Block, ray: Ray, any_hit: Bool, accept: AcceptFn) -> Walk {
        Walk { ray, any_hit, accept, slabs: Slabs::new(ray), shear: Shear::new(ray), stack: Stack::new(b) }
    }

    /// Visit children, the nearer one first, until none is left.
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

    /// An inner node: the child to go on with, or nothing; if both are entered, the farther one waits on the stack.
    fn inner(self, b: &mut Block, node: Child, top: U32, best: Hit) -> (Child, U32) {
        let [first, second] = bvh::read_children(b, node).map(|(bounds, child)| {
            let span = self.slabs.span(bounds);
            (child, span.entry, span.entry.le(span.exit.min(best.t)))
        });
        let both = |b: &mut Block| {
            let swap = second.1.lt(first.1);
            let ((near, _), (far, entry)) = (
                swap.select((second.0, second.1), (first.0, first.1)),
                swap.select((first.0, first.1), (second.0, second.1)),
            );
            (near, self.stack.push(b, top, far, entry))
        };
        let one = |_: &mut Block| (first.2.select(first.0, second.2.select(second.0, Child::nothing())), top);
        b.if_(first.2 & second.2, both, one)
    }

    /// A leaf: the best hit after its triangles; leaves by `done` where any hit will do.
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

    /// The better one of the triangle in this slot and the best hit so far.
    fn triangle(self, b: &mut Block, slot: U32, best: Hit) -> Hit {
        let corners = triangle::read_corners(b, slot);
        let edges = self.shear.edges(self.ray, corners);
        let meets = |b: &mut Block| {
            let primitive = b.read_unchecked(Triangles::PRIMITIVE, slot);
            let (hit, counts) = edges.hit(self.slabs, corners, primitive);
            let Ray { skip, skip1, skip2, .. } = self.ray;
            let skipped = primitive.eq(skip) | primitive.eq(skip1) | primitive.eq(skip2);
            let closer = hit.t.lt(best.t) | (hit.t.eq(best.t) & primitive.lt(best.primitive));
            let wins = counts & !skipped & hit.t.lt(self.ray.tmax) & closer;
            b.if_(wins, |b| self.is_accepted(b, hit).select(hit, best), |_| best)
        };
        b.if_(edges.is_inside(), meets, |_| best)
    }

    /// Does the hit count? Without cut-outs nothing is asked.
    fn is_accepted(self, b: &mut Block, hit: Hit) -> Bool {
        let has_cutouts = Row::at(0u32).get(Settings::HAS_CUTOUTS);
        b.if_(has_cutouts, |b| self.accept.call(b, (self.ray, hit)), |_| Bool::from(true))
    }
}
