//! What construction folds. The law: a fold gives the very bits that running gives (Law 3).
//!
//! So an operation over literals is [`Op::eval`], and the identities below hold for every input, signed zeros,
//! infinities and NaN included. Not here, because they are false for some float: x·0 → 0, x−x → 0, x+0 → x (−0),
//! 0−x → −x, x/x → 1, a/b → a·(1/b), and every reassociation.

use crate::lit::Lit;
use crate::op::Op;
use crate::program::{Node, NodeId};
use crate::world::World;

/// What folding found: a literal or a node that is there already.
pub(crate) enum Folded {
    Lit(Lit),
    Node(NodeId),
}

/// Fold an operation over scalars, or say that it stays.
pub(crate) fn fold(w: &World, op: Op, args: &[NodeId]) -> Option<Folded> {
    let mut lits = [None; 3];
    lits.iter_mut().zip(args).for_each(|(lit, a)| *lit = w.program().as_lit(*a));
    let lits = &lits[..args.len()];
    if lits.iter().all(Option::is_some) {
        let lits: Vec<Lit> = lits.iter().copied().flatten().collect();
        return Some(Folded::Lit(op.eval(&lits)));
    }
    identity(w, op, args, lits)
}

/// Identities of one known or two equal operands.
fn identity(w: &World, op: Op, args: &[NodeId], lits: &[Option<Lit>]) -> Option<Folded> {
    let node = |i: usize| Some(Folded::Node(args[i]));
    let lit = |l: Lit| Some(Folded::Lit(l));
    let is = |i: usize, l: Lit| lits.get(i).copied().flatten() == Some(l);
    let zero = |i: usize| is(i, Lit::I32(0)) || is(i, Lit::U32(0));
    let one = |i: usize| is(i, Lit::I32(1)) || is(i, Lit::U32(1)) || is(i, Lit::f32(1.0));
    let ones = |i: usize| is(i, Lit::I32(-1)) || is(i, Lit::U32(u32::MAX)) || is(i, Lit::Bool(true));
    let none = |i: usize| zero(i) || is(i, Lit::Bool(false));
    let same = |i: usize, j: usize| args[i] == args[j];
    let float = w.program().ty(args[0]) == crate::ty::Ty::f32();
    match op {
        Op::Add if zero(1) || is(1, Lit::f32(-0.0)) => node(0),
        Op::Add if zero(0) || is(0, Lit::f32(-0.0)) => node(1),
        Op::Sub if zero(1) || is(1, Lit::f32(0.0)) => node(0),
        Op::Mul | Op::Div if one(1) => node(0),
        Op::Mul if one(0) => node(1),
        Op::Mul if zero(0) => node(0),
        Op::Mul if zero(1) => node(1),
        Op::Absorb if [0, 1].into_iter().any(|i| is(i, Lit::f32(0.0)) || is(i, Lit::f32(-0.0))) => lit(Lit::f32(0.0)),
        Op::Min | Op::Max if same(0, 1) => node(0),
        Op::And if none(0) || ones(1) || same(0, 1) => node(0),
        Op::And if none(1) || ones(0) => node(1),
        Op::Or if ones(0) || none(1) || same(0, 1) => node(0),
        Op::Or if ones(1) || none(0) => node(1),
        Op::Xor if none(1) => node(0),
        Op::Xor if none(0) => node(1),
        Op::Shl | Op::Shr if zero(1) => node(0),
        Op::Eq | Op::Le | Op::Ge if same(0, 1) && !float => lit(Lit::Bool(true)),
        Op::Ne | Op::Lt | Op::Gt if same(0, 1) => (!float || op != Op::Ne).then_some(Folded::Lit(Lit::Bool(false))),
        Op::Select if same(1, 2) => node(1),
        Op::Select if is(0, Lit::Bool(true)) => node(1),
        Op::Select if is(0, Lit::Bool(false)) => node(2),
        Op::Not | Op::Neg => undo(w, op, args[0]).map(Folded::Node),
        _ => None,
    }
}

/// `not (not x)` and `neg (neg x)` are x.
fn undo(w: &World, op: Op, x: NodeId) -> Option<NodeId> {
    match w.program().node(x) {
        Node::Prim { op: inner, args } if *inner == op => Some(args[0]),
        _ => None,
    }
}
