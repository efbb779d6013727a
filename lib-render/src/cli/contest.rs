//! `jerboa bench devices`: CPU and GPU side by side.

use serde_json::json;

use super::args::BenchDevicesArgs;
use super::{devices, figures, in_pool, scene};
use crate::host::error::Error;
use crate::host::figures::Chart;
use crate::host::figures::devices::{DEVICES, measure};

/// Measures and tells the speed of each device, how far it is off, and what ran it.
pub(super) fn run(args: &BenchDevicesArgs) -> Result<String, Error> {
    let (mut groups, mut remarks) = (Vec::new(), Vec::new());
    for path in figures::names(&args.rendered.scenes) {
        let scene = scene::load(path, &args.rendered.select)?.0;
        let job = args.rendered.job(&scene);
        let outcome = in_pool(args.threads, || measure(&scene, &job))?;
        groups.push(outcome.group);
        outcome.missing.into_iter().for_each(|why| {
            if !remarks.contains(&why) {
                remarks.push(why);
            }
        });
    }
    let series = DEVICES.map(|(_, name)| name.to_string()).into();
    let chart = Chart { title: "Whole renders".into(), unit: "Msamples/s", stacked: false, series, groups };
    remarks.insert(0, devices::what_runs_kernels());
    remarks.extend(verdicts(&chart));
    let charts = [chart];
    Ok(match args.json {
        true => format!("{}\n", json!({ "charts": figures::json_of(&charts), "remarks": remarks })),
        false => format!("{}\n{}\n", figures::as_text(&charts), remarks.join("\n")),
    })
}

/// Whether a device's images are the CPU's.
fn verdicts(chart: &Chart) -> Vec<String> {
    let verdict = |name: &String| {
        let note = format!("{name} off");
        let offs = chart.groups.iter().flat_map(|g| &g.notes).filter(|(n, _)| *n == note).map(|(_, off)| *off);
        let worst = offs.reduce(f64::max)?;
        Some(match worst {
            0.0 => format!("{name}: all images equal those of {}, bit for bit", chart.series[0]),
            _ => format!("{name}: images differ from those of {}, by up to {worst:.1e} of the mean", chart.series[0]),
        })
    };
    chart.series[1..].iter().filter_map(verdict).collect()
}
