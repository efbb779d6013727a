//! `jerboa dump`, `jerboa time`, `jerboa explain`: what the renderer became for a scene, how long that took, and why.

use std::sync::Arc;
use std::time::Duration;

use jerboa_backend_cranelift::lanes::{Width, lanes, vectorizes};
use jerboa_ir::{Program, print};
use serde_json::json;

use super::args::{DumpArgs, ExplainArgs, KnownArg, StageArg, TimeArgs};
use super::scene::load;
use crate::host::device::DeviceKind;
use crate::host::error::Error;
use crate::host::generate::{Generated, Keep, Kernels, Request, TracerKind, generate, generic, residual};
use crate::host::tables::{Choices, Tables};

/// The text of a stage, one kernel after the other. The generic program and the residual of one kernel read back.
pub(super) fn dump(args: &DumpArgs) -> Result<String, Error> {
    let (scene, _) = load(&args.scene)?;
    let tables = Tables::new(&scene, &Choices::default(), args.known.into());
    let kernels = kernels(&tables, args.kernel.as_deref())?;
    // The generic program is one for all kernels and scenes.
    if args.stage == StageArg::Generic {
        return Ok(print(generic().program()));
    }
    let mut text = String::new();
    if let StageArg::Residual | StageArg::Lanes = args.stage {
        for kernel in &kernels {
            let residual = residual(&tables, kernel, Keep::default())?.program;
            text += &if args.stage == StageArg::Lanes { in_lanes(&residual)? } else { print(&residual) };
        }
        return Ok(text);
    }
    for g in generate(&tables, &kernels, Keep { dumps: true, log: false })?.kernels {
        let dumped = if args.stage == StageArg::Clif { g.clif() } else { g.asm() };
        text += dumped.expect("dumps were asked for");
    }
    Ok(text)
}

/// The text of a kernel with its loops over lanes, or that it has none.
fn in_lanes(residual: &Program) -> Result<String, Error> {
    let names = residual.entries.iter().map(|(name, _)| &**name).collect::<Vec<_>>().join(", ");
    if !vectorizes(residual) {
        return Ok(format!("; kernel {names} has no vectorize: nothing of it runs in lanes\n"));
    }
    lanes(residual, Width::Hint).map(|p| print(&p)).map_err(|e| Error::new(format!("kernel {names}: {e}")))
}

/// The evaluator's log of decisions.
pub(super) fn explain(args: &ExplainArgs) -> Result<String, Error> {
    let (scene, _) = load(&args.scene)?;
    let tables = Tables::new(&scene, &Choices::default(), KnownArg::default().into());
    let mut text = String::new();
    for kernel in kernels(&tables, args.kernel.as_deref())? {
        let residual = residual(&tables, &kernel, Keep { log: true, dumps: false })?;
        text += &format!("kernel {}\n{}{}", kernel.name, residual.log, residual.report);
    }
    Ok(text)
}

/// Wall times of loading, tree, specialisation and code generation.
pub(super) fn time(args: &TimeArgs) -> Result<String, Error> {
    // What is built once for all scenes is not charged to this one.
    generic();
    let (scene, load_time) = load(&args.scene)?;
    let start = std::time::Instant::now();
    let tables = Tables::new(&scene, &Choices::default(), KnownArg::default().into());
    let tables_time = start.elapsed().saturating_sub(tables.bvh_time);
    let kernels = generate(&tables, &kernels(&tables, None)?, Keep::default())?;
    let phases = Phases { load: load_time + tables_time, bvh: tables.bvh_time, kernels: &kernels };
    Ok(if args.json { phases.json() } else { phases.text() })
}

/// The kernel of a name, on any device; or all that light transport takes.
fn kernels(tables: &Tables, name: Option<&str>) -> Result<Vec<Request>, Error> {
    let Some(name) = name else { return Ok(DeviceKind::default().requests(tables, TracerKind::Path)) };
    let mut all: Vec<Request> = Vec::new();
    for request in DeviceKind::ALL.iter().flat_map(|d| TracerKind::ALL.iter().flat_map(|t| d.requests(tables, *t))) {
        if !all.contains(&request) {
            all.push(request);
        }
    }
    let names = || all.iter().map(|r| r.name.as_str()).collect::<Vec<_>>().join(", ");
    let found = all.iter().find(|r| r.name == name);
    found
        .map(|r| vec![r.clone()])
        .ok_or_else(|| Error::new(format!("there is no kernel `{name}`; there are {}", names())))
}

struct Phases<'a> {
    load: Duration,
    bvh: Duration,
    kernels: &'a Kernels,
}

fn ms(t: Duration) -> f64 {
    t.as_secs_f64() * 1e3
}

impl Phases<'_> {
    fn total(&self) -> Duration {
        self.load + self.bvh + self.kernels.specialize_time + self.kernels.codegen_time
    }

    fn json(&self) -> String {
        let kernel = |k: &Arc<Generated>| {
            json!({
                "name": k.name,
                "specialize_ms": ms(k.specialize_time),
                "codegen_ms": ms(k.codegen_time),
                "nodes_before": k.residual.report.nodes_before,
                "nodes_after": k.residual.report.nodes_after,
                "code_bytes": code_bytes(k),
                "passes": k.residual.report.passes.iter().map(|p| json!({"name": p.name, "ms": ms(p.time)})).collect::<Vec<_>>(),
            })
        };
        let object = json!({
            "load_ms": ms(self.load),
            "bvh_ms": ms(self.bvh),
            "specialize_ms": ms(self.kernels.specialize_time),
            "codegen_ms": ms(self.kernels.codegen_time),
            "total_ms": ms(self.total()),
            "kernels": self.kernels.kernels.iter().map(kernel).collect::<Vec<_>>(),
        });
        format!("{object}\n")
    }

    fn text(&self) -> String {
        let mut text = format!(
            "load {:.1} ms, bvh {:.1} ms, specialize {:.1} ms, codegen {:.1} ms, total {:.1} ms\n",
            ms(self.load),
            ms(self.bvh),
            ms(self.kernels.specialize_time),
            ms(self.kernels.codegen_time),
            ms(self.total())
        );
        for k in &self.kernels.kernels {
            let r = &k.residual.report;
            text += &format!(
                "{:<8} specialize {:>7.2} ms, codegen {:>7.2} ms, nodes {} -> {}, {} bytes of code\n",
                k.name,
                ms(k.specialize_time),
                ms(k.codegen_time),
                r.nodes_before,
                r.nodes_after,
                code_bytes(k)
            );
            for p in &r.passes {
                text += &format!("           {:<12} {:>7.2} ms, {} changes\n", p.name, ms(p.time), p.changes);
            }
        }
        text
    }
}

fn code_bytes(k: &Generated) -> usize {
    k.code.reports().map(|r| r.code_bytes).sum()
}
