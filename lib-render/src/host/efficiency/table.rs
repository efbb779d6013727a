//! What was measured, as numbers: each run as a line of comma-separated values, and the ratios that matter.

use super::bootstrap::{Interval, bootstrap};
use super::score::Errors;
use super::{Measured, Measurement, Outcome};
use crate::host::error::Error;

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

/// The columns of the lines.
const HEAD: [&str; 14] = [
    "scene",
    "width",
    "height",
    "contestant",
    "budget_s",
    "seed",
    "spp",
    "seconds",
    "render_seconds",
    "relmse",
    "relmse_trimmed",
    "relmse_eps_0.01",
    "smape",
    "bright",
];

/// A line for each run, with a head.
pub fn csv(measurements: &[Measurement]) -> String {
    let mut lines = csv::Writer::from_writer(Vec::new());
    let mut put = |cells: &[String]| lines.write_record(cells).expect("memory takes it, and lines are equally long");
    put(&HEAD.map(String::from));
    for Measurement { scene, size: [width, height], outcomes } in measurements {
        for Outcome { contestant, budget, spp, runs, bright } in outcomes {
            for Measured { seed, seconds, render_seconds, errors } in runs {
                let Errors { relative, trimmed, public, smape } = errors;
                let name = [scene.clone(), width.to_string(), height.to_string(), contestant.clone()];
                let run = [budget.to_string(), seed.to_string(), spp.to_string()];
                let times = [seconds, render_seconds].map(|s| format!("{s:.4}"));
                let rest = [relative, trimmed, public, smape, bright].map(|x| format!("{x:.6e}"));
                put(&[&name[..], &run, &times, &rest].concat());
            }
        }
    }
    String::from_utf8(lines.into_inner().expect("memory takes it")).expect("it was text")
}

/// What such lines say. Runs of a scene, contestant and budget stand together.
///
/// # Errors
/// When they are not such lines: which one, and why.
pub fn from_csv(text: &str) -> Result<Vec<Measurement>, Error> {
    let mut all: Vec<Measurement> = Vec::new();
    let mut lines = csv::ReaderBuilder::new().has_headers(false).from_reader(text.as_bytes());
    for (number, line) in (1..).zip(lines.records()) {
        let fault = |what: &str| Error::new(format!("line {number} of the runs: {what}"));
        let line = line.map_err(|e| fault(&e.to_string()))?;
        if number == 1 {
            if line != HEAD[..] {
                return Err(fault(&format!("the head must be {}", HEAD.join(","))));
            }
            continue;
        }
        let float = |k: usize| line[k].parse::<f64>().map_err(|_| fault(&format!("{} is no number", HEAD[k])));
        let count = |k: usize| line[k].parse::<u32>().map_err(|_| fault(&format!("{} is no whole number", HEAD[k])));
        let (scene, size, contestant, budget) = (&line[0], [count(1)?, count(2)?], &line[3], float(4)?);
        let errors = Errors { relative: float(9)?, trimmed: float(10)?, public: float(11)?, smape: float(12)? };
        let run = Measured { seed: count(5)?, seconds: float(7)?, render_seconds: float(8)?, errors };
        if all.last().is_none_or(|m| m.scene != scene || m.size != size) {
            all.push(Measurement { scene: scene.into(), size, outcomes: Vec::new() });
        }
        let outcomes = &mut all.last_mut().expect("there is one now").outcomes;
        if outcomes.last().is_none_or(|o| o.contestant != contestant || o.budget != budget) {
            let (spp, bright) = (count(6)?, float(13)?);
            outcomes.push(Outcome { contestant: contestant.into(), budget, spp, runs: Vec::new(), bright });
        }
        outcomes.last_mut().expect("there is one now").runs.push(run);
    }
    Ok(all)
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

    #[test]
    fn lines_are_read_back() {
        let other = Outcome { contestant: "b, with \"words\"".into(), ..outcome(0.5, 1.0) };
        let [first, later] = [1.0, 8.0].map(|budget| Outcome { budget, ..outcome(0.25, 2.0) });
        let of = |scene: &str, outcomes| Measurement { scene: scene.into(), size: [3, 2], outcomes };
        let text = csv(&[of("s", vec![first.clone(), other, later]), of("t", vec![first])]);
        let read = from_csv(&text).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(read.iter().map(|m| m.outcomes.len()).collect::<Vec<_>>(), [3, 1]);
        assert_eq!((read[0].outcomes[1].contestant.as_str(), read[0].outcomes[2].budget), ("b, with \"words\"", 8.0));
        assert_eq!(csv(&read), text);
        for (broken, says) in [
            (text.replacen("seed", "sead", 1), "line 1 of the runs: the head must be scene,"),
            (text.replacen(",4,", ",few,", 1), "line 2 of the runs: spp is no whole number"),
            (format!("{text}s,3\n"), "line 10 of the runs: "),
        ] {
            let error = from_csv(&broken).expect_err("it is broken").to_string();
            assert!(error.starts_with(says), "{error}");
        }
    }
}
