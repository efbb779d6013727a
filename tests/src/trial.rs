//! One random program put through every engine and every stage.

use std::collections::BTreeSet;
use std::time::{Duration, Instant};

use jerboa_backend_cranelift as cranelift;
use jerboa_backend_cranelift::lanes::{Width, lanes, vectorizes};
use jerboa_ir::interp::{Interp, Limits, Memory, Stop};
use jerboa_ir::*;
use jerboa_peval::{Arg, Error, Facts, Generic, Options, specialize};

use crate::choices::Choices;
use crate::coverage::{Coverage, Watch, within_iterations};
use crate::engine::Runs;
use crate::knowledge::{Level, classify};
use crate::machine::{call, canonical};
use crate::programs::Case;
use crate::refold::refold;

/// Inputs of each program in the test command.
pub const INPUTS: u64 = 32;

/// A run that needs more has no result to compare.
const LIMITS: Limits = Limits { fuel: 100_000, cells: 1 << 20 };

/// What happened, over all programs.
#[derive(Default, Debug)]
pub struct Tally {
    /// Runs of generic programs.
    pub runs: u64,
    /// Runs that reached a limit, or whose program the evaluator did not finish.
    pub unfinished: u64,
    /// What the interpreter has executed in generic programs.
    pub interpreted: Coverage,
    /// … that the evaluator has left in residuals, and the interpreter has executed there.
    pub left: Coverage,
    /// Operations that were compiled to machine code.
    pub compiled: BTreeSet<Op>,
    /// The longest that the evaluator took for a program.
    pub slowest: Duration,
}

impl Tally {
    /// Both together.
    pub fn add(&mut self, other: Tally) {
        self.runs += other.runs;
        self.unfinished += other.unfinished;
        self.interpreted.add(other.interpreted);
        self.left.add(other.left);
        self.compiled.extend(other.compiled);
        self.slowest = self.slowest.max(other.slowest);
    }
}

/// What a run leaves behind: results and memory, or why there are none.
type Outcome = Result<(Vec<Lit>, Vec<Memory>), Stop>;

/// A program, what is known of it, and what it does on some inputs.
struct Trial<'c> {
    case: &'c Case,
    memory: Vec<Memory>,
    facts: Facts,
    split: Split,
    /// Arguments, and what they lead to; only runs within the limits.
    runs: Vec<(Vec<Lit>, Outcome)>,
}

/// Put a program through every engine and every stage, on so many inputs from this seed.
///
/// # Errors
/// Where the first difference is, in words.
pub fn check(case: &Case, seed: u64, inputs: u64, tally: &mut Tally) -> Result<(), String> {
    clean("the program", &verify(&case.program), &case.program)?;
    round_trip(&case.program)?;
    let trial = Trial::new(case, seed, inputs, tally)?;
    trial.check_order("the program in another order", &case.program, seed)?;
    trial.check_construction()?;
    let generic = Generic::new(case.program.clone());
    let start = Instant::now();
    let residual = trial.specialize(&generic, Options::default())?;
    tally.slowest = tally.slowest.max(start.elapsed());
    let Some(residual) = residual else {
        tally.unfinished += inputs;
        return Ok(());
    };
    trial.check_residual("the residual", &residual, tally)?;
    trial.check_order("the residual in another order", &residual, seed)?;
    for (stage, options) in [
        ("the residual before it is tidied", Options { tidy: false, ..Options::default() }),
        ("the residual in chaos", Options { chaos: Some(seed), ..Options::default() }),
    ] {
        if let Some(other) = trial.specialize(&generic, options)? {
            trial.check_residual(stage, &other, tally)?;
        }
    }
    trial.check_again(&residual)?;
    round_trip(&residual)?;
    trial.check_lanes(&residual, tally)?;
    trial.check_machine_code(&residual, tally)
}

/// A residual with runs of it.
pub struct Sample {
    /// The residual.
    pub residual: Program,
    /// What every run begins with.
    pub memory: Vec<Memory>,
    /// Inputs, and what the generic program makes of them.
    pub runs: Runs,
}

/// The residual of a program on so many inputs, with something known or nothing; none if the evaluator does not finish.
///
/// # Errors
/// What went wrong, in words.
pub fn sample(case: &Case, seed: u64, inputs: u64) -> Result<Option<Sample>, String> {
    let trial = Trial::new(case, seed, inputs, &mut Tally::default())?;
    let Some(residual) = trial.specialize(&Generic::new(case.program.clone()), Options::default())? else {
        return Ok(None);
    };
    let mut runs = Runs::default();
    for (args, outcome) in trial.runs {
        runs.inputs.push(trial.split.unknown(&args));
        runs.expected.extend(outcome);
    }
    Ok(Some(Sample { residual, memory: trial.memory, runs }))
}

