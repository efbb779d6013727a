//! The operations on scalars as naga expressions, bit for bit what [`Op::eval`] says.
//!
//! The `match` has no wildcard over [`Op`]: an operation without code does not compile. Where naga, SPIR-V or a driver
//! would do something else, the operation is spelled with what they agree on: minimum and maximum by a comparison, `≠`
//! of floats as the contrary of `=`, conversions to integers of numbers in range only, shifts and divisions likewise.
//! Whether a float is NaN is asked of its bits: a driver may assume that floats are numbers.

use jerboa_ir::{Lit, NAN_BITS, Op, Scalar};
use naga::{BinaryOperator as B, MathFunction, UnaryOperator as U};

use crate::code::{Code, Value};

/// An operand, and the literal that it is.
pub(crate) type Operand = (Value, Option<Lit>);

/// Code of one operation on scalars. `scalar` is the type of the last operand, the T of the operation's rule (for a shift
/// that of the first). The absorbing product has a third operand, a +0 that no driver can fold. Operations over lanes are not
/// here: see [`over_lanes`].
pub(crate) fn scalar(c: &mut Code, op: Op, scalar: Scalar, args: &[Operand]) -> Value {
    let float = scalar == Scalar::F32;
    let (x, y) = (args[0].0, args[args.len().min(2) - 1].0);
    match op {
        Op::Add => c.binary(B::Add, x, y),
        Op::Sub => c.binary(B::Subtract, x, y),
        Op::Mul => c.binary(B::Multiply, x, y),
        Op::Div if float => c.binary(B::Divide, x, y),
        Op::Div | Op::Rem => divide(c, op, scalar, args[0], args[1]),
        // Not naga's `min` and `max`: those give the operand that is a number.
        Op::Min => pick(c, B::Less, x, y),
        Op::Max => pick(c, B::Greater, x, y),
        Op::Neg => c.unary(U::Negate, x),
        Op::Abs if float => {
            // Not naga's `abs`: drivers take a root for positive and leave the sign of √−0 as it is.
            let bits = c.cast(x, Scalar::U32);
            let magnitude = c.u32(0x7fff_ffff);
            let bits = c.binary(B::And, bits, magnitude);
            c.cast(bits, Scalar::F32)
        }
        Op::Abs => {
            let none = c.i32(0);
            let is_negative = c.binary(B::Less, x, none);
            let negated = c.unary(U::Negate, x);
            c.select(is_negative, negated, x)
        }
        Op::Fma => unreachable!("it was refused"),
        Op::Absorb => {
            let none = c.f32(0.0);
            let product = c.binary(B::Multiply, x, y);
            let x_is_zero = c.binary(B::Equal, x, none);
            let y_is_zero = c.binary(B::Equal, y, none);
            let absorbs = c.binary(B::LogicalOr, x_is_zero, y_is_zero);
            c.select(absorbs, args[2].0, product)
        }
        Op::Sqrt => c.math(MathFunction::Sqrt, x),
        Op::Floor => c.math(MathFunction::Floor, x),
        Op::Ceil => c.math(MathFunction::Ceil, x),
        Op::Trunc => c.math(MathFunction::Trunc, x),
        Op::Round => c.math(MathFunction::Round, x),
        Op::And if scalar == Scalar::Bool => c.binary(B::LogicalAnd, x, y),
        Op::And => c.binary(B::And, x, y),
        Op::Or if scalar == Scalar::Bool => c.binary(B::LogicalOr, x, y),
        Op::Or => c.binary(B::InclusiveOr, x, y),
        Op::Xor if scalar == Scalar::Bool => c.binary(B::NotEqual, x, y),
        Op::Xor => c.binary(B::ExclusiveOr, x, y),
        Op::Not if scalar == Scalar::Bool => c.unary(U::LogicalNot, x),
        Op::Not => c.unary(U::BitwiseNot, x),
        Op::Shl => {
            let by = amount(c, args[1]);
            c.binary(B::ShiftLeft, x, by)
        }
        Op::Shr => {
            let by = amount(c, args[1]);
            c.binary(B::ShiftRight, x, by)
        }
        Op::Eq => c.binary(B::Equal, x, y),
        // naga's `!=` of floats is false for NaN.
        Op::Ne if float => {
            let equal = c.binary(B::Equal, x, y);
            c.unary(U::LogicalNot, equal)
        }
        Op::Ne => c.binary(B::NotEqual, x, y),
        Op::Lt => c.binary(B::Less, x, y),
        Op::Le => c.binary(B::LessEqual, x, y),
        Op::Gt => c.binary(B::Greater, x, y),
        Op::Ge => c.binary(B::GreaterEqual, x, y),
        Op::Select => c.select(x, y, args[2].0),
        Op::ToF32 => c.convert(x, Scalar::F32),
        Op::ToI32 => {
            let (lowest, above) = (c.f32(-2_147_483_648.0), c.f32(2_147_483_648.0));
            let (least, most) = (c.i32(i32::MIN), c.i32(i32::MAX));
            let is_high = c.binary(B::GreaterEqual, x, above);
            let is_low = c.binary(B::Less, x, lowest);
            let converted = in_range(c, x, lowest, above, Scalar::I32);
            let low = c.select(is_low, least, converted);
            c.select(is_high, most, low)
        }
        Op::ToU32 => {
            let (lowest, above, most) = (c.f32(0.0), c.f32(4_294_967_296.0), c.u32(u32::MAX));
            let is_high = c.binary(B::GreaterEqual, x, above);
            let converted = in_range(c, x, lowest, above, Scalar::U32);
            c.select(is_high, most, converted)
        }
        Op::Bits => match scalar {
            Scalar::Bool => bit(c, x, 1),
            Scalar::I32 => c.cast(x, Scalar::U32),
            Scalar::U32 => x,
            Scalar::F32 => {
                let bits = c.cast(x, Scalar::U32);
                let (magnitude, infinity, nan) = (c.u32(0x7fff_ffff), c.u32(0x7f80_0000), c.u32(NAN_BITS));
                let magnitude = c.binary(B::And, bits, magnitude);
                let is_nan = c.binary(B::Greater, magnitude, infinity);
                c.select(is_nan, nan, bits)
            }
        },
        Op::FloatOfBits => c.cast(x, Scalar::F32),
        Op::IntOfBits => c.cast(x, Scalar::I32),
        Op::Any | Op::All | Op::Ballot => unreachable!("they take vectors, see `over_lanes`"),
    }
}

