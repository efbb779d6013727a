//! Where words are: buffers and local arrays.
//!
//! Addresses of columns and numbers of rows are loaded once, where the function begins. A buffer without rows has a word 0
//! for each column: its columns lie in a word of the frame, and its last row is row 0.

use std::collections::BTreeSet;

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{InstBuilder, MemFlagsData, StackSlot, StackSlotData, StackSlotKind, Value, types};
use cranelift_frontend::FunctionBuilder;
use jerboa_ir::cfg::Function;
use jerboa_ir::schedule::Schedule;
use jerboa_ir::{Body, BufId, BufKind, Column, Layout, Mem, Node, Program, Scalar};
use rustc_hash::FxHashMap;

use crate::abi::{POINTER, clif};

/// Bytes of a [`crate::Binding`], and where its number of rows is.
const BINDING_BYTES: i32 = size_of::<crate::Binding>() as i32;
const ROWS_AT: i32 = std::mem::offset_of!(crate::Binding, rows) as i32;

/// A word of 4 bytes in memory.
pub(crate) struct Place {
    address: Value,
    offset: i32,
}

/// The buffers that a function touches.
#[derive(Default)]
pub(crate) struct Buffers {
    columns: FxHashMap<Column, Strided>,
    rows: FxHashMap<BufId, Rows>,
    /// Distance in bytes from row 0 to a clamped row, which all columns of a buffer share. Made in the block at hand.
    distances: FxHashMap<(BufId, Value), Value>,
}

/// Words at equal distances.
#[derive(Clone, Copy)]
struct Strided {
    base: Value,
    offset: i32,
    /// Bytes between rows.
    stride: u32,
}

#[derive(Clone, Copy)]
struct Rows {
    count: Value,
    /// The last row; row 0 of a buffer without rows.
    last: Value,
}

impl Buffers {
    /// Loads the addresses of all columns that the function touches.
    pub fn new(b: &mut FunctionBuilder, p: &Program, used: &BTreeSet<Column>, bindings: Value) -> Buffers {
        let mut buffers = Buffers::default();
        let constant = MemFlagsData::trusted().with_readonly();
        let mut words = FxHashMap::default();
        let mut empty: Option<Value> = None;
        for column in used {
            let buffer = p.buffer(column.buf);
            let at = column.buf.0 as i32 * BINDING_BYTES;
            let stream = buffer.kind == BufKind::Stream;
            let start = *words.entry(column.buf).or_insert_with(|| b.ins().load(POINTER, constant, bindings, at));
            let rows = *buffers.rows.entry(column.buf).or_insert_with(|| {
                let count = b.ins().load(types::I32, constant, bindings, at + ROWS_AT);
                let one = b.ins().iconst(types::I32, 1);
                let some = if stream { b.ins().umax(count, one) } else { count };
                Rows { count, last: b.ins().isub(some, one) }
            });
            let mut place = match buffer.layout {
                Layout::Rows => {
                    Strided { base: start, offset: column.col as i32 * 4, stride: buffer.columns.len() as u32 * 4 }
                }
                Layout::Columns => {
                    let count = b.ins().uextend(types::I64, rows.count);
                    let before = b.ins().imul_imm_u(count, i64::from(column.col) * 4);
                    Strided { base: b.ins().iadd(start, before), offset: 0, stride: 4 }
                }
            };
            if stream {
                let zero = *empty.get_or_insert_with(|| zero_word(b));
                let address = b.ins().iadd_imm_u(place.base, i64::from(place.offset));
                place = Strided { base: b.ins().select(rows.count, address, zero), offset: 0, ..place };
            }
            buffers.columns.insert(*column, place);
        }
        buffers
    }

    /// The word of this row, which is less than the number of rows.
    pub fn unchecked(&self, b: &mut FunctionBuilder, column: Column, row: Value) -> Place {
        let Strided { base, offset, stride } = self.columns[&column];
        let distance = distance(b, row, stride);
        Place { address: b.ins().iadd(base, distance), offset }
    }

