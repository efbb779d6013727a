//! The interpreter: what a program means. Every other engine is compared with it, bit for bit.
//!
//! It is an environment machine. A *closure* is a continuation and the frame around it; a *frame* is one activation of a
//! continuation: a cell for each pure node that the continuation owns ([`Scope`]), its parameters among them, and the
//! frame around. A jump evaluates its operands, makes a frame and goes on there, so runs never nest and the machine's
//! stack does not grow. A pure node is evaluated when a jump first needs it, at most once per frame of its owner.
//! Filters are never looked at. Of the rest of the crate it shares [`Op::eval`](crate::Op::eval), the meaning of the
//! operations, and nothing else.

mod eval;
mod heap;
mod machine;
mod memory;
mod vectorize;

use std::fmt;

use crate::lit::Lit;
use crate::program::*;
use crate::scope::Scope;

/// Content of a buffer. Its words lie as [`Buffer::word`] says.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Memory {
    /// Number of rows: at least 1 for a table.
    pub rows: u32,
    /// One word per row and column.
    pub words: Vec<u32>,
}

/// How long and how big a run may be.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Jumps.
    pub fuel: u64,
    /// Cells of 12 bytes that are alive at once: frames, vectors, tuples, local arrays. Bounds the depth of recursion.
    pub cells: usize,
}

impl Default for Limits {
    /// No limit of time, 16 Mi cells (the collector needs up to 600 MiB for them).
    fn default() -> Limits {
        Limits { fuel: u64::MAX, cells: 1 << 24 }
    }
}

/// Why a run ended without a result.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Stop {
    /// The fuel is used up.
    Fuel,
    /// Recursion is too deep, or the local arrays are too big.
    Limit,
    /// The program or its inputs are wrong.
    Fault {
        /// Line of the author's source.
        loc: Loc,
        /// What is wrong.
        message: String,
    },
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Stop::Fuel => f.write_str("the run used up its fuel"),
            Stop::Limit => f.write_str("the run needs more memory than its limit: recursion too deep?"),
            Stop::Fault { loc: Loc::NONE, message } => f.write_str(message),
            Stop::Fault { loc, message } => write!(f, "{message} ({loc})"),
        }
    }
}

impl std::error::Error for Stop {}

fn fault<T>(loc: Loc, message: impl Into<String>) -> Result<T, Stop> {
    Err(Stop::Fault { loc, message: message.into() })
}

/// Watches a run: for `jerboa trace`, and for tests of what is evaluated. `()` watches nothing and costs nothing.
pub trait Observer {
    /// The run goes on in this continuation.
    fn enter(&mut self, _cont: ContId) {}
    /// A scalar: a parameter of the continuation just entered, or a node just evaluated.
    fn value(&mut self, _node: NodeId, _lit: Lit) {}
    /// A read of a table beyond its last row, which gives the last row. A program for a valid scene has none.
    fn clamped(&mut self, _read: NodeId, _index: u32) {}
}

impl Observer for () {}

/// A program made ready to run.
pub struct Interp<'p> {
    program: &'p Program,
    /// Where each node's value lies.
    places: Vec<Place>,
    /// What a frame of each continuation looks like.
    shapes: Vec<Shape>,
    /// The first thing out of scope, if any.
    fault: Option<Stop>,
    /// In which order the iterations of a `vectorize` run: ascending, or as this number says.
    order: Option<u64>,
}

/// The cell of a node: in the frame at `level` of the nesting. Constants have a frame of their own at level 0.
#[derive(Clone, Copy)]
struct Place {
    level: u32,
    slot: u32,
}

/// The frame of a continuation.
struct Shape {
    level: u32,
    slots: u32,
    /// The node of each parameter that is used.
    params: Box<[Option<NodeId>]>,
}

