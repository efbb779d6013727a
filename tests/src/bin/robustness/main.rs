//! What robustness costs: each remedy against what it replaces.
//!
//! ```sh
//! cargo run --release -p jerboa-tests --bin robustness -- instructions
//! cargo run --release -p jerboa-tests --bin robustness -- renders [SCENE…] [--rounds N]
//! cargo run --release -p jerboa-tests --bin robustness -- builds
//! ```
//!
//! `instructions` runs this program under callgrind (valgrind must be installed), once with N and once with 2N calls of each
//! kernel, and prints the difference divided by N: instructions per ray, without all that is done once. `renders` renders
//! whole scenes with one remedy replaced at a time, interleaved, on one thread, and prints medians of the time that it ran for.
//! `builds` measures building trees of hostile triangles (accuracy.md, T29). Each prints rows of a table.

mod builds;
mod kernels;
mod renders;

use std::process::ExitCode;

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    let done = match words[..] {
        ["instructions"] => kernels::table(),
        ["kernel", name, calls] => {
            calls.parse().map_err(|e| format!("`{calls}`: {e}")).and_then(|n| kernels::run(name, n))
        }
        ["builds"] => builds::table(),
        ["renders", ref rest @ ..] => renders::table(rest),
        _ => Err("usage: robustness instructions | renders [SCENE…] [--rounds N] | builds".into()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("robustness: {message}");
            ExitCode::FAILURE
        }
    }
}
