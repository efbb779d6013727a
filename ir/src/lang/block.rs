//! The cursor: where control is. Each structured statement closes the current continuation and goes on in a new one.

use std::marker::PhantomData;

use crate::lang::staged::Staged;
use crate::lang::value::Bool;
use crate::lang::{always, with};
use crate::program::{Body, ContId, Loc, Mode, NodeId, Role};

/// The path that is being written: a continuation without a body yet.
///
/// Closures take the cursor as an argument (`|b| …`), so the borrow checker refuses the outer one inside a branch.
pub struct Block {
    cont: ContId,
    /// The next join is copied per branch.
    pub(crate) per_branch: bool,
}

/// Proof that a path has left through an exit: what `take` returns and a branch may end in.
pub struct Left(PhantomData<()>);

impl Left {
    pub(crate) fn new() -> Left {
        Left(PhantomData)
    }
}

/// How a branch ends: with a value of `T`, or by having [`Left`].
pub trait Ends<T> {
    /// Close the block: pass the value on to `to`, if there is one. `why` is passed first where the target asks for it.
    #[doc(hidden)]
    fn end(self, b: Block, to: NodeId, why: Option<Bool>, loc: Loc);
}

impl<T: Staged> Ends<T> for T {
    fn end(self, mut b: Block, to: NodeId, why: Option<Bool>, loc: Loc) {
        let mut args: Vec<NodeId> = why.into_iter().map(Bool::node).collect();
        self.flatten(&mut args);
        b.leave(Body::Jump { callee: to, args, mode: Mode::Filter }, loc);
    }
}

impl<T: Staged> Ends<T> for Left {
    fn end(self, _: Block, _: NodeId, _: Option<Bool>, _: Loc) {}
}

impl Block {
    pub(crate) fn new(cont: ContId) -> Block {
        Block { cont, per_branch: false }
    }

    /// Close this path with a jump.
    pub(crate) fn leave(&mut self, body: Body, loc: Loc) {
        with(|w| w.set_body(self.cont, body, loc));
    }

    /// A continuation that takes a `T`, and the value it gets.
    pub(crate) fn continuation<T: Staged>(name: &str, role: Role, filter: Bool, loc: Loc) -> (ContId, T) {
        let params = T::all_params("");
        with(|w| {
            let cont = w.cont(name, role, params, loc);
            w.cont_mut(cont).filter = filter.node();
            let nodes = w.params(cont);
            (cont, T::unflatten(&mut nodes.into_iter()))
        })
    }

    /// An arm: a continuation without parameters, written by `body`, that ends in `join`.
    pub(crate) fn arm<T, E: Ends<T>>(name: &str, body: impl FnOnce(&mut Block) -> E, join: NodeId, loc: Loc) -> NodeId {
        let (cont, ()) = Block::continuation("", Role::Arm, always(), loc);
        with(|w| w.cont_mut(cont).name = name.into());
        let mut b = Block::new(cont);
        // The cursor may have moved on: what is closed at the end is where it stands then.
        let end = body(&mut b);
        end.end(b, join, None, loc);
        with(|w| w.cont_value(cont))
    }

    /// Let the next `if_`, `switch` or `dispatch` copy what follows into each branch. Copies multiply; use it only
    /// where different functions must meet.
    pub fn per_branch(&mut self) -> &mut Block {
        self.per_branch = true;
        self
    }

    /// The filter of a join: it unfolds where the branch was decided.
    pub(crate) fn join_filter(&mut self, decided: Bool) -> Bool {
        if std::mem::take(&mut self.per_branch) { always() } else { decided }
    }
}
