//! Structured control: branches, loops, labels. All are sugar over continuations.

use crate::lang::block::{Block, Ends, Left};
use crate::lang::fun::{Exit, always, known, never};
use crate::lang::staged::Staged;
use crate::lang::value::{Bool, I32, U32};
use crate::lang::{Buf, Row, here, with};
use crate::program::{Body, Loc, Role};

/// An arm of a switch: its number and its body.
pub type Case<'a, T> = (u32, &'a dyn Fn(&mut Block) -> T);

/// The integers from `lo` up to, not including, `hi`.
#[derive(Clone, Copy)]
pub struct Range {
    lo: I32,
    hi: I32,
    unroll: bool,
}

/// The integers from `lo` up to, not including, `hi`.
pub fn range(lo: impl Into<I32>, hi: impl Into<I32>) -> Range {
    Range { lo: lo.into(), hi: hi.into(), unroll: false }
}

impl Range {
    /// Unroll where the evaluator knows both bounds.
    pub fn unroll(self) -> Range {
        Range { unroll: true, ..self }
    }
}

impl Block {
    /// `if cond { then } else { other }`. A branch gives a value or leaves.
    #[track_caller]
    pub fn if_<T: Staged, A: Ends<T>, B: Ends<T>>(
        &mut self,
        cond: impl Into<Bool>,
        then: impl FnOnce(&mut Block) -> A,
        other: impl FnOnce(&mut Block) -> B,
    ) -> T {
        let (cond, loc) = (cond.into(), here());
        let filter = self.join_filter(known(cond));
        let (join, value) = Block::continuation::<T>("join", Role::Join, filter, loc);
        let to = with(|w| w.cont_value(join));
        let then = Block::arm("then", then, to, loc);
        let other = Block::arm("else", other, to, loc);
        self.leave(Body::Branch { cond: cond.node(), then, other }, loc);
        *self = Block::new(join);
        value
    }

    /// `if cond { body }`.
    #[track_caller]
    pub fn when<E: Ends<()>>(&mut self, cond: impl Into<Bool>, body: impl FnOnce(&mut Block) -> E) {
        self.if_::<(), E, ()>(cond, body, |_| ())
    }

    /// `if cond { then } else { other }` where both leave.
    #[track_caller]
    pub fn branch(
        &mut self,
        cond: impl Into<Bool>,
        then: impl FnOnce(&mut Block) -> Left,
        other: impl FnOnce(&mut Block) -> Left,
    ) -> Left {
        let (cond, loc) = (cond.into(), here());
        // Neither arm reaches it.
        let nowhere = cond.node();
        let then = Block::arm::<(), Left>("then", then, nowhere, loc);
        let other = Block::arm::<(), Left>("else", other, nowhere, loc);
        self.leave(Body::Branch { cond: cond.node(), then, other }, loc);
        Left::new()
    }

