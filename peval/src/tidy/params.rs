//! Law: a parameter that is the same for every jump is no parameter.
//!
//! A parameter is *invariant* if every jump passes one value or the parameter itself; then it is that value, which every
//! jump can see, so the block can. Two parameters are *identical* if every jump passes the same value for both. A
//! function's parameter may only be a constant, since a caller's values are not in its scope.

use jerboa_ir::*;
use rustc_hash::FxHashMap;

use super::draft::{Draft, Mention, Subst};

pub(crate) fn run(draft: &mut Draft) -> u64 {
    let order = draft.order();
    let mentions = draft.mentions(&order);
    let mut subst = Subst::default();
    let mut dropped: FxHashMap<ContId, Vec<usize>> = FxHashMap::default();
    // Inner loops come later in the order; what they learn serves the outer ones.
    for c in order.iter().rev() {
        let gone = redundant(draft, *c, &mentions[c.index()], &mut subst);
        if !gone.is_empty() {
            dropped.insert(*c, gone);
        }
    }
    let changes = dropped.values().map(|gone| gone.len() as u64).sum();
    drop_params(draft, &order, &dropped, subst);
    changes
}

/// Places of the parameters of `c` that are something else; what they are goes to `subst`.
fn redundant(draft: &mut Draft, c: ContId, mentions: &[Mention], subst: &mut Subst) -> Vec<usize> {
    let count = draft.p().cont(c).params.len();
    let is_function = draft.p().cont(c).role == Role::Fun;
    if count == 0 || c == draft.entry || mentions.is_empty() {
        return Vec::new();
    }
    // What each jump passes; none for what a loop makes: its index and its return.
    let mut jumps: Vec<Vec<Option<NodeId>>> = Vec::new();
    for m in mentions {
        match (m, draft.body(m.from())) {
            (Mention::Call(_), Body::Jump { args, .. }) | (Mention::Body(_), Body::Vectorize { args, .. }) => {
                let mut passed: Vec<_> = args.iter().map(|x| Some(resolve(subst, *x))).collect();
                passed.resize(count, None);
                jumps.push(passed);
            }
            _ => return Vec::new(),
        }
    }
    let params: Vec<NodeId> = (0..count).map(|i| draft.world.param(c, i)).collect();
    let mut seen: FxHashMap<Vec<NodeId>, usize> = FxHashMap::default();
    let mut gone = Vec::new();
    for (i, param) in params.iter().enumerate() {
        if draft.p().ty(*param).params().is_some() {
            continue;
        }
        // `NONE` stands for "itself", so that two parameters that circle alike are alike.
        let itself = |x: NodeId| if x == *param { NodeId::NONE } else { x };
        let passed: Option<Vec<NodeId>> = jumps.iter().map(|args| args[i].map(itself)).collect();
        let Some(passed) = passed else { continue };
        let mut values = passed.iter().copied().filter(|x| *x != NodeId::NONE);
        let Some(first) = values.next() else { continue };
        if values.all(|x| x == first) && (!is_function || draft.p().as_lit(first).is_some()) {
            subst.insert(*param, first);
            gone.push(i);
            continue;
        }
        if let Some(twin) = seen.get(&passed) {
            subst.insert(*param, params[*twin]);
            gone.push(i);
            continue;
        }
        seen.insert(passed, i);
    }
    gone
}

fn resolve(subst: &Subst, mut x: NodeId) -> NodeId {
    while let Some(to) = subst.get(&x) {
        x = *to;
    }
    x
}

/// Take parameters away from blocks and from the jumps to them.
pub(crate) fn drop_params(
    draft: &mut Draft,
    order: &[ContId],
    dropped: &FxHashMap<ContId, Vec<usize>>,
    mut subst: Subst,
) {
    if dropped.is_empty() {
        return;
    }
    for c in order {
        let (Body::Jump { callee, .. } | Body::Vectorize { body: callee, .. }) = draft.body(*c) else { continue };
        if let Some(gone) = draft.cont_of(*callee).and_then(|to| dropped.get(&to))
            && let Body::Jump { args, .. } | Body::Vectorize { args, .. } = &mut draft.world.cont_mut(*c).body
        {
            let mut place = 0;
            args.retain(|_| {
                place += 1;
                !gone.contains(&(place - 1))
            });
        }
    }
    for c in order {
        if let Some(gone) = dropped.get(c) {
            let keep: Vec<usize> = (0..draft.p().cont(*c).params.len()).filter(|i| !gone.contains(i)).collect();
            draft.shorten(*c, &keep, &mut subst);
        }
    }
    let mut all: Vec<ContId> = order.iter().copied().filter(|c| !dropped.contains_key(c)).collect();
    all.extend(order.iter().filter(|c| dropped.contains_key(c)).filter_map(|c| {
        let old = draft.world.cont_value(*c);
        draft.cont_of(subst[&old])
    }));
    draft.apply(&all, &subst);
}
