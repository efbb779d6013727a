//! Accuracy list T1 and T23: random programs mean the same on every engine, bit for bit.
//!
//! A program that an engine gets wrong is shrunk, then printed with its recipe. A long run:
//! `JERBOA_PROGRAMS=1000000 JERBOA_SEED=7 cargo test --release -p jerboa-tests --test random -- --nocapture`.
//! `JERBOA_PROGRAMS` is the number of programs, `JERBOA_SEED` the seed of the first; program i has the seed's successor i.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};

use jerboa_backend_cranelift as cranelift;
use jerboa_ir::interp::{Interp, Limits, Memory, Observer, Stop};
use jerboa_ir::*;
use jerboa_peval::{Arg, Generic, specialize};
use jerboa_tests::choices::{Choices, shrink};
use jerboa_tests::knowledge::{Level, classify};
use jerboa_tests::machine::call;
use jerboa_tests::programs::{Case, case};
use jerboa_tests::refold::refold;

/// Programs of a run in the test command, and inputs of each.
const PROGRAMS: u64 = 2000;
const INPUTS: u64 = 32;

/// A run that needs more has no result to compare; less than 5 % may.
const LIMITS: Limits = Limits { fuel: 100_000, cells: 1 << 20 };

/// What a run leaves behind: results and memory, or why there are none.
type Outcome = Result<(Vec<Lit>, Vec<Memory>), Stop>;

/// What happened, over all programs.
#[derive(Default)]
struct Tally {
    runs: u64,
    unfinished: u64,
    /// Operations that the interpreter has executed in generic programs.
    interpreted: BTreeSet<Op>,
    /// … that the evaluator has left in residuals, and the interpreter has executed there.
    left: BTreeSet<Op>,
    /// … that were compiled to machine code.
    compiled: BTreeSet<Op>,
}

impl Tally {
    fn add(&mut self, other: Tally) {
        self.runs += other.runs;
        self.unfinished += other.unfinished;
        self.interpreted.extend(other.interpreted);
        self.left.extend(other.left);
        self.compiled.extend(other.compiled);
    }
}

/// Collects the operations that are evaluated.
struct Ops<'p>(&'p Program, BTreeSet<Op>);

impl Observer for Ops<'_> {
    fn value(&mut self, node: NodeId, _: Lit) {
        if let Node::Prim { op, .. } = self.0.node(node) {
            self.1.insert(*op);
        }
    }
}

/// Every NaN in memory becomes the one NaN, as a load makes it.
fn canonical(p: &Program, mut memory: Vec<Memory>) -> Vec<Memory> {
    for (buffer, m) in p.buffers.iter().zip(&mut memory) {
        for (col, _) in buffer.columns.iter().enumerate().filter(|(_, c)| c.ty == ColTy::Scalar(Scalar::F32)) {
            for row in 0..m.rows as usize {
                let word = &mut m.words[buffer.word(m.rows as usize, row, col)];
                *word = Lit::from_word(Scalar::F32, *word).word();
            }
        }
    }
    memory
}

fn interpret(p: &Program, main: ContId, args: &[Lit], memory: &[Memory], ops: &mut BTreeSet<Op>) -> Outcome {
    let mut memory = memory.to_vec();
    let mut observer = Ops(p, std::mem::take(ops));
    let results = Interp::new(p).run_observed(main, args, &mut memory, LIMITS, &mut observer);
    *ops = observer.1;
    Ok((results?, canonical(p, memory)))
}

