//! Law: a function that returns what it itself returns is a loop.
//!
//! Its body becomes the header of a loop over its data parameters, and each such call a jump to it. A function that is
//! called from one place only then merges into it, loop and all.

use jerboa_ir::*;

use super::draft::{Draft, Mention, Subst};

pub(crate) fn run(draft: &mut Draft) -> u64 {
    let order = draft.order();
    let mentions = draft.mentions(&order);
    let functions: Vec<ContId> = order.iter().copied().filter(|c| draft.p().cont(*c).role == Role::Fun).collect();
    let mut loops = 0;
    for f in functions {
        let returns = draft.p().cont(f).params.len() - 1;
        let own_return = draft.world.param(f, returns);
        let is_tail = |m: &&Mention| match m {
            Mention::Call(from) => matches!(draft.body(*from), Body::Jump { args, .. } if args[returns] == own_return),
            _ => false,
        };
        let tails: Vec<Mention> = mentions[f.index()].iter().filter(is_tail).copied().collect();
        if !tails.is_empty() {
            make_loop(draft, &order, f, &tails);
            loops += 1;
        }
    }
    loops
}

fn make_loop(draft: &mut Draft, order: &[ContId], f: ContId, tails: &[Mention]) {
    let old = draft.p().cont(f).clone();
    let data = old.params.len() - 1;
    let header = draft.world.cont(old.name, Role::Loop, old.params[..data].to_vec(), old.loc);
    draft.world.cont_mut(header).filter = old.filter;
    draft.world.cont_mut(header).body = old.body;
    let to_header = draft.world.cont_value(header);
    // The function may call itself in its first body, which is the header's now.
    for m in tails {
        let from = if m.from() == f { header } else { m.from() };
        if let Body::Jump { callee, args, .. } = &mut draft.world.cont_mut(from).body {
            *callee = to_header;
            args.truncate(data);
        }
    }
    let mut subst = Subst::default();
    let outer: Vec<NodeId> = (0..data).map(|i| draft.world.param(f, i)).collect();
    for (i, param) in outer.iter().enumerate() {
        let inner = draft.world.param(header, i);
        subst.insert(*param, inner);
    }
    let mut inside: Vec<ContId> = order.iter().copied().filter(|c| *c != f).collect();
    inside.push(header);
    draft.apply(&inside, &subst);
    draft.world.cont_mut(f).body = Body::Jump { callee: to_header, args: outer, mode: Mode::Filter };
}
