//! `jerboa bench edits`: how long an edit takes to be seen.

use std::fmt::Write;
use std::time::{Duration, Instant};

use jerboa_scenes::{AlphaMode, Material, Scene, Volume};
use serde_json::json;

use super::args::EditsArgs;
use super::in_pool;
use super::scene::load;
use crate::host::edit::Edit;
use crate::host::error::Error;
use crate::host::renderer::{Options, Renderer};
use crate::host::session::Session;

/// A kind of edit: its name, and what it does to a material in a round.
type Kind = (&'static str, fn(&Scene, usize, &mut Material));

/// From what needs nothing made to what concerns every kernel.
const KINDS: [Kind; 4] = [
    ("a value", |_, round, m| m.base_color[0] = (round % 8 + 1) as f32 / 9.0),
    ("a class that is there", |scene, _, m| {
        let other = scene.materials.iter().find(|o| !o.is_emissive() && structure(o) != structure(m));
        *m = other.unwrap_or(m).clone();
    }),
    ("one new class", |_, round, m| *m = rare(round)),
    ("the first coloured glass", |_, _, m| {
        let volume = Volume {
            thickness: 1.0,
            thickness_texture: None,
            attenuation_distance: 0.1,
            attenuation_color: [0.9, 0.5, 0.5],
        };
        *m = Material { volume: Some(volume), ..Material::glass("coloured glass", 1.5) };
    }),
];

/// Something of what makes a class.
fn structure(m: &Material) -> impl PartialEq {
    (
        m.metallic > 0.0,
        m.transmission > 0.0,
        m.specular > 0.0,
        m.base_color_texture.is_some(),
        m.normal_texture.is_some(),
    )
}

/// A material of a structure that no other round and hardly any scene has: there are 32.
fn rare(round: usize) -> Material {
    let bit = |n: usize| round >> n & 1 == 1;
    Material {
        name: "rare".into(),
        metallic: if bit(0) { 0.5 } else { 0.0 },
        roughness: if bit(1) { 0.0 } else { 0.4 },
        transmission: if bit(2) { 0.3 } else { 0.0 },
        specular: if bit(3) { 0.0 } else { 0.5 },
        alpha_mode: AlphaMode::Opaque,
        base_color: if bit(4) { [0.0, 0.0, 0.0, 1.0] } else { [0.5; 4] },
        // No lobe but this one has an inside.
        volume: Some(Volume {
            thickness: 1.0,
            thickness_texture: None,
            attenuation_distance: f32::INFINITY,
            attenuation_color: [1.0; 3],
        }),
        ..Material::default()
    }
}

/// A kind of edit, a few times over.
struct Row {
    name: &'static str,
    /// What each edit took to make.
    edits: Vec<Edit>,
    /// Until a whole pass of it was seen.
    seen: Vec<Duration>,
}

/// Edits a scene while it is rendered and returns the table.
pub(super) fn run(args: &EditsArgs) -> Result<String, Error> {
    in_pool(args.threads, || measure(args))
}

fn measure(args: &EditsArgs) -> Result<String, Error> {
    let (scene, _) = load(&args.scene, &args.select)?;
    let Some(number) = scene.materials.iter().position(|m| !m.is_emissive()) else {
        return Err(Error::new(format!("{}: there is no material to edit that does not shine", args.scene)));
    };
    let renderer = Renderer::new(&scene, Options { spp: u32::MAX, ..Options::default() })?;
    let original = scene.materials[number].clone();
    let session = Session::start(renderer, scene.clone(), scene.camera_or_default(), [args.width, args.height])?;
    session.wait(0, 1)?;
    let mut rows = Vec::new();
    for (name, change) in KINDS {
        let mut row = Row { name, edits: Vec::new(), seen: Vec::new() };
        for round in 0..args.rounds as usize {
            let mut material = original.clone();
            change(&scene, round, &mut material);
            let start = Instant::now();
            let edit = session.set_material(number, material);
            session.wait(edit, 1)?;
            row.seen.push(start.elapsed());
            row.edits.push(session.outcome(edit).ok_or_else(|| Error::new("an edit was seen before it was made"))??);
            session.wait(session.set_material(number, original.clone()), 1)?;
        }
        rows.push(row);
    }
    Ok(if args.json { as_json(&rows) } else { as_text(&rows) })
}

impl Row {
    /// What the first edit took, then the median of all, ms.
    fn first_and_median(times: impl Iterator<Item = Duration>) -> [f64; 2] {
        let mut times: Vec<f64> = times.map(|t| t.as_secs_f64() * 1e3).collect();
        let first = times[0];
        times.sort_by(f64::total_cmp);
        [first, times[times.len() / 2]]
    }

    /// Wall time and work until it was made, and wall time until it was seen.
    fn times(&self) -> [[f64; 2]; 3] {
        [
            Row::first_and_median(self.edits.iter().map(|e| e.work)),
            Row::first_and_median(self.edits.iter().map(|e| e.time)),
            Row::first_and_median(self.seen.iter().copied()),
        ]
    }
}

fn as_json(rows: &[Row]) -> String {
    let object = |r: &Row| {
        let [work, made, seen] = r.times();
        json!({
            "edit": r.name,
            "work_ms": work[1],
            "made_ms": made[1],
            "seen_ms": seen[1],
            "first": {
                "work_ms": work[0],
                "made_ms": made[0],
                "seen_ms": seen[0],
                "specialised": r.edits[0].kernels,
                "compiled": r.edits[0].compiled,
            },
        })
    };
    format!("{}\n", serde_json::Value::Array(rows.iter().map(object).collect()))
}

fn as_text(rows: &[Row]) -> String {
    let mut text = String::from(
        "ms, the first edit and the median      work          made          seen   specialised, compiled first\n",
    );
    for r in rows {
        let [work, made, seen] = r.times().map(|[first, median]| format!("{first:.1} {median:.1}"));
        let (specialised, compiled) = (r.edits[0].kernels.len(), r.edits[0].compiled.len());
        writeln!(text, "{:<30} {work:>12} {made:>13} {seen:>13}   {specialised}, {compiled}", r.name)
            .expect("a string takes it");
    }
    text
}
