//! Accuracy list T1 on the GPU: residuals of random programs mean there what they mean in the interpreter, bit for bit, run
//! once for each input, and run for many rows at once.
//!
//! Every module passes naga's validator (the back end sees to that), and `spirv-val`: of every tenth program here, of all in
//! a long run: `JERBOA_PROGRAMS=2000 JERBOA_SPIRV_VAL=1 cargo test --release -p jerboa-tests --test spirv -- --nocapture`.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use jerboa_backend_spirv::Grid;
use jerboa_backend_spirv::gpu::Gpu;
use jerboa_ir::interp::{Limits, Memory};
use jerboa_ir::*;
use jerboa_tests::choices::{Choices, shrink};
use jerboa_tests::harness::bench::number;
use jerboa_tests::programs::{Case, case};
use jerboa_tests::spirv::{Spirv, SpirvVal, gpu, refusal, spirv_val};
use jerboa_tests::sweep::{Through, fits, sweep};
use jerboa_tests::trial::{Sample, sample};

/// Programs of a run in the test command, and inputs of each.
const PROGRAMS: usize = 300;
const INPUTS: u64 = 32;

/// Every so many modules pass `spirv-val`.
const VALIDATED: usize = 10;

/// Rows of a grid: more than a workgroup, and no whole number of them.
const ROWS: u32 = 100;

/// Programs that are tried to make a failing one smaller.
const TRIES: usize = 300;

/// A row that needs more has no result to compare.
const LIMITS: Limits = Limits { fuel: 100_000, cells: 1 << 20 };

/// What was done, by what it is called, and how often.
type Tally = BTreeMap<&'static str, usize>;

/// One `fma` in a program of a hundred operations is enough to be refused; a product in its place is not.
fn without_fma(case: &Case) -> Case {
    let mut program = case.program.clone();
    for node in &mut program.nodes {
        if let Node::Prim { op: op @ Op::Fma, args: args @ [_, _, _] } = node {
            (*op, args[2]) = (Op::Mul, NodeId::NONE);
        }
    }
    Case { program, main: case.main, memory: case.memory.clone() }
}

/// What the back end should refuse, it does.
fn check_refusal(engine: &Spirv, p: &Program, word: &'static str) -> Result<(), String> {
    match engine.module(p, "main", Grid::Single) {
        Err(e) if e.contains(word) => Ok(()),
        Err(e) => Err(format!("it {word}, and is refused with: {e}\n{}", print(p))),
        Ok(_) => Err(format!("it {word}, and is not refused\n{}", print(p))),
    }
}

/// Run the residual of a program for each input.
fn check_inputs(engine: &Spirv, case: &Case, seed: u64, tally: &mut Tally) -> Result<(), String> {
    let mut count = |what| *tally.entry(what).or_default() += 1;
    let Some(mut s) = sample(case, seed, INPUTS)? else {
        count("without a residual");
        return Ok(());
    };
    if let Some(word @ "fma") = refusal(&s.residual) {
        check_refusal(engine, &s.residual, word)?;
        count("refused for fma, run without");
        match sample(&without_fma(case), seed, INPUTS)? {
            Some(other) => s = other,
            None => return Ok(()),
        }
    }
    let Sample { residual, memory, runs } = s;
    if let Some(word) = refusal(&residual) {
        check_refusal(engine, &residual, word)?;
        count("refused for recursion");
        return Ok(());
    }
    count("run");
    *tally.entry("runs").or_default() += runs.inputs.len();
    runs.compare(engine, &residual, &memory)
}

/// Run the residual of a program for all rows of a stream at once.
fn check_rows(engine: &Spirv, case: &Case, seed: u64, tally: &mut Tally) -> Result<(), String> {
    let mut count = |what| *tally.entry(what).or_default() += 1;
    let Some(Sample { residual, memory, .. }) = sample(&without_fma(case), seed, 0)? else {
        count("without a residual");
        return Ok(());
    };
    if !fits(&residual) {
        count("with runs that meet");
        return Ok(());
    }
    if refusal(&residual).is_some() {
        count("refused for recursion");
        return Ok(());
    }
    let sweep = sweep(&residual, &memory, ROWS, Through::Grid, &mut Choices::random(seed));
    if !engine.compare_rows(&sweep, ROWS, LIMITS)? {
        count("with a row without end");
        return Ok(());
    }
    count("run");
    *tally.entry("rows").or_default() += ROWS as usize;
    Ok(())
}

