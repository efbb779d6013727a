//! Where words are: buffers and local arrays.
//!
//! Both are [`Words`]. Addresses of columns and numbers of rows are loaded once, where the function begins. A stream
//! without rows has a row of zeros in the frame, and that is its last row.

use std::collections::BTreeSet;

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{InstBuilder, MemFlagsData, StackSlot, StackSlotData, StackSlotKind, Value, types};
use cranelift_frontend::FunctionBuilder;
use jerboa_ir::cfg::Function;
use jerboa_ir::schedule::Schedule;
use jerboa_ir::{Body, BufId, BufKind, Column, Layout, Mem, Node, Program, Scalar};
use rustc_hash::FxHashMap;

use crate::abi::{LANES, POINTER, clif, data, part};
use crate::pack;

/// Bytes of a [`crate::Binding`], and where its number of rows is.
const BINDING_BYTES: i32 = size_of::<crate::Binding>() as i32;
const ROWS_AT: i32 = std::mem::offset_of!(crate::Binding, rows) as i32;

/// A word of 4 bytes in memory.
#[derive(Clone, Copy)]
pub(crate) struct Place {
    pub address: Value,
    pub offset: i32,
}

/// A column of a buffer, or a local array: words at equal distances.
#[derive(Clone, Copy)]
pub(crate) struct Words {
    base: Value,
    offset: i32,
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
    pub fn of_wide(b: &mut FunctionBuilder, row: Value, stride: u32) -> Distance {
        let shift = stride.trailing_zeros().min(3);
        let step = stride >> shift;
        let steps = match step.is_power_of_two() {
            true if step == 1 => row,
            true => b.ins().ishl_imm_u(row, i64::from(step.trailing_zeros())),
            false => b.ins().imul_imm_u(row, i64::from(step)),
        };
        Distance { steps, shift: i64::from(shift) }
    }
}

/// The buffers that a function touches.
#[derive(Default)]
pub(crate) struct Buffers {
    starts: FxHashMap<BufId, Start>,
    /// Columns whose address is made where the function begins.
    columns: FxHashMap<Column, Words>,
    /// Distance to a clamped row, which all columns of a buffer share. Made in the block at hand.
    distances: FxHashMap<(BufId, Value), Distance>,
    /// Distances to the rows of a part of indices, clamped to a last row or unchecked, for a stride. Likewise.
    gathered: FxHashMap<(Option<Value>, Value, u32), [Distance; LANES]>,
    /// Four columns of a table by rows, at the rows of a part of indices. Likewise.
    windows: FxHashMap<(Value, Option<Value>, Value, i32), [Value; LANES]>,
    /// Parts of last rows. Likewise.
    lasts: FxHashMap<Value, Value>,
}

/// A buffer's first word and size.
#[derive(Clone, Copy)]
struct Start {
    /// Of the first column.
    words: Words,
    /// Bytes from a column to the next.
    step: Value,
}

impl Buffers {
    /// Loads the addresses of what the function touches.
    pub fn new(b: &mut FunctionBuilder, p: &Program, used: &Used, bindings: Value) -> Buffers {
        let mut buffers = Buffers::default();
        for buf in &used.buffers {
            buffers.starts.insert(*buf, Start::new(b, p, *buf, bindings));
        }
        for column in &used.columns {
            let words = buffers.words(b, *column);
            buffers.columns.insert(*column, words);
        }
        buffers
    }

    /// The words of a column.
    pub fn words(&self, b: &mut FunctionBuilder, column: Column) -> Words {
        if let Some(words) = self.columns.get(&column) {
            return *words;
        }
        let Start { words, step } = self.starts[&column.buf];
        if words.stride > 4 || column.col == 0 {
            return Words { offset: column.col as i32 * 4, ..words };
        }
        let before = b.ins().imul_imm_u(step, i64::from(column.col));
        Words { base: b.ins().iadd(words.base, before), ..words }
    }

    /// Bytes from a column of a buffer by columns to the next.
    pub fn step(&self, buf: BufId) -> Value {
        self.starts[&buf].step
    }

    /// The word of this row, or of the last one.
    pub fn clamped(&mut self, b: &mut FunctionBuilder, column: Column, row: Value) -> Place {
        let words = self.words(b, column);
        let distance = *self.distances.entry((column.buf, row)).or_insert_with(|| {
            let row = b.ins().umin(row, words.last);
            Distance::of(b, row, words.stride)
        });
        words.at(b, distance)
    }

    /// Distances to the rows of four lanes, clamped to the last row unless they are in range.
    pub fn distances(
        &mut self,
        b: &mut FunctionBuilder,
        words: &Words,
        indices: Value,
        unchecked: bool,
    ) -> [Distance; LANES] {
        let last = if unchecked { None } else { Some(words.last) };
        *self.gathered.entry((last, indices, words.stride)).or_insert_with(|| {
            let rows = match last {
                None => indices,
                Some(last) => {
                    let last = *self.lasts.entry(last).or_insert_with(|| b.ins().splat(types::I32X4, last));
                    b.ins().umin(indices, last)
                }
            };
            pack::wide_lanes(b, rows).map(|row| Distance::of_wide(b, row, words.stride))
        })
    }

