//! The operations on scalars as machine instructions, bit for bit what [`Op::eval`] says, and none that can trap.
//!
//! The `match` has no wildcard over [`Op`]: an operation without code does not compile.

use cranelift_codegen::ir::condcodes::{FloatCC, IntCC};
use cranelift_codegen::ir::{InstBuilder, MemFlagsData, Value, types};
use cranelift_frontend::FunctionBuilder;
use jerboa_ir::{NAN_BITS, Op, Scalar};

/// Code of one operation on scalars. `scalar` is the type of the last operand, the T of the operation's rule (for a shift
/// that of the first); `fma` gives the fused multiply-add of three floats. Operations over lanes are not here: see
/// [`crate::vector::over_lanes`].
pub(crate) fn scalar(
    b: &mut FunctionBuilder,
    op: Op,
    scalar: Scalar,
    args: &[Value],
    fma: impl FnOnce(&mut FunctionBuilder, &[Value]) -> Value,
) -> Value {
    let float = scalar == Scalar::F32;
    let (x, y) = (args[0], args[args.len().min(2) - 1]);
    match op {
        Op::Add if float => b.ins().fadd(x, y),
        Op::Add => b.ins().iadd(x, y),
        Op::Sub if float => b.ins().fsub(x, y),
        Op::Sub => b.ins().isub(x, y),
        Op::Mul if float => b.ins().fmul(x, y),
        Op::Mul => b.ins().imul(x, y),
        Op::Div if float => b.ins().fdiv(x, y),
        Op::Div | Op::Rem => divide(b, op, scalar == Scalar::I32, x, y),
        // Not `fmin` and `fmax`: those pass NaN on and order the zeros.
        Op::Min => pick(b, Op::Lt, scalar, x, y),
        Op::Max => pick(b, Op::Gt, scalar, x, y),
        Op::Neg if float => b.ins().fneg(x),
        Op::Neg => b.ins().ineg(x),
        Op::Abs if float => b.ins().fabs(x),
        Op::Abs => b.ins().iabs(x),
        Op::Fma => fma(b, args),
        Op::Absorb => {
            let zero = b.ins().f32const(0.0);
            let product = b.ins().fmul(x, y);
            let x_is_zero = b.ins().fcmp(FloatCC::Equal, x, zero);
            let y_is_zero = b.ins().fcmp(FloatCC::Equal, y, zero);
            let absorbs = b.ins().bor(x_is_zero, y_is_zero);
            b.ins().select(absorbs, zero, product)
        }
        Op::Sqrt => b.ins().sqrt(x),
        Op::Floor => b.ins().floor(x),
        Op::Ceil => b.ins().ceil(x),
        Op::Trunc => b.ins().trunc(x),
        Op::Round => b.ins().nearest(x),
        Op::And => b.ins().band(x, y),
        Op::Or => b.ins().bor(x, y),
        Op::Xor => b.ins().bxor(x, y),
        // A bool is the byte 0 or 1.
        Op::Not if scalar == Scalar::Bool => b.ins().bxor_imm_u(x, 1),
        Op::Not => b.ins().bnot(x),
        // Shifts take their amount modulo the width.
        Op::Shl => b.ins().ishl(x, y),
        Op::Shr if scalar == Scalar::I32 => b.ins().sshr(x, y),
        Op::Shr => b.ins().ushr(x, y),
        Op::Eq | Op::Ne | Op::Lt | Op::Le | Op::Gt | Op::Ge => compare(b, op, scalar, x, y),
        Op::Select => b.ins().select(args[0], args[1], args[2]),
        Op::ToF32 if scalar == Scalar::I32 => b.ins().fcvt_from_sint(types::F32, x),
        Op::ToF32 => b.ins().fcvt_from_uint(types::F32, x),
        // The saturating conversions; the others trap.
        Op::ToI32 => b.ins().fcvt_to_sint_sat(types::I32, x),
        Op::ToU32 => b.ins().fcvt_to_uint_sat(types::I32, x),
        Op::Bits => match scalar {
            Scalar::Bool => b.ins().uextend(types::I32, x),
            Scalar::I32 | Scalar::U32 => x,
            Scalar::F32 => {
                let bits = b.ins().bitcast(types::I32, MemFlagsData::new(), x);
                let nan = b.ins().iconst(types::I32, i64::from(NAN_BITS));
                let is_nan = b.ins().fcmp(FloatCC::Unordered, x, x);
                b.ins().select(is_nan, nan, bits)
            }
        },
        Op::FloatOfBits => b.ins().bitcast(types::F32, MemFlagsData::new(), x),
        Op::IntOfBits => x,
        Op::Any | Op::All | Op::Ballot => unreachable!("they take vectors, see `vector::over_lanes`"),
    }
}

