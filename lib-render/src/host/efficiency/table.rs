//! What was measured, as numbers: each run as a line of comma-separated values, and the ratios that matter.

use std::fmt::Write;

use super::bootstrap::{Interval, bootstrap};
use super::score::Errors;
use super::{Measured, Measurement, Outcome};

/// Which error a ratio is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// [`Errors::relative`].
    Relative,
    /// [`Errors::trimmed`].
    Trimmed,
    /// [`Errors::public`].
    Public,
    /// [`Errors::smape`], squared: it falls as the root of the others.
    Smape,
}

impl Metric {
    /// All, in the order of the report.
    pub const ALL: [Metric; 4] = [Metric::Relative, Metric::Trimmed, Metric::Public, Metric::Smape];

    /// What it is called there.
    pub fn name(self) -> &'static str {
        match self {
            Metric::Relative => "relMSE",
            Metric::Trimmed => "relMSE, trimmed",
            Metric::Public => "relMSE, eps 0.01",
            Metric::Smape => "SMAPE²",
        }
    }

    /// The error of some runs.
    pub fn of(self, runs: &[Measured]) -> f64 {
        let mean = |of: fn(&Errors) -> f64| runs.iter().map(|run| of(&run.errors)).sum::<f64>() / runs.len() as f64;
        match self {
            Metric::Relative => mean(|e| e.relative),
            Metric::Trimmed => mean(|e| e.trimmed),
            Metric::Public => mean(|e| e.public),
            Metric::Smape => mean(|e| e.smape).powi(2),
        }
    }
}

/// 1/(error · seconds) of some runs.
fn efficiency(runs: &[Measured], metric: Metric) -> f64 {
    let seconds = runs.iter().map(|run| run.seconds).sum::<f64>() / runs.len() as f64;
    1.0 / (metric.of(runs) * seconds)
}

/// How many times as efficient `a` is as `b`.
pub fn gain(a: &Outcome, b: &Outcome, metric: Metric) -> Interval {
    mean_gain(&[(a, b)], metric)
}

/// The geometric mean of gains over scenes; the interval takes the seeds of each scene for themselves.
pub fn mean_gain(pairs: &[(&Outcome, &Outcome)], metric: Metric) -> Interval {
    let lists: Vec<Vec<Measured>> = pairs.iter().flat_map(|(a, b)| [a.runs.clone(), b.runs.clone()]).collect();
    bootstrap(&lists, |lists| {
        let (pairs, _) = lists.as_chunks::<2>();
        let log = |[a, b]: &[Vec<Measured>; 2]| (efficiency(a, metric) / efficiency(b, metric)).ln();
        (pairs.iter().map(log).sum::<f64>() / pairs.len() as f64).exp()
    })
}

/// A line for each run, with a head.
pub fn csv(measurements: &[Measurement]) -> String {
    let mut text = String::from(
        "scene,width,height,contestant,budget_s,seed,spp,seconds,render_seconds,relmse,relmse_trimmed,relmse_eps_0.01,smape\n",
    );
    for Measurement { scene, size: [width, height], outcomes } in measurements {
        for Outcome { contestant, budget, spp, runs, .. } in outcomes {
            for Measured { seed, seconds, render_seconds, errors } in runs {
                let Errors { relative, trimmed, public, smape } = errors;
                let line = format!(
                    "{scene},{width},{height},{contestant},{budget},{seed},{spp},{seconds:.4},{render_seconds:.4},\
                     {relative:.6e},{trimmed:.6e},{public:.6e},{smape:.6e}"
                );
                writeln!(text, "{line}").expect("a string takes it");
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(error: f64, seconds: f64) -> Outcome {
        let errors = Errors { relative: error, trimmed: error, public: error, smape: error.sqrt() };
        let run = |seed| Measured { seed, seconds, render_seconds: seconds, errors };
        Outcome { contestant: "a".into(), budget: 1.0, spp: 4, runs: vec![run(0), run(1)], bright: 0.0 }
    }

    #[test]
    fn a_gain_is_of_error_times_seconds() {
        let (a, b) = (outcome(0.1, 2.0), outcome(0.4, 1.0));
        for metric in Metric::ALL {
            let Interval { value, least, most } = gain(&a, &b, metric);
            assert!((value - 2.0).abs() < 1e-12 && (most - least).abs() < 1e-12, "{}", metric.name());
        }
        let both = mean_gain(&[(&a, &b), (&b, &b), (&a, &b), (&b, &b)], Metric::Relative);
        assert!((both.value - 2.0_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn each_run_is_a_line() {
        let measurement = Measurement { scene: "s".into(), size: [3, 2], outcomes: vec![outcome(0.25, 2.0)] };
        let text = csv(&[measurement]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 3);
        assert_eq!(lines[0].split(',').count(), lines[1].split(',').count());
        assert!(lines[1].starts_with("s,3,2,a,1,0,4,2.0000,2.0000,2.500000e-1,"), "{}", lines[1]);
    }
}
