//! Counters of a program: the first line of every dump, so that a difference shows the effect of a change at once.

use std::fmt;

use crate::program::*;
use crate::scope::Scope;
use crate::ty::Scalar;

/// What is reachable, each in the order of its first use (breadth first over continuations).
#[derive(Clone, Debug, Default)]
pub struct Reach {
    /// Continuations.
    pub conts: Vec<ContId>,
    /// Pure nodes, those of filters included.
    pub nodes: Vec<NodeId>,
}

impl Reach {
    /// Walk the program from these continuations, in order.
    pub fn new(p: &Program, seeds: impl IntoIterator<Item = ContId>) -> Reach {
        let mut reach = Reach::default();
        let (mut seen_cont, mut seen_node) = (vec![false; p.conts.len()], vec![false; p.nodes.len()]);
        let mut done = 0;
        let (mut stack, mut operands) = (Vec::new(), Vec::new());
        for seed in seeds {
            if !std::mem::replace(&mut seen_cont[seed.index()], true) {
                reach.conts.push(seed);
            }
            while let Some(c) = reach.conts.get(done).map(|c| p.cont(*c)) {
                done += 1;
                c.body.operands(&mut |x| stack.push(x));
                stack.push(c.filter);
                stack.reverse();
                while let Some(id) = stack.pop() {
                    if std::mem::replace(&mut seen_node[id.index()], true) {
                        continue;
                    }
                    reach.nodes.push(id);
                    // A parameter leads to its owner, so that a dump of a program with scope faults is complete.
                    if let Node::Cont(cont) | Node::Param { cont, .. } = *p.node(id)
                        && !std::mem::replace(&mut seen_cont[cont.index()], true)
                    {
                        reach.conts.push(cont);
                    }
                    p.operands(id, &mut |x| operands.push(x));
                    stack.extend(operands.drain(..).rev());
                }
            }
        }
        reach
    }

    /// Walk the program from its entries, or where it has none from every continuation without free parameters.
    pub fn of(p: &Program) -> Reach {
        if !p.entries.is_empty() {
            return Reach::new(p, p.entries.iter().map(|(_, cont)| *cont));
        }
        let scope = Scope::new(p);
        let tops = (0..p.conts.len() as u32).map(ContId).filter(|c| scope.parent[c.index()].is_none());
        Reach::new(p, tops)
    }
}

/// Counters over what is reachable.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Stats {
    /// Pure nodes that compute: neither literal, nor parameter, nor continuation.
    pub nodes: usize,
    /// Operations on `f32`.
    pub floats: usize,
    /// Continuations.
    pub conts: usize,
    /// Jumps to a direct-style function, and loops that call one (`vectorize`).
    pub calls: usize,
    /// Continuations used as values: not as a jump's target, a branch's arm, a `next` or a call's return.
    pub closures: usize,
    /// Branches, switches and dispatches.
    pub branches: usize,
    /// Reads of tables.
    pub reads: usize,
    /// Placed loads.
    pub loads: usize,
    /// Placed stores.
    pub stores: usize,
}

impl Stats {
    /// Count what `reach` holds.
    pub fn new(p: &Program, reach: &Reach) -> Stats {
        let mut stats = Stats { conts: reach.conts.len(), ..Stats::default() };
        let cont_as_value = |x: NodeId| matches!(p.node(x), Node::Cont(_)) as usize;
        for id in &reach.nodes {
            stats.nodes += !matches!(p.node(*id), Node::Lit(_) | Node::Param { .. } | Node::Cont(_)) as usize;
            stats.reads += matches!(p.node(*id), Node::Read { .. }) as usize;
            p.operands(*id, &mut |x| stats.closures += cont_as_value(x));
            if let Node::Prim { args, .. } = p.node(*id) {
                stats.floats += p.ty(args[0]).lanes().is_some_and(|(s, _)| s == Scalar::F32) as usize;
            }
        }
        for c in reach.conts.iter().map(|c| p.cont(*c)) {
            match &c.body {
                Body::Jump { callee, args, .. } => {
                    let call = p.ty(*callee).is_function();
                    stats.calls += call as usize;
                    let values = &args[..args.len().saturating_sub(call as usize)];
                    stats.closures += values.iter().map(|x| cont_as_value(*x)).sum::<usize>();
                }
                Body::Branch { .. } | Body::Switch { .. } | Body::Dispatch { .. } => stats.branches += 1,
                Body::Vectorize { args, .. } => {
                    stats.calls += 1;
                    stats.closures += args.iter().map(|x| cont_as_value(*x)).sum::<usize>();
                }
                Body::Load { .. } => stats.loads += 1,
                Body::Store { .. } => stats.stores += 1,
                Body::Local { .. } | Body::Unset => {}
            }
        }
        stats
    }

    /// Count what is printed.
    pub fn of(p: &Program) -> Stats {
        Stats::new(p, &Reach::of(p))
    }
}

impl fmt::Display for Stats {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Stats { nodes, floats, conts, calls, closures, branches, reads, loads, stores } = self;
        write!(f, "nodes {nodes}  floats {floats}  conts {conts}  calls {calls}  closures {closures}  ")?;
        write!(f, "branches {branches}  reads {reads}  loads {loads}  stores {stores}")
    }
}
