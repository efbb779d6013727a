//! Accuracy list T1 for control flow: random reducible graphs mean the same in the interpreter, as machine code and on a GPU.
//!
//! A graph that an engine gets wrong is shrunk, then printed. A long run, with all modules through `spirv-val`:
//! `JERBOA_GRAPHS=10000 JERBOA_SEED=7 JERBOA_SPIRV_VAL=1 cargo test --release -p jerboa-tests --test graphs -- --nocapture`.

use std::panic::{AssertUnwindSafe, catch_unwind};

use jerboa_backend_cranelift::Opt;
use jerboa_ir::interp::Limits;
use jerboa_ir::*;
use jerboa_tests::choices::{Choices, shrink};
use jerboa_tests::engine::{Engine, Machine, Runs};
use jerboa_tests::graphs::case;
use jerboa_tests::harness::bench::number;
use jerboa_tests::spirv::{Spirv, gpu, spirv_val};

/// Graphs of a run in the test command: on the CPU, and on a GPU, whose driver takes 60 ms for each (lavapipe). And inputs of
/// each graph.
const GRAPHS: usize = 1000;
const GPU_GRAPHS: usize = 200;
const INPUTS: usize = 16;

/// Every so many modules pass `spirv-val`.
const VALIDATED: usize = 10;

/// Graphs that are tried to make a failing one smaller.
const TRIES: usize = 1000;

/// A run that needs more has no result to compare.
const LIMITS: Limits = Limits { fuel: 100_000, cells: 1 << 20 };

/// Run the program of a recipe on the interpreter and an engine; gives the number of runs.
fn check(recipe: &[u32], seed: u64, engine: &dyn Engine) -> Result<usize, String> {
    let case = case(&mut Choices::replay(recipe));
    let p = &case.program;
    if let Some(fault) = verify_residual(p).first() {
        return Err(format!("{fault}\n{}", print(p)));
    }
    let mut c = Choices::random(seed);
    let inputs = (0..INPUTS).map(|_| case.arguments(&mut c)).collect();
    let runs = Runs::interpret(p, inputs, &case.memory, LIMITS)?;
    runs.compare(engine, p, &case.memory)?;
    Ok(runs.inputs.len())
}

/// A panic is a fault too.
fn check_caught(recipe: &[u32], seed: u64, engine: &dyn Engine) -> Result<usize, String> {
    catch_unwind(AssertUnwindSafe(|| check(recipe, seed, engine))).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().cloned();
        Err(text.or(panic.downcast_ref::<&str>().map(|s| s.to_string())).unwrap_or_default())
    })
}

/// Check all graphs, each on the engine that is given for its seed.
fn check_all(graphs: usize, engine: impl Fn(u64) -> Box<dyn Engine>) {
    let (graphs, first) = (number("JERBOA_GRAPHS", graphs), number("JERBOA_SEED", 1));
    println!("{graphs} graphs from seed {first}");
    let mut runs = 0;
    for seed in (first..first + graphs).map(|seed| seed as u64) {
        let mut c = Choices::random(seed);
        case(&mut c);
        let engine = &*engine(seed);
        runs += check_caught(c.recipe(), seed, engine).unwrap_or_else(|why| {
            let recipe = shrink(c.recipe(), TRIES, |r| check_caught(r, seed, engine).is_err());
            let small = check_caught(&recipe, seed, engine).expect_err("it fails still");
            panic!("seed {seed}: {}\nshrunk:\n{small}", why.lines().next().unwrap_or_default());
        });
    }
    println!("{runs} runs compared");
    assert!(runs * 20 >= graphs * INPUTS * 19, "more than 5 % of the runs have no result");
}

/// With and without the optimiser, in turn.
#[test]
fn random_graphs_mean_the_same_as_machine_code() {
    check_all(GRAPHS, |seed| Box::new(Machine(if seed % 2 == 0 { Opt::None } else { Opt::Speed })));
}

/// All modules pass naga's validator, and so many of them `spirv-val`. With the program's buffers packed in two ways, in turn.
#[test]
fn random_graphs_mean_the_same_on_the_gpu() {
    let test = "random_graphs_mean_the_same_on_the_gpu";
    let Some(gpu) = gpu(test) else { return };
    let (validator, every) = (spirv_val(test), number("JERBOA_SPIRV_VAL", VALIDATED) as u64);
    check_all(GPU_GRAPHS, |seed| {
        let validator = validator.filter(|_| seed % every == 0);
        Box::new(Spirv { gpu: gpu.clone(), validator, spread: seed % 2 == 0 })
    });
}
