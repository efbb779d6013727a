//! Budgets: what makes specialisation end (Law 5).
//!
//! Three counters bound the work. *Unfoldings* of one continuation: beyond it, its calls stay, so that growing scalars
//! are generalised and a loop closes. *Size* (nodes of the residual, cells of the environments): beyond it, every call
//! that can stay does. *Copies* of one continuation in one environment: scalars are generalised there already, so only
//! a growing function argument gets so far; that is an error with the chain of calls.

/// Explicit bounds. The defaults leave room for a renderer's kernels (30,000 nodes) thirty times over and end every
/// program within 512 MiB.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Budget {
    /// How often the calls of one continuation are unfolded.
    pub unfoldings: u32,
    /// Nodes and continuations of the residual before tidying.
    pub nodes: usize,
    /// Cells of the environments (16 bytes each).
    pub cells: usize,
    /// Residual copies of one continuation that differ in their function arguments.
    pub copies: u32,
    /// Classes of a table for which a dispatch runs its body one by one; above it the class stays unknown.
    pub classes: u32,
}

impl Default for Budget {
    fn default() -> Budget {
        Budget { unfoldings: 1 << 13, nodes: 1 << 18, cells: 1 << 22, copies: 400, classes: 64 }
    }
}

/// A budget that was reached.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Event {
    /// The calls of this continuation stay from now on.
    Unfoldings(String),
    /// All calls stay from now on.
    Size,
    /// A dispatch on this table went on without the class: the table has so many.
    Classes(String, u32),
}

impl std::fmt::Display for Event {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Event::Unfoldings(name) => {
                write!(f, "`{name}` is unfolded no more: its calls stay, and known scalars become parameters")
            }
            Event::Size => f.write_str("the residual is large: from here on every call stays"),
            Event::Classes(table, n) => {
                write!(f, "`{table}` has {n} classes: too many to run a dispatch once for each")
            }
        }
    }
}
