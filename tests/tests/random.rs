//! Accuracy list T1 and T23: random programs mean the same on every engine, bit for bit.
//!
//! A program that an engine gets wrong is shrunk, then printed with its recipe. A long run:
//! `JERBOA_PROGRAMS=1000000 JERBOA_SEED=7 cargo test --release -p jerboa-tests --test random -- --nocapture`.
//! `JERBOA_PROGRAMS` is the number of programs, `JERBOA_SEED` the seed of the first; program i has the seed's successor i.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};

use jerboa_ir::interp::{Interp, Limits, Memory, Observer, Stop};
use jerboa_ir::*;
use jerboa_tests::choices::{Choices, shrink};
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
    /// Operations that each engine has executed.
    interpreted: BTreeSet<Op>,
}

impl Tally {
    fn add(&mut self, other: Tally) {
        self.runs += other.runs;
        self.unfinished += other.unfinished;
        self.interpreted.extend(other.interpreted);
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

fn interpret(p: &Program, main: ContId, args: &[Lit], memory: &[Memory], ops: &mut BTreeSet<Op>) -> Outcome {
    let mut memory = memory.to_vec();
    let mut observer = Ops(p, std::mem::take(ops));
    let results = Interp::new(p).run_observed(main, args, &mut memory, LIMITS, &mut observer);
    *ops = observer.1;
    Ok((results?, memory))
}

/// Put one program through every engine; what differs, if anything does.
fn check(case: &Case, seed: u64, tally: &mut Tally) -> Result<(), String> {
    let mut inputs = Choices::random(seed);
    for _ in 0..INPUTS {
        let args = case.arguments(&mut inputs);
        let expected = interpret(&case.program, case.main, &args, &case.memory, &mut tally.interpreted);
        tally.runs += 1;
        match &expected {
            Ok(_) => {}
            Err(Stop::Fault { .. }) => return Err(format!("interpreter, on {args:?}: {expected:?}")),
            Err(_) => {
                tally.unfinished += 1;
                continue;
            }
        }
        let folded = refold(&case.program, case.main, &known(case, &args, &mut inputs));
        let outcome = interpret(&folded, case.main, &args, &case.memory, &mut tally.interpreted);
        same("construction's folding", &args, &expected, &outcome)?;
    }
    Ok(())
}

/// The literals of the parameters that a random split makes known.
fn known(case: &Case, args: &[Lit], c: &mut Choices) -> Vec<Option<Vec<Lit>>> {
    let mut rest = args.iter().copied();
    let mut param = |ty: Ty| rest.by_ref().take(ty.lanes().expect("main takes data").1).collect::<Vec<_>>();
    case.params().into_iter().map(|ty| Some(param(ty)).filter(|_| c.one_in(2))).collect()
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
    let mut tally = Tally::default();
    for result in results {
        tally.add(result.unwrap_or_else(|report| panic!("{report}")));
    }
    println!("{} runs, {} without a result", tally.runs, tally.unfinished);
    assert!(tally.unfinished * 20 <= tally.runs, "more than 5 % of the runs have no result");
    let all: BTreeSet<Op> = Op::ALL.iter().copied().collect();
    assert_eq!(tally.interpreted, all, "operations that the interpreter has executed");
}
