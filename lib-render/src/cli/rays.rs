//! `jerboa bench rays`: raw tracing.

use std::fmt::Write;

use serde_json::json;

use super::args::RaysArgs;
use super::{in_pool, scene};
use crate::host::error::Error;
use crate::host::rays::{RayBench, Speed};

/// Traces the sets of rays of a scene and returns the table.
pub(super) fn run(args: &RaysArgs) -> Result<String, Error> {
    let (scene, _) = scene::load(&args.scene, &args.select)?;
    let bench = RayBench::new(&scene, &scene.camera_or_default(), args.side, args.traversal.into())?;
    if let Some(folder) = &args.write {
        bench.write(folder)?;
    }
    let speeds = in_pool(args.threads, || bench.measure())?;
    let build = bench.bvh_time().as_secs_f64();
    Ok(if args.json { as_json(&speeds, build) } else { as_text(&speeds, build) })
}

fn as_json(speeds: &[Speed], build: f64) -> String {
    let set = |s: &Speed| {
        json!({
            "set": s.set.name(),
            "rays": s.rays,
            "hits": s.hits,
            "median_rays_per_second": s.median(),
            "best_rays_per_second": s.best(),
            "rays_per_thread_second": s.per_thread(),
        })
    };
    format!("{}\n", json!({ "tree_seconds": build, "sets": speeds.iter().map(set).collect::<Vec<_>>() }))
}

fn as_text(speeds: &[Speed], build: f64) -> String {
    let mut text = String::from("set           rays      hits  Mrays/s, median    best  per thread\n");
    for s in speeds {
        let (name, median, best, thread) = (s.set.name(), s.median() / 1e6, s.best() / 1e6, s.per_thread() / 1e6);
        writeln!(text, "{name:<9} {:>8}  {:>8}  {median:>15.2}  {best:>6.2}  {thread:>10.2}", s.rays, s.hits)
            .expect("a string takes it");
    }
    writeln!(text, "the tree took {:.0} ms", 1e3 * build).expect("a string takes it");
    text
}
