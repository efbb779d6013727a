//! `jerboa devices`: where this machine can render.

use std::fmt::Write;

use serde_json::{Value, json};

use super::args::DevicesArgs;
use crate::host::native::Native;

/// The devices that need a GPU.
const ON_A_GPU: [&str; 2] = ["gpu-megakernel", "gpu-wavefront"];

/// A GPU, or a driver that stands in for one.
struct Adapter {
    name: String,
    /// What it is, and through what it is reached.
    kind: &'static str,
    system: &'static str,
    driver: String,
    is_gpu: bool,
    /// Whether float operations reach the driver as they stand.
    exact: bool,
    /// Most bytes of a buffer.
    most_bytes: u64,
    /// Why nothing runs on it.
    unfit: Option<String>,
}

/// Lists the devices.
pub(super) fn run(args: &DevicesArgs) -> String {
    let (adapters, none) = adapters();
    let (auto, why) = auto(&adapters);
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    if args.json { as_json(&adapters, none, auto, why, threads) } else { as_text(&adapters, none, auto, why, threads) }
}

/// The adapters, the best first, and what to say if there are none.
#[cfg(feature = "gpu")]
fn adapters() -> (Vec<Adapter>, &'static str) {
    use jerboa_backend_spirv::gpu;
    let adapter = |a: gpu::Adapter| Adapter {
        name: a.name().into(),
        kind: a.kind().name(),
        system: a.system(),
        driver: a.driver().into(),
        is_gpu: a.kind().is_gpu(),
        exact: a.exact(),
        most_bytes: a.most_bytes(),
        unfit: a
            .unfit()
            .map(String::from)
            .or_else(|| gpu::Gpu::open_as(a.clone(), a.mode()).err().map(|e| e.to_string())),
    };
    (gpu::adapters().into_iter().map(adapter).collect(), gpu::NONE)
}

/// None in a build without the feature.
#[cfg(not(feature = "gpu"))]
fn adapters() -> (Vec<Adapter>, &'static str) {
    (Vec::new(), "this build has no code for GPUs: build it with the cargo feature `gpu`")
}

/// A line that says on what GPU devices run here, and that a software driver's speed is no GPU's.
pub(super) fn what_runs_kernels() -> String {
    let (adapters, none) = adapters();
    match adapters.iter().find(|a| a.unfit.is_none()).or(adapters.first()) {
        None => none.into(),
        Some(Adapter { name, unfit: Some(why), .. }) => format!("nothing runs on `{name}`: {why}"),
        Some(Adapter { name, kind, system, driver, is_gpu, .. }) => match is_gpu {
            true => format!("GPU devices run on `{name}`: {kind} through {system}, driver {driver}"),
            false => format!(
                "no GPU speed is claimed: GPU devices run on `{name}`, {kind} through {system}, and not on a GPU"
            ),
        },
    }
}

/// The device that `--device auto` takes, and why.
fn auto(adapters: &[Adapter]) -> (&'static str, &'static str) {
    match adapters.iter().any(|a| a.is_gpu && a.unfit.is_none()) {
        true => (ON_A_GPU[1], "there is a GPU"),
        false if adapters.is_empty() => ("cpu", "there is no GPU"),
        false => ("cpu", "there is no GPU that can run it, and a software driver is slower than the CPU's own devices"),
    }
}

fn as_json(adapters: &[Adapter], none: &str, auto: &str, why: &str, threads: usize) -> String {
    let adapter = |a: &Adapter| {
        json!({
            "name": a.name,
            "kind": a.kind,
            "system": a.system,
            "driver": a.driver,
            "exact": a.exact,
            "largest_buffer_bytes": a.most_bytes,
            "devices": if a.unfit.is_none() { &ON_A_GPU[..] } else { &[] },
            "unfit": a.unfit,
        })
    };
    let all = json!({
        "cpu": { "threads": threads, "native_walk": Native::is_there(), "devices": ["cpu", "cpu-scalar"] },
        "adapters": adapters.iter().map(adapter).collect::<Vec<Value>>(),
        "no_adapter": adapters.is_empty().then_some(none),
        "auto": { "device": auto, "why": why },
    });
    format!("{all}\n")
}

fn as_text(adapters: &[Adapter], none: &str, auto: &str, why: &str, threads: usize) -> String {
    let walk = if Native::is_there() { "with" } else { "without" };
    let mut text =
        format!("CPU: {threads} threads, {walk} AVX-512 for `--traversal native`\n    runs cpu, cpu-scalar\n");
    let mut line = |line: String| writeln!(text, "{line}").expect("a string takes it");
    for a in adapters {
        line(format!("{}: {} through {}", a.name, a.kind, a.system));
        if !a.driver.is_empty() {
            line(format!("    driver {}", a.driver));
        }
        let mode = if a.exact {
            "float operations as they stand (exact mode)"
        } else {
            "float operations as the driver likes"
        };
        line(format!("    {mode}, buffers up to {} MiB", a.most_bytes >> 20));
        line(match &a.unfit {
            None => format!("    runs {}", ON_A_GPU.join(", ")),
            Some(why) => format!("    runs nothing: {why}"),
        });
    }
    if adapters.is_empty() {
        line(none.to_string());
    }
    line(format!("--device auto takes {auto}: {why}"));
    text
}
