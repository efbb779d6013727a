//! Operations on vectors of which the operands tell more than their types: shorter code for the same bits.

use cranelift_codegen::ir::{InstBuilder, Value, types};
use jerboa_ir::op::Rule;
use jerboa_ir::{Lit, Node, NodeId, Op, Scalar};

use super::Emitter;
use super::range::{Range, is_signed, literal};
use crate::abi::data;
use crate::pack::cast;
use crate::vector;

impl Emitter<'_> {
    /// The parts of an operation for which there is a shorter way.
    pub(super) fn shortcut(&mut self, op: Op, args: &[NodeId]) -> Option<Vec<Value>> {
        let p = self.unit.program;
        let x86 = self.unit.simd.x86;
        let scalar = data(p.ty(args[0])).0;
        match op {
            Op::Shl | Op::Shr => {
                let by = self.splatted(args[1])?;
                let by = self.scalar(by);
                Some(self.each(args[0], |e, x| vector::shift(&mut e.b, op, scalar, x, by)))
            }
            Op::ToF32 if scalar == Scalar::U32 && is_signed(p, args[0]) => {
                Some(self.each(args[0], |e, x| e.b.ins().fcvt_from_sint(types::F32X4, x)))
            }
            Op::ToI32 | Op::ToU32 if x86 => {
                let Rule::Convert(_, to) = op.rule() else { return None };
                let fits = Range::of(p, args[0])?.fits(to);
                fits.then(|| self.each(args[0], |e, x| e.b.ins().x86_cvtt2dq(types::I32X4, x)))
            }
            Op::Bits if scalar == Scalar::F32 => {
                Range::of(p, args[0])?;
                Some(self.each(args[0], |e, x| cast(&mut e.b, types::I32X4, x)))
            }
            Op::Select => self.select(args[0], args[1], args[2]),
            _ => None,
        }
    }

    /// A choice between a value and nothing is one logical operation; a choice by the contrary is the other choice.
    fn select(&mut self, mask: NodeId, x: NodeId, y: NodeId) -> Option<Vec<Value>> {
        let p = self.unit.program;
        if let Node::Prim { op: Op::Not, args } = p.node(mask) {
            let shorter = self.select(args[0], y, x);
            return shorter.or_else(|| {
                let (mask, x, y) = (self.values(args[0]), self.values(x), self.values(y));
                let one = |at: usize| self.unit.simd.select(&mut self.b, mask[at], y[at], x[at]);
                Some((0..mask.len()).map(one).collect())
            });
        }
        let is = |x: NodeId, lit: Lit| literal(p, x) == Some(lit);
        let none = |x: NodeId| literal(p, x).is_some_and(|lit| lit.word() == 0);
        let (other, when) = match () {
            _ if none(y) => (x, true),
            _ if none(x) => (y, false),
            _ if is(x, Lit::Bool(true)) => {
                let (mask, y) = (self.values(mask), self.values(y));
                return Some(mask.iter().zip(&y).map(|(m, y)| self.b.ins().bor(*m, *y)).collect());
            }
            _ => return None,
        };
        let (mask, other) = (self.values(mask), self.values(other));
        let one = |(mask, x): (&Value, &Value)| {
            let ty = self.b.func.dfg.value_type(*x);
            let mut mask = cast(&mut self.b, ty, *mask);
            if !when {
                mask = self.b.ins().bnot(mask);
            }
            self.b.ins().band(*x, mask)
        };
        Some(mask.iter().zip(&other).map(one).collect())
    }

    /// Something of each part.
    fn each(&mut self, x: NodeId, mut f: impl FnMut(&mut Self, Value) -> Value) -> Vec<Value> {
        self.values(x).into_iter().map(|part| f(self, part)).collect()
    }
}
