//! Shapes: how a value differs from lane to lane.

use jerboa_ir::{Op, Scalar, Ty};

/// How a value differs between the lanes that are active.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub(crate) enum Shape {
    /// Not at all: it is kept as one scalar.
    Uniform,
    /// Lane l has the value of lane 0 plus l, wrapping: an integer, kept as that of lane 0.
    Consecutive,
    /// In any way: it is kept as a vector.
    Varying,
}

impl Shape {
    /// The shape of a value that is one of these two, by a decision that is the same for all lanes.
    pub fn or(self, other: Shape) -> Shape {
        if self == other { self } else { Shape::Varying }
    }

    /// The shape of an operation's result, which is of type `ty`.
    pub fn of_op(op: Op, args: &[Shape], ty: Ty) -> Shape {
        use Shape::*;
        let integer = matches!(ty.as_scalar(), Some(Scalar::I32 | Scalar::U32));
        match (op, args) {
            _ if args.iter().all(|s| *s == Uniform) => Uniform,
            (Op::Add, [Consecutive, Uniform] | [Uniform, Consecutive]) if integer => Consecutive,
            (Op::Sub, [Consecutive, Uniform]) if integer => Consecutive,
            (Op::Bits | Op::IntOfBits, [Consecutive]) => Consecutive,
            _ => Varying,
        }
    }

    /// The shape of a vector, a lane of one, or a read of a table.
    pub fn of_parts(parts: &[Shape]) -> Shape {
        if parts.iter().all(|s| *s == Shape::Uniform) { Shape::Uniform } else { Shape::Varying }
    }
}
