//! Pure nodes.

use cranelift_codegen::ir::immediates::Ieee32;
use cranelift_codegen::ir::{InstBuilder, Type, Value};
use cranelift_frontend::FunctionBuilder;
use jerboa_ir::op::Rule;
use jerboa_ir::{Lit, Node, NodeId, Op, Scalar};

use super::Emitter;
use crate::abi::{LANES, clif, data, part, parts};
use crate::{ops, pack, vector};

impl Emitter<'_> {
    /// One machine value of a node that is in scope: its only one, or a part of a vector.
    fn value(&mut self, x: NodeId, at: usize) -> Value {
        let p = self.unit.program;
        match p.node(x) {
            Node::Lit(lit) => *self.literals.entry(*lit).or_insert_with(|| literal(&mut self.b, *lit)),
            Node::Param { cont, index } => {
                let block = self.f.number[cont];
                self.load_deferred(block);
                self.params[block as usize][*index as usize][at]
            }
            Node::Pack(elems) => match self.literal_words(&elems[at * LANES..]) {
                Some(words) => self.constant(part(data(p.ty(x)).0), words),
                None => self.made[self.first[&x] + at],
            },
            _ => self.made[self.first[&x] + at],
        }
    }

    pub(super) fn scalar(&mut self, x: NodeId) -> Value {
        self.value(x, 0)
    }

    /// The machine values of a node that is in scope.
    pub(super) fn values(&mut self, x: NodeId) -> Vec<Value> {
        let n = parts(self.unit.program.ty(x)).count();
        (0..n).map(|at| self.value(x, at)).collect()
    }

    /// The machine values of several nodes, one after the other.
    pub(super) fn all_values(&mut self, nodes: &[NodeId]) -> Vec<Value> {
        nodes.iter().flat_map(|x| self.values(*x)).collect()
    }

    /// Computes a node.
    pub(super) fn node(&mut self, id: NodeId) -> Result<(), String> {
        let p = self.unit.program;
        // Each operation takes its constants from memory: to keep them in registers costs more than to load them again.
        self.constants.clear();
        let values = match p.node(id) {
            Node::Prim { op, args } => self.prim(*op, &args[..op.arity()]),
            Node::Pack(elems) => self.pack(data(p.ty(id)).0, elems),
            Node::Lane { vector, lane } => {
                let parts = self.values(*vector);
                vec![pack::lane(&mut self.b, data(p.ty(id)).0, &parts, *lane as usize)]
            }
            Node::Read { column, index } => self.read(*column, *index, data(p.ty(id)).1.max(1)),
            other => return Err(format!("it computes {other:?} at {}", p.locs[id.index()])),
        };
        self.first.insert(id, self.made.len());
        self.made.extend(values);
        Ok(())
    }

    fn prim(&mut self, op: Op, args: &[NodeId]) -> Vec<Value> {
        let p = self.unit.program;
        // A shift is of its first operand's type, any other operation of its last one's.
        let is_shift = op.rule() == Rule::Shift;
        let main = if is_shift { args[0] } else { args[args.len() - 1] };
        let (scalar, lanes) = data(p.ty(main));
        if lanes == 1 {
            let args: Vec<Value> = args.iter().map(|x| self.scalar(*x)).collect();
            return vec![self.operation(op, scalar, &args)];
        }
        if matches!(op.rule(), Rule::Lanes(_)) {
            let parts = self.values(main);
            return vec![vector::over_lanes(&mut self.b, self.unit.simd, op, &parts, lanes)];
        }
        if let Some(values) = self.shortcut(op, args) {
            return values;
        }
        let one = |at: usize| {
            let args: Vec<Value> = args.iter().map(|x| self.value(*x, at)).collect();
            match vector::part(&mut self.b, self.unit.simd, &mut self.constants, op, scalar, &args) {
                Some(value) => value,
                None => self.lane_by_lane(op, scalar, &args, LANES.min(lanes - at * LANES)),
            }
        };
        (0..lanes.div_ceil(LANES)).map(one).collect()
    }

    fn operation(&mut self, op: Op, scalar: Scalar, args: &[Value]) -> Value {
        let call = self.callees.fma;
        ops::scalar(&mut self.b, op, scalar, args, |b, args| match call {
            None => b.ins().fma(args[0], args[1], args[2]),
            Some(function) => {
                let call = b.ins().call(function, args);
                b.inst_results(call)[0]
            }
        })
    }

    /// An operation on the first lanes of a part that is none of the machine's; its result is of the first operand's type.
    fn lane_by_lane(&mut self, op: Op, scalar: Scalar, args: &[Value], lanes: usize) -> Value {
        (0..lanes).fold(args[0], |vector, lane| {
            let args: Vec<Value> = args.iter().map(|x| pack::lane(&mut self.b, scalar, &[*x], lane)).collect();
            let result = self.operation(op, scalar, &args);
            pack::insert(&mut self.b, scalar, vector, lane, result)
        })
    }

    /// The parts of a vector with this scalar in so many lanes.
    pub(super) fn splat(&mut self, scalar: Scalar, x: Value, lanes: usize) -> Vec<Value> {
        vec![pack::splat(&mut self.b, scalar, x); lanes.div_ceil(LANES)]
    }

    /// The parts of a vector made of lanes.
    fn pack(&mut self, scalar: Scalar, elems: &[NodeId]) -> Vec<Value> {
        if elems.iter().all(|x| self.unit.program.as_lit(*x).is_some()) {
            // A constant is made where it is used.
            return Vec::new();
        }
        let is_lane = |x: NodeId| matches!(self.unit.program.node(x), Node::Lane { .. });
        if let Some(x) = same(elems).filter(|x| !is_lane(*x)) {
            let x = self.scalar(x);
            return self.splat(scalar, x, elems.len());
        }
        elems.chunks(LANES).map(|chunk| self.pack_part(scalar, chunk)).collect()
    }

    fn pack_part(&mut self, scalar: Scalar, elems: &[NodeId]) -> Value {
        if let Some(words) = self.literal_words(elems) {
            return self.constant(part(scalar), words);
        }
        if let Some(shuffled) = self.shuffle(elems) {
            return shuffled;
        }
        // What is known first, then the others one by one.
        let p = self.unit.program;
        let known = elems.iter().any(|x| p.as_lit(*x).is_some());
        let (first, rest) = if known {
            let words = std::array::from_fn(|i| elems.get(i).and_then(|x| p.as_lit(*x)).map_or(0, in_lane));
            (self.constant(part(scalar), words), 0)
        } else {
            let x = self.scalar(elems[0]);
            (pack::splat(&mut self.b, scalar, x), 1)
        };
        let unknown = (rest..elems.len()).filter(|i| p.as_lit(elems[*i]).is_none());
        unknown.fold(first, |vector, i| {
            let x = self.scalar(elems[i]);
            pack::insert(&mut self.b, scalar, vector, i, x)
        })
    }

    /// A part whose lanes are lanes of one or two parts.
    fn shuffle(&mut self, elems: &[NodeId]) -> Option<Value> {
        let p = self.unit.program;
        let mut sources: Vec<(NodeId, usize)> = Vec::new();
        let mut lanes: [usize; LANES] = std::array::from_fn(|i| i);
        for (x, to) in elems.iter().zip(&mut lanes) {
            let Node::Lane { vector, lane } = p.node(*x) else { return None };
            let source = (*vector, *lane as usize / LANES);
            let known = sources.iter().position(|s| *s == source);
            let number = known.unwrap_or_else(|| {
                sources.push(source);
                sources.len() - 1
            });
            *to = number * LANES + *lane as usize % LANES;
        }
        let (&(x, at), rest) = sources.split_first()?;
        let x = self.value(x, at);
        let y = match *rest {
            [] => x,
            [(y, at)] => self.value(y, at),
            _ => return None,
        };
        let as_it_is = lanes == std::array::from_fn(|i| i);
        Some(if as_it_is { x } else { pack::shuffle(&mut self.b, x, y, lanes) })
    }

    /// The scalar that a vector has in every lane, if it is made of it.
    pub(super) fn splatted(&self, vector: NodeId) -> Option<NodeId> {
        match self.unit.program.node(vector) {
            Node::Pack(elems) => same(elems),
            _ => None,
        }
    }

    /// The words of a part whose lanes are all literals; the elements may go on after the part.
    pub(super) fn literal_words(&self, elems: &[NodeId]) -> Option<[u32; LANES]> {
        let mut words = [0; LANES];
        for (x, word) in elems.iter().zip(&mut words) {
            *word = in_lane(self.unit.program.as_lit(*x)?);
        }
        Some(words)
    }

    fn constant(&mut self, ty: Type, words: [u32; LANES]) -> Value {
        self.constants.get(&mut self.b, ty, words)
    }
}

/// The element that all are.
fn same(elems: &[NodeId]) -> Option<NodeId> {
    elems.iter().all(|x| *x == elems[0]).then_some(elems[0])
}

/// What a lane holds for a literal.
fn in_lane(lit: Lit) -> u32 {
    match lit {
        Lit::Bool(b) => u32::from(b).wrapping_neg(),
        _ => lit.word(),
    }
}

fn literal(b: &mut FunctionBuilder, lit: Lit) -> Value {
    match lit {
        Lit::F32(bits) => b.ins().f32const(Ieee32::with_bits(bits)),
        _ => b.ins().iconst(clif(lit.scalar()), i64::from(lit.word())),
    }
}
