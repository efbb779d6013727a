//! Law: a branch that only chooses between cheap values is a select.
//!
//! Both sides are empty jumps to one place, and what they pass differs by little arithmetic. A select computes both
//! sides, so neither may hold a read, a division, a remainder or a root, nor more than [`MOST`] operations.

use jerboa_ir::*;

use super::draft::Draft;

/// Operations that the two sides may cost together. A branch that is mispredicted half of the time costs some ten
/// cycles; four operations cost about that many where nothing else can run.
const MOST: usize = 4;

pub(crate) fn run(draft: &mut Draft) -> u64 {
    let mut changes = 0;
    for c in draft.order() {
        let Body::Branch { cond, then, other } = *draft.body(c) else { continue };
        let (Some((to, yes)), Some((also, no))) = (passed(draft, then), passed(draft, other)) else { continue };
        if to != also || yes == no || !cheap(draft.p(), &yes, &no) {
            continue;
        }
        let loc = draft.p().cont(c).loc;
        let args = yes
            .iter()
            .zip(&no)
            .map(|(a, b)| if a == b { *a } else { draft.world.prim(Op::Select, &[cond, *a, *b], loc) })
            .collect();
        draft.world.cont_mut(c).body = Body::Jump { callee: to, args, mode: Mode::Filter };
        changes += 1;
    }
    changes
}

/// Where an empty arm jumps, and what it passes.
fn passed(draft: &Draft, arm: NodeId) -> Option<(NodeId, Vec<NodeId>)> {
    match draft.body(draft.cont_of(arm)?) {
        Body::Jump { callee, args, .. } => Some((*callee, args.clone())),
        _ => None,
    }
}

/// Are the values that differ scalars, and little work?
fn cheap(p: &Program, yes: &[NodeId], no: &[NodeId]) -> bool {
    let mut left = MOST;
    yes.iter().zip(no).all(|(a, b)| {
        let scalar = p.ty(*a).as_scalar().is_some();
        a == b || (scalar && work(p, *a, &mut left) && work(p, *b, &mut left))
    })
}

/// Count operations down; false if there are too many or one is dear.
fn work(p: &Program, x: NodeId, left: &mut usize) -> bool {
    match p.node(x) {
        Node::Lit(_) | Node::Param { .. } => true,
        Node::Prim { op: Op::Div | Op::Rem | Op::Sqrt, .. } | Node::Read { .. } => false,
        _ if *left == 0 => false,
        _ => {
            *left -= 1;
            let mut fine = true;
            p.operands(x, &mut |y| fine = fine && work(p, y, left));
            fine
        }
    }
}