/// Put one program through every engine; what differs, if anything does.
fn check(case: &Case, seed: u64, tally: &mut Tally) -> Result<(), String> {
    let mut c = Choices::random(seed);
    let mut memory = case.memory.clone();
    let facts = classify(&case.program, &mut memory, c.pick(&[Level::Nothing, Level::Structure, Level::All]));
    let split = Split::new(case, &mut c);
    let inputs: Vec<Vec<Lit>> = (0..INPUTS).map(|_| split.input(case.arguments(&mut c))).collect();
    let expected: Vec<Outcome> =
        inputs.iter().map(|args| interpret(&case.program, case.main, args, &memory, &mut tally.interpreted)).collect();
    tally.runs += INPUTS;
    tally.unfinished += expected.iter().filter(|e| e.is_err()).count() as u64;
    let checked = || inputs.iter().zip(&expected).filter(|(_, e)| !matches!(e, Err(Stop::Fuel | Stop::Limit)));
    for (args, expected) in checked() {
        if let Err(fault) = expected {
            return Err(format!("interpreter, on {args:?}: {fault}"));
        }
    }

    let folded = refold(&case.program, case.main, &split.literals());
    for (args, expected) in checked() {
        let outcome = interpret(&folded, case.main, args, &memory, &mut BTreeSet::new());
        same("construction", args, expected, &outcome)?;
    }

    let generic = Generic::new(case.program.clone());
    let residual = specialize(&generic, "main", &split.known, &facts, &Default::default())
        .map_err(|e| format!("evaluator, knowing {:?}: {e}", split.known))?
        .program;
    let main = residual.entry("main").expect("the residual has the entry");
    for (args, expected) in checked() {
        let outcome = interpret(&residual, main, &split.unknown(args), &memory, &mut tally.left);
        same(&format!("the residual, knowing {:?}", split.known), args, expected, &outcome)
            .map_err(|e| format!("{e}\n{}", print(&residual)))?;
    }

    for opt in [cranelift::Opt::None, cranelift::Opt::Speed] {
        let options = cranelift::Options { opt, verify: true, dumps: false };
        let code = cranelift::compile(&[&residual], &options).map_err(|e| format!("back end: {e}\n{}", print(&residual)))?;
        let kernel = code.kernel("main").expect("main is compiled");
        for (args, expected) in checked() {
            let mut memory = memory.clone();
            let outcome = match call(kernel, &residual, main, &split.unknown(args), &mut memory) {
                Err(_) => continue,
                Ok(results) => Ok((results, canonical(&residual, memory))),
            };
            same(&format!("machine code ({opt:?}), knowing {:?}", split.known), args, expected, &outcome)
                .map_err(|e| format!("{e}\n{}", print(&residual)))?;
        }
    }
    for node in &Reach::of(&residual).nodes {
        if let Node::Prim { op, .. } = residual.node(*node) {
            tally.compiled.insert(*op);
        }
    }
    Ok(())
}

/// Which arguments the evaluator knows.
struct Split {
    /// For each parameter of `main`.
    known: Vec<Arg>,
    /// Number of lanes of each parameter.
    lanes: Vec<usize>,
}

impl Split {
    /// Nothing, everything, or some of the scalars.
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

fn same(engine: &str, args: &[Lit], expected: &Outcome, outcome: &Outcome) -> Result<(), String> {
    if expected == outcome {
        return Ok(());
    }
    Err(format!("{engine}, on {args:?}:\n  expected {expected:?}\n  got      {outcome:?}"))
}

/// As [`check`]; a panic is a difference too.
fn check_recipe(recipe: &[u32], seed: u64, tally: &mut Tally) -> Result<(), String> {
    catch_unwind(AssertUnwindSafe(|| check(&case(&mut Choices::replay(recipe)), seed, tally))).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
        Err(format!("panic: {}", text.unwrap_or("?")))
    })
}

/// One program; if it fails, the smallest one like it.
fn check_seed(seed: u64) -> Result<Tally, String> {
    let mut tally = Tally::default();
    let mut c = Choices::random(seed);
    case(&mut c);
    let Err(first) = check_recipe(c.recipe(), seed, &mut tally) else { return Ok(tally) };
    let recipe = shrink(c.recipe(), 2000, |r| check_recipe(r, seed, &mut Tally::default()).is_err());
    let small = case(&mut Choices::replay(&recipe));
    let mut report = format!("seed {seed}: {first}\nshrunk to {recipe:?}:\n");
    let why = check_recipe(&recipe, seed, &mut Tally::default()).expect_err("it fails still");
    write!(report, "{}\n{why}\nmemory {:?}", print(&small.program), small.memory).expect("a string takes all");
    Err(report)
}

fn setting(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |v| v.parse().unwrap_or_else(|_| panic!("{name} is a number, not `{v}`")))
}

#[test]
fn random_programs_mean_the_same_on_every_engine() {
    let (programs, first) = (setting("JERBOA_PROGRAMS", PROGRAMS), setting("JERBOA_SEED", 1));
    println!("{programs} programs from seed {first}");
    // The panics of a program that is shrunk are no news.
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let worker = |start: u64| {
        let mut tally = Tally::default();
        for seed in (first + start..first + programs).step_by(2) {
            tally.add(check_seed(seed)?);
        }
        Ok(tally)
    };
    let results: Vec<Result<Tally, String>> = std::thread::scope(|s| {
        let workers = [0, 1].map(|start| s.spawn(move || worker(start)));
        workers.map(|w| w.join().expect("panics are caught")).into()
    });
    std::panic::set_hook(hook);
    let mut tally = Tally::default();
    for result in results {
        tally.add(result.unwrap_or_else(|report| panic!("{report}")));
    }
    println!("{} runs, {} without a result", tally.runs, tally.unfinished);
    assert!(tally.unfinished * 20 <= tally.runs, "more than 5 % of the runs have no result");
    let all: BTreeSet<Op> = Op::ALL.iter().copied().collect();
    assert_eq!(tally.interpreted, all, "operations that the interpreter has executed");
    assert_eq!(tally.left, all, "operations that residuals have executed");
    assert_eq!(tally.compiled, all, "operations that were compiled");
}
