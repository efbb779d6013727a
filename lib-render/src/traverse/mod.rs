//! What a ray hits (paper, section 4.6): a walk of the tree of boxes, for the nearest hit and for any hit.
//!
//! A node has four boxes and a leaf four triangles, tested at once ([`bvh`], [`triangle`]); of the boxes that are entered the
//! walk goes on with the nearest, the others wait on the [`stack`]. A kernel has one ray at a time ([`make_traverse`]) or
//! several that take [`turns`]; what a walk remembers lies in local [`memory`]. A leaf may be an `instance`, with a tree of
//! its own.
//!
//! *The hit is a function of the ray, the triangles and `accept`*: of all accepted triangles in range the one of smallest
//! computed t, then of smallest number. No tree can change it. A triangle counts only if the ray passes its own box too,
//! and its t is never less than the entry of that box ([`triangle`]). The entry and exit of a box are monotone: a box
//! around another one is entered no later and left no earlier, in floats as in the reals ([`bvh`]). So every box around
//! a triangle that could win is entered at or before its t, and a box is passed over only if its entry exceeds the best t.

use jerboa_ir::lang::{Block, Bool, F32, Fun, Keep, Vector, never};

use crate::ray::{Hit, Ray};

pub mod line;
pub mod bvh;
pub mod triangle;
pub mod stack;
pub mod memory;
mod instance;
mod lanes;
mod walk;
pub mod turns;

use bvh::Span;
use line::Line;
use memory::Memory;
use triangle::{Corners, Meeting};
use walk::Walk;

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
    /// (line, planes on its side, planes on the other, limit) → where it enters and leaves.
    pub span: fn(Line, [F32x4; 3], [F32x4; 3], F32x4) -> Span,
    /// (line, corners) → where it meets the triangles.
    pub meet: fn(Line, Corners) -> Meeting,
}

impl Default for Tests {
    fn default() -> Tests {
        Tests { span: bvh::span, meet: triangle::meet }
    }
}

/// The traversal. It stays a call: a kernel has one copy for the nearest hit and one for any hit.
pub fn make_traverse() -> TraverseFn {
    make_traverse_with(Tests::default())
}

/// The traversal by these tests.
pub fn make_traverse_with(tests: Tests) -> TraverseFn {
    let body = move |b: &mut Block, _, (ray, Keep(any_hit), accept): (Ray, Keep<Bool>, AcceptFn)| {
        let memory = Memory::new(b, 1);
        traverse_here(b, tests, memory, (ray, any_hit, accept))
    };
    TraverseFn::rec("traverse", |_| never(), body)
}

/// The traversal, written out where it is asked for, for the nearest hit or any hit, as is known or not.
pub fn traverse_here(
    b: &mut Block,
    tests: Tests,
    memory: Memory,
    (ray, any_hit, accept): (Ray, Bool, AcceptFn),
) -> Hit {
    let walk = Walk { tests, any_hit, memory };
    let root = walk.start(b, ray);
    b.loop_(root, |b, child, go_on, done| {
        let leaf = |b: &mut Block| {
            let visit = |b: &mut Block| {
                let child = walk.leaf(b, child, |_| (ray, accept));
                go_on.take(b, child)
            };
            b.branch(child.is_nothing(), |b| done.take(b, ()), visit)
        };
        let inner = |b: &mut Block| {
            let child = walk.inner(b, child);
            go_on.take(b, child)
        };
        b.branch(child.is_leaf(), leaf, inner)
    });
    walk.hit(b, |_| ray)
}