/// Check so many programs; a panic is a fault too.
fn check_all(test: &str, check: fn(&Spirv, &Case, u64, &mut Tally) -> Result<(), String>) -> Option<Tally> {
    let gpu: Arc<Gpu> = gpu(test)?;
    let validator: Option<SpirvVal> = spirv_val(test);
    let every = number("JERBOA_SPIRV_VAL", VALIDATED);
    let (programs, first) = (number("JERBOA_PROGRAMS", PROGRAMS), number("JERBOA_SEED", 1));
    println!("{test}: {programs} programs from seed {first} on {}", gpu.adapter().name());
    let mut tally = Tally::new();
    for seed in first..first + programs {
        let engine =
            Spirv { gpu: gpu.clone(), validator: validator.filter(|_| seed % every == 0), spread: seed % 2 == 0 };
        let seed = seed as u64;
        let caught = |recipe: &[u32], tally: &mut Tally| {
            let check = AssertUnwindSafe(|| check(&engine, &case(&mut Choices::replay(recipe)), seed, tally));
            catch_unwind(check).unwrap_or_else(|panic| {
                let text = panic.downcast_ref::<String>().cloned();
                Err(text.or(panic.downcast_ref::<&str>().map(|s| s.to_string())).unwrap_or_default())
            })
        };
        let mut c = Choices::random(seed);
        case(&mut c);
        caught(c.recipe(), &mut tally).unwrap_or_else(|why| {
            let recipe = shrink(c.recipe(), TRIES, |r| caught(r, &mut Tally::new()).is_err());
            let small = caught(&recipe, &mut Tally::new()).expect_err("it fails still");
            panic!("seed {seed}: {}\nshrunk:\n{small}", why.lines().next().unwrap_or_default());
        });
    }
    println!("{test}: {tally:?}");
    Some(tally)
}

/// Rounds of a loop, by row; what it reads, loads, compares and chooses in the last one is returned.
const ROUNDS: &str = "jerboa-ir 1
table words by rows
  word: u32 bulk
stream values by columns
  value: f32 bulk
entry main = main
fun main(n: u32, return: fn(u32, f32, bool, u32, u32))
  last = and n 31u
  jump head(0u)
  loop head(i: u32)
    word = read words.word i
    go_on = lt word last
    load values.value i -> loaded
  rest loaded(value: f32)
    is_large = gt value 40.0
    odd = and i 1u
    is_odd = eq odd 1u
    branch is_odd odd_round even_round
  arm odd_round()
    jump chosen(word)
  arm even_round()
    jump chosen(7u)
  join chosen(which: u32)
    branch go_on again done
  arm again()
    next = add i 1u
    jump head(next)
  arm done()
    jump return(word, value, is_large, which, i)
";

/// An invocation that has left a loop keeps what it had, whatever rounds those beside it go on for.
#[test]
fn what_leaves_a_loop_is_of_ones_own_round() {
    let test = "what_leaves_a_loop_is_of_ones_own_round";
    let Some(gpu) = gpu(test) else { return };
    let p = parse(ROUNDS).unwrap_or_else(|e| panic!("{e}"));
    let words = |of: &dyn Fn(u32) -> u32| Memory { rows: 40, words: (0..40).map(of).collect() };
    let memory = [words(&|i| i), words(&|i| (3.0 * i as f32).to_bits())];
    for (seed, spread) in [(1, false), (2, true)] {
        let engine = Spirv { gpu: gpu.clone(), validator: spirv_val(test), spread };
        let sweep = sweep(&p, &memory, ROWS, Through::Grid, &mut Choices::random(seed));
        let compared = engine.compare_rows(&sweep, ROWS, LIMITS).unwrap_or_else(|e| panic!("{e}"));
        assert!(compared && sweep.uniform.is_empty(), "each row has rounds of its own");
    }
}

#[test]
fn random_programs_mean_the_same_on_the_gpu() {
    let test = "random_programs_mean_the_same_on_the_gpu";
    let Some(tally) = check_all(test, check_inputs) else { return };
    let all: usize = ["run", "refused for recursion", "without a residual"]
        .map(|what| tally.get(what).copied().unwrap_or(0))
        .iter()
        .sum();
    assert!(tally["run"] * 4 >= all * 3, "less than three quarters of the programs run");
}

#[test]
fn random_functions_mean_the_same_in_a_grid() {
    let test = "random_functions_mean_the_same_in_a_grid";
    let Some(tally) = check_all(test, check_rows) else { return };
    assert!(tally["run"] > 0, "some program runs for each row");
}
