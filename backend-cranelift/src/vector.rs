//! The operations on vectors, part by part, bit for bit what [`Op::eval`] says of each lane, and none that can trap.
//!
//! The `match` has no wildcard over [`Op`]: an operation without code does not compile. Lanes beyond the vector's length
//! may compute anything.

use cranelift_codegen::ir::condcodes::{FloatCC, IntCC};
use cranelift_codegen::ir::{InstBuilder, Value, types};
use cranelift_frontend::FunctionBuilder;
use jerboa_ir::{NAN_BITS, Op, Scalar};

use crate::abi::LANES;
use crate::pack::{Constants, cast, constant};
use crate::simd::{MASK, Simd};

/// Code of one operation on a part; none where the machine has no vector instruction and it goes lane by lane. `scalar` is
/// the T of the operation's rule. All parts of an operation share its constants.
pub(crate) fn part(
    b: &mut FunctionBuilder,
    simd: Simd,
    constants: &mut Constants,
    op: Op,
    scalar: Scalar,
    args: &[Value],
) -> Option<Value> {
    let float = scalar == Scalar::F32;
    let (x, y) = (args[0], args[args.len().min(2) - 1]);
    Some(match op {
        Op::Add if float => b.ins().fadd(x, y),
        Op::Add => b.ins().iadd(x, y),
        Op::Sub if float => b.ins().fsub(x, y),
        Op::Sub => b.ins().isub(x, y),
        Op::Mul if float => b.ins().fmul(x, y),
        Op::Mul => b.ins().imul(x, y),
        Op::Div if float => b.ins().fdiv(x, y),
        Op::Div | Op::Rem => return None,
        Op::Min => simd.min(b, scalar, x, y),
        Op::Max => simd.max(b, scalar, x, y),
        Op::Neg if float => {
            let sign = constants.get(b, types::F32X4, [1 << 31; LANES]);
            b.ins().bxor(x, sign)
        }
        Op::Neg => b.ins().ineg(x),
        Op::Abs if float => {
            let others = constants.get(b, types::F32X4, [!(1 << 31); LANES]);
            b.ins().band(x, others)
        }
        Op::Abs => b.ins().iabs(x),
        Op::Fma if simd.fma => b.ins().fma(x, y, args[2]),
        Op::Fma => return None,
        Op::Absorb => {
            let zero = constants.get(b, types::F32X4, [0; LANES]);
            let product = b.ins().fmul(x, y);
            // True for NaN.
            let x_counts = b.ins().fcmp(FloatCC::NotEqual, x, zero);
            let y_counts = b.ins().fcmp(FloatCC::NotEqual, y, zero);
            let counts = b.ins().band(x_counts, y_counts);
            let counts = cast(b, types::F32X4, counts);
            b.ins().band(product, counts)
        }
        Op::Sqrt => b.ins().sqrt(x),
        Op::Floor => b.ins().floor(x),
        Op::Ceil => b.ins().ceil(x),
        Op::Trunc => b.ins().trunc(x),
        Op::Round => b.ins().nearest(x),
        Op::And => b.ins().band(x, y),
        Op::Or => b.ins().bor(x, y),
        Op::Xor => b.ins().bxor(x, y),
        Op::Not => b.ins().bnot(x),
        // By a scalar they are instructions, see `shift`.
        Op::Shl | Op::Shr => return None,
        Op::Eq | Op::Ne | Op::Lt | Op::Le | Op::Gt | Op::Ge => compare(b, op, scalar, x, y),
        Op::Select => simd.select(b, args[0], args[1], args[2]),
        Op::ToF32 if scalar == Scalar::I32 => b.ins().fcvt_from_sint(types::F32X4, x),
        Op::ToF32 => b.ins().fcvt_from_uint(types::F32X4, x),
        // The saturating conversions; the others trap.
        Op::ToI32 => b.ins().fcvt_to_sint_sat(types::I32X4, x),
        Op::ToU32 => b.ins().fcvt_to_uint_sat(types::I32X4, x),
        Op::Bits => match scalar {
            Scalar::Bool => b.ins().ushr_imm_u(x, 31),
            Scalar::I32 | Scalar::U32 => x,
            Scalar::F32 => {
                let bits = cast(b, types::I32X4, x);
                let nan = constants.get(b, types::I32X4, [NAN_BITS; LANES]);
                let is_nan = b.ins().fcmp(FloatCC::Unordered, x, x);
                simd.select(b, is_nan, nan, bits)
            }
        },
        Op::FloatOfBits => cast(b, types::F32X4, x),
        Op::IntOfBits => x,
        Op::Any | Op::All | Op::Ballot => unreachable!("they are no operation of a part, see `over_lanes`"),
    })
}

