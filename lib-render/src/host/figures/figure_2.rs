//! Figure 2: how the time of a render is shared out, and what shading a path vertex takes.
//!
//! The paper's parts: tracing camera rays, secondary rays and shadow rays, shading, and the rest, which is making new paths,
//! sorting, compaction and the film. The device of streams runs on one thread, and each call of a kernel is charged to its
//! part by the time that the thread ran for.
//!
//! Shading runs without a ray being traced, so it tells what knowing the scene and what lanes are worth, traversal excluded:
//! nanoseconds for each path vertex, by what is known, and for code that shades one vertex after the other.

use std::sync::Arc;
use std::time::Duration;

use jerboa_backend_cranelift as clif;
use jerboa_scenes::Scene;

use super::table_2::{Job, fair};
use super::{Chart, Group, LEVELS, Spread, in_turn};
use crate::host::code_cache::compile;
use crate::host::device::{DeviceKind, Traversal};
use crate::host::error::Error;
use crate::host::film::{Film, Window};
use crate::host::generate::{Generated, Keep, TracerKind, residual};
use crate::host::renderer::{Cut, Handle};
use crate::host::stages::{Stage, Stages};
use crate::host::tables::{Known, Pass, Tables};
use crate::host::wave::Wave;
use crate::host::work::Tiles;

/// The parts, and the stages that they consist of; the rest is what is left of the total.
const PARTS: [(&str, &[Stage]); 4] = [
    ("camera rays", &[Stage::Camera]),
    ("secondary rays", &[Stage::Secondary]),
    ("shadow rays", &[Stage::Shadow]),
    ("shading", &[Stage::Shade, Stage::Miss]),
];

/// What is measured.
struct Variant {
    name: String,
    tables: Tables,
    wave: Wave,
    spent: Stages,
}

impl Variant {
    fn new(scene: &Scene, job: &Job, known: Known, name: String, lanes: bool) -> Result<Variant, Error> {
        let tables = Tables::walked(scene, &fair(job.max_depth), known, Traversal::default());
        let requests = DeviceKind::Cpu.requests(&tables, TracerKind::Path);
        let residuals =
            requests.iter().map(|r| residual(&tables, r, Keep::default())).collect::<Result<Vec<_>, Error>>()?;
        let usual = clif::Options::default();
        let options = if lanes { usual } else { clif::Options { lanes: None, ..usual } };
        let code = compile(&residuals.iter().map(|r| &r.program).collect::<Vec<_>>(), &options)?;
        let kernels = requests.iter().zip(residuals).zip(code).map(|((request, residual), (code, codegen_time))| {
            let name = request.name.clone();
            Arc::new(Generated { name, residual, code, specialize_time: Duration::ZERO, codegen_time })
        });
        let wave = Wave::new(kernels.collect(), Cut::default().slots);
        Ok(Variant { name, tables, wave, spent: Stages::default() })
    }

    /// Renders on this thread. Gives what that took.
    fn render(&self, scene: &Scene, job: &Job) -> Result<Stages, Error> {
        let [width, height] = job.size;
        let window = Window { x: 0, y: 0, width, height };
        let pass = Pass { size: job.size, window, sample: 0, samples: job.spp, seed: 0 };
        let (mut film, handle, camera) = (Film::of_size(job.size), Handle::default(), scene.camera_or_default());
        let tiles = Tiles::new(&camera, self.tables.place(&camera), pass, Cut::default().tile, &mut film, &handle);
        let mut stages = Stages::default();
        self.wave.run_clocked(&self.tables, &mut tiles.worker(), &mut stages)?;
        Ok(stages)
    }
}

/// The shares of the time at level `structure`, and the time of shading a vertex: a group of each chart for each scene.
///
/// # Errors
/// When the evaluator, the code generator or a kernel gives up: a fault of Jerboa, not of the scene.
pub fn measure(scenes: &[(Scene, Job)]) -> Result<Vec<Chart>, Error> {
    let mut shares = Chart {
        title: "Where the time goes".into(),
        unit: "%",
        stacked: true,
        series: PARTS.iter().map(|(name, _)| *name).chain(["other"]).map(String::from).collect(),
        groups: Vec::new(),
    };
    let mut shading = Chart {
        title: "Shading a path vertex, traversal excluded".into(),
        unit: "ns",
        stacked: false,
        series: LEVELS.iter().map(|(_, name)| name.to_string()).chain(["structure, no lanes".into()]).collect(),
        groups: Vec::new(),
    };
    for (scene, job) in scenes {
        let mut variants = LEVELS
            .into_iter()
            .map(|(known, name)| Variant::new(scene, job, known, name.into(), true))
            .collect::<Result<Vec<_>, Error>>()?;
        variants.push(Variant::new(scene, job, Known::Structure, "structure, no lanes".into(), false)?);
        let vertex = in_turn(job.rounds, &mut variants, |_, variant| {
            let stages = variant.render(scene, job)?;
            variant.spent.add(&stages);
            let shade = stages.of(Stage::Shade);
            Ok(1e9 * shade.time.as_secs_f64() / shade.rows.max(1) as f64)
        })?;
        for variant in &variants[..2] {
            shares.groups.push(shared_out(&format!("{}, {}", scene.name, variant.name), &variant.spent));
        }
        shading.groups.push(Group {
            name: scene.name.clone(),
            notes: vec![
                ("gain by structure".into(), vertex[0].median / vertex[1].median),
                ("gain by lanes".into(), vertex[3].median / vertex[1].median),
            ],
            bars: vertex.into_iter().map(Some).collect(),
        });
    }
    Ok(vec![shares, shading])
}

/// The parts of the whole, in per cent; they add up to 100.
fn shared_out(name: &str, spent: &Stages) -> Group {
    let part = |time: Duration| 100.0 * time.as_secs_f64() / spent.total.as_secs_f64().max(f64::MIN_POSITIVE);
    let of = |stages: &[Stage]| part(stages.iter().map(|s| spent.of(*s).time).sum());
    let parts: Vec<f64> = PARTS.iter().map(|(_, stages)| of(stages)).collect();
    let other = of(&[Stage::Generate]) + part(spent.rest());
    let notes = vec![("of it new paths".into(), of(&[Stage::Generate]))];
    Group { name: name.into(), bars: parts.into_iter().chain([other]).map(|x| Some(Spread::once(x))).collect(), notes }
}