    /// Four lanes of a column of a table by rows of four columns at least: its row of each lane is loaded at once with three
    /// neighbours, which are there for whoever wants them next.
    pub fn window(&mut self, b: &mut FunctionBuilder, words: &Words, indices: Value, unchecked: bool) -> Value {
        let bytes = part(Scalar::F32).bytes() as i32;
        let start = (words.offset / bytes * bytes).min(words.stride as i32 - bytes);
        let last = if unchecked { None } else { Some(words.last) };
        let key = (words.base, last, indices, start);
        if !self.windows.contains_key(&key) {
            let rows = self.distances(b, words, indices, unchecked).map(|distance| {
                let row = words.at(b, distance).address;
                let flags = MemFlagsData::new().with_notrap().with_readonly();
                b.ins().load(part(Scalar::F32), flags, row, start)
            });
            self.windows.insert(key, pack::transposed(b, rows));
        }
        self.windows[&key][((words.offset - start) / 4) as usize]
    }

    /// Another block begins: what was made in this one may not dominate it.
    pub fn begin_block(&mut self) {
        self.distances.clear();
        self.gathered.clear();
        self.windows.clear();
        self.lasts.clear();
    }
}

impl Start {
    fn new(b: &mut FunctionBuilder, p: &Program, buf: BufId, bindings: Value) -> Start {
        let constant = MemFlagsData::trusted().with_readonly();
        let buffer = p.buffer(buf);
        let at = buf.0 as i32 * BINDING_BYTES;
        let mut base = b.ins().load(POINTER, constant, bindings, at);
        let rows = b.ins().load(types::I32, constant, bindings, at + ROWS_AT);
        let one = b.ins().iconst(types::I32, 1);
        let mut some = rows;
        if buffer.kind == BufKind::Stream {
            let zeros = zeros(b, p);
            some = b.ins().umax(rows, one);
            base = b.ins().select(rows, base, zeros);
        }
        let last = b.ins().isub(some, one);
        let stride = match buffer.layout {
            Layout::Rows => buffer.columns.len() as u32 * 4,
            Layout::Columns => 4,
        };
        let step = b.ins().uextend(types::I64, rows);
        let step = b.ins().ishl_imm_u(step, 2);
        Start { words: Words { base, offset: 0, stride, rows, last }, step }
    }
}

/// What a function reads, loads or stores.
#[derive(Default)]
pub(crate) struct Used {
    buffers: BTreeSet<BufId>,
    /// Those that are not only touched by runs, which find their columns themselves.
    columns: BTreeSet<Column>,
}

impl Used {
    /// By this function.
    pub fn by(p: &Program, f: &Function, schedule: &Schedule) -> Used {
        let mut used = Used::default();
        let mut note = |column: Column, is_run: bool| {
            used.buffers.insert(column.buf);
            if !is_run {
                used.columns.insert(column);
            }
        };
        for node in schedule.blocks.iter().flatten() {
            if let Node::Read { column, .. } = p.node(*node) {
                note(*column, false);
            }
        }
        for block in &f.blocks {
            let (mem, index, value) = match &p.cont(block.cont).body {
                Body::Load { mem, index, next } => (mem, *index, p.loaded(*next)),
                Body::Store { mem, index, value, .. } => (mem, *index, Some(p.ty(*value))),
                _ => continue,
            };
            if let Mem::Stream(column) | Mem::Unchecked(column) = mem {
                note(*column, data(p.ty(index)).1 == 1 && value.is_some_and(|ty| data(ty).1 > 1));
            }
        }
        used
    }
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

    /// Fills it with zeros: a few stores, or a loop.
    pub fn clear(self, b: &mut FunctionBuilder) {
        const UNROLLED: u64 = 16 * 16;
        let bytes = Local::bytes(self.len);
        let base = b.ins().stack_addr(POINTER, self.slot, 0);
        let zero = pack::constant(b, types::I32X4, [0; LANES]);
        if bytes <= UNROLLED {
            for at in (0..bytes as i32).step_by(16) {
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
        let next = b.ins().iadd_imm_u(at, 16);
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

/// The address of a row of zeros in the frame, as long as that of any stream.
fn zeros(b: &mut FunctionBuilder, p: &Program) -> Value {
    let streams = p.buffers.iter().filter(|buffer| buffer.kind == BufKind::Stream);
    let by_rows = streams.filter(|buffer| buffer.layout == Layout::Rows).map(|buffer| buffer.columns.len());
    let zeros = Local::new(b, by_rows.max().unwrap_or(1) as u32);
    zeros.clear(b);
    b.ins().stack_addr(POINTER, zeros.slot, 0)
}
