//! Lanes in and out of parts.

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{ConstantData, Immediate, InstBuilder, MemFlagsData, Type, Value, types};
use cranelift_frontend::FunctionBuilder;
use jerboa_ir::Scalar;
use rustc_hash::FxHashMap;

use crate::abi::{LANES, part};
use crate::memory::Place;

/// One lane of a vector, as a scalar.
pub(crate) fn lane(b: &mut FunctionBuilder, scalar: Scalar, parts: &[Value], lane: usize) -> Value {
    let x = b.ins().extractlane(parts[lane / LANES], (lane % LANES) as u8);
    if scalar == Scalar::Bool { b.ins().icmp_imm_u(IntCC::NotEqual, x, 0) } else { x }
}

/// The lanes of a part of `u32`, as 64 bits each: two at a time, which takes fewer instructions than one by one.
pub(crate) fn wide_lanes(b: &mut FunctionBuilder, x: Value) -> [Value; LANES] {
    let pairs = cast(b, types::I64X2, x);
    // The first one as a float: that is where it is already.
    let floats = cast(b, types::F64X2, x);
    let low = b.ins().extractlane(floats, 0);
    let low = b.ins().bitcast(types::I64, MemFlagsData::new(), low);
    let high = b.ins().extractlane(pairs, 1);
    let mut split = |pair| {
        let first = b.ins().ireduce(types::I32, pair);
        [b.ins().uextend(types::I64, first), b.ins().ushr_imm_u(pair, 32)]
    };
    let ([w, x], [y, z]) = (split(low), split(high));
    [w, x, y, z]
}

/// Another part, with this scalar in one lane.
pub(crate) fn insert(b: &mut FunctionBuilder, scalar: Scalar, vector: Value, lane: usize, x: Value) -> Value {
    let x = in_lane(b, scalar, x);
    b.ins().insertlane(vector, x, lane as u8)
}

/// A part with this scalar in every lane.
pub(crate) fn splat(b: &mut FunctionBuilder, scalar: Scalar, x: Value) -> Value {
    let x = in_lane(b, scalar, x);
    b.ins().splat(part(scalar), x)
}

/// The parts of a vector of these lanes.
pub(crate) fn pack(b: &mut FunctionBuilder, scalar: Scalar, lanes: &[Value]) -> Vec<Value> {
    let one = |chunk: &[Value]| {
        let first = splat(b, scalar, chunk[0]);
        (1..chunk.len()).fold(first, |vector, i| insert(b, scalar, vector, i, chunk[i]))
    };
    lanes.chunks(LANES).map(one).collect()
}

/// A part of up to four words of memory, which are loaded as floats, whatever they are: into the registers where vectors
/// are. In pairs, so that no instruction waits for all others.
pub(crate) fn loaded(b: &mut FunctionBuilder, ty: Type, flags: MemFlagsData, words: &[Place]) -> Value {
    let mut pair = |words: &[Place]| {
        let mut load = |word: &Place| b.ins().load(types::F32, flags, word.address, word.offset);
        let (first, second) = (load(&words[0]), words.get(1).map(load));
        let first = b.ins().splat(types::F32X4, first);
        second.map_or(first, |second| b.ins().insertlane(first, second, 1))
    };
    let low = pair(&words[..words.len().min(2)]);
    let all = match &words[words.len().min(2)..] {
        [] => low,
        rest => {
            let high = pair(rest);
            shuffle(b, low, high, [0, 1, 4, 5])
        }
    };
    cast(b, ty, all)
}

/// A part of this type with these words.
pub(crate) fn constant(b: &mut FunctionBuilder, ty: Type, words: [u32; LANES]) -> Value {
    let bytes: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
    let constant = b.func.dfg.constants.insert(ConstantData::from(bytes));
    b.ins().vconst(ty, constant)
}

/// Constants that several parts share.
#[derive(Default)]
pub(crate) struct Constants(FxHashMap<(Type, [u32; LANES]), Value>);

impl Constants {
    /// A part of this type with these words.
    pub fn get(&mut self, b: &mut FunctionBuilder, ty: Type, words: [u32; LANES]) -> Value {
        *self.0.entry((ty, words)).or_insert_with(|| constant(b, ty, words))
    }

    /// They are made anew from here on.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}

/// A part whose lanes are those of `x` and, from [`LANES`] on, of `y`.
pub(crate) fn shuffle(b: &mut FunctionBuilder, x: Value, y: Value, lanes: [usize; LANES]) -> Value {
    let ty = b.func.dfg.value_type(x);
    let bytes: Vec<u8> = lanes.iter().flat_map(|l| (0..4).map(|byte| *l as u8 * 4 + byte)).collect();
    let mask: Immediate = b.func.dfg.immediates.push(ConstantData::from(bytes));
    let (x, y) = (cast(b, types::I8X16, x), cast(b, types::I8X16, y));
    let shuffled = b.ins().shuffle(x, y, mask);
    cast(b, ty, shuffled)
}

/// The columns of four rows.
pub(crate) fn transposed(b: &mut FunctionBuilder, rows: [Value; LANES]) -> [Value; LANES] {
    let [first, second] =
        [[0, 4, 1, 5], [2, 6, 3, 7]].map(|lanes| [0, 2].map(|row| shuffle(b, rows[row], rows[row + 1], lanes)));
    let [low, high] = [[0, 1, 4, 5], [2, 3, 6, 7]];
    [(first, low), (first, high), (second, low), (second, high)].map(|([x, y], lanes)| shuffle(b, x, y, lanes))
}

/// The same bits as another type of as many.
pub(crate) fn cast(b: &mut FunctionBuilder, ty: Type, x: Value) -> Value {
    if b.func.dfg.value_type(x) == ty {
        return x;
    }
    let order = MemFlagsData::new().with_endianness(cranelift_codegen::ir::Endianness::Little);
    b.ins().bitcast(ty, order, x)
}

/// What a lane holds for a scalar.
fn in_lane(b: &mut FunctionBuilder, scalar: Scalar, x: Value) -> Value {
    if scalar == Scalar::Bool { b.ins().bmask(types::I32, x) } else { x }
}
