//! The exhaustive test of the math library, as a command: T18.
//!
//! ```sh
//! cargo run --release -p jerboa-tests --bin sweep -- [FUNCTION…]
//! ```
//!
//! Each function of one argument is asked for all 2^32 floats, by machine code, and compared with f64: a minute or two
//! each on two cores. A function of two is asked for 10^7 pairs. Prints a row for each; the exit code says whether all are
//! within their bounds. `tests/runs/math.txt` has the figures.

use std::process::ExitCode;
use std::time::Instant;

use jerboa_tests::harness::bench::Random;
use jerboa_tests::harness::functions::FUNCTIONS;

/// Pairs for a function of two.
const PAIRS: usize = 10_000_000;

fn main() -> ExitCode {
    let names: Vec<String> = std::env::args().skip(1).collect();
    if let Some(unknown) = names.iter().find(|n| FUNCTIONS.iter().all(|f| f.name != **n)) {
        let known: Vec<&str> = FUNCTIONS.iter().map(|f| f.name).collect();
        eprintln!("sweep: there is no function `{unknown}`; there are {}", known.join(", "));
        return ExitCode::from(2);
    }
    let mut random = Random::new(0x5eed_0018);
    let mut all_within = true;
    for f in FUNCTIONS.iter().filter(|f| names.is_empty() || names.iter().any(|n| n == f.name)) {
        let start = Instant::now();
        let worst = if f.hard.is_some() { f.sweep(&mut random, PAIRS) } else { f.exhaust() };
        let within = worst.error <= f.bound;
        all_within &= within;
        println!(
            "{:10} {:>10} arguments: at most {:.4e} {:?} at {:e}, {:e} (gives {:e}), bound {:e}{} ({:.0} s)",
            f.name,
            worst.tried,
            worst.error,
            f.measure,
            worst.at[0],
            worst.at[1],
            worst.got,
            f.bound,
            if within { "" } else { ": BEYOND" },
            start.elapsed().as_secs_f64()
        );
    }
    if all_within { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
