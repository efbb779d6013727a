//! Where instruction sets differ: what x86-64 (from SSE4.1 on) and AArch64 do best with 128 bits.

use cranelift_codegen::ir::condcodes::{FloatCC, IntCC};
use cranelift_codegen::ir::{InstBuilder, Type, Value, types};
use cranelift_frontend::FunctionBuilder;
use jerboa_ir::Scalar;

use crate::pack::cast;

/// The instruction set, as far as the choice of CLIF depends on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Simd {
    /// x86-64, else AArch64.
    pub x86: bool,
    /// Is a fused multiply-add one instruction? Else it is a call.
    pub fma: bool,
}

impl Simd {
    /// `x < y ? x : y` in each lane.
    pub fn min(self, b: &mut FunctionBuilder, scalar: Scalar, x: Value, y: Value) -> Value {
        match scalar {
            Scalar::F32 => pick(b, x, y, x, y),
            Scalar::I32 => b.ins().smin(x, y),
            Scalar::U32 | Scalar::Bool => b.ins().umin(x, y),
        }
    }

    /// `x > y ? x : y` in each lane.
    pub fn max(self, b: &mut FunctionBuilder, scalar: Scalar, x: Value, y: Value) -> Value {
        match scalar {
            Scalar::F32 => pick(b, y, x, x, y),
            Scalar::I32 => b.ins().smax(x, y),
            Scalar::U32 | Scalar::Bool => b.ins().umax(x, y),
        }
    }

    /// Is every lane of a mask true?
    pub fn all(self, b: &mut FunctionBuilder, mask: Value) -> Value {
        if !self.x86 {
            return b.ins().vall_true(mask);
        }
        let bits = b.ins().vhigh_bits(types::I32, mask);
        b.ins().icmp_imm_u(IntCC::Equal, bits, 0b1111)
    }

    /// `mask ? x : y` in each lane, of a mask of 0 and −1.
    pub fn select(self, b: &mut FunctionBuilder, mask: Value, x: Value, y: Value) -> Value {
        let ty = b.func.dfg.value_type(x);
        if !self.x86 {
            let mask = cast(b, ty, mask);
            return b.ins().bitselect(mask, x, y);
        }
        // One instruction where `bitselect` would be three.
        let (x, y) = (cast(b, types::I32X4, x), cast(b, types::I32X4, y));
        let picked = b.ins().blendv(mask, x, y);
        cast(b, ty, picked)
    }
}

/// `a < b ? x : y` in each lane. Cranelift makes this very pattern, with (x, y) the operands in either order, one
/// instruction of x86-64; `fmin` and `fmax` would pass NaN on, order the zeros and be eight.
fn pick(f: &mut FunctionBuilder, a: Value, b: Value, x: Value, y: Value) -> Value {
    let less = f.ins().fcmp(FloatCC::LessThan, a, b);
    let less = cast(f, types::F32X4, less);
    f.ins().bitselect(less, x, y)
}

/// The type of a mask.
pub(crate) const MASK: Type = types::I32X4;
