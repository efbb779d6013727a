//! Figure 5: the time of specialisation and of code generation, by scene, device and level of knowledge.
//!
//! Wall times of making all kernels of a renderer, on as many threads as the pool has. Code that an earlier round left is
//! forgotten first; what is made once for all scenes, the generic program, is there already.
//!
//! For a GPU our code ends with SPIR-V, and the driver compiles that: in its pipelines, and some (Mesa's lavapipe) at the first
//! launch of each kernel, one after the other. That is a bar of its own, measured once, where there is a driver. A driver may
//! keep what it has compiled; Mesa's does not if MESA_SHADER_CACHE_DISABLE is true.

use std::time::{Duration, Instant};

use jerboa_scenes::Scene;

use super::devices::DEVICES;
use super::{Chart, Group, LEVELS, Spread};
use crate::host::code_cache::forget_unused;
use crate::host::device::DeviceKind;
use crate::host::error::Error;
use crate::host::generate::{Keep, Request, TracerKind, generate, generic_of, residuals};
use crate::host::gpu;
use crate::host::tables::{Choices, Tables};

/// What making kernels took, and how many bytes of code they are.
struct Made {
    specialize: Duration,
    codegen: Duration,
    bytes: usize,
}

/// Makes the kernels of a device.
fn make(tables: &Tables, device: DeviceKind, requests: &[Request]) -> Result<Made, Error> {
    if !device.is_gpu() {
        let made = generate(tables, requests, Keep::default())?;
        let bytes = made.kernels.iter().flat_map(|k| k.code.reports()).map(|r| r.code_bytes).sum();
        return Ok(Made { specialize: made.specialize_time, codegen: made.codegen_time, bytes });
    }
    let start = Instant::now();
    let residuals = residuals(tables, requests, Keep::default())?;
    let specialize = start.elapsed();
    let start = Instant::now();
    let bytes = gpu::emit(tables, requests, residuals)?.iter().map(|k| 4 * k.words()).sum();
    Ok(Made { specialize, codegen: start.elapsed(), bytes })
}

/// How long a driver takes for these kernels, if the device needs one and there is one.
fn driver(tables: &Tables, device: DeviceKind, requests: &[Request]) -> Result<Option<Duration>, Error> {
    if !device.is_gpu() || !gpu::has_driver() {
        return Ok(None);
    }
    let machine = gpu::RealMachine::new(tables, requests, Keep::default())?;
    let first = machine.warmed()?.iter().map(|(_, [_, first])| *first).sum::<Duration>();
    Ok(Some(machine.pipeline_time + first))
}

/// Makes the kernels of each scene, device and level so often, in turn.
///
/// # Errors
/// When the evaluator or the code generator gives up: a fault of Jerboa, not of the scene; or a GPU is lost.
pub fn measure(scenes: &[Scene], rounds: u32) -> Result<Vec<Chart>, Error> {
    // Those of a GPU in a build that has code for it.
    let devices: Vec<_> = DEVICES.into_iter().filter(|(device, _)| gpu::IS_BUILT || !device.is_gpu()).collect();
    for (device, _) in &devices {
        generic_of(*device, TracerKind::Path);
    }
    let mut groups = Vec::new();
    for scene in scenes {
        let tables = LEVELS.map(|(known, _)| Tables::new(scene, &Choices::default(), known));
        let variants: Vec<_> = devices.iter().flat_map(|d| tables.iter().map(move |t| (d.0, t))).collect();
        let requests: Vec<_> = variants.iter().map(|(d, tables)| d.requests(tables, TracerKind::Path)).collect();
        let mut times = vec![[const { Vec::new() }; 2]; variants.len()];
        let mut sizes = vec![0; variants.len()];
        for _ in 0..rounds {
            for (((device, tables), requests), (times, size)) in
                variants.iter().zip(&requests).zip(times.iter_mut().zip(&mut sizes))
            {
                forget_unused();
                let made = make(tables, *device, requests)?;
                times[0].push(1e3 * made.specialize.as_secs_f64());
                times[1].push(1e3 * made.codegen.as_secs_f64());
                *size = made.bytes;
            }
        }
        let names = devices.iter().flat_map(|(_, device)| LEVELS.map(|(_, level)| format!("{device}, {level}")));
        for (i, name) in names.enumerate() {
            let (device, tables) = variants[i];
            let driver = driver(tables, device, &requests[i])?.map(|time| Spread::once(1e3 * time.as_secs_f64()));
            groups.push(Group {
                name: format!("{}, {name}", scene.name),
                bars: times[i].iter().map(|t| Some(Spread::of(t))).chain([driver]).collect(),
                notes: vec![("kernels".into(), requests[i].len() as f64), ("kB of code".into(), sizes[i] as f64 / 1e3)],
            });
        }
    }
    Ok(vec![Chart {
        title: "Specialisation and code generation".into(),
        unit: "ms",
        stacked: true,
        series: ["specialisation", "code generation", "driver"].map(String::from).to_vec(),
        groups,
    }])
}
