//! Speed against error: what `jerboa bench error` measures.
//!
//! A *contestant* renders a scene within a *budget* of wall time, again and again with other seeds. The clock runs from the
//! opening of the scene's file to the finished film, so that reading, trees, specialisation and code generation count; the
//! time of rendering alone stands beside it. What fits into a budget is found out before, by short renders; then
//! all contestants take turns, seed by seed.
//!
//! Of K films of a contestant the error is told without a reference: an unbiased estimator's mean squared error is its
//! variance, which the films themselves show ([`score`]). So a peer is held to its own mean, and is not charged for
//! meaning something else by the same file.
//!
//! The *efficiency* is 1/(error · seconds). For independent samples it is the same whatever the time, so ratios of it say
//! both how much less error a contestant has after the same time, and how much sooner it has the same error. Intervals are
//! bootstrapped over the seeds ([`bootstrap`]).

pub mod bootstrap;
pub mod chart;
pub mod contestant;
pub mod page;
pub mod score;
pub mod table;

use std::path::Path;

use self::contestant::{Contestant, Run};
use self::score::{Errors, errors};
use crate::host::error::Error;

/// What a contestant did on a scene within a budget.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Whose it is.
    pub contestant: String,
    /// Budget of wall time, s.
    pub budget: f64,
    /// Samples per pixel that fitted in.
    pub spp: u32,
    /// Its runs, seed by seed.
    pub runs: Vec<Measured>,
    /// Share of the light that is in the brightest thousandth of all contestants' pixels together: who finds less of it than
    /// others misses paths, or has not found them yet.
    pub bright: f64,
}

/// A run, without its film.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// Its seed.
    pub seed: u32,
    /// Wall time from the opening of the file to the finished film, s.
    pub seconds: f64,
    /// Of that, rendering alone, s.
    pub render_seconds: f64,
    /// What this run adds to the errors: their means over the runs are the errors.
    pub errors: Errors,
}

impl Outcome {
    /// The mean of something over the runs.
    pub fn mean(&self, of: impl Fn(&Measured) -> f64) -> f64 {
        self.runs.iter().map(of).sum::<f64>() / self.runs.len() as f64
    }

    /// Wall time before the first sample, s.
    pub fn setup_seconds(&self) -> f64 {
        self.mean(|run| run.seconds - run.render_seconds)
    }

    /// Samples per pixel and second, once it renders.
    pub fn samples_per_second(&self) -> f64 {
        f64::from(self.spp) / self.mean(|run| run.render_seconds)
    }

    /// Seconds from the opening of the file after which this one has more samples than `other`, if it ever has: the point
    /// where a longer preparation has paid for itself.
    pub fn overtakes(&self, other: &Outcome) -> Option<f64> {
        let [a, b] = [self, other].map(|r| (r.setup_seconds(), r.samples_per_second()));
        // Both lines begin at their setup; before that there are no samples.
        let crossing = (a.1 * a.0 - b.1 * b.0) / (a.1 - b.1);
        if a.0 <= b.0 && a.1 >= b.1 {
            Some(a.0)
        } else if a.1 > b.1 {
            Some(crossing.max(a.0))
        } else {
            None
        }
    }
}

/// All that was measured of a scene.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// The scene's name: of its file, or of the built-in.
    pub scene: String,
    /// Size of the film, pixels.
    pub size: [u32; 2],
    /// Contestants in their order, for each budget in its.
    pub outcomes: Vec<Outcome>,
}

/// What is measured.
#[derive(Clone, Debug)]
pub struct Job {
    /// Size of the film, pixels.
    pub size: [u32; 2],
    /// Wall times, s.
    pub budgets: Vec<f64>,
    /// Seeds for each of them, at least 2: one film has no variance.
    pub runs: u32,
    /// The first seed.
    pub seed: u32,
}

/// Samples per pixel of the longest render that finds out how many fit: of films of a pixel, too.
const MOST_PROBED: u32 = 1 << 16;

