//! `jerboa bench`: measurements that take a while.

use std::fmt::Write;

use jerboa_scenes::Scene;
use jerboa_scenes::builtin::{Builtin, Hard, Source, gallery};
use serde_json::{Value, json};

use super::args::StabilityArgs;
use super::in_pool;
use super::scene::choices_of;
use crate::host::error::Error;
use crate::host::image_io::Image;
use crate::host::sheet::{Tile, contact_sheet};
use crate::host::stability::{Outcome, measure, naive};

/// Columns of the contact sheet.
const COLUMNS: u32 = 7;

/// Linear colours of names: of a scene that passes, and of one that fails.
const INK: [[f32; 3]; 2] = [[0.8; 3], [1.0, 0.05, 0.02]];

/// A scene of the gallery and what its render showed.
struct Row {
    builtin: &'static Builtin,
    hard: Hard,
    outcome: Outcome,
    /// By these words, which a naive renderer has no other than.
    naive: Option<(&'static str, Outcome)>,
}

impl Row {
    /// Time for a sample over that of the naive renderer: what its remedy costs.
    fn cost(&self, naive: &Outcome) -> f64 {
        self.outcome.batch_time.as_secs_f64() / naive.batch_time.as_secs_f64().max(f64::MIN_POSITIVE)
    }
}

/// Renders the gallery of hard cases, writes the contact sheet if asked, and returns the table and the names of the scenes
/// that fail.
pub(super) fn stability(args: &StabilityArgs) -> Result<(String, Vec<&'static str>), Error> {
    if let Some(path) = &args.output {
        Image::check_target(path)?;
    }
    let (chosen, choices) = (chosen(&args.scene)?, choices_of(&args.sampling));
    let measure = |(builtin, hard): (&'static Builtin, Hard)| {
        let scene = Scene::load(format!("builtin:{}", builtin.name)).map_err(|e| Error::new(e.to_string()))?;
        let Some((words, other)) = naive(builtin.name, choices) else {
            let [outcome] = measure(&scene, &hard.reference, args.spp, args.seed, [choices])?;
            return Ok(Row { builtin, hard, outcome, naive: None });
        };
        let [outcome, naive] = measure(&scene, &hard.reference, args.spp, args.seed, [choices, other])?;
        Ok(Row { builtin, hard, outcome, naive: Some((words, naive)) })
    };
    let rows: Vec<Row> = in_pool(args.threads, || chosen.into_iter().map(measure).collect::<Result<_, Error>>())?;
    if let Some(path) = &args.output {
        let tile = |r: &Row| INK[usize::from(!r.outcome.passes())];
        let tiles: Vec<Tile> =
            rows.iter().map(|r| Tile { name: r.builtin.name, picture: &r.outcome.picture, ink: tile(r) }).collect();
        contact_sheet(&tiles, COLUMNS).write(path, 0.0)?;
    }
    let failed = rows.iter().filter(|r| !r.outcome.passes()).map(|r| r.builtin.name).collect();
    Ok((if args.json { as_json(&rows) } else { as_text(&rows) }, failed))
}

/// The scenes of these names, in the order of the gallery; all of it if none is named.
fn chosen(names: &[String]) -> Result<Vec<(&'static Builtin, Hard)>, Error> {
    let short: Vec<&str> = names.iter().map(|n| n.strip_prefix("builtin:").unwrap_or(n)).collect();
    if let Some(name) = short.iter().find(|n| !gallery().any(|(b, _)| b.name == **n)) {
        let known: Vec<&str> = gallery().map(|(b, _)| b.name).collect();
        let message = format!("--scene {name}: not in the gallery of hard cases; there are {}", known.join(", "));
        return Err(Error::new(message));
    }
    Ok(gallery().filter(|(b, _)| short.is_empty() || short.contains(&b.name)).collect())
}

/// A list of objects, one for each scene; an infinite number of standard errors is null.
fn as_json(rows: &[Row]) -> String {
    let object = |r: &Row| {
        let (o, reference) = (&r.outcome, &r.hard.reference);
        let (source, spp) = match reference.source {
            Source::ClosedForm => ("closed form", Value::Null),
            Source::Rendered { spp } => ("rendered", spp.into()),
        };
        json!({
            "scene": r.builtin.name,
            "purpose": r.builtin.purpose,
            "naive": r.hard.naive,
            "beside": r.naive.as_ref().map(|(words, naive)| json!({
                "words": words,
                "time_ratio": r.cost(naive),
                "relative": naive.relative,
                "sigmas": naive.sigmas,
                "standard_error": naive.standard_error,
            })),
            "samples": o.samples,
            "seconds": o.time.as_secs_f64(),
            "samples_per_second": o.samples_per_second(),
            "rays_per_second": o.rays_per_second(),
            "rays_per_sample": o.rays as f64 / o.samples as f64,
            "mean": o.mean,
            "standard_error": o.standard_error,
            "reference": {
                "mean": reference.mean,
                "standard_error": reference.standard_error,
                "source": source,
                "spp": spp,
            },
            "sigmas": o.sigmas,
            "relative": o.relative,
            "dropped_samples": o.dropped,
            "non_finite_pixels": o.non_finite,
            "pass": o.passes(),
        })
    };
    format!("{}\n", Value::Array(rows.iter().map(object).collect()))
}

fn as_text(rows: &[Row]) -> String {
    let mut text = String::from(
        "scene           Msamples/s  Mrays/s  rays/sample       mean  reference   relative  sigmas  dropped  not finite\n",
    );
    for r in rows {
        let o = &r.outcome;
        writeln!(
            text,
            "{:<15} {:>10.3} {:>8.2} {:>12.1} {:>10.6} {:>10.6} {:>+10.1e} {:>+7.2} {:>8} {:>11}  {}",
            r.builtin.name,
            o.samples_per_second() / 1e6,
            o.rays_per_second() / 1e6,
            o.rays as f64 / o.samples as f64,
            o.mean,
            r.hard.reference.mean,
            o.relative,
            o.sigmas,
            o.dropped,
            o.non_finite,
            if o.passes() { "pass" } else { "FAIL" },
        )
        .expect("a string takes it");
        if !o.passes() {
            writeln!(text, "    a naive renderer {}", r.hard.naive).expect("a string takes it");
        }
    }
    text + &beside(rows)
}

/// What remedies cost and bring, where their lack is a matter of words.
fn beside(rows: &[Row]) -> String {
    let mut text = String::new();
    for (r, words, naive) in rows.iter().filter_map(|r| r.naive.as_ref().map(|(words, naive)| (r, words, naive))) {
        if text.is_empty() {
            text.push_str("\nBeside a naive renderer, in turns: time per sample over its time, and how far off each is (standard error)\n");
            text.push_str("scene             time      by default                naively               naively is\n");
        }
        let relative = |o: &Outcome| {
            let scale = if r.hard.reference.mean == 0.0 { 1.0 } else { r.hard.reference.mean };
            format!("{:+.1e} ({:.1e})", o.relative, o.standard_error / scale)
        };
        let (ours, theirs) = (relative(&r.outcome), relative(naive));
        writeln!(text, "{:<15} {:>6.2}  {ours:<24}  {theirs:<20}  {words}", r.builtin.name, r.cost(naive))
            .expect("a string takes it");
    }
    text
}
