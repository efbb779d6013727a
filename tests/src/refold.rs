//! A program built once more through the [`World`], with literals for some arguments of an entry: so everything that
//! construction folds is folded.

use jerboa_ir::*;

/// The same program, in which parameter `i` of `main` is `known[i]` wherever that is there: one literal for each lane.
/// `main` keeps its parameters, and ignores those.
pub fn refold(p: &Program, main: ContId, known: &[Option<Vec<Lit>>]) -> Program {
    let mut w = World::new();
    p.buffers.iter().for_each(|b| _ = w.buffer(b.clone()));
    for c in &p.conts {
        w.cont(c.name.clone(), c.role, c.params.clone(), c.loc);
    }
    let mut new: Vec<NodeId> = Vec::with_capacity(p.nodes.len());
    for (i, node) in p.nodes.iter().enumerate() {
        let (at, loc) = (|n: &NodeId| new[n.index()], p.locs[i]);
        let node = match node {
            Node::Lit(lit) => w.lit(*lit),
            Node::Param { cont, index } => match known.get(*index as usize) {
                Some(Some(lits)) if *cont == main => literal(&mut w, lits),
                _ => w.param(*cont, *index as usize),
            },
            Node::Cont(cont) => w.cont_value(*cont),
            Node::Prim { op, args } => {
                let args: Vec<NodeId> = args[..op.arity()].iter().map(at).collect();
                w.prim(*op, &args, loc)
            }
            Node::Pack(elems) => w.pack(&elems.iter().map(at).collect::<Vec<_>>(), loc),
            Node::Lane { vector, lane } => w.lane(at(vector), *lane as usize, loc),
            Node::Tuple(elems) => w.tuple(&elems.iter().map(at).collect::<Vec<_>>(), loc),
            Node::Extract { tuple, index } => w.extract(at(tuple), *index as usize, loc),
            Node::Read { column, index } => w.read(*column, at(index), loc),
            Node::Row { table, index } => w.row(*table, at(index), loc),
            Node::Sibling { row, index } => w.sibling(at(row), at(index), loc),
            Node::RowIndex(row) => w.row_index(at(row), loc),
            Node::Known(x) => w.known(at(x), loc),
        };
        new.push(node);
    }
    for (i, c) in p.conts.iter().enumerate() {
        let id = ContId(i as u32);
        w.cont_mut(id).filter = new[c.filter.index()];
        w.set_body(id, renamed(&c.body, &|n| new[n.index()]), c.loc);
    }
    p.entries.iter().for_each(|(name, cont)| w.entry(name.clone(), *cont));
    w.finish()
}

fn literal(w: &mut World, lits: &[Lit]) -> NodeId {
    let lanes: Vec<NodeId> = lits.iter().map(|l| w.lit(*l)).collect();
    if let [one] = lanes[..] { one } else { w.pack(&lanes, Loc::NONE) }
}

/// The jump with other operands.
fn renamed(body: &Body, new: &dyn Fn(NodeId) -> NodeId) -> Body {
    let mem = |m: &Mem| if let Mem::Local(x) = m { Mem::Local(new(*x)) } else { *m };
    match body {
        Body::Unset => Body::Unset,
        Body::Jump { callee, args, mode } => {
            Body::Jump { callee: new(*callee), args: args.iter().map(|a| new(*a)).collect(), mode: *mode }
        }
        Body::Branch { cond, then, other } => Body::Branch { cond: new(*cond), then: new(*then), other: new(*other) },
        Body::Switch { index, arms, default } => Body::Switch {
            index: new(*index),
            arms: arms.iter().map(|(n, arm)| (*n, new(*arm))).collect(),
            default: new(*default),
        },
        Body::Dispatch { row, arm } => Body::Dispatch { row: new(*row), arm: new(*arm) },
        Body::Load { mem: m, index, next } => Body::Load { mem: mem(m), index: new(*index), next: new(*next) },
        Body::Store { mem: m, index, value, mask, next } => {
            let mask = if *mask == NodeId::NONE { *mask } else { new(*mask) };
            Body::Store { mem: mem(m), index: new(*index), value: new(*value), mask, next: new(*next) }
        }
        Body::Vectorize { width, lo, hi, body, args, next } => Body::Vectorize {
            width: *width,
            lo: new(*lo),
            hi: new(*hi),
            body: new(*body),
            args: args.iter().map(|a| new(*a)).collect(),
            next: new(*next),
        },
        Body::Local { scalar, len, next } => Body::Local { scalar: *scalar, len: *len, next: new(*next) },
    }
}