/// Code of an operation over all lanes of a vector of `bool`.
pub(crate) fn over_lanes(c: &mut Code, op: Op, lanes: &[Value]) -> Value {
    let fold = |c: &mut Code, op: B, xs: &[Value]| {
        let (first, rest) = xs.split_first().expect("a vector has lanes");
        rest.iter().fold(*first, |all, x| c.binary(op, all, *x))
    };
    match op {
        Op::Any => fold(c, B::LogicalOr, lanes),
        Op::All => fold(c, B::LogicalAnd, lanes),
        _ => {
            let bits: Vec<Value> = lanes.iter().enumerate().map(|(i, x)| bit(c, *x, 1 << i)).collect();
            fold(c, B::InclusiveOr, &bits)
        }
    }
}

/// These bits if a `bool` holds, else none.
pub(crate) fn bit(c: &mut Code, x: Value, bits: u32) -> Value {
    let (set, clear) = (c.u32(bits), c.u32(0));
    c.select(x, set, clear)
}

/// The first operand if the relation is true, else the second.
fn pick(c: &mut Code, relation: B, x: Value, y: Value) -> Value {
    let first = c.binary(relation, x, y);
    c.select(first, x, y)
}

/// A shift's amount, modulo the width: SPIR-V leaves larger ones undefined.
fn amount(c: &mut Code, by: Operand) -> Value {
    match by.1 {
        Some(lit) => c.u32(lit.word() % 32),
        None => {
            let last = c.u32(31);
            c.binary(B::And, by.0, last)
        }
    }
}

/// A float as an integer, 0 unless it is in `lowest` to below `above`.
fn in_range(c: &mut Code, x: Value, lowest: Value, above: Value, to: Scalar) -> Value {
    let none = c.f32(0.0);
    let not_low = c.binary(B::GreaterEqual, x, lowest);
    let not_high = c.binary(B::Less, x, above);
    let fits = c.binary(B::LogicalAnd, not_low, not_high);
    let x = c.select(fits, x, none);
    c.convert(x, to)
}

/// Integer quotient or remainder. Where SPIR-V leaves it undefined, the divisor is 1; then the remainder is right (0), and
/// so is the quotient of `i32::MIN` by −1; the quotient by 0 becomes 0. A literal divisor needs no test.
fn divide(c: &mut Code, op: Op, scalar: Scalar, (x, _): Operand, (y, lit): Operand) -> Value {
    let number = |c: &mut Code, n: i32| c.literal(if scalar == Scalar::I32 { Lit::I32(n) } else { Lit::U32(n as u32) });
    let operator = if op == Op::Rem { B::Modulo } else { B::Divide };
    let minus_one = Lit::I32(-1);
    match lit {
        Some(lit) if lit.word() == 0 => return number(c, 0),
        Some(lit) if lit != minus_one => return c.binary(operator, x, y),
        _ => {}
    }
    let (zero, one) = (number(c, 0), number(c, 1));
    let by_zero = c.binary(B::Equal, y, zero);
    let mut undefined = by_zero;
    if scalar == Scalar::I32 {
        let (least, minus_one) = (c.i32(i32::MIN), c.literal(minus_one));
        let is_least = c.binary(B::Equal, x, least);
        let by_minus_one = c.binary(B::Equal, y, minus_one);
        let overflows = c.binary(B::LogicalAnd, is_least, by_minus_one);
        undefined = c.binary(B::LogicalOr, by_zero, overflows);
    }
    let divisor = c.select(undefined, one, y);
    let result = c.binary(operator, x, divisor);
    if op == Op::Rem { result } else { c.select(by_zero, zero, result) }
}