impl<'p> Interp<'p> {
    /// Make a program ready: computes its [`Scope`].
    pub fn new(program: &'p Program) -> Interp<'p> {
        let scope = Scope::new(program);
        let level = |c: ContId| scope.level[c.index()] + 1;
        let owned = scope.owner.iter().zip(&scope.slot);
        let places = owned.map(|(owner, slot)| Place { level: owner.map_or(0, level), slot: *slot }).collect();
        let ids = (0..program.conts.len() as u32).map(ContId);
        let mut shapes: Vec<Shape> = ids
            .map(|c| Shape {
                level: level(c),
                slots: scope.slots[c.index()],
                params: vec![None; program.cont(c).params.len()].into(),
            })
            .collect();
        for (i, node) in program.nodes.iter().enumerate() {
            if let Node::Param { cont, index } = node {
                shapes[cont.index()].params[*index as usize] = Some(NodeId(i as u32));
            }
        }
        let fault = scope
            .faults
            .first()
            .map(|(c, message)| Stop::Fault { loc: program.cont(*c).loc, message: message.clone() });
        Interp { program, places, shapes, fault, order: None }
    }

    /// Run the iterations of each `vectorize` in an order that this number chooses. No order changes a result; a test
    /// that finds one has found iterations that are not independent.
    pub fn shuffled(self, order: u64) -> Interp<'p> {
        Interp { order: Some(order), ..self }
    }

    /// Run a continuation whose last parameter is its return, and give what it returns.
    ///
    /// Arguments and results are scalars in order: a vector is its lanes, a row its index, a tuple its components.
    /// `memory` has an element per buffer of the program.
    ///
    /// # Errors
    /// [`Stop::Fuel`] and [`Stop::Limit`] at the limits; [`Stop::Fault`] when an unchecked load is out of range, when an
    /// iteration of a `vectorize` loads beyond the rows of a column that iterations store to, or when the arguments or the
    /// memory do not fit the declarations.
    ///
    /// # Panics
    /// On a program that the verifier refuses.
    pub fn run(&self, entry: ContId, args: &[Lit], memory: &mut [Memory], limits: Limits) -> Result<Vec<Lit>, Stop> {
        self.run_observed(entry, args, memory, limits, &mut ())
    }

    /// As [`Interp::run`], watched.
    ///
    /// # Errors
    /// As [`Interp::run`].
    ///
    /// # Panics
    /// As [`Interp::run`].
    pub fn run_observed(
        &self,
        entry: ContId,
        args: &[Lit],
        memory: &mut [Memory],
        limits: Limits,
        observer: &mut impl Observer,
    ) -> Result<Vec<Lit>, Stop> {
        if let Some(fault) = &self.fault {
            return Err(fault.clone());
        }
        self.check_memory(memory)?;
        machine::Machine::new(self, memory, limits, observer).run(entry, args)
    }

    /// Does the memory fit the declarations?
    fn check_memory(&self, memory: &[Memory]) -> Result<(), Stop> {
        let buffers = &self.program.buffers;
        if memory.len() != buffers.len() {
            return fault(Loc::NONE, format!("the program has {} buffers, not {}", buffers.len(), memory.len()));
        }
        for (buffer, m) in buffers.iter().zip(memory) {
            if m.words.len() != m.rows as usize * buffer.columns.len() {
                let (words, rows, columns) = (m.words.len(), m.rows, buffer.columns.len());
                return fault(Loc::NONE, format!("`{}`: {words} words for {rows} rows of {columns}", buffer.name));
            }
            if m.rows == 0 && matches!(buffer.kind, BufKind::Table { .. }) {
                return fault(Loc::NONE, format!("table `{}` has no row", buffer.name));
            }
        }
        Ok(())
    }
}

/// [`Interp::new`] and [`Interp::run`] in one.
///
/// # Errors
/// As [`Interp::run`].
///
/// # Panics
/// As [`Interp::run`].
pub fn run(
    program: &Program,
    entry: ContId,
    args: &[Lit],
    memory: &mut [Memory],
    limits: Limits,
) -> Result<Vec<Lit>, Stop> {
    Interp::new(program).run(entry, args, memory, limits)
}