/// Measures a scene. `tell` hears what is being done.
///
/// # Errors
/// When a contestant fails: [`Contestant::run`].
pub fn measure(
    scene: &str,
    job: &Job,
    contestants: &mut [Contestant],
    mut tell: impl FnMut(&str),
) -> Result<Measurement, Error> {
    let plans = contestants.iter_mut().map(|c| plan(c, job)).collect::<Result<Vec<_>, Error>>()?;
    let mut outcomes = Vec::new();
    for (b, budget) in job.budgets.iter().enumerate() {
        let mut films: Vec<Vec<Run>> = contestants.iter().map(|_| Vec::new()).collect();
        for seed in job.seed..job.seed + job.runs {
            tell(&format!("{scene}, {budget} s, seed {seed}"));
            for ((contestant, films), plan) in contestants.iter_mut().zip(&mut films).zip(&plans) {
                films.push(contestant.run(job.size, plan[b], seed)?);
            }
        }
        let scores =
            errors(&films.iter().map(|runs| runs.iter().map(|r| &r.luminance[..]).collect()).collect::<Vec<_>>());
        for ((contestant, runs), score) in contestants.iter().zip(&films).zip(scores) {
            let measured = |(run, errors): (&Run, Errors)| Measured {
                seed: run.seed,
                seconds: run.seconds,
                render_seconds: run.render_seconds,
                errors,
            };
            outcomes.push(Outcome {
                contestant: contestant.name().into(),
                budget: *budget,
                spp: runs[0].spp,
                runs: runs.iter().zip(score.runs).map(measured).collect(),
                bright: score.bright,
            });
        }
    }
    Ok(Measurement { scene: scene.into(), size: job.size, outcomes })
}

/// Samples per pixel that fit into each budget, at least 1: a line through the last two of some renders, each with four times the
/// samples of the one before, until one takes an eighth of the largest budget. So what a contestant compiles while it renders counts
/// once, and what it learns at first.
fn plan(contestant: &mut Contestant, job: &Job) -> Result<Vec<u32>, Error> {
    let longest = job.budgets.iter().copied().fold(0.0, f64::max);
    // No seed that counts is used up here.
    let mut probe = |spp| contestant.run(job.size, spp, job.seed.wrapping_sub(1));
    let (mut before, mut last) = (probe(1)?, probe(4)?);
    while last.render_seconds < longest / 8.0 && last.spp < MOST_PROBED {
        (before, last) = (last.clone(), probe(4 * last.spp)?);
    }
    Ok(job.budgets.iter().map(|budget| fit([&before, &last].map(|r| (f64::from(r.spp), r.seconds)), *budget)).collect())
}

/// Samples for which a line through two points, each samples and seconds, takes so many seconds.
fn fit([(n0, s0), (n1, s1)]: [(f64, f64); 2], seconds: f64) -> u32 {
    // Of noise alone, by the longer one.
    let each = if s1 > s0 && n1 > n0 { (s1 - s0) / (n1 - n0) } else { s1 / n1 };
    (n1 + (seconds - s1) / each).floor().clamp(1.0, f64::from(1 << 20)) as u32
}

/// Name of a scene for people: the file's without its folder and endings.
pub fn short_name(scene: &str) -> String {
    let file = Path::new(scene).file_name().and_then(|n| n.to_str()).unwrap_or(scene);
    let name = scene.strip_prefix("builtin:").unwrap_or(file);
    name.split('.').next().unwrap_or(name).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn result(setup: f64, samples_per_second: f64) -> Outcome {
        let run = Measured { seed: 0, seconds: setup + 1.0, render_seconds: 1.0, errors: Errors::default() };
        Outcome { contestant: "a".into(), budget: 1.0, spp: samples_per_second as u32, runs: vec![run; 2], bright: 0.0 }
    }

    #[test]
    fn a_longer_preparation_pays_for_itself_once_samples_are_as_many() {
        // 20 samples a second from 0.5 s on are 8 after 0.9 s, as are 10 a second from 0.1 s on.
        let (slow, quick) = (result(0.5, 20.0), result(0.1, 10.0));
        assert!((slow.overtakes(&quick).expect("it does") - 0.9).abs() < 1e-12);
        assert_eq!(quick.overtakes(&slow), None);
        assert_eq!(result(0.125, 20.0).overtakes(&slow), Some(0.125));
    }

    #[test]
    fn what_fits_is_on_a_line() {
        // Half a second before the first sample, then ten a second.
        assert_eq!(fit([(1.0, 0.6), (4.0, 0.9)], 2.05), 15);
        assert_eq!(fit([(1.0, 0.6), (4.0, 0.9)], 0.1), 1, "at least one");
        assert_eq!(fit([(1.0, 0.9), (4.0, 0.8)], 2.1), 10, "what falls is noise");
    }

    #[test]
    fn scenes_are_named_without_folder_and_ending() {
        assert_eq!(short_name("a/b/kitchen.matched.glb"), "kitchen");
        assert_eq!(short_name("builtin:cornell-box"), "cornell-box");
    }
}
