//! `jerboa time`: how long it takes until the renderer of a scene is there.

use std::time::{Duration, Instant};

use jerboa_peval::Report;
use serde_json::{Value, json};

use super::args::{KnownArg, TimeArgs};
use super::scene::{choices_of, load};
use crate::host::device::DeviceKind;
use crate::host::error::Error;
use crate::host::generate::{Generated, Keep, TracerKind, generate, generic_of};
use crate::host::gpu::{Emitted, RealMachine};
use crate::host::tables::Tables;

/// Times the phases for the scene, as one who has rendered no other scene in this process would see them.
pub(super) fn run(args: &TimeArgs) -> Result<String, Error> {
    let device = DeviceKind::from(args.device);
    // What is built once for all scenes is not charged to this one.
    generic_of(device, TracerKind::Path);
    let (scene, load) = load(&args.scene, &args.select)?;
    let start = Instant::now();
    let tables = Tables::new(&scene, &choices_of(&args.sampling), KnownArg::default().into());
    let load = load + start.elapsed().saturating_sub(tables.bvh_time);
    let made = if device.is_gpu() { on_gpu(&tables, device)? } else { on_cpu(&tables, device)? };
    let times = [("load", load), ("bvh", tables.bvh_time)].into_iter().chain(made.times);
    let phases = Phases { times: times.collect(), kernels: made.kernels };
    Ok(if args.json { phases.json() } else { phases.text() })
}

/// Names of phases and how long they take.
type Times = Vec<(&'static str, Duration)>;

/// Kernels, and wall times of making all of them.
struct Made {
    times: Times,
    kernels: Vec<Kernel>,
}

/// A kernel, and how long a thread ran for it, or a driver.
struct Kernel {
    name: String,
    times: Times,
    report: Report,
    code_bytes: usize,
}

fn on_cpu(tables: &Tables, device: DeviceKind) -> Result<Made, Error> {
    let made = generate(tables, &device.requests(tables, TracerKind::Path), Keep::default())?;
    let kernel = |k: &Generated| Kernel {
        name: k.name.clone(),
        times: vec![("specialize", k.specialize_time), ("codegen", k.codegen_time)],
        report: k.residual.report.clone(),
        code_bytes: k.code.reports().map(|r| r.code_bytes).sum(),
    };
    Ok(Made {
        times: vec![("specialize", made.specialize_time), ("codegen", made.codegen_time)],
        kernels: made.kernels.iter().map(|k| kernel(k)).collect(),
    })
}

/// Our own times, specialisation and code generation, are apart from the driver's: of its pipelines and of the first launches,
/// since some drivers compile only then.
fn on_gpu(tables: &Tables, device: DeviceKind) -> Result<Made, Error> {
    let machine = RealMachine::new(tables, &device.requests(tables, TracerKind::Path), Keep::default())?;
    let kernel = |(k, [pipeline, first]): (&Emitted, [Duration; 2])| Kernel {
        name: k.name.clone(),
        times: vec![
            ("specialize", k.specialize_time),
            ("codegen", k.emit_time),
            ("pipeline", pipeline),
            ("first_launch", first),
        ],
        report: k.residual.report.clone(),
        code_bytes: 4 * k.words(),
    };
    let kernels: Vec<Kernel> = machine.warmed()?.into_iter().map(kernel).collect();
    let first = kernels.iter().map(|k| k.times[3].1).sum();
    let ours = [("specialize", machine.specialize_time), ("codegen", machine.emit_time)];
    Ok(Made {
        times: ours.into_iter().chain([("pipeline", machine.pipeline_time), ("first_launch", first)]).collect(),
        kernels,
    })
}

struct Phases {
    times: Times,
    kernels: Vec<Kernel>,
}

fn ms(t: Duration) -> f64 {
    t.as_secs_f64() * 1e3
}

impl Phases {
    fn total(&self) -> Duration {
        self.times.iter().map(|(_, time)| *time).sum()
    }

    fn json(&self) -> String {
        let timed = |mut object: Value, times: &Times| {
            times.iter().for_each(|(name, time)| object[format!("{name}_ms")] = ms(*time).into());
            object
        };
        let kernel = |k: &Kernel| {
            let passes: Vec<Value> =
                k.report.passes.iter().map(|p| json!({"name": p.name, "ms": ms(p.time)})).collect();
            let object = json!({
                "name": k.name,
                "nodes_before": k.report.nodes_before,
                "nodes_after": k.report.nodes_after,
                "code_bytes": k.code_bytes,
                "passes": passes,
            });
            timed(object, &k.times)
        };
        let kernels: Vec<Value> = self.kernels.iter().map(kernel).collect();
        format!("{}\n", timed(json!({ "total_ms": ms(self.total()), "kernels": kernels }), &self.times))
    }

    fn text(&self) -> String {
        let times = self.times.iter().map(|(name, time)| format!("{name} {:.1} ms, ", ms(*time))).collect::<String>();
        let mut text = format!("{times}total {:.1} ms\n", ms(self.total()));
        for k in &self.kernels {
            let times =
                k.times.iter().map(|(name, time)| format!("{name} {:>7.2} ms, ", ms(*time))).collect::<String>();
            let Report { nodes_before, nodes_after, passes, .. } = &k.report;
            let (name, bytes) = (&k.name, k.code_bytes);
            text += &format!("{name:<8} {times}nodes {nodes_before} -> {nodes_after}, {bytes} bytes of code\n");
            for p in passes {
                text += &format!("           {:<12} {:>7.2} ms, {} changes\n", p.name, ms(p.time), p.changes);
            }
        }
        text
    }
}
