//! What is known of numbers: bounds that spare an operation its special cases, and an index its check.
//!
//! Clamps, roundings and conversions from integers say how large a float can be, and that it is no NaN. A conversion to
//! integers in range is one instruction of x86-64 instead of seven, and the bits of what is no NaN are just there.

use jerboa_ir::{Lit, Node, NodeId, Op, Program, Scalar};

use crate::abi::data;

/// Bounds of a float that is no NaN.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Range {
    low: f32,
    high: f32,
}

/// Operands are followed so many operations deep.
const DEPTH: u32 = 8;

impl Range {
    /// Of a scalar, or of each lane of a vector, if anything is known.
    pub fn of(p: &Program, x: NodeId) -> Option<Range> {
        Range::within(p, x, DEPTH)
    }

    /// Does it become this integer type without being clamped?
    pub fn fits(self, scalar: Scalar) -> bool {
        let low = match scalar {
            Scalar::U32 => self.low > -1.0,
            _ => self.low >= -2_147_483_648.0,
        };
        // The float before 2^31, for a `u32` as well: the conversion is a signed one.
        low && self.high <= 2_147_483_520.0
    }

    fn within(p: &Program, x: NodeId, depth: u32) -> Option<Range> {
        let depth = depth.checked_sub(1)?;
        let of = |x: NodeId| Range::within(p, x, depth);
        let (op, args) = match p.node(x) {
            Node::Lit(Lit::F32(bits)) => {
                let value = f32::from_bits(*bits);
                return (!value.is_nan()).then_some(Range { low: value, high: value });
            }
            Node::Pack(elems) if elems.iter().all(|e| *e == elems[0]) => return of(elems[0]),
            Node::Prim { op, args } => (*op, args),
            _ => return None,
        };
        let round = |f: fn(f32) -> f32| of(args[0]).map(|x| Range { low: f(x.low), high: f(x.high) });
        match op {
            // The second operand if the first is NaN.
            Op::Min | Op::Max => {
                let any = Range { low: f32::NEG_INFINITY, high: f32::INFINITY };
                let y = of(args[1])?;
                Some(match (op, of(args[0])) {
                    (Op::Min, None) => Range { high: y.high, ..any },
                    (_, None) => Range { low: y.low, ..any },
                    (Op::Min, Some(x)) => Range { low: x.low.min(y.low), high: x.high.min(y.high) },
                    (_, Some(x)) => Range { low: x.low.max(y.low), high: x.high.max(y.high) },
                })
            }
            Op::Select => {
                let (x, y) = (of(args[1])?, of(args[2])?);
                Some(Range { low: x.low.min(y.low), high: x.high.max(y.high) })
            }
            Op::Floor => round(f32::floor),
            Op::Ceil => round(f32::ceil),
            Op::Trunc => round(f32::trunc),
            Op::Round => round(f32::round_ties_even),
            Op::ToF32 if data(p.ty(args[0])).0 == Scalar::I32 => {
                Some(Range { low: -2_147_483_648.0, high: 2_147_483_648.0 })
            }
            Op::ToF32 => Some(Range { low: 0.0, high: 4_294_967_296.0 }),
            _ => None,
        }
    }
}

/// The largest that a `u32` can be, if masks and literals say so.
pub(super) fn most(p: &Program, x: NodeId) -> Option<u32> {
    most_within(p, x, DEPTH)
}

fn most_within(p: &Program, x: NodeId, depth: u32) -> Option<u32> {
    let depth = depth.checked_sub(1)?;
    let (op, args) = match p.node(x) {
        Node::Lit(lit) => return lit.as_u32(),
        Node::Prim { op, args } => (*op, args),
        _ => return None,
    };
    let of = |i: usize| most_within(p, args[i], depth);
    match op {
        Op::And => of(0).into_iter().chain(of(1)).min(),
        Op::Add => of(0)?.checked_add(of(1)?),
        Op::Mul => of(0)?.checked_mul(of(1)?),
        _ => None,
    }
}

/// Is this `u32` less than 2^31, hence the same as an `i32`?
pub(super) fn is_signed(p: &Program, x: NodeId) -> bool {
    let Node::Prim { op, args } = p.node(x) else { return false };
    let second = || literal(p, args[1]).and_then(|lit| lit.as_u32());
    match op {
        Op::Shr => second().is_some_and(|by| by % 32 > 0),
        Op::And => second().is_some_and(|bits| bits >> 31 == 0),
        _ => false,
    }
}

/// The literal that a scalar is, or each lane of a vector.
pub(super) fn literal(p: &Program, x: NodeId) -> Option<Lit> {
    match p.node(x) {
        Node::Pack(elems) if elems.iter().all(|e| *e == elems[0]) => p.as_lit(elems[0]),
        Node::Lit(lit) => Some(*lit),
        _ => None,
    }
}