impl<'c> Trial<'c> {
    fn new(case: &'c Case, seed: u64, inputs: u64, tally: &mut Tally) -> Result<Trial<'c>, String> {
        let mut c = Choices::random(seed);
        let mut memory = case.memory.clone();
        let facts = classify(&case.program, &mut memory, c.pick(&[Level::Nothing, Level::Structure, Level::All]));
        let split = Split::new(case, &mut c);
        let mut runs = Vec::new();
        let program = Ready::new(&case.program);
        for _ in 0..inputs {
            let args = split.input(case.arguments(&mut c));
            let outcome = program.run(&args, &memory, &mut tally.interpreted);
            tally.runs += 1;
            match outcome {
                Err(Stop::Fault { .. }) => return Err(format!("interpreter, on {args:?}: {outcome:?}")),
                Err(_) => tally.unfinished += 1,
                Ok(_) => runs.push((args, outcome)),
            }
        }
        Ok(Trial { case, memory, facts, split, runs })
    }

    /// Folding while a program is built changes nothing.
    fn check_construction(&self) -> Result<(), String> {
        let folded = refold(&self.case.program, self.case.main, &self.split.literals());
        clean("the program built again", &verify(&folded), &folded)?;
        let ready = Ready::new(&folded);
        self.compare("the program built again", &folded, |args| ready.run(args, &self.memory, &mut Coverage::default()))
    }

    /// The order of independent iterations changes nothing.
    fn check_order(&self, stage: &str, p: &Program, order: u64) -> Result<(), String> {
        if !p.conts.iter().any(|c| matches!(c.body, Body::Vectorize { .. })) {
            return Ok(());
        }
        let generic = std::ptr::eq(p, &self.case.program);
        let ready = Ready { interp: Interp::new(p).shuffled(order), ..Ready::new(p) };
        self.compare(stage, p, |args| {
            let args = if generic { args.to_vec() } else { self.split.unknown(args) };
            ready.run(&args, &self.memory, &mut Coverage::default())
        })
    }

    /// The residual; none if the evaluator's budget does not suffice, or if it refuses the program by Law 4: what follows
    /// a call is evaluated once per return, and then a function made there is two, which may meet at a join further on.
    fn specialize(&self, generic: &Generic, options: Options) -> Result<Option<Program>, String> {
        match specialize(generic, "main", &self.split.known, &self.facts, &options) {
            Ok(residual) => Ok(Some(residual.program)),
            Err(Error::Budget { .. } | Error::TooLarge { .. } | Error::ClosuresMeet { .. }) => Ok(None),
            Err(e) => Err(format!("evaluator, {options:?}, knowing {:?}: {e}", self.split.known)),
        }
    }

    fn check_residual(&self, stage: &str, residual: &Program, tally: &mut Tally) -> Result<(), String> {
        clean(stage, &verify_residual(residual), residual)?;
        let ready = Ready::new(residual);
        self.compare(stage, residual, |args| ready.run(&self.split.unknown(args), &self.memory, &mut tally.left))
    }

    /// Specialising a residual again changes nothing, if nothing more is known.
    fn check_again(&self, residual: &Program) -> Result<(), String> {
        let main = residual.entry("main").expect("the residual has the entry");
        let args = vec![Arg::Unknown; residual.cont(main).params.len() - 1];
        let generic = Generic::new(residual.clone());
        let again = specialize(&generic, "main", &args, &Facts::none(), &Options::default());
        let again = again.map_err(|e| format!("the residual does not specialise: {e}\n{}", print(residual)))?.program;
        if bare(residual) == bare(&again) {
            return Ok(());
        }
        Err(format!("specialised twice:\n{}\nbecomes\n{}", print(residual), print(&again)))
    }

    /// What is vectorised, in lanes.
    fn check_lanes(&self, residual: &Program, tally: &mut Tally) -> Result<(), String> {
        if !vectorizes(residual) {
            return Ok(());
        }
        for width in [Width::Hint, Width::Lanes(16)] {
            let vector = lanes(residual, width).map_err(|e| format!("lanes: {e}\n{}", print(residual)))?;
            round_trip(&vector)?;
            self.check_residual(&format!("lanes ({width:?})"), &vector, tally)?;
        }
        Ok(())
    }

    fn check_machine_code(&self, residual: &Program, tally: &mut Tally) -> Result<(), String> {
        let main = residual.entry("main").expect("the residual has the entry");
        let in_lanes = Some(Width::Hint);
        let mut settings = vec![(cranelift::Opt::None, in_lanes), (cranelift::Opt::Speed, in_lanes)];
        settings.extend(vectorizes(residual).then_some((cranelift::Opt::None, None)));
        for (opt, lanes) in settings {
            let options = cranelift::Options { opt, verify: true, lanes, ..Default::default() };
            let code =
                cranelift::compile(&[residual], &options).map_err(|e| format!("back end: {e}\n{}", print(residual)))?;
            let kernel = code.kernel("main").expect("main is compiled");
            self.compare(&format!("machine code ({opt:?}, {lanes:?})"), residual, |args| {
                let mut memory = self.memory.clone();
                let results = call(kernel, residual, main, &self.split.unknown(args), &mut memory)?;
                Ok((results, canonical(residual, memory)))
            })?;
        }
        for node in &Reach::of(residual).nodes {
            if let Node::Prim { op, .. } = residual.node(*node) {
                tally.compiled.insert(*op);
            }
        }
        Ok(())
    }

    /// Does another run of each input lead to the same? A run that reaches a limit is not compared.
    fn compare(&self, stage: &str, p: &Program, mut run: impl FnMut(&[Lit]) -> Outcome) -> Result<(), String> {
        for (args, expected) in &self.runs {
            let outcome = run(args);
            if outcome != *expected && !matches!(outcome, Err(Stop::Limit | Stop::Fuel)) {
                let knowing = &self.split.known;
                return Err(format!(
                    "{stage}, knowing {knowing:?}, on {args:?}:\n  expected {expected:?}\n  got      {outcome:?}\n{}",
                    print(p)
                ));
            }
        }
        Ok(())
    }
}

fn clean(stage: &str, faults: &[Fault], p: &Program) -> Result<(), String> {
    match faults.first() {
        None => Ok(()),
        Some(fault) => Err(format!("{stage} has {} faults, the first: {fault}\n{}", faults.len(), print(p))),
    }
}

/// The text of a residual without its hints: names, and what the blocks were made for.
fn bare(p: &Program) -> String {
    let mut p = p.clone();
    p.names.clear();
    for c in &mut p.conts {
        c.name = "".into();
        c.params.iter_mut().for_each(|param| param.name = None);
        if c.role != Role::Fun {
            c.role = Role::Rest;
        }
    }
    print(&p)
}

/// The text of a program reads back to a program of the same text.
fn round_trip(p: &Program) -> Result<(), String> {
    let text = print(p);
    let again = parse(&text).map_err(|e| format!("the text does not read back: {e}\n{text}"))?;
    let twice = print(&again);
    if twice == text { Ok(()) } else { Err(format!("the text\n{text}\nreads back as\n{twice}")) }
}

/// A program that is ready to be interpreted.
struct Ready<'p> {
    program: &'p Program,
    interp: Interp<'p>,
    within: Vec<bool>,
}

