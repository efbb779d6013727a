//! Law: what nobody needs is not computed.
//!
//! A parameter is needed if a branch, an address, a store, a result or a needed parameter depends on it. A load whose
//! value is not needed is not made. (Unreached continuations and nodes vanish when the draft is finished.)

use jerboa_ir::*;
use rustc_hash::FxHashMap;

use super::draft::{Draft, Mention};
use super::params::drop_params;

pub(crate) fn run(draft: &mut Draft) -> u64 {
    let order = draft.order();
    let mentions = draft.mentions(&order);
    let entered = Entered::all(draft, &mentions);
    let needed = needed_nodes(draft, &order, &mentions, &entered);
    let loads = drop_loads(draft, &order, &needed);
    let mut dropped: FxHashMap<ContId, Vec<usize>> = FxHashMap::default();
    for c in &order {
        let Entered { may_shrink: true, index } = entered[c.index()] else { continue };
        let count = draft.p().cont(*c).params.len();
        let params: Vec<NodeId> = (0..count).map(|i| draft.world.param(*c, i)).collect();
        let idle =
            |i: &usize| Some(*i) != index && !is_needed(&needed, params[*i]) && draft.p().ty(params[*i]).is_data();
        let gone: Vec<usize> = (0..count).filter(idle).collect();
        if !gone.is_empty() {
            dropped.insert(*c, gone);
        }
    }
    drop_params(draft, &order, &dropped, Default::default());
    loads + dropped.values().map(|gone| gone.len() as u64).sum::<u64>()
}

/// What the ways into a continuation leave of it, found once: a function may be called from everywhere.
#[derive(Clone, Copy)]
struct Entered {
    /// May it lose parameters? Not where something else than a jump passes them: the host, a load, a function's return.
    may_shrink: bool,
    /// The place of the parameter that a `vectorize` gives its index, if it is the body of one.
    index: Option<usize>,
}

impl Entered {
    /// For each continuation.
    fn all(draft: &Draft, mentions: &[Vec<Mention>]) -> Vec<Entered> {
        let of = |(at, mentions): (usize, &Vec<Mention>)| {
            let c = ContId(at as u32);
            let is_body = mentions.iter().any(|m| matches!(m, Mention::Body(_)));
            let jumps = mentions.iter().all(|m| matches!(m, Mention::Call(_) | Mention::Body(_)));
            Entered {
                may_shrink: c != draft.entry && jumps,
                index: is_body.then(|| draft.p().cont(c).params.len() - 2),
            }
        };
        mentions.iter().enumerate().map(of).collect()
    }
}

/// A parameter made while asking is in no body, so not needed.
fn is_needed(needed: &[bool], node: NodeId) -> bool {
    needed.get(node.index()).copied().unwrap_or(false)
}

/// Nodes that the effects and the control of the program depend on.
fn needed_nodes(draft: &Draft, order: &[ContId], mentions: &[Vec<Mention>], entered: &[Entered]) -> Vec<bool> {
    let p = draft.p();
    let mut needed = vec![false; p.nodes.len()];
    let mut stack: Vec<NodeId> = Vec::new();
    for c in order {
        match draft.body(*c) {
            // Arguments are needed when the parameter is, or cannot go. A call needs its return.
            Body::Jump { callee, args, .. } => match draft.cont_of(*callee).map(|to| entered[to.index()]) {
                Some(Entered { may_shrink: true, index }) => {
                    let stays = |(i, x): &(usize, &NodeId)| Some(*i) == index || !p.ty(**x).is_data();
                    stack.extend(args.iter().enumerate().filter(stays).map(|(_, x)| *x));
                }
                _ => stack.extend([callee].into_iter().chain(args)),
            },
            Body::Vectorize { lo, hi, .. } => stack.extend([*lo, *hi]),
            // The address of a load is needed when its value is.
            Body::Load { next, .. } => stack.push(*next),
            body => body.operands(&mut |x| stack.push(x)),
        }
        while let Some(x) = stack.pop() {
            if std::mem::replace(&mut needed[x.index()], true) {
                continue;
            }
            match p.node(x) {
                Node::Param { cont, index } => {
                    for m in &mentions[cont.index()] {
                        match (m, draft.body(m.from())) {
                            (Mention::Call(_), Body::Jump { args, .. }) => stack.push(args[*index as usize]),
                            (Mention::Body(_), Body::Vectorize { args, .. }) => stack.extend(args.get(*index as usize)),
                            (Mention::Arm(_), Body::Load { mem, index, .. }) => {
                                stack.push(*index);
                                stack.extend(if let Mem::Local(local) = mem { Some(*local) } else { None });
                            }
                            _ => {}
                        }
                    }
                }
                _ => p.operands(x, &mut |y| stack.push(y)),
            }
        }
    }
    needed
}

/// Go on without loads of values that nobody needs. Their parameter gets a zero until it is dropped.
fn drop_loads(draft: &mut Draft, order: &[ContId], needed: &[bool]) -> u64 {
    let mut loads = 0;
    for c in order {
        let Body::Load { next, .. } = draft.body(*c) else { continue };
        let next = *next;
        let to = draft.cont_of(next).expect("a residual load goes on in a block");
        let value = draft.world.param(to, 0);
        if !is_needed(needed, value) {
            let (scalar, lanes) = draft.p().ty(value).lanes().expect("a residual load gives data");
            let mut zero = draft.world.lit(Lit::from_word(scalar, 0));
            if lanes > 1 {
                zero = draft.world.pack(&vec![zero; lanes], Loc::NONE);
            }
            draft.world.cont_mut(*c).body = Body::Jump { callee: next, args: vec![zero], mode: Mode::Filter };
            loads += 1;
        }
    }
    loads
}
