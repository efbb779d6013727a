//! Specialisation: runs everything in a program that the known data decide, and leaves the rest.
//!
//! ```
//! use jerboa_ir::{Lit, lang::*, print};
//! use jerboa_peval::*;
//!
//! let program = jerboa_ir::lang::build(|| {
//!     let pow = Fun::<(I32, I32), I32>::rec("pow", |(_, n)| known(n), |b, pow, (x, n)| {
//!         b.if_(n.eq(0), |_| I32::from(1), |b| x * pow.call(b, (x, n - 1)))
//!     });
//!     entry("main", Fun::<(I32, I32), I32>::lam(|b, (x, n)| pow.call(b, (x, n))));
//! });
//! let known = [Arg::Unknown, Arg::Known(Lit::I32(3))];
//! let residual = specialize(&Generic::new(program), "main", &known, &Facts::none(), &Options::default())?;
//! assert!(print(&residual.program).ends_with("\
//! fun lam(y1: i32, return: fn(i32))
//!   y2 = mul y1 y1
//!   y3 = mul y1 y2
//!   jump return(y3)
//! "));
//! # Ok::<(), Error>(())
//! ```
//!
//! # Online partial evaluation
//! A program's data are known early or late. Partial evaluation is running a program on the early data; what is left, the
//! *residual*, takes the late ones, and means the same (Law 3). *Online* says that what is known is decided while
//! running, value by value, not by an analysis before; so a value is
//!
//! ```text
//! value = literal | tuple | closure (continuation, environment) | row (class, index) | unknown: a node of the residual
//! ```
//!
//! An environment machine evaluates the generic program over such values. ρ, the environment, is a chain of frames along
//! the nesting tree ([`jerboa_ir::Scope`]); B is the residual block that is being written. The judgement ρ ⊢ body ⇓ B:
//!
//! ```text
//! pure node          evaluated when a jump asks, once per frame; over literals it folds, else it is a node of the residual
//! branch, known      go on in the side that is taken; the other is never looked at
//! branch, unknown    B ends in a branch; each side is a new block
//! dispatch, unknown  B ends in a switch on the class; each class is a new block, in which the row's class is known
//! call k(v…)         k = (continuation c, ρ'). In ρ' extended by v…, evaluate the filter of c:
//!   true             unfold: go on in the body of c
//!   false            stay: B ends in a jump to a residual block or function for (c, ρ', what is kept of v…), which is
//!                    looked up, or made once. Closures are kept, scalars become parameters
//! load, store        B ends in it and goes on in a new block
//! vectorize          B ends in it; its body stays as a function, whose unknowns it passes. Nothing where bounds are known
//!                    to hold nothing
//! return             an opaque exit: B ends in a jump to the residual function's return
//! ```
//!
//! What stays is a *function* if its only way out is its return: then its environment is abstracted over its unknowns,
//! and calls that differ in unknowns only share it. Else it is a *block* of the current function, shared by frame.
//! A loop closes because its header calls itself in the frame it was made in. The join of an unknown branch stays, so what
//! follows exists once; two different closures must not meet there ([`Error::ClosuresMeet`]). When all paths have ended,
//! nothing higher-order is left (Law 4), and small passes tidy up: each module of `tidy` states its law.
//!
//! # Why it ends
//! A run is infinite only if it unfolds for ever or makes blocks for ever. Unfoldings of a continuation are counted; at
//! [`Budget::unfoldings`] its calls stay, and so do all when the residual is large. A call that stays makes a block only
//! for a new key. Scalars are not in the key (kept ones leave it when there are many copies), so only closures can
//! make new keys for ever, and those are counted too: [`Budget::copies`] of one continuation in one environment end in
//! [`Error::Budget`], which names the function, the argument that grows and the chain of calls.
//!
//! # What is where
//! `value`, `frame`: values and environments · `eval`: pure nodes · `machine`: bodies · `call`: decisions and blocks ·
//! `lift`: functions · `vectorize`: loops over them · `copies`: what must not meet or grow · `emit`: writing blocks · `facts`: what is known of tables · `budget`, `error`, `log`, `report` · `tidy`: the passes.

mod budget;
mod call;
mod copies;
mod emit;
mod error;
mod eval;
mod facts;
mod frame;
mod lift;
mod log;
mod machine;
mod report;
mod tidy;
mod value;
mod vectorize;

use std::time::Instant;

use jerboa_ir::{ContId, Lit, Param, Program, Role, Scope, Ty, TyKind, verify_residual};

pub use budget::{Budget, Event};
pub use error::{Error, Place};
pub use facts::{ColumnFacts, Facts, Fold, TableFacts, Target};
pub use log::{Call, Decision, Log, Origin, Reason};
pub use report::{Pass, Report};
pub use tidy::tidy_with;

use machine::{Machine, Step};
use value::Value;

/// A generic program, frozen and ready to be specialised, by many threads at once.
pub struct Generic {
    program: Program,
    scope: Scope,
}

impl Generic {
    /// Freeze a program that the verifier has let through.
    pub fn new(program: Program) -> Generic {
        let scope = Scope::new(&program);
        Generic { program, scope }
    }

    /// The program.
    pub fn program(&self) -> &Program {
        &self.program
    }
}

