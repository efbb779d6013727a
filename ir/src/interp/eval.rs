//! Pure nodes on demand.

use super::heap::{At, Value};
use super::machine::{FIRST_SLOT, Machine};
use super::*;
use crate::op::{Op, Rule};

impl<O: Observer> Machine<'_, O> {
    pub(super) fn lit(&mut self, node: NodeId) -> Lit {
        match self.eval(node) {
            Value::Lit(lit) => lit,
            other => unreachable!("{other:?} is no scalar"),
        }
    }

    pub(super) fn index(&mut self, node: NodeId) -> u32 {
        self.lit(node).as_u32().expect("an index is a u32")
    }

    pub(super) fn object(&mut self, node: NodeId) -> At {
        match self.eval(node) {
            Value::Object(at) => at,
            other => unreachable!("{other:?} is no object"),
        }
    }

    /// The value of a node: from its cell, or evaluated now, without recursion however deep the node is.
    pub(super) fn eval(&mut self, node: NodeId) -> Value {
        if let Ok(value) = self.get(node) {
            return value;
        }
        self.pending.push(node);
        while let Some(&next) = self.pending.last() {
            match self.compute(next) {
                Ok(value) => {
                    self.put(next, value);
                    self.pending.pop();
                }
                Err(operand) => self.pending.push(operand),
            }
        }
        self.get(node).expect("evaluated just now")
    }

    /// The node's cell, or the node if it is not evaluated yet.
    fn get(&self, node: NodeId) -> Result<Value, NodeId> {
        let place = self.code.places[node.index()];
        match self.heap.get(self.display[place.level as usize], FIRST_SLOT + place.slot as usize) {
            Value::Absent => Err(node),
            value => Ok(value),
        }
    }

    pub(super) fn put(&mut self, node: NodeId, value: Value) {
        if let Value::Lit(lit) = value {
            self.observer.value(node, lit);
        }
        let place = self.code.places[node.index()];
        self.heap.set(self.display[place.level as usize], FIRST_SLOT + place.slot as usize, value);
    }

    /// A node's value from those of its operands, or an operand that has to be evaluated first.
    fn compute(&mut self, node: NodeId) -> Result<Value, NodeId> {
        Ok(match self.code.program.node(node) {
            Node::Lit(lit) => Value::Lit(*lit),
            Node::Param { .. } => unreachable!("entering sets the parameters"),
            Node::Cont(cont) => {
                let level = self.code.shapes[cont.index()].level as usize;
                Value::Closure { cont: *cont, frame: self.display[level - 1] }
            }
            Node::Prim { op, args } => self.prim(*op, &args[..op.arity()])?,
            Node::Pack(elems) | Node::Tuple(elems) => {
                let mut values = Vec::with_capacity(elems.len());
                for elem in elems {
                    values.push(self.get(*elem)?);
                }
                Value::Object(self.heap.object(values.into_iter()))
            }
            Node::Lane { vector: x, lane } => self.component(*x, *lane as usize)?,
            Node::Extract { tuple: x, index } => self.component(*x, *index as usize)?,
            Node::Read { column, index } => match self.get(*index)? {
                Value::Object(at) => {
                    let indices = self.heap.cells(at).to_vec();
                    let words: Vec<Value> = indices.into_iter().map(|i| self.read(node, *column, i)).collect();
                    Value::Object(self.heap.object(words.into_iter()))
                }
                index => self.read(node, *column, index),
            },
            Node::Row { index: x, .. } | Node::Sibling { index: x, .. } | Node::RowIndex(x) => self.get(*x)?,
            Node::Known(_) => unreachable!("`known` occurs in filters only"),
        })
    }

    /// What a table holds.
    fn read(&mut self, node: NodeId, column: Column, index: Value) -> Value {
        let Value::Lit(Lit::U32(index)) = index else { unreachable!("{index:?} is no index") };
        if index >= self.memory[column.buf.index()].rows {
            self.observer.clamped(node, index);
        }
        Value::Lit(self.word_at(column, index))
    }

    fn component(&self, object: NodeId, index: usize) -> Result<Value, NodeId> {
        match self.get(object)? {
            Value::Object(at) => Ok(self.heap.get(at, index)),
            other => unreachable!("{other:?} has no components"),
        }
    }

    /// An operation: on scalars, or lane by lane.
    fn prim(&mut self, op: Op, args: &[NodeId]) -> Result<Value, NodeId> {
        let mut values = [Value::Absent; 3];
        for (value, arg) in values.iter_mut().zip(args) {
            *value = self.get(*arg)?;
        }
        let mut lits = [Lit::Bool(false); 3];
        let lanes = match values[0] {
            Value::Object(at) => self.heap.cells(at).len(),
            _ => {
                for (lit, value) in lits.iter_mut().zip(&values[..args.len()]) {
                    *lit = scalar(*value);
                }
                return Ok(Value::Lit(op.eval(&lits[..args.len()])));
            }
        };
        let lane = |machine: &Self, arg: usize, lane: usize| match values[arg] {
            Value::Object(at) => scalar(machine.heap.get(at, lane)),
            other => unreachable!("{other:?} is no vector"),
        };
        if matches!(op.rule(), Rule::Lanes(_)) {
            let all: Vec<Lit> = (0..lanes).map(|l| lane(self, 0, l)).collect();
            return Ok(Value::Lit(op.eval(&all)));
        }
        let mut results = [Value::Absent; 16];
        for (l, result) in results[..lanes].iter_mut().enumerate() {
            for (arg, lit) in lits[..args.len()].iter_mut().enumerate() {
                *lit = lane(self, arg, l);
            }
            *result = Value::Lit(op.eval(&lits[..args.len()]));
        }
        Ok(Value::Object(self.heap.object(results[..lanes].iter().copied())))
    }
}

fn scalar(value: Value) -> Lit {
    match value {
        Value::Lit(lit) => lit,
        other => unreachable!("{other:?} is no scalar"),
    }
}
