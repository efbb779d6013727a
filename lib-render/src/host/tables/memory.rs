//! Tables in memory: typed rows over the words that kernels read.

use std::marker::PhantomData;

use jerboa_ir::Layout;
pub use jerboa_ir::interp::Memory;
use jerboa_ir::lang::{Bool, Buf, Col, F32, I32, Row, U32};

use crate::host::bvh::pages::with_room;

/// A staged type that has a host counterpart in one word of memory.
pub trait Word {
    /// The host's type.
    type Host;
    /// The word that holds it.
    fn word(x: Self::Host) -> u32;
}

macro_rules! words {
    ($($staged:ty, $host:ty, $word:expr;)+) => { $(impl Word for $staged {
        type Host = $host;
        fn word(x: $host) -> u32 {
            let word: fn($host) -> u32 = $word;
            word(x)
        }
    })+ };
}
words! { F32, f32, f32::to_bits; U32, u32, |x| x; I32, i32, |x| x as u32; Bool, bool, u32::from; }

impl<B> Word for Row<B> {
    type Host = u32;
    fn word(x: u32) -> u32 {
        x
    }
}

/// A table that is being written.
pub struct Table<B> {
    memory: Memory,
    buf: PhantomData<B>,
}

/// A row that is being written; what is not set is 0.
pub struct RowMut<'a, B> {
    words: &'a mut [u32],
    buf: PhantomData<B>,
}

impl<B: Buf> Default for Table<B> {
    fn default() -> Self {
        assert!(B::LAYOUT == Layout::Rows, "tables lie row by row");
        Table { memory: Memory::default(), buf: PhantomData }
    }
}

impl<B: Buf> Table<B> {
    /// An empty table.
    pub fn new() -> Self {
        Table::default()
    }

    /// An empty table with room for so many rows, in large pages if it can be: they are read all over.
    pub fn with_rows(rows: usize) -> Self {
        let mut table = Table::default();
        table.memory.words = with_room(rows * B::COLUMNS.len());
        table
    }

    /// Append a row of zeros.
    pub fn push(&mut self) -> RowMut<'_, B> {
        let start = self.memory.words.len();
        self.memory.words.resize(start + B::COLUMNS.len(), 0);
        self.memory.rows += 1;
        RowMut { words: &mut self.memory.words[start..], buf: PhantomData }
    }

    /// Append rows of zeros until there are so many.
    pub fn pad(&mut self, rows: u32) {
        if self.memory.rows < rows {
            self.memory.words.resize(rows as usize * B::COLUMNS.len(), 0);
            self.memory.rows = rows;
        }
    }

    /// Number of rows so far.
    pub fn rows(&self) -> u32 {
        self.memory.rows
    }

    /// The finished table; it has at least one row, if need be of zeros.
    pub fn finish(mut self) -> Memory {
        if self.memory.rows == 0 {
            self.push();
        }
        self.memory
    }
}

impl<B: Buf> RowMut<'_, B> {
    /// Set a column.
    pub fn set<T: Word>(&mut self, column: Col<B, T>, x: T::Host) -> &mut Self {
        self.words[column.0 as usize] = T::word(x);
        self
    }

    /// Set columns of floats.
    pub fn set_all<const N: usize>(&mut self, columns: [Col<B, F32>; N], xs: [f32; N]) -> &mut Self {
        for (column, x) in columns.into_iter().zip(xs) {
            self.set(column, x);
        }
        self
    }
}
