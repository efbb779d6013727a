//! Small passes over a residual, each with one law, repeated until nothing changes.

mod dead;
mod draft;
mod equal;
mod forward;
mod merge;
mod params;
mod select;
mod tail;

use std::time::Instant;

use jerboa_ir::{ContId, Program, World};

use crate::report::Pass;
use draft::Draft;

/// A pass: changes the draft and says how much.
type Tidy = fn(&mut Draft) -> u64;

/// Passes that look at one place at a time.
const LOCAL: [(&str, Tidy); 6] = [
    ("tail", tail::run),
    ("merge", merge::run),
    ("forward", forward::run),
    ("params", params::run),
    ("dead", dead::run),
    ("select", select::run),
];

/// Tidy a residual with one entry. Passes only shrink it, so they come to an end. Without `all`, only what is not
/// reached is dropped.
pub(crate) fn tidy(world: World, entry: ContId, all: bool) -> (Program, Vec<Pass>) {
    let mut draft = Draft { world, entry };
    let mut passes = Vec::new();
    loop {
        while all && LOCAL.iter().map(|(name, run)| timed(&mut passes, name, || run(&mut draft))).sum::<u64>() > 0 {}
        timed(&mut passes, "compact", || draft.compact());
        if !all || timed(&mut passes, "equal", || equal::run(&mut draft)) == 0 {
            return (draft.world.finish(), passes);
        }
    }
}

/// One pass over a residual with one entry, once, by its name in the report: for tests and for bug reports. None if there
/// is no such pass.
pub fn tidy_with(program: &Program, pass: &str) -> Option<Program> {
    let all = LOCAL.iter().chain(&[("equal", equal::run as Tidy)]);
    let (_, run) = *all.into_iter().find(|(name, _)| *name == pass)?;
    let mut draft = Draft::copy(program, program.entries.first()?.1);
    run(&mut draft);
    draft.compact();
    Some(draft.world.finish())
}

/// Run a pass and add its time and changes to its line of the report.
fn timed(passes: &mut Vec<Pass>, name: &'static str, run: impl FnOnce() -> u64) -> u64 {
    let start = Instant::now();
    let changes = run();
    let at = passes.iter().position(|p| p.name == name).unwrap_or_else(|| {
        passes.push(Pass { name, time: Default::default(), changes: 0 });
        passes.len() - 1
    });
    passes[at].time += start.elapsed();
    passes[at].changes += changes;
    changes
}
