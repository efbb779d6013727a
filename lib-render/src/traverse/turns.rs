//! Walks that take turns.
//!
//! A ray with no neighbours waits for memory at every step. So some rays are under way at a time, a step each in turn, and
//! a step ends with a look at what the walk's next one needs: no one waits for that look, and by the walk's turn it is there.

use jerboa_ir::lang::{Block, Bool, U32};

use super::bvh::Child;
use super::memory::{Memory, WALK, word};
use super::walk::Walk;
use super::{AcceptFn, Tests};
use crate::ray::{Hit, Ray};
use crate::schema::{NONE, Tree};

/// Walks under way; a power of two.
const TURNS: u32 = 4;

/// What a row asks.
#[derive(Clone, Copy)]
pub struct Question {
    /// Does it ask anything?
    pub is_asked: Bool,
    /// What does this ray hit?
    pub ray: Ray,
    /// See [`AcceptFn`].
    pub accept: AcceptFn,
}

/// Answer the questions of a range of rows, as [`super::TraverseFn`] answers them one by one, in any order. `ask` may be
/// asked the same again.
pub fn trace(
    b: &mut Block,
    (lo, hi): (U32, U32),
    any_hit: bool,
    ask: impl Fn(&mut Block, U32) -> Question,
    answer: impl Fn(&mut Block, U32, Hit),
) {
    let first = Memory::new(b, TURNS);
    let walk = |start: U32| Walk { tests: Tests::default(), any_hit: any_hit.into(), memory: first.starting(start) };
    for number in 0..TURNS {
        let Walk { memory, .. } = walk((number * WALK).into());
        memory.set_word(b, word::CHILD, Child::nothing().word);
        memory.set_word(b, word::ROW, NONE);
    }
    first.set_word(b, word::NEXT, lo);
    first.set_word(b, word::ANSWERED, lo);
    let has_answered = |b: &mut Block| {
        let answered = first.word(b, word::ANSWERED);
        first.set_word(b, word::ANSWERED, answered + 1u32);
    };

    // Where the walk begins whose turn it is.
    b.loop_(U32::from(0), |b, turn, go_on, done| {
        let walk = walk(turn & ((TURNS - 1) * WALK));
        let memory = walk.memory;
        let child = Child { word: memory.word(b, word::CHILD) };
        let ended = |b: &mut Block| {
            let row = memory.word(b, word::ROW);
            b.when(row.ne(NONE), |b| {
                let hit = walk.hit(b, |b| ask(b, row).ray);
                answer(b, row, hit);
                memory.set_word(b, word::ROW, NONE);
                has_answered(b);
            });
            let next = first.word(b, word::NEXT);
            b.when(next.lt(hi), |b| {
                first.set_word(b, word::NEXT, next + 1u32);
                let Question { is_asked, ray, .. } = ask(b, next);
                let start = |b: &mut Block| {
                    memory.set_word(b, word::ROW, next);
                    let root = walk.start(b, ray);
                    memory.set_word(b, word::CHILD, root.word);
                };
                b.if_(is_asked, start, has_answered);
            });
            let answered = first.word(b, word::ANSWERED);
            b.branch(answered.lt(hi), |b| go_on.take(b, turn + WALK), |b| done.take(b, ()))
        };
        let visited = |b: &mut Block, next: Child| {
            memory.set_word(b, word::CHILD, next.word);
            look(b, next, memory);
            go_on.take(b, turn + WALK)
        };
        let leaf = |b: &mut Block| {
            let next = walk.leaf(b, child, |b| {
                let row = memory.word(b, word::ROW);
                let Question { ray, accept, .. } = ask(b, row);
                (ray, accept)
            });
            visited(b, next)
        };
        let inner = |b: &mut Block| {
            let next = walk.inner(b, child);
            visited(b, next)
        };
        b.branch(child.is_leaf(), |b| b.branch(child.is_nothing(), ended, leaf), inner)
    });
}

/// Look at a node or a block.
fn look(b: &mut Block, child: Child, memory: Memory) {
    let word: U32 = b.read_unchecked(Tree::WORD, child.block());
    // Only what is stored is loaded.
    memory.set_word(b, word::LOOK, word);
}
