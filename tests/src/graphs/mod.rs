//! Random residuals that are control flow first of all: reducible graphs as no author would write them.
//!
//! Each function is a graph of a random [`Shape`]: loops within loops that are left in the middle to places far behind them,
//! joins of many ways, some of them taken twice, switches with gaps, returns anywhere. Blocks use values and local arrays of any
//! block that dominates them, in any loop, and pass others as parameters, in loops permuted; they read tables, load and
//! store streams, call the functions before theirs. Programs end: who enters a loop's header pays with *fuel*, which is
//! passed along with the other values, and at none the function returns.
//!
//! Accuracy list T1 for back ends whose control flow is structured.

mod code;
mod shape;

pub use shape::Shape;

use jerboa_ir::interp::Memory;
use jerboa_ir::*;

use crate::choices::Choices;
use crate::programs::Case;
use crate::values;

/// The buffers of every program: a table of each layout, then a stream of each.
const TABLES: [BufId; 2] = [BufId(0), BufId(1)];
const STREAMS: [BufId; 2] = [BufId(2), BufId(3)];

/// Functions of a program besides `main` at most, and their blocks; they are called from loops.
const FUNCTIONS: u32 = 3;
const CALLED: u32 = 8;

/// Rounds of all loops of one call of `main` at least, and of the functions that it calls at most.
const FUEL: u32 = 6;

/// A random program: a residual whose only entry is `main`.
pub fn case(c: &mut Choices) -> Case {
    let mut w = World::new();
    declare(&mut w);
    let memory: Vec<Memory> = w.program().buffers.iter().map(|b| content(b, c)).collect();
    let rows: Vec<u32> = memory.iter().map(|m| m.rows).collect();
    let mut functions = Vec::new();
    for i in 0..c.below(FUNCTIONS + 1) {
        let fuel = c.below(FUEL);
        let function = code::function(&mut w, c, &format!("f{i}"), CALLED, fuel, &functions, &rows);
        functions.push(function);
    }
    let fuel = FUEL + c.below(3 * FUEL);
    let main = code::function(&mut w, c, "main", u32::MAX, fuel, &functions, &rows);
    w.entry("main", main);
    Case { program: w.finish(), main, memory }
}

/// Columns of all scalars in both tables and both streams.
fn declare(w: &mut World) {
    let columns = || {
        let column = |s: &Scalar| ColumnDecl { name: s.name().into(), ty: ColTy::Scalar(*s), time: Time::Bulk };
        Scalar::ALL.iter().map(column).collect()
    };
    let mut buffer = |name: &str, kind: BufKind, layout: Layout| {
        w.buffer(Buffer { name: name.into(), kind, layout, columns: columns() });
    };
    let table = BufKind::Table { classed: false };
    buffer("near", table, Layout::Rows);
    buffer("far", table, Layout::Columns);
    buffer("soa", BufKind::Stream, Layout::Columns);
    buffer("aos", BufKind::Stream, Layout::Rows);
}

/// Random content. Streams may be empty.
fn content(buffer: &Buffer, c: &mut Choices) -> Memory {
    let rows = if buffer.kind == BufKind::Stream { c.pick(&[4, 0, 1, 2, 3, 11]) } else { 1 + c.below(5) };
    let mut words = vec![0; rows as usize * buffer.columns.len()];
    for row in 0..rows as usize {
        for (col, s) in Scalar::ALL.iter().enumerate() {
            words[buffer.word(rows as usize, row, col)] = values::random(*s, c).word();
        }
    }
    Memory { rows, words }
}
