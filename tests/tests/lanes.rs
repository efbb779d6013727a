//! T1 for lanes: random functions run in lanes mean what they mean one after the other, for every mask and remainder, in
//! the interpreter and as machine code.
//!
//! A long run: `JERBOA_PROGRAMS=100000 JERBOA_SEED=7 cargo test --release -p jerboa-tests --test lanes -- --nocapture`.

use std::panic::{AssertUnwindSafe, catch_unwind};

use jerboa_backend_cranelift::lanes::{Width, lanes};
use jerboa_backend_cranelift::{Options as Settings, compile};
use jerboa_ir::interp::{Interp, Limits, Memory, Stop};
use jerboa_ir::*;
use jerboa_peval::{Arg, Facts, Generic, Options, specialize};
use jerboa_tests::choices::{Choices, shrink};
use jerboa_tests::harness::bench::number;
use jerboa_tests::machine::{call, canonical};
use jerboa_tests::programs::case;
use jerboa_tests::sweep::{Sweep, Through, fits, sweep};

/// Programs of a run in the test command.
const PROGRAMS: usize = 1000;

/// Programs that are tried to make a failing one smaller.
const TRIES: usize = 1000;

/// Runs of the scalar program, and of lanes: those take more jumps.
const SCALAR: Limits = Limits { fuel: 200_000, cells: 1 << 20 };
const LANES: Limits = Limits { fuel: 4_000_000, cells: 1 << 22 };

/// What a run leaves in memory.
type Outcome = Result<Vec<Memory>, Stop>;

/// Check the program of a recipe; gives the number of runs that were compared.
fn check(recipe: &[u32], seed: u64) -> Result<u64, String> {
    let case = case(&mut Choices::replay(recipe));
    let args = vec![Arg::Unknown; case.params().len()];
    let generic = Generic::new(case.program);
    // A program whose functions differ by what is unknown has no residual (Law 4).
    let Ok(residual) = specialize(&generic, "main", &args, &Facts::none(), &Options::default()) else { return Ok(0) };
    if !fits(&residual.program) {
        return Ok(0);
    }
    let mut c = Choices::random(seed);
    let width = c.pick(&[4u8, 8, 16]);
    let rows = u32::from(width) * 4;
    let sweep = sweep(&residual.program, &case.memory, rows, Through::Vectorize(width), &mut c);
    clean("the sweep", &sweep.program)?;
    let vector = lanes(&sweep.program, Width::Hint).map_err(|e| e.to_string())?;
    clean("lanes", &vector)?;
    let text = print(&vector);
    let read = parse(&text).map_err(|e| format!("{e}\n{text}"))?;
    if print(&read) != text {
        return Err(format!("does not read back as it prints:\n{text}"));
    }
    let code =
        compile(&[&vector], &Settings { verify: true, ..Settings::default() }).map_err(|e| format!("{e}\n{text}"))?;
    let kernel = code.kernel("sweep").ok_or("no kernel")?;
    let mut compared = 0;
    for _ in 0..4 {
        let lo = c.below(u32::from(width) + 2);
        let bounds = [lo, lo + c.below(3 * u32::from(width) + 1)].map(Lit::U32);
        let args = [&bounds[..], &sweep.uniform].concat();
        let Ok(expected) = interpret(&sweep, &sweep.program, &args, SCALAR) else { continue };
        let entry = vector.entry("sweep").ok_or("no entry")?;
        let machine = || {
            let mut memory = sweep.memory.clone();
            call(kernel, &vector, entry, &args, &mut memory).map(|_| canonical(&vector, memory))
        };
        for (engine, outcome) in
            [("interpreter", interpret(&sweep, &vector, &args, LANES)), ("machine code", machine())]
        {
            compared += 1;
            if outcome != Ok(expected.clone()) && outcome != Err(Stop::Limit) {
                let what = match outcome {
                    Ok(memory) => difference(&sweep.program, &expected, &memory),
                    Err(stop) => stop.to_string(),
                };
                return Err(format!(
                    "width {width}, {engine}, on {args:?}: {what}\n{}\nin lanes\n{text}\nmemory {:?}",
                    print(&sweep.program),
                    sweep.memory
                ));
            }
        }
    }
    Ok(compared)
}

fn clean(what: &str, p: &Program) -> Result<(), String> {
    match verify_residual(p).first() {
        None => Ok(()),
        Some(fault) => Err(format!("{what}: {fault}\n{}", print(p))),
    }
}

fn interpret(sweep: &Sweep, p: &Program, args: &[Lit], limits: Limits) -> Outcome {
    let mut memory = sweep.memory.clone();
    let entry = p.entry("sweep").expect("it has the entry");
    Interp::new(p).run(entry, args, &mut memory, limits).map(|_| canonical(p, memory))
}

/// The first word that differs.
fn difference(p: &Program, expected: &[Memory], got: &[Memory]) -> String {
    for (buffer, (a, b)) in p.buffers.iter().zip(expected.iter().zip(got)) {
        for col in 0..buffer.columns.len() {
            for row in 0..a.rows as usize {
                let at = buffer.word(a.rows as usize, row, col);
                if a.words[at] != b.words[at] {
                    let (name, expected, got) = (&buffer.columns[col].name, a.words[at], b.words[at]);
                    return format!("{}.{name} of row {row} is {got:#x}, not {expected:#x}", buffer.name);
                }
            }
        }
    }
    "nothing differs".to_owned()
}

/// A panic is a fault too.
fn check_caught(recipe: &[u32], seed: u64) -> Result<u64, String> {
    catch_unwind(AssertUnwindSafe(|| check(recipe, seed))).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().cloned();
        Err(text.or(panic.downcast_ref::<&str>().map(|s| s.to_string())).unwrap_or_default())
    })
}

#[test]
fn random_functions_mean_the_same_in_lanes() {
    let (programs, first) = (number("JERBOA_PROGRAMS", PROGRAMS), number("JERBOA_SEED", 1));
    println!("{programs} programs from seed {first}");
    let mut compared = 0;
    for seed in (first..first + programs).map(|seed| seed as u64) {
        let mut c = Choices::random(seed);
        case(&mut c);
        match check_caught(c.recipe(), seed) {
            Ok(runs) => compared += runs,
            Err(why) => {
                let recipe = shrink(c.recipe(), TRIES, |r| check_caught(r, seed).is_err());
                let small = check_caught(&recipe, seed).expect_err("it fails still");
                panic!("seed {seed}: {}\nshrunk:\n{small}", why.lines().next().unwrap_or_default());
            }
        }
    }
    println!("{compared} runs compared");
    assert!(compared > programs as u64, "too few programs are compared");
}
