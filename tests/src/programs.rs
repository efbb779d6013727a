//! Random programs: well typed, terminating, and full of what a specialiser can get wrong (accuracy list T1).
//!
//! They are made of structured statements, as an author would write them: branches, switches and dispatches that meet
//! in joins, bounded loops with breaks, functions of first and higher order with filters of all kinds, bounded recursion,
//! labels with exits, tuples, vectors, tables whose columns have every binding time, streams and local arrays, loops of
//! independent iterations. Loops run a few times and recursion goes a few levels down, so programs end; the number of statements is bounded, so they end soon.
//!
//! Law 4 is kept: no function value depends on an unknown. What has to stay in one residual function is marked as
//! *tied* (`Value::tied`) and is not shown to functions that may stay calls.

mod control;
mod exprs;
mod functions;
mod stmts;
mod vectorize;

use jerboa_ir::interp::Memory;
use jerboa_ir::*;

use crate::choices::Choices;
use crate::values;

/// A program with its memory.
pub struct Case {
    /// The program; its only entry is `main`, which takes scalars and vectors and returns scalars.
    pub program: Program,
    /// `main`.
    pub main: ContId,
    /// Content of the buffers; the classes are not numbered yet (see [`crate::knowledge::classify`]).
    pub memory: Vec<Memory>,
}

/// What a statement may use.
#[derive(Clone, Copy)]
struct Value {
    node: NodeId,
    /// It leads to an exit or to a local array of the function around it, so only functions that are always unfolded
    /// may capture it.
    tied: bool,
}

/// The state of generation.
struct Gen<'c> {
    w: World,
    c: &'c mut Choices,
    /// The continuation that is being written.
    at: ContId,
    /// Values in scope.
    env: Vec<Value>,
    /// Continuations that this path may leave to; the first is the return of the function around it.
    exits: Vec<NodeId>,
    /// Statements that may still be made.
    budget: u32,
    /// Nesting of statements.
    depth: u32,
    /// Continuations whose first parameter is a function, and the one function that everybody passes to it (Law 4).
    pinned: Vec<(NodeId, NodeId)>,
    /// Statements made: the line of the pretended source.
    line: u32,
    /// Rows of the buffers.
    rows: Vec<u32>,
    /// The iteration of a `vectorize` that is being written.
    iteration: Option<vectorize::Iteration>,
    /// Functions that touch no stream.
    calm: Vec<NodeId>,
    /// Does what is being written touch a stream?
    touched: bool,
}

/// The buffers of every program, by number.
const KINDS: BufId = BufId(0);
const PLAIN: BufId = BufId(1);
const STREAMS: [BufId; 2] = [BufId(2), BufId(3)];

/// Statements of a program at most.
const STATEMENTS: u32 = 150;

/// A random program.
pub fn case(c: &mut Choices) -> Case {
    let mut w = World::new();
    declare(&mut w);
    let memory: Vec<Memory> = w.program().buffers.iter().map(|b| content(b, c)).collect();
    let mut g = Gen {
        w,
        budget: c.below(STATEMENTS),
        c,
        at: ContId(0),
        env: vec![],
        exits: vec![],
        depth: 0,
        pinned: vec![],
        line: 1,
        rows: memory.iter().map(|m| m.rows).collect(),
        iteration: None,
        calm: vec![],
        touched: false,
    };
    let mut params: Vec<Ty> = (0..1 + g.c.below(4)).map(|_| g.scalar_ty()).collect();
    if g.c.one_in(4) {
        params.push(g.vector_ty());
    }
    let results: Vec<Ty> = (0..1 + g.c.below(5)).map(|_| g.scalar_ty()).collect();
    let (main, _) = g.function("main", &params, &results);
    g.write(main, true, |g| {
        g.block();
        g.finish(g.exits[0]);
    });
    g.w.entry("main", main);
    Case { program: g.w.finish(), main, memory }
}

impl Case {
    /// The types of the arguments of `main`.
    pub fn params(&self) -> Vec<Ty> {
        let params = &self.program.cont(self.main).params;
        params[..params.len() - 1].iter().map(|p| p.ty).collect()
    }

    /// Random arguments for `main`.
    pub fn arguments(&self, c: &mut Choices) -> Vec<Lit> {
        let lanes = self.params().into_iter().map(|t| t.lanes().expect("main takes scalars and vectors"));
        lanes.flat_map(|(s, n)| (0..n).map(|_| values::random(s, c)).collect::<Vec<_>>()).collect()
    }
}

/// A classed table, a plain table, and a stream of each layout.
fn declare(w: &mut World) {
    use Scalar::*;
    let column = |name: &str, ty: ColTy, time: Time| ColumnDecl { name: name.into(), ty, time };
    let scalar = |name: &str, s: Scalar, time: Time| column(name, ColTy::Scalar(s), time);
    let mut buffer = |name: &str, kind: BufKind, layout: Layout, columns: Vec<ColumnDecl>| {
        w.buffer(Buffer { name: name.into(), kind, layout, columns });
    };
    let kinds = vec![
        scalar("class", U32, Time::Structure),
        scalar("kind", U32, Time::Structure),
        scalar("flag", Bool, Time::Structure),
        scalar("gain", F32, Time::Value),
        scalar("texel", I32, Time::Bulk),
        column("plain", ColTy::Ref(PLAIN), Time::Value),
        column("next", ColTy::Ref(KINDS), Time::Structure),
    ];
    let plain = vec![
        scalar("x", F32, Time::Value),
        scalar("n", U32, Time::Structure),
        scalar("k", I32, Time::Bulk),
        column("kind", ColTy::Ref(KINDS), Time::Bulk),
    ];
    let [soa, aos] = [[F32, U32, I32, Bool], [U32, F32, F32, I32]]
        .map(|cs| cs.iter().map(|s| scalar("c", *s, Time::Bulk)).collect::<Vec<_>>());
    buffer("kinds", BufKind::Table { classed: true }, Layout::Rows, kinds);
    buffer("plain", BufKind::Table { classed: false }, Layout::Rows, plain);
    buffer("soa", BufKind::Stream, Layout::Columns, soa);
    buffer("aos", BufKind::Stream, Layout::Rows, aos);
}

/// Random content. Streams may be empty; classes are numbered later, by what is known.
fn content(buffer: &Buffer, c: &mut Choices) -> Memory {
    let table = matches!(buffer.kind, BufKind::Table { .. });
    let rows = if table { 1 + c.below(4) } else { c.pick(&[0, 1, 2, 3, 4, 11, 35]) };
    let mut words = vec![0; rows as usize * buffer.columns.len()];
    for row in 0..rows as usize {
        for (col, decl) in buffer.columns.iter().enumerate() {
            words[buffer.word(rows as usize, row, col)] = match decl.ty {
                ColTy::Ref(_) => c.below(4),
                ColTy::Scalar(_) if decl.time == Time::Structure => c.below(2),
                ColTy::Scalar(s) => values::random(s, c).word(),
            };
        }
    }
    Memory { rows, words }
}
