//! Law: a continuation with one way in, a jump, is part of where it is entered from.
//!
//! Its parameters are then the arguments of that jump. This holds for blocks and for functions: a function that is
//! called once becomes blocks of its caller, and its return the continuation of the call.

use jerboa_ir::*;

use super::draft::{Draft, Mention, Subst};

pub(crate) fn run(draft: &mut Draft) -> u64 {
    let order = draft.order();
    let mentions = draft.mentions(&order);
    let mut subst = Subst::default();
    let mut merged = 0;
    for c in &order {
        while let Body::Jump { callee, args, .. } = draft.body(*c)
            && let Some(next) = draft.cont_of(*callee)
            && let [Mention::Call(_)] = mentions[next.index()][..]
            && next != draft.entry
            && next != *c
            && *draft.body(next) != Body::Unset
        {
            let args = args.clone();
            for (i, arg) in args.into_iter().enumerate() {
                subst.insert(draft.world.param(next, i), arg);
            }
            // Its body moves; `Unset` marks that it is gone.
            let body = std::mem::replace(&mut draft.world.cont_mut(next).body, Body::Unset);
            draft.world.cont_mut(*c).body = body;
            merged += 1;
        }
    }
    // Not the order of now: what a merged function returns to is not reached before the substitution.
    let left: Vec<ContId> = order.into_iter().filter(|c| *draft.body(*c) != Body::Unset).collect();
    draft.apply(&left, &subst);
    merged
}
