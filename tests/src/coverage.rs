//! What random programs have executed: operations, and what iterations of a `vectorize` are made of.

use std::collections::BTreeSet;

use jerboa_ir::interp::Observer;
use jerboa_ir::*;

/// What was executed.
#[derive(Default, Debug)]
pub struct Coverage {
    /// Operations.
    pub ops: BTreeSet<Op>,
    /// Kinds of jumps within iterations, and the widths of loops.
    pub iterations: BTreeSet<&'static str>,
}

/// The kinds that a residual can have; a generic program also has `dispatch`.
pub const KINDS: [&str; 12] = [
    "4 wide",
    "8 wide",
    "16 wide",
    "branch",
    "switch",
    "loop",
    "call",
    "load",
    "store",
    "array",
    "array load",
    "array store",
];

impl Coverage {
    /// Both together.
    pub fn add(&mut self, other: Coverage) {
        self.ops.extend(other.ops);
        self.iterations.extend(other.iterations);
    }
}

/// Which continuations run within iterations.
pub fn within_iterations(p: &Program) -> Vec<bool> {
    let mut within = vec![false; p.conts.len()];
    let mut stack: Vec<NodeId> = Vec::new();
    for c in &p.conts {
        if let Body::Vectorize { body, .. } = c.body {
            stack.push(body);
        }
    }
    let mut seen = vec![false; p.nodes.len()];
    while let Some(x) = stack.pop() {
        if std::mem::replace(&mut seen[x.index()], true) {
            continue;
        }
        p.operands(x, &mut |y| stack.push(y));
        if let Node::Cont(c) = p.node(x) {
            within[c.index()] = true;
            p.cont(*c).body.operands(&mut |y| stack.push(y));
        }
    }
    within
}

/// Notes what a run executes.
pub struct Watch<'a> {
    /// The program.
    pub program: &'a Program,
    /// See [`within_iterations`].
    pub within: &'a [bool],
    /// What was executed so far.
    pub coverage: &'a mut Coverage,
}

impl Observer for Watch<'_> {
    fn enter(&mut self, cont: ContId) {
        let body = &self.program.cont(cont).body;
        let kind = match body {
            Body::Vectorize { width: 4, .. } => "4 wide",
            Body::Vectorize { width: 8, .. } => "8 wide",
            Body::Vectorize { .. } => "16 wide",
            _ if !self.within[cont.index()] => return,
            Body::Jump { callee, .. } => match self.program.node(*callee) {
                Node::Cont(c) if self.program.cont(*c).role == Role::Loop => "loop",
                _ if self.program.ty(*callee).is_function() => "call",
                _ => return,
            },
            Body::Branch { .. } => "branch",
            Body::Switch { .. } => "switch",
            Body::Dispatch { .. } => "dispatch",
            Body::Load { mem: Mem::Local(_), .. } => "array load",
            Body::Load { .. } => "load",
            Body::Store { mem: Mem::Local(_), .. } => "array store",
            Body::Store { .. } => "store",
            Body::Local { .. } => "array",
            Body::Unset => return,
        };
        self.coverage.iterations.insert(kind);
    }

    fn value(&mut self, node: NodeId, _: Lit) {
        if let Node::Prim { op, .. } = self.program.node(node) {
            self.coverage.ops.insert(*op);
        }
    }
}
