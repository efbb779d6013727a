//! Accuracy list T1 and T23: random programs mean the same on every engine and after every stage, bit for bit.
//!
//! A program that an engine gets wrong is shrunk, then printed with its recipe. A long run:
//! `JERBOA_PROGRAMS=1000000 JERBOA_SEED=7 cargo test --release -p jerboa-tests --test random -- --nocapture`.
//! `JERBOA_PROGRAMS` is the number of programs, `JERBOA_SEED` the seed of the first; program i has the seed's successor i.
//! `JERBOA_INPUTS` is the number of inputs of each (T23 asks for 10,000).

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};

use jerboa_ir::{Op, print};
use jerboa_tests::choices::{Choices, shrink};
use jerboa_tests::coverage::KINDS;
use jerboa_tests::programs::case;
use jerboa_tests::trial::{INPUTS, Tally, check};

/// Programs of a run in the test command.
const PROGRAMS: u64 = 2000;

/// Programs that are tried to make a failing one smaller.
const TRIES: usize = 2000;

thread_local! {
    /// The last panic of this thread, with its place.
    static PANIC: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Put the program of this recipe through everything; a panic is a fault too.
fn check_recipe(recipe: &[u32], seed: u64, tally: &mut Tally) -> Result<(), String> {
    catch_unwind(AssertUnwindSafe(|| {
        check(&case(&mut Choices::replay(recipe)), seed, setting("JERBOA_INPUTS", INPUTS), tally)
    }))
    .unwrap_or_else(|_| Err(PANIC.take()))
}

/// One program; if it fails, the smallest one like it.
fn check_seed(seed: u64) -> Result<Tally, String> {
    let mut tally = Tally::default();
    let mut c = Choices::random(seed);
    case(&mut c);
    let Err(first) = check_recipe(c.recipe(), seed, &mut tally) else { return Ok(tally) };
    let recipe = shrink(c.recipe(), TRIES, |r| check_recipe(r, seed, &mut Tally::default()).is_err());
    let why = check_recipe(&recipe, seed, &mut Tally::default()).expect_err("it fails still");
    let small = case(&mut Choices::replay(&recipe));
    let first = first.lines().next().unwrap_or_default();
    Err(format!(
        "seed {seed}: {first}\nshrunk to {recipe:?}:\n{}\n{why}\nmemory {:?}",
        print(&small.program),
        small.memory
    ))
}

fn setting(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |v| v.parse().unwrap_or_else(|_| panic!("{name} is a number, not `{v}`")))
}

/// All programs, on two threads.
fn check_all(programs: u64, first: u64) -> Result<Tally, String> {
    let worker = |start: u64| {
        let mut tally = Tally::default();
        for seed in (first + start..first + programs).step_by(2) {
            tally.add(check_seed(seed)?);
        }
        Ok::<_, String>(tally)
    };
    std::thread::scope(|s| {
        let other = s.spawn(move || worker(1));
        let mut tally = worker(0)?;
        tally.add(other.join().expect("panics are caught")?);
        Ok(tally)
    })
}

#[test]
fn random_programs_mean_the_same_on_every_engine() {
    let (programs, first) = (setting("JERBOA_PROGRAMS", PROGRAMS), setting("JERBOA_SEED", 1));
    println!("{programs} programs from seed {first}");
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|info| PANIC.set(info.to_string())));
    let result = check_all(programs, first);
    std::panic::set_hook(hook);
    let tally = result.unwrap_or_else(|report| panic!("{report}"));
    println!("{} runs, {} without a result", tally.runs, tally.unfinished);
    println!("the evaluator took {:?} at most for a program", tally.slowest);
    assert!(tally.unfinished * 20 <= tally.runs, "more than 5 % of the runs have no result");
    let all: BTreeSet<Op> = Op::ALL.iter().copied().collect();
    assert_eq!(tally.interpreted.ops, all, "operations that the interpreter has executed");
    assert_eq!(tally.left.ops, all, "operations that residuals have executed");
    assert_eq!(tally.compiled, all, "operations that were compiled");
    let mut kinds = BTreeSet::from(KINDS);
    assert_eq!(tally.left.iterations, kinds, "what iterations of residuals have executed");
    kinds.insert("dispatch");
    assert_eq!(tally.interpreted.iterations, kinds, "what iterations have executed");
}
