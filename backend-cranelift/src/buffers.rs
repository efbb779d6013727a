//! The buffers of a function: where their columns begin, and what several accesses share.
//!
//! A stream without rows has a row of zeros in the frame, and that is its last row.

use std::collections::BTreeSet;

use cranelift_codegen::ir::{InstBuilder, MemFlagsData, Value, types};
use cranelift_frontend::FunctionBuilder;
use jerboa_ir::cfg::Function;
use jerboa_ir::schedule::Schedule;
use jerboa_ir::{Body, BufId, BufKind, Column, Layout, Mem, Node, Program, Scalar};
use rustc_hash::FxHashMap;

use crate::abi::{LANES, POINTER, data, part};
use crate::memory::{Distance, Local, Place, Words};
use crate::pack;

/// Bytes of a [`crate::Binding`], and where its number of rows is.
const BINDING_BYTES: i32 = size_of::<crate::Binding>() as i32;
const ROWS_AT: i32 = std::mem::offset_of!(crate::Binding, rows) as i32;

/// The buffers that a function touches.
#[derive(Default)]
pub(crate) struct Buffers {
    starts: FxHashMap<BufId, Start>,
    /// Columns whose address is made where the function begins, because a loop touches them.
    columns: FxHashMap<Column, Words>,
    /// The address of the bindings.
    bindings: Option<Value>,
    /// Tables that no loop touches. Made in the block at hand.
    tables: FxHashMap<BufId, Start>,
    /// Distance to a clamped row, which all columns of a buffer share. Made in the block at hand.
    distances: FxHashMap<(BufId, Value), Distance>,
    /// Distances to the rows of a part of indices, clamped to a last row or unchecked, for a stride. Likewise.
    gathered: FxHashMap<(Option<Value>, Value, u32), [Distance; LANES]>,
    /// Four columns of a buffer by rows, at the rows of a part of indices. Likewise.
    windows: FxHashMap<(Value, Option<Value>, Value, i32), Window>,
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
        let mut buffers = Buffers { bindings: Some(bindings), ..Buffers::default() };
        for buf in &used.buffers {
            buffers.starts.insert(*buf, Start::new(b, p, *buf, bindings));
        }
        for column in &used.columns {
            let words = buffers.words(b, p, *column);
            buffers.columns.insert(*column, words);
        }
        buffers
    }

    /// The words of a column.
    pub fn words(&mut self, b: &mut FunctionBuilder, p: &Program, column: Column) -> Words {
        if let Some(words) = self.columns.get(&column) {
            return *words;
        }
        let Start { words, step } = self.start(b, p, column.buf);
        if words.stride > 4 || column.col == 0 {
            return Words { offset: column.col as i32 * 4, ..words };
        }
        let before = b.ins().imul_imm_u(step, i64::from(column.col));
        Words { base: b.ins().iadd(words.base, before), ..words }
    }

    fn start(&mut self, b: &mut FunctionBuilder, p: &Program, buf: BufId) -> Start {
        if let Some(start) = self.starts.get(&buf) {
            return *start;
        }
        let bindings = self.bindings.expect("who touches a buffer has the bindings");
        *self.tables.entry(buf).or_insert_with(|| Start::new(b, p, buf, bindings))
    }

    /// Bytes from a column of a buffer by columns to the next.
    pub fn step(&mut self, b: &mut FunctionBuilder, p: &Program, buf: BufId) -> Value {
        self.start(b, p, buf).step
    }

    /// The word of this row, or of the last one.
    pub fn clamped(&mut self, b: &mut FunctionBuilder, p: &Program, column: Column, row: Value) -> Place {
        let words = self.words(b, p, column);
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
            Distance::of_lanes(b, rows, words.stride)
        })
    }

    /// Four lanes of a column of a buffer by rows of four columns at least: its row of each lane is loaded at once with three
    /// neighbours, which are there for whoever wants them next. Only `readonly` flags say that nobody stores to it.
    pub fn window(
        &mut self,
        b: &mut FunctionBuilder,
        words: &Words,
        indices: Value,
        unchecked: bool,
        flags: MemFlagsData,
    ) -> Value {
        let bytes = part(Scalar::F32).bytes() as i32;
        let start = (words.offset / bytes * bytes).min(words.stride as i32 - bytes);
        let last = if unchecked { None } else { Some(words.last) };
        let key = (words.base, last, indices, start);
        if !self.windows.contains_key(&key) {
            let mut unaligned = MemFlagsData::new().with_notrap();
            if flags.readonly() {
                unaligned.set_readonly();
            }
            let rows = self.distances(b, words, indices, unchecked).map(|distance| {
                let row = words.at(b, distance).address;
                b.ins().load(part(Scalar::F32), unaligned, row, start)
            });
            self.windows.insert(key, Window { columns: pack::transposed(b, rows), stays: flags.readonly() });
        }
        self.windows[&key].columns[((words.offset - start) / 4) as usize]
    }

    /// Streams may have changed.
    pub fn changed(&mut self) {
        self.windows.retain(|_, window| window.stays);
    }

    /// Another block begins: what was made in this one may not dominate it.
    pub fn begin_block(&mut self) {
        self.distances.clear();
        self.gathered.clear();
        self.tables.clear();
        self.windows.clear();
        self.lasts.clear();
    }
}

/// Four columns of four lanes.
struct Window {
    columns: [Value; LANES],
    /// Does nobody store to them?
    stays: bool,
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

/// What a function has at hand from its beginning: all streams, and what its loops touch; of the rest the addresses are
/// made where they are used, which takes no more than to fetch them from the frame.
#[derive(Default)]
pub(crate) struct Used {
    buffers: BTreeSet<BufId>,
    columns: BTreeSet<Column>,
}

impl Used {
    /// By this function.
    pub fn by(p: &Program, f: &Function, schedule: &Schedule) -> Used {
        let mut used = Used::default();
        for (i, block) in f.blocks.iter().enumerate() {
            let in_loop = f.loops.depth(i as u32) > 0;
            let mut note = |column: Column, is_run: bool| {
                if in_loop || p.buffer(column.buf).kind == BufKind::Stream {
                    used.buffers.insert(column.buf);
                }
                // Runs find their columns themselves.
                if in_loop && !is_run {
                    used.columns.insert(column);
                }
            };
            for node in &schedule.blocks[i] {
                if let Node::Read { column, .. } = p.node(*node) {
                    note(*column, false);
                }
            }
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

/// The address of a row of zeros in the frame, as long as that of any stream.
fn zeros(b: &mut FunctionBuilder, p: &Program) -> Value {
    let streams = p.buffers.iter().filter(|buffer| buffer.kind == BufKind::Stream);
    let by_rows = streams.filter(|buffer| buffer.layout == Layout::Rows).map(|buffer| buffer.columns.len());
    let zeros = Local::new(b, by_rows.max().unwrap_or(1) as u32);
    zeros.clear(b);
    zeros.words(b).base
}
