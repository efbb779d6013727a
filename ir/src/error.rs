//! What can be wrong with a text and with a program.

use std::fmt;

use crate::program::{ContId, Loc, NodeId};

/// Why a text is not a program: the text is at fault, at this place.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TextError {
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1.
    pub column: usize,
    /// What was found and what was expected.
    pub what: String,
}

impl fmt::Display for TextError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}: {}", self.line, self.column, self.what)
    }
}

impl std::error::Error for TextError {}

/// What is wrong with a program. Always a mistake of whoever made the program: its author, the evaluator or a pass.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Fault {
    /// The rule that is broken, as the table in [`mod@crate::verify`] names it.
    pub rule: &'static str,
    /// Where.
    pub cont: Option<ContId>,
    /// Which node.
    pub node: Option<NodeId>,
    /// The author's line.
    pub loc: Loc,
    /// What is wrong, with names.
    pub what: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.rule, self.what)?;
        if self.loc != Loc::NONE { write!(f, " ({})", self.loc) } else { Ok(()) }
    }
}

impl std::error::Error for Fault {}
