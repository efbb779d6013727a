//! The iterations of a `vectorize` must not meet, so that any order, and any number of them at once, gives the same bits.
//!
//! A body, with all that it calls,
//! - stores to a column of a stream at one index only: its own index, or that plus or minus a *uniform* value, which is
//!   the same in all iterations;
//! - loads from a column that it stores to only there, and from others anywhere;
//! - stores scalars, not vectors, and holds no other `vectorize`.
//!
//! One thing cannot be seen here: a load beyond the last row gives the last row, which belongs to another iteration. From
//! columns that it stores to, an iteration loads within the rows of the stream; the interpreter finds those that do not.
//!
//! What an index is, is found by following values: a parameter that every jump gives the same value is that value
//! (optimistic value numbering: Alpern, Wegman, Zadeck, POPL 1988). What comes from a load or a call is unknown. Only what
//! indices depend on is looked at.

use rustc_hash::FxHashMap;

use super::Verifier;
use crate::op::Op;
use crate::program::*;
use crate::stats::Reach;

/// The name of the rule.
const RULE: &str = "independent";

/// What is known of a value.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Known {
    /// No jump gives it yet.
    Unseen,
    /// This term over the parameters of the body.
    Term(NodeId),
    /// It may differ from time to time.
    Unknown,
}

/// Terms: nodes whose operands are terms, so that equal values are one term.
#[derive(Default)]
struct Terms {
    number: FxHashMap<Node, NodeId>,
    terms: Vec<Node>,
    /// Does it depend on the index?
    varies: Vec<bool>,
}

impl Terms {
    fn make(&mut self, node: Node, varies: bool) -> NodeId {
        let next = NodeId(self.terms.len() as u32);
        *self.number.entry(node).or_insert_with_key(|node| {
            self.terms.push(node.clone());
            self.varies.push(varies);
            next
        })
    }

    /// Is it the index `i`, or `i` plus or minus something uniform?
    fn is_own(&self, term: NodeId, i: NodeId) -> bool {
        let uniform = |x: NodeId| !self.varies[x.index()];
        match self.terms[term.index()] {
            Node::Prim { op: Op::Add, args: [x, y, _] } => (x == i && uniform(y)) || (y == i && uniform(x)),
            Node::Prim { op: Op::Sub, args: [x, y, _] } => x == i && uniform(y),
            _ => term == i,
        }
    }
}

/// What enters a continuation with its parameters.
#[derive(Clone, Copy)]
enum Giver<'p> {
    /// A jump with these arguments.
    Jump(&'p [NodeId]),
    /// A load, a call's return, a local array: not followed.
    Other,
}

/// The values of indices in a body and in what it calls.
struct Values<'p> {
    p: &'p Program,
    /// Continuations that the body reaches.
    conts: Vec<ContId>,
    /// Nodes that indices depend on, also through parameters; operands first.
    nodes: Vec<NodeId>,
    terms: Terms,
    /// The index of the iteration.
    index: NodeId,
    givers: FxHashMap<ContId, Vec<Giver<'p>>>,
    params: FxHashMap<(ContId, u32), Known>,
    known: FxHashMap<NodeId, Known>,
}

impl<'p> Values<'p> {
    fn new(p: &'p Program, body: ContId) -> Values<'p> {
        let conts = Reach::new(p, [body]).conts;
        let mut terms = Terms::default();
        let count = p.cont(body).params.len() as u32;
        let term = |index: u32| terms.make(Node::Param { cont: body, index }, index + 2 == count);
        let own: Vec<NodeId> = (0..count).map(term).collect();
        let params = (0..count).map(|i| ((body, i), Known::Term(own[i as usize]))).collect();
        let (index, givers) = (own[count as usize - 2], givers(p, &conts));
        let mut values = Values { p, conts, nodes: vec![], terms, index, givers, params, known: FxHashMap::default() };
        values.demand();
        loop {
            values.evaluate();
            if !values.pass() {
                return values;
            }
        }
    }

    /// The nodes that the indices of streams depend on.
    fn demand(&mut self) {
        let p = self.p;
        let mut stack: Vec<NodeId> = Vec::new();
        for c in &self.conts {
            if let Body::Store { mem: Mem::Stream(_), index, .. } | Body::Load { mem: Mem::Stream(_), index, .. } =
                &p.cont(*c).body
            {
                stack.push(*index);
            }
        }
        while let Some(x) = stack.pop() {
            if self.known.insert(x, Known::Unseen).is_some() {
                continue;
            }
            self.nodes.push(x);
            p.operands(x, &mut |y| stack.push(y));
            if let Node::Param { cont, index } = p.node(x) {
                self.params.entry((*cont, *index)).or_insert(Known::Unseen);
                stack.extend(self.jumps(*cont).map(|args| args[*index as usize]));
            }
        }
        self.nodes.sort_unstable();
    }

    /// The arguments of all jumps to a continuation.
    fn jumps(&self, to: ContId) -> impl Iterator<Item = &'p [NodeId]> {
        let givers = self.givers.get(&to).map_or(&[][..], |givers| &givers[..]);
        givers.iter().filter_map(|giver| if let Giver::Jump(args) = giver { Some(*args) } else { None })
    }

