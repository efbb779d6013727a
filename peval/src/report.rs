//! What a specialisation cost and how far it multiplied code.

use std::fmt;
use std::time::Duration;

use crate::budget::Event;

/// Time and size of one pass.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Pass {
    /// Name of the pass.
    pub name: &'static str,
    /// Wall time, all rounds together.
    pub time: Duration,
    /// What it did: how many changes.
    pub changes: u64,
}

/// What was done, how long it took, and what it made.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Report {
    /// Passes in order: evaluation, then tidying.
    pub passes: Vec<Pass>,
    /// Nodes of the generic program, whatever the entry reaches of it.
    pub generic_nodes: usize,
    /// Nodes that evaluation left, before tidying.
    pub nodes_before: usize,
    /// Nodes of the residual.
    pub nodes_after: usize,
    /// Continuations of the residual.
    pub blocks: usize,
    /// Pure nodes evaluated.
    pub evaluations: u64,
    /// Calls unfolded.
    pub unfoldings: u64,
    /// Residual functions made.
    pub functions: usize,
    /// Generic continuations that became more than one residual one: name and how many, most copied first.
    pub copies: Vec<(String, u32)>,
    /// Budgets that were reached.
    pub events: Vec<Event>,
}

impl Report {
    /// Time of all passes.
    pub fn time(&self) -> Duration {
        self.passes.iter().map(|p| p.time).sum()
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "nodes: generic {}, left {}, tidied {}", self.generic_nodes, self.nodes_before, self.nodes_after)?;
        writeln!(
            f,
            "evaluations {}, unfoldings {}, functions {}, blocks {}",
            self.evaluations, self.unfoldings, self.functions, self.blocks
        )?;
        for pass in &self.passes {
            writeln!(f, "{:>10.1} us  {} ({} changes)", pass.time.as_secs_f64() * 1e6, pass.name, pass.changes)?;
        }
        for (name, count) in self.copies.iter().take(10) {
            writeln!(f, "{count:>10} copies of {name}")?;
        }
        self.events.iter().try_for_each(|e| writeln!(f, "{e}"))
    }
}
