//! Jerboa's programs: what they are, what they mean, how they are written, printed, checked and run.
//!
//! # The calculus
//! A [`Program`] has two kinds of things. *Pure nodes* ([`Node`]: literals, operations, tuples, reads of tables, …)
//! float: they have no place and no order, equal ones are one, and what nobody needs does not exist. *Continuations*
//! ([`Cont`]) are placed: parameters, a filter, and a [`Body`] that is one jump. Nothing returns. A direct-style function
//! `(f32, i32) → f32` is a continuation of `(f32, i32, fn(f32))`, whose last parameter is where to go with the result;
//! further parameters of continuation type are further exits. Branches, switches, loads and stores are jumps to built-in
//! continuations, so that the order of effects is the order of jumps (Appel, *Compiling with Continuations*, 1992; the
//! graph form without nesting is Leißa, Köster, Hack, *A graph-based higher-order intermediate representation*, CGO 2015).
//!
//! ```
//! use jerboa_ir::lang::*;
//!
//! type PowFn = Fun<(F32, I32), F32>;
//! let program = build(|| {
//!     let pow = PowFn::rec("pow", |(_, n)| known(n) & n.lt(64), |b, pow, (x, n)| {
//!         b.if_(n.eq(0), |_| F32::from(1.0), |b| x * pow.call(b, (x, n - 1)))
//!     });
//!     entry("cube", Fun::<F32, F32>::lam(|b, x| pow.call(b, (x, 3.into()))));
//! });
//! assert_eq!(jerboa_ir::verify(&program), []);
//! # let text = "\
//! # jerboa-ir 1  ; nodes 7  floats 1  conts 7  calls 2  closures 0  branches 1  reads 0  loads 0  stores 0
//! # entry cube = lam
//! #
//! # fun lam(y1: f32, return: fn(f32)) @
//! #   jump pow(y1, 3i, rest)
//! #   rest rest(y2: f32) @  ; free: return
//! #   jump return(y2)
//! #
//! # fun pow(y1: f32, y2: i32, return: fn(f32)) @(and (known y2) (lt y2 64i))
//! #   y3 = eq y2 0i
//! #   branch y3 then else
//! #   arm then() @  ; free: y2, return
//! #     jump join(1.0)
//! #   arm else() @  ; free: y1, y2, return
//! #     y4 = sub y2 1i
//! #     jump pow(y1, y4, rest)
//! #     rest rest(y5: f32) @  ; free: y1, y2, return
//! #     y6 = mul y1 y5
//! #     jump join(y6)
//! #   join join(y7: f32) @(known y3)  ; free: y2, return
//! #   jump return(y7)
//! # ";
//! assert_eq!(jerboa_ir::print(&program), text);
//!
//! use jerboa_ir::{Lit, interp};
//! let cube = program.entry("cube").unwrap();
//! let results = interp::run(&program, cube, &[Lit::f32(1.5)], &mut [], interp::Limits::default());
//! assert_eq!(results, Ok(vec![Lit::f32(3.375)]));
//! ```
//!
//! where `text`, in the format of [`mod@print`], holds
//!
//! ```text
//! fun pow(y1: f32, y2: i32, return: fn(f32)) @(and (known y2) (lt y2 64i))
//!   y3 = eq y2 0i
//!   branch y3 then else
//!   arm then() @  ; free: y2, return
//!     jump join(1.0)
//!   arm else() @  ; free: y1, y2, return
//!     y4 = sub y2 1i
//!     jump pow(y1, y4, rest)
//!     rest rest(y5: f32) @  ; free: y1, y2, return
//!     y6 = mul y1 y5
//!     jump join(y6)
//!   join join(y7: f32) @(known y3)  ; free: y2, return
//!   jump return(y7)
//! ```
//!
//! # Evaluation
//! A jump evaluates its operands and goes on in its target; arguments are values, never unevaluated terms. When and how
//! often a pure node is computed cannot be observed: every operation is total ([`op`]), reads of tables are clamped and
//! tables do not change while a kernel runs. [`interp`] *is* the meaning; every other engine gives the same bits.
//!
//! # Independent iterations
//! `vectorize width lo hi body(args) -> next` calls `body(args…, i, k)` for each i from `lo` up to `hi`, and `k` ends an
//! iteration. What it means does not depend on the order, because no iteration touches what another one writes
//! ([`mod@verify`] has the rules of that), so a back end may run `width` of them at once, as the lanes of vectors. In a generic
//! program the body is written in place ([`lang::Block::vectorize`]) and what it captures is uniform; in a residual it is a
//! function, and what it captured are its arguments. The interpreter runs iterations in ascending order, or shuffled where
//! a test asks for it ([`interp::Interp::shuffled`]). Lane code, which a back end makes of a body, has vectors in memory:
//! gathers, scatters and runs under masks ([`Mem`]).
//!
//! # Scope
//! Nesting is not written down, it follows from free variables ([`scope`]): what uses a parameter belongs to the
//! parameter's continuation, and so does what mentions something that does. The owners of one term's free parameters form
//! a chain; a program in which they do not uses a value where it was never made, and the verifier says so.
//!
//! # Filters
//! A continuation's filter says whether a call of it is unfolded while the program is specialised: a `bool` node over its
//! parameters and what is in scope, in which `known(x)` asks whether the evaluator knows `x`. The filter `true` prints as
//! `@`, `false` as nothing. A filter can change how much is left to do at run time, never a result; so `known` occurs in
//! filters only. A call can force or hold ([`Mode`]), and a parameter marked `keep` stays specialised where the call stays.
//! (Leißa et al., *AnyDSL: a partial evaluation framework for programming high-performance libraries*, OOPSLA 2018.)
//!
//! # Words
//! | word | meaning |
//! |---|---|
//! | continuation | parameters, filter and one jump; it never returns |
//! | function | a continuation whose last parameter is its return |
//! | block | a continuation of a residual that is no function |
//! | entry | a function that the host calls: a kernel |
//! | pure node | a value without a place |
//! | table | a buffer that kernels only read; a row of it is a value with a class |
//! | stream | a buffer that kernels read and write |
//! | gather, scatter | a load, a store of a vector, each lane at an index of its own |
//! | run | a load or store of a vector in rows that follow each other |
//! | mask | which lanes of a vector are stored |
//! | `vectorize` | a loop whose iterations are independent; its body is a function of the index |
//! | uniform | the same in all iterations of a `vectorize` |
//! | varying | not uniform |
//! | class | rows of a table that agree in every known column |
//! | binding time | structure, value or bulk: at which level of knowledge a column is known |
//! | generic program | as authors write it; higher-order |
//! | specialise | run what the known data decide, and emit the rest |
//! | residual | what is left: a first-order program ([`verify_residual`] has its rules) |
//! | unfold | go on in a callee's body while specialising, instead of leaving a call |
//! | closure | a continuation used as a value, with what is around it |
//! | fold | compute a node of literals while the program is built, to the bits that running gives |
//!
//! # What is never done here
//! No reassociation, no contraction, no `x·0 → 0`; no address and no pointer; no recursion over a program's depth (long
//! programs do not overflow the host's stack); no dependency on any other crate of Jerboa.
//!
//! The modules stand in reading order.

// Data.
pub mod ty;
pub mod lit;
pub mod op;
pub mod program;
// Construction.
pub mod world;
mod fold;
pub mod lang;
// Meaning.
pub mod scope;
pub mod interp;
// Rules.
pub mod typing;
pub mod verify;
pub mod error;
// Text.
pub mod print;
pub mod parse;
pub mod stats;
// Analyses of residuals.
pub mod dom;
pub mod loops;
pub mod cfg;
pub mod structure;
pub mod schedule;
pub mod hash;

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