    /// The word of this row, or of the last one.
    pub fn clamped(&mut self, b: &mut FunctionBuilder, column: Column, row: Value) -> Place {
        let Strided { base, offset, stride } = self.columns[&column];
        let last = self.rows[&column.buf].last;
        let distance = *self.distances.entry((column.buf, row)).or_insert_with(|| {
            let row = b.ins().umin(row, last);
            distance(b, row, stride)
        });
        Place { address: b.ins().iadd(base, distance), offset }
    }

    /// The word of row 0, which every table has; of a stream without rows a word 0.
    pub fn first(&self, column: Column) -> Place {
        let Strided { base, offset, .. } = self.columns[&column];
        Place { address: base, offset }
    }

    /// Another block begins: what was made in this one may not dominate it.
    pub fn begin_block(&mut self) {
        self.distances.clear();
    }

    /// The number of rows.
    pub fn rows(&self, buffer: BufId) -> Value {
        self.rows[&buffer].count
    }
}

/// The columns that a function reads, loads or stores.
pub(crate) fn used_columns(p: &Program, f: &Function, schedule: &Schedule) -> BTreeSet<Column> {
    let mut used = BTreeSet::new();
    for node in schedule.blocks.iter().flatten() {
        if let Node::Read { column, .. } = p.node(*node) {
            used.insert(*column);
        }
    }
    for block in &f.blocks {
        if let Body::Load { mem, .. } | Body::Store { mem, .. } = &p.cont(block.cont).body
            && let Mem::Stream(column) | Mem::Unchecked(column) = mem
        {
            used.insert(*column);
        }
    }
    used
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

    /// Fills it with zeros: a few stores, or a loop.
    pub fn clear(self, b: &mut FunctionBuilder) {
        const UNROLLED: u64 = 16 * 16;
        let bytes = Local::bytes(self.len);
        let base = b.ins().stack_addr(POINTER, self.slot, 0);
        let zero = b.ins().iconst(types::I64, 0);
        if bytes <= UNROLLED {
            for at in (0..bytes as i32).step_by(8) {
                b.ins().store(MemFlagsData::trusted(), zero, base, at);
            }
            return;
        }
        let (body, done) = (b.create_block(), b.create_block());
        let at = b.append_block_param(body, POINTER);
        let end = b.ins().iadd_imm_u(base, bytes as i64);
        b.ins().jump(body, &[base.into()]);
        b.switch_to_block(body);
        b.ins().store(MemFlagsData::trusted(), zero, at, 0);
        b.ins().store(MemFlagsData::trusted(), zero, at, 8);
        let next = b.ins().iadd_imm_u(at, 16);
        let more = b.ins().icmp(IntCC::UnsignedLessThan, next, end);
        b.ins().brif(more, body, &[next.into()], done, &[]);
        b.switch_to_block(done);
    }

    /// The word of this element, or of the last one.
    pub fn clamped(self, b: &mut FunctionBuilder, index: Value) -> Place {
        let last = b.ins().iconst(types::I32, i64::from(self.len - 1));
        let index = b.ins().umin(index, last);
        self.unchecked(b, index)
    }

    /// The word of this element, which is less than the length.
    pub fn unchecked(self, b: &mut FunctionBuilder, index: Value) -> Place {
        let base = b.ins().stack_addr(POINTER, self.slot, 0);
        let distance = distance(b, index, 4);
        Place { address: b.ins().iadd(base, distance), offset: 0 }
    }

    /// The number of elements.
    pub fn len(self, b: &mut FunctionBuilder) -> Value {
        b.ins().iconst(types::I32, i64::from(self.len))
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

/// Bytes from row 0 to this row.
fn distance(b: &mut FunctionBuilder, row: Value, stride: u32) -> Value {
    let row = b.ins().uextend(types::I64, row);
    if stride == 4 { b.ins().ishl_imm_u(row, 2) } else { b.ins().imul_imm_u(row, i64::from(stride)) }
}

/// The address of a word 0 in the frame.
fn zero_word(b: &mut FunctionBuilder) -> Value {
    let slot = b.create_sized_stack_slot(StackSlotData::new(StackSlotKind::ExplicitSlot, 4, 2));
    let zero = b.ins().iconst(types::I32, 0);
    b.ins().stack_store(POINTER, zero, slot, 0);
    b.ins().stack_addr(POINTER, slot, 0)
}