    /// All nodes, from what is known of the parameters.
    fn evaluate(&mut self) {
        for i in 0..self.nodes.len() {
            let id = self.nodes[i];
            let known = match self.p.node(id) {
                Node::Param { cont, index } => self.params[&(*cont, *index)],
                node => self.term(node, id),
            };
            self.known.insert(id, known);
        }
    }

    /// A node over the terms of its operands.
    fn term(&mut self, node: &Node, id: NodeId) -> Known {
        let (mut known, mut varies) = (Known::Term(NodeId::NONE), false);
        self.p.operands(id, &mut |x| match self.known[&x] {
            Known::Term(x) => varies |= self.terms.varies[x.index()],
            Known::Unknown => known = Known::Unknown,
            Known::Unseen if known != Known::Unknown => known = Known::Unseen,
            Known::Unseen => {}
        });
        if known != Known::Term(NodeId::NONE) {
            return known;
        }
        let of = |x: &NodeId| match self.known.get(x) {
            Some(Known::Term(term)) => *term,
            _ => NodeId::NONE,
        };
        let term = match node {
            Node::Prim { op, args } => Node::Prim { op: *op, args: [of(&args[0]), of(&args[1]), of(&args[2])] },
            Node::Pack(lanes) => Node::Pack(lanes.iter().map(of).collect()),
            Node::Lane { vector, lane } => Node::Lane { vector: of(vector), lane: *lane },
            Node::Read { column, index } => Node::Read { column: *column, index: of(index) },
            Node::Lit(lit) => Node::Lit(*lit),
            _ => return Known::Unknown,
        };
        Known::Term(self.terms.make(term, varies))
    }

    /// Give every parameter what the jumps pass to it. Did one change?
    fn pass(&mut self) -> bool {
        let mut changed = false;
        for ((to, index), known) in &mut self.params {
            for giver in self.givers.get(to).into_iter().flatten() {
                let value = match giver {
                    Giver::Jump(args) => self.known.get(&args[*index as usize]).copied().unwrap_or(Known::Unseen),
                    Giver::Other => Known::Unknown,
                };
                let met = match (*known, value) {
                    (old, Known::Unseen) => old,
                    (Known::Unseen, new) => new,
                    (old, new) if old == new => old,
                    _ => Known::Unknown,
                };
                changed |= std::mem::replace(known, met) != met;
            }
        }
        changed
    }

    /// Is it the index of the iteration, or that and something uniform?
    fn is_own(&self, index: NodeId) -> bool {
        matches!(self.known[&index], Known::Term(term) if self.terms.is_own(term, self.index))
    }
}

/// What enters each of these continuations.
fn givers<'p>(p: &'p Program, conts: &[ContId]) -> FxHashMap<ContId, Vec<Giver<'p>>> {
    let mut givers: FxHashMap<ContId, Vec<Giver>> = FxHashMap::default();
    for c in conts {
        let body = &p.cont(*c).body;
        let callee = match body {
            Body::Jump { callee, args, .. } => {
                if let Node::Cont(to) = p.node(*callee) {
                    givers.entry(*to).or_default().push(Giver::Jump(args));
                }
                Some(*callee)
            }
            _ => None,
        };
        body.operands(&mut |x| {
            if let (Node::Cont(to), true) = (p.node(x), callee != Some(x)) {
                givers.entry(*to).or_default().push(Giver::Other);
            }
        });
    }
    givers
}

impl Verifier<'_> {
    /// The rules of one body, a function of a residual.
    pub(super) fn independent(&mut self, body: ContId) {
        let p = self.p;
        let values = Values::new(p, body);
        let mut stored: FxHashMap<Column, NodeId> = FxHashMap::default();
        let name = |column: &Column| format!("`{}.{}`", p.buffer(column.buf).name, p.column(*column).name);
        for c in &values.conts {
            match &p.cont(*c).body {
                Body::Vectorize { .. } => {
                    self.fault_at(RULE, *c, "a `vectorize` within an iteration of another".to_owned());
                }
                Body::Store { mem: Mem::Stream(column), index, mask, .. } => {
                    let first = *stored.entry(*column).or_insert(*index);
                    let what = match () {
                        () if *mask != NodeId::NONE => "a vector, so that iterations overlap",
                        () if !values.is_own(*index) => {
                            "at an index that is not its own, nor that plus a value that is the same in all iterations"
                        }
                        () if values.known[&first] != values.known[index] => "at two indices, so that iterations meet",
                        () => continue,
                    };
                    let what = format!("an iteration of `{}` stores to {} {what}", p.cont(body).name, name(column));
                    self.fault_at(RULE, *c, what);
                }
                _ => {}
            }
        }
        for c in &values.conts {
            if let Body::Load { mem: Mem::Stream(column), index, next } = &p.cont(*c).body
                && let Some(own) = stored.get(column)
            {
                let vector = p.loaded(*next).is_none_or(|ty| ty.as_scalar().is_none());
                if vector || !values.is_own(*index) || values.known[own] != values.known[index] {
                    let (body, name) = (&p.cont(body).name, name(column));
                    let what = format!(
                        "an iteration of `{body}` loads from {name}, but not at the index it stores to: \
                         another iteration may have stored there"
                    );
                    self.fault_at(RULE, *c, what);
                }
            }
        }
    }
}
