//! Loads and stores: of tables, streams and local arrays, lane by lane.
//!
//! A load clamps its index to the last row, a store out of range is dropped: it stands in an `if`. Consecutive stores to one
//! row of one buffer share the `if`. So a store waits until something else must happen: a load of the same memory, a store
//! elsewhere, a call, a branch.

use jerboa_ir::{BufId, Column, Layout, Lit, Mem, Node, NodeId, Op, Program, Scalar};
use naga::{BinaryOperator as B, Block};

use super::top::Top;
use super::{Array, Emitter, Known};
use crate::code::{Code, Value};
use crate::ops;

/// Stores to one row that are still to be made, in order.
pub(super) struct Stores {
    to: Rows,
    row: Value,
    /// The column, and the word.
    words: Vec<(u32, Value)>,
}

/// Rows of memory.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Rows {
    /// Of a buffer.
    Buffer(BufId),
    /// Of a local array, by the block whose parameter it is.
    Array(u32),
}

/// Where a lane is loaded from or stored to.
#[derive(Clone, Copy)]
struct Row {
    value: Value,
    literal: Option<u32>,
}

/// A local array is cleared by so many stores, a longer one in a loop.
const STORES: u32 = 8;

impl Emitter<'_> {
    /// What a table holds in a column.
    pub(super) fn read(&mut self, column: Column, index: NodeId) -> Vec<Value> {
        // A reference is stored as its index.
        let scalar = self.unit.program.column(column).ty.ty().as_scalar().unwrap_or(Scalar::U32);
        (0..self.width(index)).map(|lane| self.read_lane(column, scalar, index, lane)).collect()
    }

    fn read_lane(&mut self, column: Column, scalar: Scalar, index: NodeId, lane: usize) -> Value {
        if self.literal_lane(index, lane) == Some(Lit::U32(0)) {
            // A table has a first row.
            let word = self.top(Top::Base(column));
            return self.word_of(column.buf, scalar, word);
        }
        let index = self.lane(index, lane);
        let row = self.clamped(column.buf, index);
        self.load_row(column, scalar, row)
    }

    /// Loads; of a vector at the index of each lane, or at an index and the rows that follow it.
    pub(super) fn load(&mut self, mem: &Mem, index: NodeId, scalar: Scalar, lanes: usize) -> Vec<Value> {
        let stored = match (mem, self.stores.as_ref().map(|s| s.to)) {
            (Mem::Stream(column), Some(Rows::Buffer(buf))) => buf == column.buf,
            (Mem::Local(_), Some(Rows::Array(_))) => true,
            _ => false,
        };
        if stored {
            self.make_stores();
        }
        let rows = self.row_of_lanes(index, lanes);
        rows.into_iter().map(|row| self.load_word(mem, scalar, (index, lanes), row)).collect()
    }

    fn load_word(&mut self, mem: &Mem, scalar: Scalar, (index, lanes): (NodeId, usize), row: Row) -> Value {
        match mem {
            Mem::Unchecked(column) => self.load_row(*column, scalar, row.value),
            Mem::Stream(column) => {
                let value = match row.literal {
                    Some(0) => {
                        let word = self.top(Top::Base(*column));
                        self.word_of(column.buf, scalar, word)
                    }
                    _ => {
                        let row = self.clamped(column.buf, row.value);
                        self.load_row(*column, scalar, row)
                    }
                };
                let none = self.top(Top::IsEmpty(column.buf));
                let nothing = match scalar {
                    Scalar::F32 => self.zero(),
                    _ => self.code.literal(Lit::from_word(scalar, 0)),
                };
                self.code.select(none, nothing, value)
            }
            Mem::Local(x) => {
                let array = self.arrays[&self.array(*x)];
                let last = self.code.u32(array.len - 1);
                let row = match row.literal {
                    // naga refuses a literal out of range.
                    Some(row) => self.code.u32(row.min(array.len - 1)),
                    None if self.is_inside(index, lanes, array) => row.value,
                    None => self.code.umin(row.value, last),
                };
                let pointer = self.code.local(array.variable);
                let pointer = self.code.element(pointer, row);
                let value = self.code.load(pointer);
                if scalar == Scalar::Bool { decode(&mut self.code, scalar, value) } else { value }
            }
        }
    }

    /// The row of each lane: of a vector of indices its own, of a run the next one.
    fn row_of_lanes(&mut self, index: NodeId, lanes: usize) -> Vec<Row> {
        let is_run = self.width(index) < lanes;
        let row = |lane: usize| {
            let (of, step) = if is_run { (0, lane as u32) } else { (lane, 0) };
            let first = self.lane(index, of);
            // The value of a node may be a literal though the node is none: a lane of a vector of literals.
            let literal = self.code.as_u32(first).map(|first| first.wrapping_add(step));
            let value = match (literal, step) {
                (Some(row), _) => self.code.u32(row),
                (None, 0) => first,
                (None, _) => {
                    let step = self.code.u32(step);
                    self.code.binary(B::Add, first, step)
                }
            };
            Row { value, literal }
        };
        (0..lanes).map(row).collect()
    }

    /// The row for an index: the last one, if the index is beyond.
    fn clamped(&mut self, buf: BufId, index: Value) -> Value {
        let last = self.top(Top::Last(buf));
        self.once(Known::Row(buf, index), |e| e.code.umin(index, last))
    }

    /// The word of a column in a row.
    fn word(&mut self, column: Column, row: Value) -> Value {
        let base = self.top(Top::Base(column));
        let buffer = self.unit.program.buffer(column.buf);
        let columns = buffer.columns.len() as u32;
        let distance = match buffer.layout {
            Layout::Rows if columns > 1 => self.once(Known::Distance(column.buf, row), |e| {
                let columns = e.code.u32(columns);
                e.code.binary(B::Multiply, row, columns)
            }),
            _ => row,
        };
        self.code.binary(B::Add, base, distance)
    }

    /// What a column holds in a row that is there.
    fn load_row(&mut self, column: Column, scalar: Scalar, row: Value) -> Value {
        let word = self.word(column, row);
        self.word_of(column.buf, scalar, word)
    }

    fn word_of(&mut self, buf: BufId, scalar: Scalar, word: Value) -> Value {
        let pointer = self.pointer(buf, word);
        let word = self.code.load(pointer);
        decode(&mut self.code, scalar, word)
    }

    fn pointer(&mut self, buf: BufId, word: Value) -> Value {
        let base = self.code.global(self.unit.globals.buffers[buf.index()]);
        self.code.element(base, word)
    }

    /// Stores; of a vector the lanes under the mask.
    pub(super) fn store(&mut self, mem: &Mem, index: NodeId, value: NodeId, mask: NodeId) {
        let lanes = self.width(value);
        let rows = self.row_of_lanes(index, lanes);
        let scalar = self.scalar(value);
        for (lane, row) in rows.into_iter().enumerate() {
            let word = match (self.literal_lane(value, lane), mem) {
                // A driver may pass on to a load what was stored; so a zero is one that it does not know.
                (Some(lit), Mem::Stream(_) | Mem::Unchecked(_)) if lit != Lit::F32(0) => self.code.u32(lit.word()),
                (_, Mem::Local(_)) if scalar != Scalar::Bool => self.lane(value, lane),
                _ => {
                    let value = self.lane(value, lane);
                    encode(&mut self.code, scalar, value)
                }
            };
            let (to, col) = match mem {
                Mem::Stream(column) | Mem::Unchecked(column) => (Rows::Buffer(column.buf), column.col),
                Mem::Local(x) => (Rows::Array(self.array(*x)), 0),
            };
            let inside = match to {
                Rows::Buffer(_) => false,
                // naga refuses a literal out of range.
                Rows::Array(block) if row.literal.is_some_and(|row| row >= self.arrays[&block].len) => continue,
                Rows::Array(block) => row.literal.is_some() || self.is_inside(index, lanes, self.arrays[&block]),
            };
            let taken = if mask == NodeId::NONE { Some(Lit::Bool(true)) } else { self.literal_lane(mask, lane) };
            if let Some(taken) = taken {
                if taken == Lit::Bool(true) {
                    self.store_word(to, inside, row.value, (col, word));
                }
                continue;
            }
            self.make_stores();
            let taken = self.lane(mask, lane);
            self.open();
            self.store_word(to, inside, row.value, (col, word));
            let accept = self.close();
            self.code.branch(taken, accept, Block::new());
        }
    }

    /// Stores a word, or lets it wait; at once where the row is surely inside an array.
    fn store_word(&mut self, to: Rows, inside: bool, row: Value, word: (u32, Value)) {
        match &mut self.stores {
            Some(stores) if (stores.to, stores.row) == (to, row) => stores.words.push(word),
            _ => {
                self.make_stores();
                match to {
                    Rows::Array(block) if inside => self.store_element(self.arrays[&block], row, word.1),
                    _ => self.stores = Some(Stores { to, row, words: vec![word] }),
                }
            }
        }
    }

    /// Are the rows of an access surely in an array?
    fn is_inside(&self, index: NodeId, lanes: usize, array: Array) -> bool {
        // Of a vector of indices nothing is known; of a run the first one may be.
        let most = most(self.unit.program, index);
        most.is_some_and(|most| u64::from(most) + lanes as u64 <= u64::from(array.len))
    }

    /// Makes the stores that wait.
    pub(super) fn make_stores(&mut self) {
        let Some(Stores { to, row, words }) = self.stores.take() else { return };
        let rows = match to {
            Rows::Buffer(buf) => self.rows(buf),
            Rows::Array(block) => self.code.u32(self.arrays[&block].len),
        };
        let fits = self.code.binary(B::Less, row, rows);
        self.open();
        for (col, value) in words {
            match to {
                Rows::Buffer(buf) => {
                    let word = self.word(Column { buf, col }, row);
                    let pointer = self.pointer(buf, word);
                    self.code.store(pointer, value);
                }
                Rows::Array(block) => self.store_element(self.arrays[&block], row, value),
            }
        }
        let accept = self.close();
        self.code.branch(fits, accept, Block::new());
    }

    fn store_element(&mut self, array: Array, row: Value, value: Value) {
        let pointer = self.code.local(array.variable);
        let pointer = self.code.element(pointer, row);
        self.code.store(pointer, value);
    }

    /// The block whose parameter an array is.
    fn array(&self, x: NodeId) -> u32 {
        match self.unit.program.node(x) {
            Node::Param { cont, .. } => self.f.number[cont],
            other => unreachable!("an array is a parameter, not {other:?}"),
        }
    }

    /// Fills an array with zeros, if it is used.
    pub(super) fn clear(&mut self, array: Option<Array>) {
        let Some(array) = array else { return };
        self.make_stores();
        let lit = if array.scalar == Scalar::Bool { Lit::U32(0) } else { Lit::from_word(array.scalar, 0) };
        let zero = self.literal(lit);
        if array.len <= STORES {
            for i in 0..array.len {
                let base = self.code.local(array.variable);
                let pointer = self.code.component(base, i);
                self.code.store(pointer, zero);
            }
            return;
        }
        let index = self.variable("element", Scalar::U32);
        let (first, len) = (self.code.u32(0), self.code.u32(array.len));
        self.code.set(index, first);
        self.counted(index, len, |e, i| e.store_element(array, i, zero));
    }
}

