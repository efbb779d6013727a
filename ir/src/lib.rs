//! What a program is: pure nodes that float, continuations that are placed, one jump per body.
//!
//! (The page of theory grows with the crate; until then read the modules in this order.)

pub mod ty;
pub mod lit;
pub mod op;
pub mod program;
pub mod world;
mod fold;
pub mod scope;
pub mod lang;
pub mod interp;
pub mod stats;
mod layout;
mod names;
pub mod print;
mod lex;
mod parse_line;
pub mod parse;
pub mod typing;
pub mod verify;
pub mod error;
pub mod dom;
pub mod loops;
pub mod cfg;
pub mod schedule;

pub use error::{Fault, TextError};
pub use lit::{Lit, NAN_BITS};
pub use op::Op;
pub use parse::parse;
pub use print::{SourceLines, print, print_with};
pub use program::*;
pub use scope::Scope;
pub use stats::{Reach, Stats};
pub use ty::{Scalar, Ty, TyKind};
pub use verify::{verify, verify_residual};
pub use world::World;
