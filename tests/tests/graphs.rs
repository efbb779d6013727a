//! Accuracy list T1 for control flow: random reducible graphs mean the same in the interpreter and as machine code.
//!
//! A graph that an engine gets wrong is shrunk, then printed. A long run:
//! `JERBOA_GRAPHS=100000 JERBOA_SEED=7 cargo test --release -p jerboa-tests --test graphs -- --nocapture`.

use std::panic::{AssertUnwindSafe, catch_unwind};

use jerboa_backend_cranelift::{Opt, Options, compile};
use jerboa_ir::interp::{Interp, Limits, Memory, Stop};
use jerboa_ir::*;
use jerboa_tests::choices::{Choices, shrink};
use jerboa_tests::graphs::case;
use jerboa_tests::harness::bench::number;
use jerboa_tests::machine::{call, canonical};

/// Graphs of a run in the test command, and inputs of each.
const GRAPHS: usize = 1000;
const INPUTS: usize = 16;

/// Graphs that are tried to make a failing one smaller.
const TRIES: usize = 1000;

/// A run that needs more has no result to compare.
const LIMITS: Limits = Limits { fuel: 100_000, cells: 1 << 20 };

/// A run: arguments, and what they lead to, results and memory.
type Run = (Vec<Lit>, (Vec<Lit>, Vec<Memory>));

/// Put the program of a recipe through all engines; gives the number of runs.
fn check(recipe: &[u32], seed: u64) -> Result<usize, String> {
    let case = case(&mut Choices::replay(recipe));
    let p = &case.program;
    if let Some(fault) = verify_residual(p).first() {
        return Err(format!("{fault}\n{}", print(p)));
    }
    let mut c = Choices::random(seed);
    let interp = Interp::new(p);
    let mut runs: Vec<Run> = Vec::new();
    for _ in 0..INPUTS {
        let args = case.arguments(&mut c);
        let mut memory = case.memory.clone();
        match interp.run(case.main, &args, &mut memory, LIMITS) {
            Ok(results) => runs.push((args, (results, canonical(p, memory)))),
            Err(Stop::Fuel) => {}
            Err(stop) => return Err(format!("interpreter, on {args:?}: {stop}\n{}", print(p))),
        }
    }
    // With and without the optimiser, in turn.
    let opt = if seed % 2 == 0 { Opt::None } else { Opt::Speed };
    let code = compile(&[p], &Options { opt, verify: true, ..Options::default() })
        .map_err(|e| format!("{e}\n{}", print(p)))?;
    let kernel = code.kernel("main").ok_or("no kernel")?;
    for (args, expected) in &runs {
        let mut memory = case.memory.clone();
        let results = call(kernel, p, case.main, args, &mut memory).map_err(|stop| stop.to_string())?;
        let got = (results, canonical(p, memory));
        if got != *expected {
            return Err(format!(
                "{opt:?}, on {args:?}:\n  expected {expected:?}\n  got      {got:?}\n{}memory {:?}",
                print(p),
                case.memory
            ));
        }
    }
    Ok(runs.len())
}

/// A panic is a fault too.
fn check_caught(recipe: &[u32], seed: u64) -> Result<usize, String> {
    catch_unwind(AssertUnwindSafe(|| check(recipe, seed))).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().cloned();
        Err(text.or(panic.downcast_ref::<&str>().map(|s| s.to_string())).unwrap_or_default())
    })
}

#[test]
fn random_graphs_mean_the_same_on_every_engine() {
    let (graphs, first) = (number("JERBOA_GRAPHS", GRAPHS), number("JERBOA_SEED", 1));
    println!("{graphs} graphs from seed {first}");
    let mut runs = 0;
    for seed in (first..first + graphs).map(|seed| seed as u64) {
        let mut c = Choices::random(seed);
        case(&mut c);
        runs += check_caught(c.recipe(), seed).unwrap_or_else(|why| {
            let recipe = shrink(c.recipe(), TRIES, |r| check_caught(r, seed).is_err());
            let small = check_caught(&recipe, seed).expect_err("it fails still");
            panic!("seed {seed}: {}\nshrunk:\n{small}", why.lines().next().unwrap_or_default());
        });
    }
    println!("{runs} runs compared");
    assert!(runs * 20 >= graphs * INPUTS * 19, "more than 5 % of the runs have no result");
}
