//! Where words are: a column of a buffer and a local array are both [`Words`].

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{InstBuilder, MemFlagsData, StackSlot, StackSlotData, StackSlotKind, Value, types};
use cranelift_frontend::FunctionBuilder;
use jerboa_ir::Scalar;

use crate::abi::{LANES, POINTER, clif};
use crate::pack;

/// A word of 4 bytes in memory.
#[derive(Clone, Copy)]
pub(crate) struct Place {
    pub address: Value,
    pub offset: i32,
}

/// A column of a buffer, or a local array: words at equal distances.
#[derive(Clone, Copy)]
pub(crate) struct Words {
    pub base: Value,
    pub offset: i32,
    /// Bytes between rows.
    pub stride: u32,
    /// The number of rows.
    pub rows: Value,
    /// The last row, of a stream without rows its row of zeros.
    pub last: Value,
}

impl Words {
    /// The word of row 0, which every table has; of a stream without rows a word 0.
    pub fn first(&self) -> Place {
        Place { address: self.base, offset: self.offset }
    }

    /// The word at a distance from row 0.
    pub fn at(&self, b: &mut FunctionBuilder, distance: Distance) -> Place {
        let bytes = b.ins().ishl_imm_u(distance.steps, distance.shift);
        Place { address: b.ins().iadd(self.base, bytes), offset: self.offset }
    }

    /// The word of this row, a `u32` that is less than the number of rows.
    pub fn row(&self, b: &mut FunctionBuilder, row: Value) -> Place {
        let distance = Distance::of(b, row, self.stride);
        self.at(b, distance)
    }

    /// The word of this row, or of the last one.
    pub fn clamped(&self, b: &mut FunctionBuilder, row: Value) -> Place {
        let row = b.ins().umin(row, self.last);
        self.row(b, row)
    }
}

/// Bytes from row 0 to a row: steps of a size that an address takes in.
#[derive(Clone, Copy)]
pub(crate) struct Distance {
    steps: Value,
    shift: i64,
}

impl Distance {
    /// To this row, a `u32`.
    pub fn of(b: &mut FunctionBuilder, row: Value, stride: u32) -> Distance {
        let row = b.ins().uextend(types::I64, row);
        Distance::of_wide(b, row, stride)
    }

    /// To this row, as 64 bits.
    fn of_wide(b: &mut FunctionBuilder, row: Value, stride: u32) -> Distance {
        let (step, shift) = step(stride);
        let steps = match step.is_power_of_two() {
            true if step == 1 => row,
            true => b.ins().ishl_imm_u(row, i64::from(step.trailing_zeros())),
            false => b.ins().imul_imm_u(row, i64::from(step)),
        };
        Distance { steps, shift }
    }

    /// To four rows, the lanes of a part of `u32`. Steps are counted in 32 bits: a step is a word at least.
    pub fn of_lanes(b: &mut FunctionBuilder, rows: Value, stride: u32) -> [Distance; LANES] {
        let (step, shift) = step(stride);
        let steps = match step.is_power_of_two() {
            true if step == 1 => rows,
            true => b.ins().ishl_imm_u(rows, i64::from(step.trailing_zeros())),
            false => {
                let step = pack::constant(b, types::I32X4, [step; LANES]);
                b.ins().imul(rows, step)
            }
        };
        pack::wide_lanes(b, steps).map(|steps| Distance { steps, shift })
    }
}

/// Bytes between rows as a number of steps, and the logarithm of a step that an address takes in.
fn step(stride: u32) -> (u32, i64) {
    let shift = stride.trailing_zeros().min(3);
    (stride >> shift, i64::from(shift))
}

/// A local array in the frame.
#[derive(Clone, Copy)]
pub(crate) struct Local {
    slot: StackSlot,
    len: u32,
}

impl Local {
    /// Bytes that an array of so many words takes: whole vectors.
    pub fn bytes(len: u32) -> u64 {
        u64::from(len).next_multiple_of(4) * 4
    }

    /// Room for an array. Its size was checked against [`crate::STACK_LIMIT`].
    pub fn new(b: &mut FunctionBuilder, len: u32) -> Local {
        let size = Local::bytes(len) as u32;
        Local { slot: b.create_sized_stack_slot(StackSlotData::new(StackSlotKind::ExplicitSlot, size, 4)), len }
    }

    /// Its words.
    pub fn words(self, b: &mut FunctionBuilder) -> Words {
        let base = b.ins().stack_addr(POINTER, self.slot, 0);
        let rows = b.ins().iconst(types::I32, i64::from(self.len));
        let last = b.ins().iconst(types::I32, i64::from(self.len - 1));
        Words { base, offset: 0, stride: 4, rows, last }
    }

    /// The number of elements.
    pub fn len(self) -> u32 {
        self.len
    }

    /// Fills it with zeros: a few stores, or a loop of some at a time.
    pub fn clear(self, b: &mut FunctionBuilder) {
        const AT_A_TIME: u64 = 16 * 16;
        let bytes = Local::bytes(self.len);
        let base = b.ins().stack_addr(POINTER, self.slot, 0);
        let zero = pack::constant(b, types::I32X4, [0; LANES]);
        let some = |b: &mut FunctionBuilder, at: Value, bytes: u64| {
            for offset in (0..bytes as i32).step_by(16) {
                b.ins().store(MemFlagsData::trusted(), zero, at, offset);
            }
        };
        let rest = bytes % AT_A_TIME;
        some(b, base, rest);
        let first = b.ins().iadd_imm_u(base, rest as i64);
        match bytes / AT_A_TIME {
            0 => return,
            1 => return some(b, first, AT_A_TIME),
            _ => {}
        }
        let (body, done) = (b.create_block(), b.create_block());
        let at = b.append_block_param(body, POINTER);
        let end = b.ins().iadd_imm_u(base, bytes as i64);
        b.ins().jump(body, &[first.into()]);
        b.switch_to_block(body);
        some(b, at, AT_A_TIME);
        let next = b.ins().iadd_imm_u(at, AT_A_TIME as i64);
        let more = b.ins().icmp(IntCC::UnsignedLessThan, next, end);
        b.ins().brif(more, body, &[next.into()], done, &[]);
        b.switch_to_block(done);
    }
}

/// Loads a scalar. A word that is not 0 is `true`.
pub(crate) fn load(b: &mut FunctionBuilder, scalar: Scalar, place: &Place, flags: MemFlagsData) -> Value {
    if scalar == Scalar::Bool {
        let word = b.ins().load(types::I32, flags, place.address, place.offset);
        return b.ins().icmp_imm_u(IntCC::NotEqual, word, 0);
    }
    b.ins().load(clif(scalar), flags, place.address, place.offset)
}

/// Stores a scalar. A bool is the word 0 or 1.
pub(crate) fn store(b: &mut FunctionBuilder, scalar: Scalar, place: &Place, value: Value) {
    let value = if scalar == Scalar::Bool { b.ins().uextend(types::I32, value) } else { value };
    b.ins().store(MemFlagsData::trusted(), value, place.address, place.offset);
}

/// The `n`-th of the words at an address.
pub(crate) fn nth_word(address: Value, n: usize) -> Place {
    Place { address, offset: n as i32 * 4 }
}