/// Is the relation true?
fn compare(b: &mut FunctionBuilder, op: Op, scalar: Scalar, x: Value, y: Value) -> Value {
    match scalar {
        Scalar::F32 => b.ins().fcmp(float_relation(op), x, y),
        _ => b.ins().icmp(int_relation(op, scalar), x, y),
    }
}

/// The relation of floats that a comparison tests.
pub(crate) fn float_relation(op: Op) -> FloatCC {
    match op {
        Op::Ne => FloatCC::NotEqual, // true for NaN, the others false
        Op::Lt => FloatCC::LessThan,
        Op::Le => FloatCC::LessThanOrEqual,
        Op::Gt => FloatCC::GreaterThan,
        Op::Ge => FloatCC::GreaterThanOrEqual,
        _ => FloatCC::Equal,
    }
}

/// The relation of integers that a comparison tests.
pub(crate) fn int_relation(op: Op, scalar: Scalar) -> IntCC {
    match (op, scalar) {
        (Op::Ne, _) => IntCC::NotEqual,
        (Op::Lt, Scalar::I32) => IntCC::SignedLessThan,
        (Op::Le, Scalar::I32) => IntCC::SignedLessThanOrEqual,
        (Op::Gt, Scalar::I32) => IntCC::SignedGreaterThan,
        (Op::Ge, Scalar::I32) => IntCC::SignedGreaterThanOrEqual,
        (Op::Lt, _) => IntCC::UnsignedLessThan,
        (Op::Le, _) => IntCC::UnsignedLessThanOrEqual,
        (Op::Gt, _) => IntCC::UnsignedGreaterThan,
        (Op::Ge, _) => IntCC::UnsignedGreaterThanOrEqual,
        _ => IntCC::Equal,
    }
}

/// The first operand if the relation is true, else the second.
fn pick(b: &mut FunctionBuilder, relation: Op, scalar: Scalar, x: Value, y: Value) -> Value {
    let first = compare(b, relation, scalar, x, y);
    b.ins().select(first, x, y)
}

/// Integer quotient or remainder. Where the machine would trap, the divisor is 1; then the remainder is right (0), and
/// so is the quotient of `i32::MIN` by −1; the quotient by 0 becomes 0.
fn divide(b: &mut FunctionBuilder, op: Op, signed: bool, x: Value, y: Value) -> Value {
    let zero = b.ins().iconst(types::I32, 0);
    let one = b.ins().iconst(types::I32, 1);
    let by_zero = b.ins().icmp(IntCC::Equal, y, zero);
    let mut traps = by_zero;
    if signed {
        let is_min = b.ins().icmp_imm_s(IntCC::Equal, x, i64::from(i32::MIN));
        let by_minus_one = b.ins().icmp_imm_s(IntCC::Equal, y, -1);
        let overflows = b.ins().band(is_min, by_minus_one);
        traps = b.ins().bor(by_zero, overflows);
    }
    let y = b.ins().select(traps, one, y);
    match (op, signed) {
        (Op::Rem, true) => b.ins().srem(x, y),
        (Op::Rem, false) => b.ins().urem(x, y),
        (_, true) => {
            let quotient = b.ins().sdiv(x, y);
            b.ins().select(by_zero, zero, quotient)
        }
        (_, false) => {
            let quotient = b.ins().udiv(x, y);
            b.ins().select(by_zero, zero, quotient)
        }
    }
}