/// What is known of one parameter of an entry.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Arg {
    /// A scalar with this value. The residual does not have the parameter.
    Known(Lit),
    /// A row of this class, its index unknown.
    Class(u32),
    /// Anything. It becomes parameters of the residual: one for each scalar or vector in it, a row is its index.
    Unknown,
}

/// How to specialise.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Options {
    /// Bounds on the work.
    pub budget: Budget,
    /// Keep the decision log.
    pub log: bool,
    /// Tidy the residual.
    pub tidy: bool,
    /// Check that the residual is first-order (Law 4). On in debug builds.
    pub check: bool,
    /// Flip decisions that must not change any result, by this seed (tests set it from `JERBOA_CHAOS`).
    pub chaos: Option<u64>,
}

impl Default for Options {
    fn default() -> Options {
        Options { budget: Budget::default(), log: false, tidy: true, check: cfg!(debug_assertions), chaos: None }
    }
}

/// What specialisation leaves.
#[derive(Clone, Debug)]
pub struct Residual {
    /// A first-order program with one entry.
    pub program: Program,
    /// Every call considered, if [`Options::log`] is set.
    pub log: Log,
    /// Cost and size.
    pub report: Report,
    /// The facts that the residual depends on, ascending.
    pub folds: Vec<Fold>,
}

/// Specialise an entry: one [`Arg`] for each of its parameters but the return.
pub fn specialize(
    generic: &Generic,
    entry: &str,
    args: &[Arg],
    facts: &Facts,
    options: &Options,
) -> Result<Residual, Error> {
    let start = Instant::now();
    let mut machine = Machine::new(&generic.program, &generic.scope, facts, options);
    begin(&mut machine, entry, args)?;
    machine.run()?;
    let mut passes = vec![Pass { name: "evaluate", time: start.elapsed(), changes: machine.evaluations }];
    let mut report = machine.report();
    let Machine { world, used, calls, .. } = machine;
    report.nodes_before = world.program().nodes.len();
    // The entry is the first continuation that is made.
    let (program, tidied) = tidy::tidy(world, ContId(0), options.tidy);
    passes.extend(tidied);
    if options.check {
        let faults = verify_residual(&program);
        if !faults.is_empty() {
            return Err(Error::NotFirstOrder { entry: entry.into(), faults });
        }
    }
    report.passes = passes;
    report.nodes_after = program.nodes.len();
    report.blocks = program.conts.len();
    Ok(Residual { program, log: Log { calls }, report, folds: used.finish() })
}

/// Make the residual entry and let its body wait.
fn begin(m: &mut Machine<'_>, entry: &str, args: &[Arg]) -> Result<(), Error> {
    let p = m.p;
    let Some(cont) = p.entry(entry) else {
        let entries = p.entries.iter().map(|(name, _)| name.to_string()).collect();
        return Err(Error::NoEntry { name: entry.into(), entries });
    };
    let refuse = |why: String| Err(Error::Arguments { entry: entry.into(), why });
    let generic = p.cont(cont);
    let Some((last, formals)) = generic.params.split_last() else { return refuse("it has no return".into()) };
    let Some(ret_ty) = lift::return_ty(last.ty) else { return refuse(format!("it cannot return to {}", last.ty)) };
    if formals.len() != args.len() {
        return refuse(format!("arguments: {} expected, {} given", formals.len(), args.len()));
    }
    let mut params: Vec<Param> = Vec::new();
    for (formal, arg) in formals.iter().zip(args) {
        let mut types: Vec<Ty> = Vec::new();
        let fits = match (arg, formal.ty.kind()) {
            (Arg::Known(lit), _) => lit.ty() == formal.ty,
            (Arg::Class(class), TyKind::Row(table)) if *class < m.facts.classes(*table) => {
                lift::flat(formal.ty, &mut types)
            }
            (Arg::Class(_), _) => false,
            (Arg::Unknown, _) => lift::flat(formal.ty, &mut types),
        };
        if !fits {
            let arg = match arg {
                Arg::Known(lit) => lit.to_string(),
                Arg::Class(class) => format!("a row of class {class}"),
                Arg::Unknown => "an unknown".into(),
            };
            return refuse(format!("{arg} is no argument of type {}", formal.ty));
        }
        params.extend(types.into_iter().map(|ty| Param { ty, name: formal.name.clone(), keep: false }));
    }
    params.push(Param { ty: ret_ty, name: last.name.clone(), keep: false });
    let (block, _) = m.block(Value::Closure(cont, frame::ROOT), Role::Fun, params, generic.loc);
    m.world.entry(entry, block);
    let mut nodes = m.world.params(block).into_iter();
    let mut values: Vec<Value> = Vec::new();
    for (formal, arg) in formals.iter().zip(args) {
        values.push(match (arg, formal.ty.kind()) {
            (Arg::Known(lit), _) => Value::Data(m.world.lit(*lit)),
            (Arg::Class(class), TyKind::Row(table)) => {
                let index = nodes.next().expect("made above");
                m.row(*table, Some(*class), index)
            }
            _ => m.of_type(formal.ty, &mut nodes),
        });
    }
    values.push(Value::Exit(nodes.next().expect("the return is the last parameter")));
    let trail = m.trails.push(m.trail, cont);
    m.trail = trail;
    let frame = m.frames.enter(m.scope, cont, frame::ROOT, &values, trail);
    m.wait(block, block, Step::Enter(cont, frame));
    Ok(())
}
