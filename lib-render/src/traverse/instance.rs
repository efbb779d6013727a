//! Instances: a leaf of the tree may be a tree of its own, which a walk enters with the ray in that tree's frame.
//!
//! The direction is transformed and not made unit, so t is the same in both frames, and what waits on the stack keeps its
//! place in the order of visits. *What a ray hits in an instance is a function of the ray, the instance and its triangles*, as
//! everywhere ([`crate::traverse`]): the instance has a box in the world, and what is in it counts only if the ray passes that
//! box, at no t before it is entered. So a box around the instance is entered no later than anything in it is hit.
//!
//! The ray's origin, its direction and the triangle test are off by (5 + 8 + 8) · 2^-24 of the farthest corner as seen in the
//! frame; seen in the world that is κ times as much, the condition of the transform, which is at most 8
//! (`host::tables::placing`). Boxes of a scene with instances grow by more than that.

use jerboa_ir::lang::{Block, Bool, F32, Row, U32, Vector};

use super::bvh::Child;
use super::line::{GROWTH, Line};
use super::memory::{Memory, float, word};
use super::walk::Walk;
use super::{F32x4, stack};
use crate::core::vec::{Vec3, vec3};
use crate::ray::Ray;
use crate::schema::{Settings, Tree};

/// Growth of boxes where there are instances: 256 · 2^-24 against the 8 · 21 · 2^-24 above.
const INSTANCES_GROWTH: f32 = 16.0 * GROWTH;
/// Words from an instance to the rows of the matrix that takes rays to its frame; its box comes first, as in a node.
const TO_FRAME: u32 = 24;
/// To where zero comes to, world.
const ZERO: u32 = 33;
/// To where its tree begins: a box around all of it, then the root.
const TREE: u32 = 36;
/// To the number of its first primitive.
const FIRST: u32 = 37;
/// Words from the box around a tree to its root.
const ROOT: u32 = 8;

/// Does the scene have any?
pub(super) fn are_there() -> Bool {
    Row::<Settings>::at(0u32).get(Settings::HAS_INSTANCES)
}

/// A ray made ready for the world.
pub(super) fn world_line(b: &mut Block, ray: Ray) -> Line {
    let growth = are_there().select(F32::from(INSTANCES_GROWTH), GROWTH.into());
    Line::new(b, ray, 0.into(), growth)
}

/// Begin in the world.
pub(super) fn begin(b: &mut Block, memory: Memory) {
    b.when(are_there(), |b| {
        memory.set_word(b, word::BEST_INSTANCE, 0);
        in_world(b, memory);
    });
}

/// The walk is in no instance.
fn in_world(b: &mut Block, memory: Memory) {
    memory.set_word(b, word::INSTANCE, 0);
    memory.set_float(b, float::FLOOR, 0.0.into());
}

/// The numbers of primitives that have these in the tree that the walk is in: those of an instance follow each other.
pub(super) fn numbers(b: &mut Block, memory: Memory, here: Vector<U32, 4>) -> Vector<U32, 4> {
    let placed = |b: &mut Block| here + Vector::splat(first_number(b, memory));
    b.if_(are_there(), placed, |_| here)
}

/// The number of one.
pub(super) fn number(b: &mut Block, memory: Memory, here: U32) -> U32 {
    let placed = |b: &mut Block| here + first_number(b, memory);
    b.if_(are_there(), placed, |_| here)
}

fn first_number(b: &mut Block, memory: Memory) -> U32 {
    let instance = memory.word(b, word::INSTANCE);
    b.if_(instance.eq(0), |_| U32::from(0), |b| b.read_unchecked(Tree::WORD, instance + FIRST))
}

/// Distances, not before the instance is entered that the walk is in.
pub(super) fn not_before(b: &mut Block, memory: Memory, t: F32x4) -> F32x4 {
    let later = |b: &mut Block| F32x4::splat(memory.float(b, float::FLOOR)).max(t);
    b.if_(are_there(), later, |_| t)
}

/// One of them.
pub(super) fn one_not_before(b: &mut Block, memory: Memory, t: F32) -> F32 {
    let later = |b: &mut Block| memory.float(b, float::FLOOR).max(t);
    b.if_(are_there(), later, |_| t)
}

/// Visit an instance, or go back from one: gives the child that is next.
pub(super) fn visit(b: &mut Block, walk: Walk, child: Child, ray: Ray) -> Child {
    let memory = walk.memory;
    let back = |b: &mut Block| {
        let line = world_line(b, ray);
        line.keep(b, memory);
        in_world(b, memory);
        walk.next(b)
    };
    let enter = |b: &mut Block| {
        let instance = child.instance();
        let line = Line::kept(b, memory);
        let limit = memory.float(b, float::T);
        let [near, far] = [line.near, line.far].map(|at| instance.planes(b, at));
        let span = (walk.tests.span)(line, near, far, F32x4::splat(limit));
        let inside = |b: &mut Block| {
            stand_in(b, memory, instance.word, ray);
            memory.set_word(b, word::INSTANCE, instance.word);
            memory.set_float(b, float::FLOOR, span.entry.extract(0));
            let top = memory.word(b, word::TOP);
            let top = stack::push(b, memory, top, Child::way_back(), 0.0.into());
            memory.set_word(b, word::TOP, top);
            Child { word: tree(b, instance.word) + ROOT }
        };
        b.if_(span.is_entered().extract(0), inside, |b| walk.next(b))
    };
    b.if_(child.is_way_back(), back, enter)
}

/// Make the ray ready for the frame of an instance again, if the best hit is in one.
pub(super) fn stand_at_best(b: &mut Block, memory: Memory, ray: impl Fn(&mut Block) -> Ray) {
    b.when(are_there(), |b| {
        let instance = memory.word(b, word::BEST_INSTANCE);
        b.when(instance.ne(0), |b| {
            let ray = ray(b);
            stand_in(b, memory, instance, ray);
        });
    });
}

/// Note where the best hit is.
pub(super) fn found(b: &mut Block, memory: Memory, is_new: Bool) {
    b.when(are_there(), |b| {
        let [here, before] = [word::INSTANCE, word::BEST_INSTANCE].map(|place| memory.word(b, place));
        memory.set_word(b, word::BEST_INSTANCE, is_new.select(here, before));
    });
}

/// Make the ray ready for the frame of an instance.
fn stand_in(b: &mut Block, memory: Memory, instance: U32, ray: Ray) {
    let mut vector = |at: u32| -> Vec3 {
        let [x, y, z] = [0, 1, 2].map(|k| b.read_unchecked::<_, U32>(Tree::WORD, instance + (at + k)).float_of_bits());
        vec3(x, y, z)
    };
    let [x, y, z] = [0, 3, 6].map(|row| vector(TO_FRAME + row));
    let zero = vector(ZERO);
    let to_frame = |v: Vec3| vec3(x.dot(v), y.dot(v), z.dot(v));
    let ray = Ray { org: to_frame(ray.org - zero), dir: to_frame(ray.dir), ..ray };
    let around = tree(b, instance);
    let line = Line::new(b, ray, around, GROWTH.into());
    line.keep(b, memory);
}

/// Where the tree of an instance begins.
fn tree(b: &mut Block, instance: U32) -> U32 {
    b.read_unchecked(Tree::WORD, instance + TREE)
}
