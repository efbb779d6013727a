//! Pure nodes. A vector is its lanes: GPUs compute with scalars.

use jerboa_ir::op::Rule;
use jerboa_ir::{Lit, Node, NodeId, Op, Scalar};

use super::memory::{decode, encode};
use super::top::Top;
use super::{Emitter, Known, Place};
use crate::code::Value;
use crate::ops;

impl Emitter<'_> {
    /// A lane of a value in scope; of a scalar its only one.
    pub(super) fn lane(&mut self, x: NodeId, lane: usize) -> Value {
        if let Node::Lit(lit) = self.unit.program.node(x) {
            return self.literal(*lit);
        }
        if let Some(value) = self.look_up(Known::Lane(x, lane)) {
            return value;
        }
        let place = match self.uses.def(self.unit.program, self.f, x, self.at) {
            Some(def) => self.far[&(x, def)][lane],
            None => self.params[&x][lane],
        };
        let value = self.take(place);
        self.know(Known::Lane(x, lane), value);
        value
    }

    /// The lanes of a value.
    pub(super) fn lanes(&mut self, x: NodeId) -> Vec<Value> {
        (0..self.width(x)).map(|lane| self.lane(x, lane)).collect()
    }

    /// The lanes of several values, one after the other.
    pub(super) fn all_lanes(&mut self, nodes: &[NodeId]) -> Vec<Value> {
        nodes.iter().flat_map(|x| self.lanes(*x)).collect()
    }

    /// How many lanes a value has.
    pub(super) fn width(&self, x: NodeId) -> usize {
        self.unit.program.ty(x).lanes().map_or(0, |(_, lanes)| lanes)
    }

    /// The scalar type of a value's lanes.
    pub(super) fn scalar(&self, x: NodeId) -> Scalar {
        self.unit.program.ty(x).lanes().map_or(Scalar::U32, |(scalar, _)| scalar)
    }

    pub(super) fn look_up(&self, what: Known) -> Option<Value> {
        self.known.iter().rev().find_map(|known| known.get(&what).copied())
    }

    /// From here to the end of the innermost naga block.
    pub(super) fn know(&mut self, what: Known, value: Value) {
        self.known.last_mut().expect("a block is open").insert(what, value);
    }

    /// What is known, or is made now.
    pub(super) fn once(&mut self, what: Known, make: impl FnOnce(&mut Self) -> Value) -> Value {
        if let Some(value) = self.look_up(what) {
            return value;
        }
        let value = make(self);
        self.know(what, value);
        value
    }

    /// A node that the block at hand has computed, or a parameter that it passes on.
    pub(super) fn define(&mut self, x: NodeId, lanes: &[Value]) {
        for (lane, value) in lanes.iter().enumerate() {
            self.know(Known::Lane(x, lane), *value);
        }
        if let Some(places) = self.far.get(&(x, self.at)).cloned() {
            self.assign(&places, lanes);
        }
    }

    /// Puts values where they are found later.
    pub(super) fn assign(&mut self, places: &[Place], values: &[Value]) {
        for (place, value) in places.iter().zip(values) {
            let in_word = place.kept && place.scalar == Scalar::Bool;
            let value = if in_word { encode(&mut self.code, Scalar::Bool, *value) } else { *value };
            let pointer = self.pointer_to(*place);
            self.code.store(pointer, value);
        }
    }

    /// Takes a value from there.
    fn take(&mut self, place: Place) -> Value {
        let pointer = self.pointer_to(place);
        let value = self.code.load(pointer);
        let in_word = place.kept && place.scalar == Scalar::Bool;
        if in_word { decode(&mut self.code, Scalar::Bool, value) } else { value }
    }

    fn pointer_to(&mut self, place: Place) -> Value {
        let pointer = self.code.local(place.variable);
        if !place.kept {
            return pointer;
        }
        let element = self.top(Top::Word(self.unit.launch.zero()));
        self.code.element(pointer, element)
    }

    /// Computes a node.
    pub(super) fn node(&mut self, x: NodeId) {
        let lanes = match self.unit.program.node(x) {
            Node::Prim { op, args } => self.operation(*op, &args[..op.arity()], self.width(x)),
            Node::Pack(elems) => elems.iter().map(|x| self.lane(*x, 0)).collect(),
            Node::Lane { vector, lane } => vec![self.lane(*vector, *lane as usize)],
            Node::Read { column, index } => self.read(*column, *index),
            other => unreachable!("{other:?} is in no residual: `Unit` refuses it"),
        };
        self.define(x, &lanes);
    }

    fn operation(&mut self, op: Op, args: &[NodeId], width: usize) -> Vec<Value> {
        if let Rule::Lanes(_) = op.rule() {
            let lanes = self.lanes(args[0]);
            return vec![ops::over_lanes(&mut self.code, op, &lanes)];
        }
        let scalar = match op.rule() {
            Rule::Shift => self.scalar(args[0]),
            _ => self.scalar(args[args.len() - 1]),
        };
        // What is only compared may be a literal zero.
        let compares = matches!(op.rule(), Rule::Equal | Rule::Order);
        let one = |lane: usize| {
            let mut operands: Vec<ops::Operand> = args
                .iter()
                .map(|x| match self.literal_lane(*x, lane) {
                    Some(Lit::F32(bits)) if compares && bits << 1 == 0 => (self.code.f32(0.0), None),
                    lit => (self.lane(*x, lane), lit),
                })
                .collect();
            operands.extend((op == Op::Absorb).then(|| (self.zero(), None)));
            // Lanes of a vector are often alike; scalars that are, are one node.
            let values = std::array::from_fn(|i| operands.get(i).map(|x| x.0));
            self.once(Known::Result(op, values), |e| ops::scalar(&mut e.code, op, scalar, &operands))
        };
        (0..width).map(one).collect()
    }

    /// The literal that a lane is.
    pub(super) fn literal_lane(&self, x: NodeId, lane: usize) -> Option<Lit> {
        let p = self.unit.program;
        match p.node(x) {
            Node::Pack(elems) => p.as_lit(elems[lane]),
            _ => p.as_lit(x),
        }
    }
}
