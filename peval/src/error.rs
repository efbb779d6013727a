//! Why a program cannot be specialised. All are the program author's to fix, never a scene's.

use std::fmt;
use std::sync::Arc;

use jerboa_ir::{Fault, Loc};

/// A continuation as an error names it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Place {
    /// The author's name.
    pub name: Arc<str>,
    /// The author's line.
    pub loc: Loc,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}`", self.name)?;
        if self.loc != Loc::NONE { write!(f, " ({})", self.loc) } else { Ok(()) }
    }
}

/// Why specialisation failed.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Error {
    /// There is no entry of this name.
    NoEntry {
        /// What was asked for.
        name: String,
        /// What there is.
        entries: Vec<String>,
    },
    /// The arguments do not fit the entry.
    Arguments {
        /// The entry.
        entry: String,
        /// What does not fit.
        why: String,
    },
    /// Two different closures meet at the join of an unknown branch (Law 4).
    ClosuresMeet {
        /// The join.
        join: Place,
        /// What arrived first.
        first: Place,
        /// What arrived later.
        second: Place,
    },
    /// The body of a `vectorize` is no function of its own: it reaches an exit or a local array of the function around it.
    NotIndependent {
        /// The body.
        body: Place,
        /// The calls that led there, outermost first.
        chain: Vec<Place>,
    },
    /// A budget is used up and nothing is left to generalise: a function argument grows (Law 5).
    Budget {
        /// The function whose copies grow.
        function: Place,
        /// The argument that differs from copy to copy.
        argument: String,
        /// The calls that led there, outermost first.
        chain: Vec<Place>,
        /// How many copies there are.
        copies: u32,
    },
    /// The residual is not first-order (Law 4): a mistake of the evaluator, or of a program that the verifier refuses. Or
    /// iterations of a `vectorize` are not independent: a mistake of the author's that shows in a residual only.
    NotFirstOrder {
        /// The entry.
        entry: String,
        /// What is wrong, each with its node and line.
        faults: Vec<Fault>,
    },
    /// The residual grew beyond all bounds although every call stays.
    TooLarge {
        /// Nodes and continuations made.
        nodes: usize,
        /// The calls that led there, outermost first.
        chain: Vec<Place>,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let chain = |places: &[Place]| {
            let words: Vec<String> = places.iter().map(Place::to_string).collect();
            if words.is_empty() { "the entry".into() } else { words.join(" → ") }
        };
        match self {
            Error::NoEntry { name, entries } => {
                write!(f, "there is no entry `{name}`; there are: {}", entries.join(", "))
            }
            Error::Arguments { entry, why } => write!(f, "entry `{entry}`: {why}"),
            Error::ClosuresMeet { join, first, second } => write!(
                f,
                "two functions meet at the join {join} of an unknown branch: {first} and {second}; choose inside the \
                 function, or ask for a copy per branch with `.per_branch()`"
            ),
            Error::NotIndependent { body, chain: calls } => write!(
                f,
                "an iteration of `vectorize`, {body}, uses an exit or a local array of the function around it; calls: {}; \
                 make the array inside, and let the iteration come to its end",
                chain(calls)
            ),
            Error::Budget { function, argument, chain: calls, copies } => write!(
                f,
                "{function} has {copies} copies because {argument} grows with each call; calls: {}; make that argument \
                 a scalar, or give the function a filter that ends",
                chain(calls)
            ),
            Error::NotFirstOrder { entry, faults } => {
                write!(f, "the residual of `{entry}` breaks rules; is the program verified?")?;
                faults.iter().try_for_each(|fault| write!(f, "\n  {fault}"))
            }
            Error::TooLarge { nodes, chain: calls } => {
                write!(f, "the residual has {nodes} nodes and still grows; calls: {}", chain(calls))
            }
        }
    }
}

impl std::error::Error for Error {}