    /// The arm whose number is `index`, else `default`. Arms are given in ascending order of their numbers.
    #[track_caller]
    pub fn switch<T: Staged>(&mut self, index: U32, arms: &[Case<'_, T>], default: impl FnOnce(&mut Block) -> T) -> T {
        let loc = here();
        let filter = self.join_filter(known(index));
        let (join, value) = Block::continuation::<T>("join", Role::Join, filter, loc);
        let to = with(|w| w.cont_value(join));
        let arms = arms.iter().map(|(n, arm)| (*n, Block::arm(&format!("case_{n}"), arm, to, loc))).collect();
        let default = Block::arm("default", default, to, loc);
        self.leave(Body::Switch { index: index.node(), arms, default }, loc);
        *self = Block::new(join);
        value
    }

    /// Do it with this row. The evaluator may run the body once per class of rows; inside, the class is then known.
    #[track_caller]
    pub fn dispatch<B: Buf, T: Staged>(&mut self, row: Row<B>, body: impl FnOnce(&mut Block, Row<B>) -> T) -> T {
        let loc = here();
        let filter = self.join_filter(known(row));
        let (join, value) = Block::continuation::<T>("join", Role::Join, filter, loc);
        let to = with(|w| w.cont_value(join));
        let (arm, inner) = Block::continuation::<Row<B>>("row", Role::Arm, always(), loc);
        let mut b = Block::new(arm);
        let end = body(&mut b, inner);
        end.end(b, to, None, loc);
        let arm = with(|w| w.cont_value(arm));
        self.leave(Body::Dispatch { row: row.node(), arm }, loc);
        *self = Block::new(join);
        value
    }

    /// Do it with this row, and do not come back: what [`Block::dispatch`] is made of.
    #[track_caller]
    pub fn dispatch_left<B: Buf>(&mut self, row: Row<B>, body: impl FnOnce(&mut Block, Row<B>) -> Left) -> Left {
        let loc = here();
        let (arm, inner) = Block::continuation::<Row<B>>("row", Role::Arm, always(), loc);
        body(&mut Block::new(arm), inner);
        let arm = with(|w| w.cont_value(arm));
        self.leave(Body::Dispatch { row: row.node(), arm }, loc);
        Left::new()
    }

    /// Run `body` with a way out: `exit` leaves the block from anywhere inside, also from inner loops.
    #[track_caller]
    pub fn label<T: Staged, E: Ends<T>>(&mut self, body: impl FnOnce(&mut Block, Exit<T>) -> E) -> T {
        let loc = here();
        let (after, value) = Block::continuation::<T>("label", Role::Label, never(), loc);
        let to = with(|w| w.cont_value(after));
        let end = body(self, Exit::to(after));
        end.end(std::mem::replace(self, Block::new(after)), to, None, loc);
        value
    }

    /// The general loop: `body` goes on with `next` or leaves with `done`. The header stays in the residual.
    #[track_caller]
    pub fn loop_<S: Staged, T: Staged>(
        &mut self,
        state: S,
        body: impl FnOnce(&mut Block, S, Exit<S>, Exit<T>) -> Left,
    ) -> T {
        let loc = here();
        let (after, value) = Block::continuation::<T>("done", Role::Label, never(), loc);
        let (head, inner) = Block::continuation::<S>("loop", Role::Loop, never(), loc);
        let mut b = Block::new(head);
        body(&mut b, inner, Exit::to(head), Exit::to(after));
        let head = with(|w| w.cont_value(head));
        state.end(std::mem::replace(self, Block::new(after)), head, None, loc);
        value
    }

    /// `while cond(state) { state = body(state) }`; gives the last state.
    #[track_caller]
    pub fn while_<S: Staged>(
        &mut self,
        state: S,
        cond: impl FnOnce(&mut Block, S) -> Bool,
        body: impl FnOnce(&mut Block, S) -> S,
    ) -> S {
        self.iterate(state, |_| never(), cond, body, here())
    }

    /// `for i in range { acc = body(i, acc) }`; gives the last accumulator. Unrolled where the range says so and its
    /// bounds are known.
    #[track_caller]
    pub fn for_<S: Staged>(&mut self, range: Range, acc: S, body: impl FnOnce(&mut Block, I32, S) -> S) -> S {
        let Range { lo, hi, unroll } = range;
        let filter = |(i, _): (I32, S)| if unroll { known(i) & known(hi) } else { never() };
        let step = |b: &mut Block, (i, acc): (I32, S)| (i + 1, body(b, i, acc));
        self.iterate((lo, acc), filter, |_, (i, _)| i.lt(hi), step, here()).1
    }

    /// A loop whose header has a filter. The rest of the program is entered with the condition that ended the loop, and
    /// unfolds where that was known: so an unrolled loop loses nothing, and a loop that stays copies nothing.
    fn iterate<S: Staged>(
        &mut self,
        state: S,
        filter: impl FnOnce(S) -> Bool,
        cond: impl FnOnce(&mut Block, S) -> Bool,
        body: impl FnOnce(&mut Block, S) -> S,
        loc: Loc,
    ) -> S {
        let (after, (why, value)) = Block::continuation::<(Bool, S)>("done", Role::Label, never(), loc);
        let (head, inner) = Block::continuation::<S>("loop", Role::Loop, never(), loc);
        let filter = filter(inner);
        with(|w| {
            w.cont_mut(head).filter = filter.node();
            w.cont_mut(after).filter = known_node(w, why, loc);
        });
        let to_head = with(|w| w.cont_value(head));
        let to_after = with(|w| w.cont_value(after));
        let mut b = Block::new(head);
        let go_on = cond(&mut b, inner);
        let then = Block::arm("body", |b| body(b, inner), to_head, loc);
        let other = Block::arm::<(), Left>("exit", |b| leave_with(b, inner, to_after, go_on, loc), to_after, loc);
        b.leave(Body::Branch { cond: go_on.node(), then, other }, loc);
        state.end(std::mem::replace(self, Block::new(after)), to_head, None, loc);
        value
    }
}

fn known_node(w: &mut crate::World, x: Bool, loc: Loc) -> crate::NodeId {
    w.known(x.node(), loc)
}

/// Leave a loop, telling the continuation which condition ended it.
fn leave_with<S: Staged>(b: &mut Block, state: S, to: crate::NodeId, why: Bool, loc: Loc) -> Left {
    let here = std::mem::replace(b, Block::new(crate::ContId(u32::MAX)));
    state.end(here, to, Some(why), loc);
    Left::new()
}