/// A shift of all lanes by the same scalar, modulo the width.
pub(crate) fn shift(b: &mut FunctionBuilder, op: Op, scalar: Scalar, x: Value, by: Value) -> Value {
    match (op, scalar) {
        (Op::Shl, _) => b.ins().ishl(x, by),
        (_, Scalar::I32) => b.ins().sshr(x, by),
        _ => b.ins().ushr(x, by),
    }
}

/// The part that these words of memory are: of `bool` a word that is not 0 is true.
pub(crate) fn of_words(b: &mut FunctionBuilder, scalar: Scalar, words: Value) -> Value {
    if scalar != Scalar::Bool {
        return words;
    }
    let zero = constant(b, MASK, [0; LANES]);
    b.ins().icmp(IntCC::NotEqual, words, zero)
}

/// The words that memory holds for a part.
pub(crate) fn to_words(b: &mut FunctionBuilder, scalar: Scalar, part: Value) -> Value {
    if scalar == Scalar::Bool { b.ins().ushr_imm_u(part, 31) } else { part }
}

/// `any`, `all` and `ballot` of so many lanes.
pub(crate) fn over_lanes(b: &mut FunctionBuilder, simd: Simd, op: Op, parts: &[Value], lanes: usize) -> Value {
    let mut parts = parts.to_vec();
    if let Some(last) = parts.last_mut().filter(|_| !lanes.is_multiple_of(LANES)) {
        // The lanes left over do not count.
        let there = std::array::from_fn(|i| if i < lanes % LANES { u32::MAX } else { 0 });
        *last = match op {
            Op::All => {
                let missing = constant(b, MASK, there.map(|w: u32| !w));
                b.ins().bor(*last, missing)
            }
            _ => {
                let there = constant(b, MASK, there);
                b.ins().band(*last, there)
            }
        };
    }
    match op {
        Op::Any => {
            let any = parts.into_iter().reduce(|x, y| b.ins().bor(x, y)).expect("a vector has parts");
            b.ins().vany_true(any)
        }
        Op::All => {
            let all = parts.into_iter().reduce(|x, y| b.ins().band(x, y)).expect("a vector has parts");
            simd.all(b, all)
        }
        _ => ballot(b, &parts),
    }
}

/// The sign bits of 1 to 4 masks: the masks are narrowed into one value first.
fn ballot(b: &mut FunctionBuilder, parts: &[Value]) -> Value {
    match *parts {
        [x] => b.ins().vhigh_bits(types::I32, x),
        [x, y] => {
            let narrow = b.ins().snarrow(x, y);
            b.ins().vhigh_bits(types::I32, narrow)
        }
        _ => {
            let last = parts.get(3).copied().unwrap_or_else(|| constant(b, MASK, [0; LANES]));
            let low = b.ins().snarrow(parts[0], parts[1]);
            let high = b.ins().snarrow(parts[2], last);
            let narrow = b.ins().snarrow(low, high);
            b.ins().vhigh_bits(types::I32, narrow)
        }
    }
}

/// The mask of the lanes where the relation is true.
fn compare(b: &mut FunctionBuilder, op: Op, scalar: Scalar, x: Value, y: Value) -> Value {
    if scalar == Scalar::F32 {
        return b.ins().fcmp(crate::ops::float_relation(op), x, y);
    }
    match op {
        Op::Ne if scalar == Scalar::Bool => b.ins().bxor(x, y),
        _ => b.ins().icmp(crate::ops::int_relation(op, scalar), x, y),
    }
}
