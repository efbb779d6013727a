//! A walk of the tree, step by step.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, F32, Row, U32, Vector};

use super::bvh::Child;
use super::instance;
use super::line::{Line, is_usable};
use super::memory::{Memory, float, word};
use super::triangle::{self, Meeting};
use super::{AcceptFn, Bool4, F32x4, Tests, lanes, stack};
use crate::ray::{Hit, Ray};
use crate::schema::{NONE, Settings};

/// The best hit so far. Its weights wait until the walk has ended.
#[derive(Clone, Copy)]
struct Best {
    /// See [`Hit::t`]; where there is no hit, the end of the ray's range.
    t: F32,
    /// See [`Hit::primitive`]; 0 where there is no hit, so that none at the end of the range is better.
    primitive: U32,
    /// The first word of the triangle in its block; 0 where there is no hit.
    slot: U32,
}
impl_staged!(Best { t, primitive, slot });

/// A walk.
#[derive(Clone, Copy)]
pub(super) struct Walk {
    /// What it asks of boxes and triangles.
    pub tests: Tests,
    /// Is any hit as good as the nearest?
    pub any_hit: Bool,
    /// All else.
    pub memory: Memory,
}

impl Walk {
    /// Begin a walk: gives the child to visit first; nothing where the ray hits nothing for sure.
    pub fn start(self, b: &mut Block, ray: Ray) -> Child {
        self.memory.set_word(b, word::TOP, 0);
        self.set_best(b, Best { t: ray.tmax, primitive: 0.into(), slot: 0.into() });
        let line = instance::world_line(b, ray);
        line.keep(b, self.memory);
        instance::begin(b, self.memory);
        is_usable(ray).select(Child::root(), Child::nothing())
    }

    fn best(self, b: &mut Block) -> Best {
        let Walk { memory, .. } = self;
        let [primitive, slot] = [word::PRIMITIVE, word::SLOT].map(|place| memory.word(b, place));
        Best { t: memory.float(b, float::T), primitive, slot }
    }

    fn set_best(self, b: &mut Block, best: Best) {
        self.memory.set_float(b, float::T, best.t);
        self.memory.set_word(b, word::PRIMITIVE, best.primitive);
        self.memory.set_word(b, word::SLOT, best.slot);
    }

    /// Visit an inner node: gives the child that is entered first, or what waits if none is; the others wait on the stack.
    pub fn inner(self, b: &mut Block, node: Child) -> Child {
        let line = Line::kept(b, self.memory);
        let limit = self.best(b).t;
        let [near, far] = [line.near, line.far].map(|at| node.planes(b, at));
        let span = (self.tests.span)(line, near, far, F32x4::splat(limit));
        let entered = span.is_entered();
        let ballot = entered.ballot();
        let others = lanes::without_lowest(ballot);
        let one = |b: &mut Block| node.child(b, lanes::lowest(ballot));
        // The lane in the two lowest bits of its entry; whoever compares the entry rounds it down again.
        let keys = (span.entry.bits() & Vector::splat(!3)) | Vector::new([0, 1, 2, 3].map(U32::from));
        let or_last = entered.select(keys, Vector::splat(u32::MAX));
        let two = |b: &mut Block| {
            let top = self.memory.word(b, word::TOP);
            let top = self.push(b, node, top, lanes::largest(entered.select(keys, Vector::splat(0))));
            self.memory.set_word(b, word::TOP, top);
            node.child(b, lanes::smallest(or_last) & 3)
        };
        let more = |b: &mut Block| {
            let [first, second, third, fourth] = lanes::sorted(or_last);
            let top = self.memory.word(b, word::TOP);
            let top = b.if_(fourth.ne(u32::MAX), |b| self.push(b, node, top, fourth), |_| top);
            let top = self.push(b, node, top, third);
            let top = self.push(b, node, top, second);
            self.memory.set_word(b, word::TOP, top);
            node.child(b, first & 3)
        };
        let some = |b: &mut Block| b.if_(others.eq(0), one, |b| b.if_(lanes::without_lowest(others).eq(0), two, more));
        b.if_(ballot.eq(0), |b| self.pop(b, limit), some)
    }

    /// Leave the child of this key for later.
    fn push(self, b: &mut Block, node: Child, top: U32, key: U32) -> U32 {
        let child = node.child(b, key & 3);
        stack::push(b, self.memory, top, child, (key & !3).float_of_bits())
    }

    /// What waits, if it is entered no later than this.
    fn pop(self, b: &mut Block, limit: F32) -> Child {
        let top = self.memory.word(b, word::TOP);
        let (child, top) = stack::pop(b, self.memory, top, limit);
        self.memory.set_word(b, word::TOP, top);
        child
    }

    /// What waits, if it is entered no later than the best hit.
    pub fn next(self, b: &mut Block) -> Child {
        let limit = self.best(b).t;
        self.pop(b, limit)
    }