impl<'p> Ready<'p> {
    fn new(program: &'p Program) -> Ready<'p> {
        Ready { program, interp: Interp::new(program), within: within_iterations(program) }
    }

    /// Run its `main`.
    fn run(&self, args: &[Lit], memory: &[Memory], coverage: &mut Coverage) -> Outcome {
        let mut memory = memory.to_vec();
        let main = self.program.entry("main").expect("there is a main");
        let mut watch = Watch { program: self.program, within: &self.within, coverage };
        let results = self.interp.run_observed(main, args, &mut memory, LIMITS, &mut watch)?;
        Ok((results, canonical(self.program, memory)))
    }
}

/// Which arguments the evaluator knows.
struct Split {
    /// For each parameter of `main`.
    known: Vec<Arg>,
    /// Number of lanes of each parameter.
    lanes: Vec<usize>,
}

impl Split {
    /// Nothing, all scalars, or some of them.
    fn new(case: &Case, c: &mut Choices) -> Split {
        let mode = c.below(4);
        let args = case.arguments(c);
        let lanes: Vec<usize> = case.params().iter().map(|t| t.lanes().expect("main takes data").1).collect();
        let mut at = 0;
        let known = |lanes: &usize| {
            at += lanes;
            let known = *lanes == 1 && (mode == 1 || mode > 1 && c.one_in(2));
            if known { Arg::Known(args[at - lanes]) } else { Arg::Unknown }
        };
        Split { known: lanes.iter().map(known).collect(), lanes }
    }

    /// These arguments, less what is known.
    fn unknown(&self, args: &[Lit]) -> Vec<Lit> {
        self.zip(args).filter(|(known, _)| matches!(known, Arg::Unknown)).flat_map(|(_, lits)| lits.to_vec()).collect()
    }

    /// These arguments with those that are known instead.
    fn input(&self, args: Vec<Lit>) -> Vec<Lit> {
        let lits = self.zip(&args).flat_map(|(known, lits)| match known {
            Arg::Known(lit) => vec![lit],
            _ => lits.to_vec(),
        });
        lits.collect()
    }

    /// As [`refold`] takes it.
    fn literals(&self) -> Vec<Option<Vec<Lit>>> {
        let literal = |arg: &Arg| if let Arg::Known(lit) = arg { Some(vec![*lit]) } else { None };
        self.known.iter().map(literal).collect()
    }

    fn zip<'a>(&'a self, args: &'a [Lit]) -> impl Iterator<Item = (Arg, &'a [Lit])> {
        let mut rest = args;
        self.known.iter().zip(&self.lanes).map(move |(known, lanes)| {
            let (own, others) = rest.split_at(*lanes);
            rest = others;
            (*known, own)
        })
    }
}