/// A scalar of a word. A word that is not 0 is `true`.
pub(super) fn decode(c: &mut Code, scalar: Scalar, word: Value) -> Value {
    match scalar {
        Scalar::Bool => {
            let none = c.u32(0);
            c.binary(B::NotEqual, word, none)
        }
        Scalar::U32 => word,
        Scalar::I32 | Scalar::F32 => c.cast(word, scalar),
    }
}

/// The word of a scalar. A bool is the word 0 or 1.
pub(super) fn encode(c: &mut Code, scalar: Scalar, value: Value) -> Value {
    match scalar {
        Scalar::Bool => ops::bit(c, value, 1),
        Scalar::U32 => value,
        Scalar::I32 | Scalar::F32 => c.cast(value, Scalar::U32),
    }
}

/// The largest that a `u32` can be, if masks and literals say so; operands are followed a few operations deep.
fn most(p: &Program, x: NodeId) -> Option<u32> {
    fn within(p: &Program, x: NodeId, depth: u32) -> Option<u32> {
        let depth = depth.checked_sub(1)?;
        let of = |x: NodeId| within(p, x, depth);
        match p.node(x) {
            Node::Lit(lit) => lit.as_u32(),
            Node::Prim { op: Op::And, args } => of(args[0]).into_iter().chain(of(args[1])).min(),
            Node::Prim { op: Op::Add, args } => of(args[0])?.checked_add(of(args[1])?),
            _ => None,
        }
    }
    within(p, x, 8)
}