    /// Visit a leaf: gives what is next, which is nothing where any hit will do and there is one. `asked` gives what is asked:
    /// the ray, and what counts.
    pub fn leaf(self, b: &mut Block, leaf: Child, asked: impl Fn(&mut Block) -> (Ray, AcceptFn)) -> Child {
        let instance = |b: &mut Block| {
            let (ray, _) = asked(b);
            instance::visit(b, self, leaf, ray)
        };
        let is_instance = instance::are_there() & leaf.is_instance();
        b.if_(is_instance, instance, |b| self.block(b, leaf.block(), &asked))
    }

    /// Visit a block of triangles.
    fn block(self, b: &mut Block, block: U32, asked: &impl Fn(&mut Block) -> (Ray, AcceptFn)) -> Child {
        let line = Line::kept(b, self.memory);
        let corners = triangle::read_corners(b, block, line);
        let is_inside = (self.tests.meet)(line, corners).is_inside;
        let limit = self.best(b).t;
        let meets = |b: &mut Block| {
            // What only the triangles' own boxes need is loaded here.
            let own = Line::kept(b, self.memory);
            let line = Line { org: line.org, shear: [line.shear[0], line.shear[1], own.shear[2]], ..own };
            let meeting = (self.tests.meet)(line, corners);
            let t = instance::not_before(b, self.memory, meeting.t);
            let (best, (ray, accept)) = (self.best(b), asked(b));
            let here = triangle::read_primitives(b, block);
            let primitives = instance::numbers(b, self.memory, here);
            let wins = meeting.is_inside & meeting.counts & is_better(ray, t, primitives, best);
            let ballot = wins.ballot();
            let some = |b: &mut Block| {
                let has_cutouts = Row::at(0u32).get(Settings::HAS_CUTOUTS);
                let accepted = |b: &mut Block| self.accepted(b, block, ballot, best, ray, accept);
                let new = b.if_(has_cutouts, accepted, |_| nearest(block, wins, t, primitives));
                self.set_best(b, new);
                instance::found(b, self.memory, new.slot.ne(best.slot) | new.primitive.ne(best.primitive));
                b.when(self.any_hit & new.slot.ne(0), |b| self.memory.set_word(b, word::TOP, 0));
                new.t
            };
            b.if_(ballot.ne(0), some, |_| limit)
        };
        let limit = b.if_(is_inside.ballot().ne(0), meets, |_| limit);
        self.pop(b, limit)
    }

    /// The best hit after those of a ballot, one by one, where they may not count.
    fn accepted(self, b: &mut Block, block: U32, ballot: U32, best: Best, ray: Ray, accept: AcceptFn) -> Best {
        let step = |b: &mut Block, (ballot, best): (U32, Best)| {
            let slot = block + lanes::lowest(ballot);
            let here = triangle::read_primitive(b, slot);
            let primitive = instance::number(b, self.memory, here);
            let hit = self.hit_on(b, slot, primitive);
            let hit = Hit { t: instance::one_not_before(b, self.memory, hit.t), ..hit };
            let closer = hit.t.lt(best.t) | (hit.t.eq(best.t) & primitive.lt(best.primitive));
            let counts = b.if_(closer, |b| accept.call(b, (ray, hit)), |_| Bool::from(false));
            (lanes::without_lowest(ballot), counts.select(Best { t: hit.t, primitive, slot }, best))
        };
        b.while_((ballot, best), |_, (ballot, _)| ballot.ne(0), step).1
    }

    /// What was found. `asked` gives the ray.
    pub fn hit(self, b: &mut Block, asked: impl Fn(&mut Block) -> Ray) -> Hit {
        let Best { t, primitive, slot } = self.best(b);
        let is_hit = slot.ne(0);
        let whole = |b: &mut Block| {
            instance::stand_at_best(b, self.memory, asked);
            Hit { t, ..self.hit_on(b, slot, primitive) }
        };
        let part = |_: &mut Block| Hit { primitive: is_hit.select(primitive, NONE.into()), ..Hit::miss(t) };
        b.if_(is_hit & !self.any_hit, whole, part)
    }

    /// All of the hit on one triangle.
    fn hit_on(self, b: &mut Block, slot: U32, primitive: U32) -> Hit {
        let line = Line::kept(b, self.memory);
        let corners = triangle::read_corners_of(b, slot, line);
        let Meeting { t, u, v, .. } = (self.tests.meet)(line, corners);
        Hit { primitive, t: t.extract(0), u: u.extract(0), v: v.extract(0) }
    }
}

/// Are they in range, not to be skipped, and better than the best: nearer, or as near and of smaller number?
fn is_better(ray: Ray, t: F32x4, primitives: Vector<U32, 4>, best: Best) -> Bool4 {
    let Ray { skip, skip1, skip2, .. } = ray;
    let is = |number: U32| primitives.eq(Vector::splat(number));
    let limit = F32x4::splat(best.t);
    let closer = t.lt(limit) | (t.eq(limit) & primitives.lt(Vector::splat(best.primitive)));
    let skipped = is(skip) | is(skip1) | is(skip2);
    skipped.select(Vector::splat(false), closer)
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
