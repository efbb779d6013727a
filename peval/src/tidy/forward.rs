//! Law: a block that only passes its parameters on is where it passes them to.
//!
//! So a call whose return only returns becomes a tail call, and an empty arm becomes its join. A branch whose sides are
//! the same block, or whose condition other passes have made known, is a jump; so is a `vectorize` of no iteration.

use jerboa_ir::*;
use rustc_hash::FxHashMap;

use super::draft::{Draft, Mention, Subst};

pub(crate) fn run(draft: &mut Draft) -> u64 {
    pass_on(draft, false) + same_sides(draft) + pass_on(draft, true)
}

/// Branches and switches that do not matter, or are decided.
fn same_sides(draft: &mut Draft) -> u64 {
    let mut changes = 0;
    for c in draft.order() {
        let known = match *draft.body(c) {
            Body::Branch { cond: x, .. } | Body::Switch { index: x, .. } => draft.p().as_lit(x).map(Lit::word),
            _ => None,
        };
        let empty = match *draft.body(c) {
            Body::Vectorize { lo, hi, .. } => {
                let bound = |x| draft.p().as_lit(x).and_then(Lit::as_u32);
                bound(lo).zip(bound(hi)).is_some_and(|(lo, hi)| lo >= hi)
            }
            _ => false,
        };
        let to = match &mut draft.world.cont_mut(c).body {
            Body::Vectorize { next, .. } if empty => *next,
            Body::Branch { then, other, .. } if then == other => *then,
            Body::Branch { then, other, .. } if known.is_some() => {
                if known == Some(0) {
                    *other
                } else {
                    *then
                }
            }
            Body::Switch { arms, default, .. } if known.is_some() => {
                arms.iter().find(|(number, _)| known == Some(*number)).map_or(*default, |(_, arm)| *arm)
            }
            Body::Switch { arms, default, .. } => {
                let before = arms.len();
                arms.retain(|(_, arm)| arm != default);
                changes += (before - arms.len()) as u64;
                if !arms.is_empty() {
                    continue;
                }
                *default
            }
            _ => continue,
        };
        draft.world.cont_mut(c).body = Body::Jump { callee: to, args: vec![], mode: Mode::Filter };
        changes += 1;
    }
    changes
}

/// To blocks, or to returns: one after the other, since an arm may become a block that passes on to a return.
fn pass_on(draft: &mut Draft, to_returns: bool) -> u64 {
    let order = draft.order();
    let mentions = draft.mentions(&order);
    let uses = param_uses(draft, &order);
    let mut subst = Subst::default();
    for c in &order {
        let Body::Jump { callee, args, .. } = draft.body(*c) else { continue };
        let (callee, args) = (*callee, args.clone());
        let cont = draft.p().cont(*c);
        let mut params = Vec::new();
        let is_function = cont.role == Role::Fun || cont.params.last().is_some_and(|p| p.ty.params().is_some());
        if *c == draft.entry || is_function || args.len() != cont.params.len() {
            continue;
        }
        for i in 0..args.len() {
            params.push(draft.world.param(*c, i));
        }
        // An arm is a continuation, so it cannot be the return itself; a function cannot be a block.
        let is_arm = mentions[c.index()].iter().any(|m| matches!(m, Mention::Arm(_)));
        let fits = match draft.cont_of(callee) {
            Some(to) => !to_returns && draft.p().cont(to).role != Role::Fun,
            None => to_returns && !is_arm,
        };
        let unused_else = params.iter().all(|p| uses.get(p) == Some(&1));
        let me = draft.world.cont_value(*c);
        if args == params && fits && unused_else && !leads_to(&subst, callee, me) {
            subst.insert(me, callee);
        }
    }
    draft.apply(&order, &subst);
    subst.len() as u64
}

/// Does following substitutions from `from` come to `to`? Then a loop does nothing, for ever.
fn leads_to(subst: &Subst, mut from: NodeId, to: NodeId) -> bool {
    while from != to {
        match subst.get(&from) {
            Some(next) => from = *next,
            None => return false,
        }
    }
    true
}

/// How often each parameter is an operand, in bodies and in the nodes that they reach.
pub(crate) fn param_uses(draft: &Draft, order: &[ContId]) -> FxHashMap<NodeId, u32> {
    let p = draft.p();
    let mut uses: FxHashMap<NodeId, u32> = FxHashMap::default();
    let mut seen = vec![false; p.nodes.len()];
    let mut stack = Vec::new();
    for c in order {
        draft.body(*c).operands(&mut |x| stack.push(x));
        while let Some(x) = stack.pop() {
            if let Node::Param { .. } = p.node(x) {
                *uses.entry(x).or_default() += 1;
            } else if !std::mem::replace(&mut seen[x.index()], true) {
                p.operands(x, &mut |y| stack.push(y));
            }
        }
    }
    uses
}
