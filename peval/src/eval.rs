//! Pure nodes, on demand.
//!
//! A node is evaluated when a jump first needs it, once per frame of its owner. What is known folds in the residual
//! world's own constructors, by the very operations that would run (Law 3); what is not becomes a node there. The
//! evaluator keeps its own stack, so chains may be as deep as memory allows, and it leaves out operands that do not
//! matter: the other side of a decided `select`, the rest of a decided `and` or `or`.

use jerboa_ir::*;

use crate::facts::Fold;
use crate::frame::ROOT;
use crate::machine::Machine;
use crate::value::{FrameId, NO_CLASS, Value};

impl Machine<'_> {
    /// The value of a node as seen from frame `f`.
    pub(crate) fn eval(&mut self, node: NodeId, f: FrameId) -> Value {
        let found = self.ready(node, f);
        if found != Value::Nothing {
            return found;
        }
        let mut stack = std::mem::take(&mut self.stack);
        stack.push((node, self.home(node, f)));
        while let Some(&(node, f)) = stack.last() {
            let height = stack.len();
            if self.frames.cell(f, self.scope.slot[node.index()]) == Value::Nothing {
                self.demand(node, f, &mut stack);
                if stack.len() > height {
                    continue;
                }
                let value = self.compute(node, f);
                self.evaluations += 1;
                self.frames.set(f, self.scope.slot[node.index()], value);
            }
            stack.pop();
        }
        self.stack = stack;
        self.ready(node, f)
    }

    /// The residual node of a scalar or a vector.
    pub(crate) fn data(&mut self, node: NodeId, f: FrameId) -> NodeId {
        match self.eval(node, f) {
            Value::Data(x) | Value::Row { index: x, .. } => x,
            other => unreachable!("the verifier lets only data through here, not {other:?}"),
        }
    }

    /// The literal behind a residual node.
    pub(crate) fn lit(&self, node: NodeId) -> Option<Lit> {
        self.world.program().as_lit(node)
    }

    /// The frame that holds a node's cell.
    fn home(&self, node: NodeId, f: FrameId) -> FrameId {
        self.scope.owner[node.index()].map_or(ROOT, |o| self.frame_of(o, f))
    }

    /// The frame of `cont` on the chain from `f`.
    pub(crate) fn frame_of(&self, cont: ContId, f: FrameId) -> FrameId {
        let found = self.frames.ancestor(f, self.scope.level[cont.index()] + 1);
        debug_assert_eq!(self.frames.cont(found), cont, "a value is used outside of its scope");
        found
    }

    /// The value if it is there already; parameters and continuations always are.
    fn ready(&self, node: NodeId, f: FrameId) -> Value {
        match self.p.node(node) {
            Node::Param { cont, index } => self.frames.arg(self.frame_of(*cont, f), *index),
            Node::Cont(cont) => {
                Value::Closure(*cont, self.scope.parent[cont.index()].map_or(ROOT, |p| self.frame_of(p, f)))
            }
            _ => self.frames.cell(self.home(node, f), self.scope.slot[node.index()]),
        }
    }

    /// Push the operands that are needed now and not there yet.
    fn demand(&self, node: NodeId, f: FrameId, stack: &mut Vec<(NodeId, FrameId)>) {
        let mut need = |x: NodeId| {
            let value = self.ready(x, f);
            if value == Value::Nothing {
                stack.push((x, self.home(x, f)));
            }
            value
        };
        match self.p.node(node) {
            Node::Prim { op: op @ (Op::Select | Op::And | Op::Or), args } => {
                let Value::Data(first) = need(args[0]) else { return };
                match (op, self.lit(first)) {
                    (Op::Select, Some(Lit::Bool(c))) => {
                        need(args[if c { 1 } else { 2 }]);
                    }
                    (Op::And, Some(Lit::Bool(false))) | (Op::Or, Some(Lit::Bool(true))) => {}
                    _ => args[1..op.arity()].iter().for_each(|x| {
                        need(*x);
                    }),
                }
            }
            _ => self.p.operands(node, &mut |x| {
                need(x);
            }),
        }
    }

    /// Evaluate a node whose needed operands are there.
    fn compute(&mut self, node: NodeId, f: FrameId) -> Value {
        let loc = self.p.locs[node.index()];
        let value = match self.p.node(node) {
            Node::Lit(lit) => Value::Data(self.world.lit(*lit)),
            Node::Prim { op, args } => Value::Data(self.prim(*op, args, f, loc)),
            Node::Pack(elems) => {
                let lanes: Vec<NodeId> = elems.iter().map(|x| self.data(*x, f)).collect();
                Value::Data(self.world.pack(&lanes, loc))
            }
            Node::Lane { vector, lane } => {
                let vector = self.data(*vector, f);
                Value::Data(self.world.lane(vector, *lane as usize, loc))
            }
            Node::Tuple(elems) => {
                let elems: Vec<Value> = elems.iter().map(|x| self.ready(*x, f)).collect();
                self.tuples.make(&elems)
            }
            Node::Extract { tuple, index } => match self.ready(*tuple, f) {
                Value::Tuple(id) => self.tuples.elems(id)[*index as usize],
                other => unreachable!("the verifier lets only tuples through here, not {other:?}"),
            },
            Node::Read { column, index } => self.read(*column, self.ready(*index, f), loc),
            Node::Row { table, index } => {
                let index = self.data(*index, f);
                self.row(*table, None, index)
            }
            Node::Sibling { row, index } => match (self.ready(*row, f), self.data(*index, f)) {
                (Value::Row { table, class, .. }, index) => {
                    self.row(table, (class != NO_CLASS).then_some(class), index)
                }
                (other, _) => unreachable!("the verifier lets only rows through here, not {other:?}"),
            },
            Node::RowIndex(row) => Value::Data(self.data(*row, f)),
            Node::Known(x) => Value::Data(self.world.lit(Lit::Bool(self.is_known(self.ready(*x, f))))),
            Node::Param { .. } | Node::Cont(_) => unreachable!("always ready"),
        };
        if let (Value::Data(x), Some(name)) = (value, self.p.names.get(&node)) {
            self.world.name(x, name);
        }
        value
    }

    fn prim(&mut self, op: Op, args: &[NodeId; 3], f: FrameId, loc: Loc) -> NodeId {
        let first = self.data(args[0], f);
        match (op, self.lit(first)) {
            (Op::Select, Some(Lit::Bool(c))) => return self.data(args[if c { 1 } else { 2 }], f),
            (Op::And, Some(Lit::Bool(false))) | (Op::Or, Some(Lit::Bool(true))) => return first,
            _ => {}
        }
        let mut operands = [first; 3];
        for (to, x) in operands.iter_mut().zip(args).take(op.arity()).skip(1) {
            *to = self.data(*x, f);
        }
        self.world.prim(op, &operands[..op.arity()], loc)
    }

    /// The row of a table at an index. A class that is not given may follow from the index or from there being one.
    pub(crate) fn row(&mut self, table: BufId, class: Option<u32>, index: NodeId) -> Value {
        let class = class.or_else(|| {
            if self.facts.classes(table) == 1 {
                self.used.add(Fold::Classes(table));
                return Some(0);
            }
            let row = self.lit(index)?.as_u32()?;
            self.used.add(Fold::Classes(table));
            self.facts.class_of(table, row)
        });
        Value::Row { table, class: class.unwrap_or(NO_CLASS), index }
    }

    /// What a table holds: the class's literal where the column is known, else a read in the residual. A reference
    /// becomes a row, whose index is read when it is not known.
    fn read(&mut self, column: Column, at: Value, loc: Loc) -> Value {
        let (class, index) = match at {
            Value::Row { class, index, .. } => ((class != NO_CLASS).then_some(class), index),
            Value::Data(index) => match self.row(column.buf, None, index) {
                Value::Row { class, index, .. } => ((class != NO_CLASS).then_some(class), index),
                _ => unreachable!("a row is a row"),
            },
            other => unreachable!("the verifier lets only indices through here, not {other:?}"),
        };
        let fold = Fold::Column { column, class };
        match self.p.column(column).ty {
            ColTy::Scalar(_) => match self.facts.scalar(column, class) {
                Some(lit) => {
                    self.used.add(fold);
                    let (lit, lanes) = (self.world.lit(lit), self.world.program().ty(index).lanes());
                    Value::Data(match lanes {
                        Some((_, lanes)) if lanes > 1 => self.world.pack(&vec![lit; lanes], loc),
                        _ => lit,
                    })
                }
                None => Value::Data(self.world.read(column, index, loc)),
            },
            ColTy::Ref(table) => {
                let (class, row) = self.facts.target(column, class);
                if class.is_some() || row.is_some() {
                    self.used.add(fold);
                }
                let index = match row {
                    Some(row) => self.world.lit(Lit::U32(row)),
                    None => self.world.read(column, index, loc),
                };
                self.row(table, class, index)
            }
        }
    }

    /// Does the evaluator know this value?
    fn is_known(&self, value: Value) -> bool {
        let lit = |x: &NodeId| self.lit(*x).is_some();
        match value {
            Value::Data(x) => match self.world.program().node(x) {
                Node::Pack(lanes) => lanes.iter().all(lit),
                node => matches!(node, Node::Lit(_)),
            },
            Value::Tuple(id) => self.tuples.elems(id).iter().all(|x| self.is_known(*x)),
            Value::Closure(..) => true,
            Value::Row { class, .. } => class != NO_CLASS,
            Value::Nothing | Value::Local(_) | Value::Exit(_) => false,
        }
    }
}
