//! The embedded language: programs written as Rust functions.
//!
//! A Rust `fn` over staged values is a *constructor*: it runs once, while the program is built, and is gone afterwards. A
//! [`Fun`] is a function *of the program*: it has a filter, and the evaluator sees it. So a host `if` or `for` ranges over
//! the author's own structure (three components of a vector), never over the program's data.
//!
//! - Pure values ([`F32`], [`I32`], [`U32`], [`Bool`], [`Vector`]) are copyable handles with operators; they have no place.
//! - Control needs the cursor `b: &mut Block`: [`Block::if_`], [`Block::loop_`], [`Block::label`], [`Block::vectorize`],
//!   calls, loads and stores. A function without `b` in its type is visibly pure.
//! - Records are plain structs with one line [`impl_staged!`](crate::impl_staged); functions and exits are fields like
//!   any other.
//!
//! ```
//! use jerboa_ir::lang::*;
//!
//! type PowFn = Fun<(I32, I32), I32>;
//!
//! /// fn @(?n & n < 64) pow(x, n), section 3.2 of the paper.
//! fn make_pow() -> PowFn {
//!     PowFn::rec("pow", |(_x, n)| known(n) & n.lt(64), |b, pow, (x, n)| {
//!         b.if_(n.eq(0), |_| I32::from(1), |b| {
//!             b.if_((n % 2).eq(0), |b| { let y = pow.call(b, (x, n / 2)); y * y }, |b| x * pow.call(b, (x, n - 1)))
//!         })
//!     })
//! }
//!
//! let program = build(|| {
//!     let pow = make_pow();
//!     entry("main", Fun::<I32, I32>::lam(|b, x| pow.call(b, (x, 5.into()))));
//! });
//! assert_eq!(program.entries.len(), 1);
//! ```
//!
//! # What the compiler refuses
//! A host `==` on staged values (they have no `PartialEq`):
//! ```compile_fail,E0369
//! # use jerboa_ir::lang::*;
//! fn f(a: F32, b: F32) -> bool { a == b }
//! ```
//! A host `if` on a staged condition:
//! ```compile_fail,E0308
//! # use jerboa_ir::lang::*;
//! fn f(a: F32) -> F32 { if a.lt(3.0) { a } else { -a } }
//! ```
//! The outer cursor inside a branch:
//! ```compile_fail,E0500
//! # use jerboa_ir::lang::*;
//! fn f(b: &mut Block, c: Bool, g: Fun<F32, F32>, x: F32) -> F32 { b.if_(c, |_| g.call(b, x), |_| x) }
//! ```
//! The cursor of the function around it inside a `vectorize`:
//! ```compile_fail,E0500
//! # use jerboa_ir::lang::*;
//! fn f(b: &mut Block, n: U32, g: Fun<U32, ()>) { b.vectorize(8, 0, n, |_, i| g.call(b, i)) }
//! ```
//! A forgotten field of a record:
//! ```compile_fail,E0027
//! # use jerboa_ir::lang::*;
//! #[derive(Clone, Copy)]
//! struct Pair { a: F32, b: F32 }
//! jerboa_ir::impl_staged!(Pair { a });
//! ```
//! What it cannot see is refused while building, in the author's words and with his line: leaving a block twice, or a
//! value used outside of its scope.

use std::cell::RefCell;

use crate::program::{Loc, Program};
use crate::world::World;

pub mod staged;
pub mod value;
pub mod vector;
pub mod fun;
pub mod block;
pub mod control;
mod vectorize;
pub mod buffer;
pub mod record;

pub use block::{Block, Ends, Left};
pub use buffer::{Array, Buf, Col, ColumnSpec, Elem, Row, Spec, SpecTy, declare, spec};
pub use control::{Case, Range, range};
pub use fun::{Exit, Fun, Never, always, entry, known, never};
pub use staged::{Keep, Staged};
pub use value::{Bool, F32, I32, U32};
pub use vector::Vector;

thread_local! {
    /// The interner that constructors write to. It holds no current block: control needs a [`Block`].
    static WORLD: RefCell<Option<World>> = const { RefCell::new(None) };
}

/// Build a program: run constructors in a fresh world.
///
/// # Panics
/// When called inside itself, or when the author misuses the language; the message has his line.
pub fn build(author: impl FnOnce()) -> Program {
    /// Leaves no world behind when the author's code panics.
    struct Clear;
    impl Drop for Clear {
        fn drop(&mut self) {
            WORLD.with_borrow_mut(|w| *w = None);
        }
    }
    WORLD.with_borrow_mut(|w| assert!(w.replace(World::new()).is_none(), "a program is being built on this thread"));
    let _clear = Clear;
    author();
    WORLD.with_borrow_mut(|w| w.take()).expect("the world is there until it is taken").finish()
}

/// Use the world. Never calls back into the author's code, so the borrow is short.
pub(crate) fn with<R>(f: impl FnOnce(&mut World) -> R) -> R {
    WORLD.with_borrow_mut(|w| f(w.as_mut().expect("staged values live inside `lang::build`")))
}

/// The author's line.
#[track_caller]
pub(crate) fn here() -> Loc {
    Loc::caller()
}
