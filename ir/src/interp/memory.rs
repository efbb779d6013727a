//! Loads and stores, lane by lane.

use super::heap::Value;
use super::machine::Machine;
use super::*;

/// Lanes of the widest vector.
const LANES: usize = 16;

impl<O: Observer> Machine<'_, O> {
    /// What a load passes to `next`.
    pub(super) fn load(&mut self, mem: Mem, index: NodeId, next: NodeId) -> Result<Value, Stop> {
        let loaded = self.code.program.loaded(next).and_then(|ty| ty.lanes());
        let lanes = loaded.map_or(1, |(_, lanes)| lanes);
        let rows = self.rows(index);
        let loc = self.code.program.locs[next.index()];
        if lanes == 1 {
            return Ok(Value::Lit(self.load_word(mem, rows[0], loc)?));
        }
        let mut words = [Value::Absent; LANES];
        for (word, row) in words[..lanes].iter_mut().zip(rows) {
            *word = Value::Lit(self.load_word(mem, row, loc)?);
        }
        Ok(Value::Object(self.heap.object(words[..lanes].iter().copied())))
    }

    /// Store a scalar, or the lanes of a vector that the mask lets through.
    pub(super) fn store(&mut self, mem: Mem, index: NodeId, value: NodeId, mask: NodeId) {
        let rows = self.rows(index);
        if mask == NodeId::NONE {
            let value = self.lit(value);
            return self.store_word(mem, rows[0], value);
        }
        let (value, mask) = (self.object(value), self.object(mask));
        for (lane, row) in rows.into_iter().enumerate().take(self.heap.cells(value).len()) {
            if let (Value::Lit(value), Value::Lit(Lit::Bool(true))) =
                (self.heap.get(value, lane), self.heap.get(mask, lane))
            {
                self.store_word(mem, row, value);
            }
        }
    }

    /// The row of each lane: of a vector of indices its own, of a run the next one.
    fn rows(&mut self, index: NodeId) -> [u32; LANES] {
        match self.eval(index) {
            Value::Lit(Lit::U32(first)) => std::array::from_fn(|lane| first.wrapping_add(lane as u32)),
            Value::Object(at) => {
                let mut rows = [0; LANES];
                for (row, cell) in rows.iter_mut().zip(self.heap.cells(at)) {
                    match cell {
                        Value::Lit(Lit::U32(index)) => *row = *index,
                        other => unreachable!("{other:?} is no index"),
                    }
                }
                rows
            }
            other => unreachable!("{other:?} is no index"),
        }
    }

    fn load_word(&mut self, mem: Mem, row: u32, loc: Loc) -> Result<Lit, Stop> {
        Ok(match mem {
            Mem::Local(array) => {
                let cells = self.object(array);
                let cells = self.heap.cells(cells);
                match cells[(row as usize).min(cells.len() - 1)] {
                    Value::Lit(lit) => lit,
                    other => unreachable!("{other:?} is in a local array"),
                }
            }
            Mem::Stream(column) if self.memory[column.buf.index()].rows == 0 => self.decode(column, 0),
            Mem::Stream(column) => {
                if row >= self.memory[column.buf.index()].rows
                    && let Some(touched) = self.loops.last_mut()
                {
                    touched.load_beyond(column, loc);
                }
                self.word_at(column, row)
            }
            Mem::Unchecked(column) => {
                let rows = self.memory[column.buf.index()].rows;
                if row >= rows {
                    let name = &self.code.program.buffer(column.buf).name;
                    return fault(loc, format!("unchecked read of `{name}` at {row}, which has {rows} rows"));
                }
                self.word_at(column, row)
            }
        })
    }

    fn store_word(&mut self, mem: Mem, row: u32, value: Lit) {
        match mem {
            Mem::Local(array) => {
                let cells = self.object(array);
                if (row as usize) < self.heap.cells(cells).len() {
                    self.heap.set(cells, row as usize, Value::Lit(value));
                }
            }
            Mem::Stream(column) | Mem::Unchecked(column) => {
                let memory = &mut self.memory[column.buf.index()];
                if memory.rows.checked_sub(1) == Some(row)
                    && let Some(touched) = self.loops.last_mut()
                {
                    touched.store_last(column);
                }
                if row < memory.rows {
                    let buffer = self.code.program.buffer(column.buf);
                    let word = buffer.word(memory.rows as usize, row as usize, column.col as usize);
                    memory.words[word] = value.word();
                }
            }
        }
    }

    /// What a column holds at an index, clamped to the last row.
    pub(super) fn word_at(&self, column: Column, index: u32) -> Lit {
        let memory = &self.memory[column.buf.index()];
        let row = index.min(memory.rows - 1);
        let buffer = self.code.program.buffer(column.buf);
        self.decode(column, memory.words[buffer.word(memory.rows as usize, row as usize, column.col as usize)])
    }

    fn decode(&self, column: Column, word: u32) -> Lit {
        match self.code.program.column(column).ty {
            ColTy::Scalar(s) => Lit::from_word(s, word),
            ColTy::Ref(_) => Lit::U32(word),
        }
    }
}
