//! Specialisation: runs everything in a program that the known data decide, and leaves the rest.

mod budget;
mod call;
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

use std::time::Instant;

use jerboa_ir::{ContId, Lit, Param, Program, Role, Scope, Ty, TyKind, verify_residual};

pub use budget::{Budget, Event};
pub use error::{Error, Place};
pub use facts::{ColumnFacts, Facts, Fold, TableFacts, Target};
pub use log::{Call, Decision, Log, Origin, Reason};
pub use report::{Pass, Report};

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
        return refuse(format!("it takes {} arguments, not {}", formals.len(), args.len()));
    }
    let mut params: Vec<Param> = Vec::new();
    for (formal, arg) in formals.iter().zip(args) {
        let mut types: Vec<Ty> = Vec::new();
        let fits = match (arg, formal.ty.kind()) {
            (Arg::Known(lit), _) => lit.ty() == formal.ty,
            (Arg::Class(class), TyKind::Row(table)) if *class < m.facts.classes(*table) => lift::flat(formal.ty, &mut types),
            (Arg::Class(_), _) => false,
            (Arg::Unknown, _) => lift::flat(formal.ty, &mut types),
        };
        if !fits {
            return refuse(format!("{arg:?} is no argument of type {}", formal.ty));
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
