//! Figure 5: the time of specialisation and of code generation, by scene, device and level of knowledge.
//!
//! Wall times of making all kernels of a renderer, on as many threads as the pool has. Code that an earlier round left is
//! forgotten first; what is made once for all scenes, the generic program, is there already.

use jerboa_scenes::Scene;

use super::{Chart, Group, LEVELS, Spread};
use crate::host::code_cache::forget_unused;
use crate::host::device::DeviceKind;
use crate::host::error::Error;
use crate::host::generate::{Keep, Kernels, TracerKind, generate, generic};
use crate::host::tables::{Choices, Tables};

/// The devices, by the names of the command line.
const DEVICES: [(DeviceKind, &str); 2] = [(DeviceKind::Cpu, "cpu"), (DeviceKind::CpuScalar, "cpu-scalar")];

/// Makes the kernels of each scene, device and level so often, in turn.
///
/// # Errors
/// When the evaluator or the code generator gives up: a fault of Jerboa, not of the scene.
pub fn measure(scenes: &[Scene], rounds: u32) -> Result<Vec<Chart>, Error> {
    generic();
    let mut groups = Vec::new();
    for scene in scenes {
        let tables = LEVELS.map(|(known, _)| Tables::new(scene, &Choices::default(), known));
        let variants: Vec<_> = DEVICES.iter().flat_map(|d| tables.iter().map(move |t| (d.0, t))).collect();
        let mut times = vec![[const { Vec::new() }; 2]; variants.len()];
        let mut sizes = vec![[0; 2]; variants.len()];
        for _ in 0..rounds {
            for (((device, tables), times), size) in variants.iter().zip(&mut times).zip(&mut sizes) {
                forget_unused();
                let requests = device.requests(tables, TracerKind::Path);
                let Kernels { kernels, specialize_time, codegen_time } = generate(tables, &requests, Keep::default())?;
                times[0].push(1e3 * specialize_time.as_secs_f64());
                times[1].push(1e3 * codegen_time.as_secs_f64());
                let bytes = kernels.iter().flat_map(|k| k.code.reports()).map(|r| r.code_bytes).sum();
                *size = [kernels.len(), bytes];
            }
        }
        let names = DEVICES.iter().flat_map(|(_, device)| LEVELS.map(|(_, level)| format!("{device}, {level}")));
        groups.extend(names.zip(times.iter().zip(&sizes)).map(|(name, (times, [kernels, bytes]))| Group {
            name: format!("{}, {name}", scene.name),
            bars: times.iter().map(|t| Some(Spread::of(t))).collect(),
            notes: vec![("kernels".into(), *kernels as f64), ("kB of code".into(), *bytes as f64 / 1e3)],
        }));
    }
    Ok(vec![Chart {
        title: "Specialisation and code generation".into(),
        unit: "ms",
        stacked: true,
        series: ["specialisation", "code generation"].map(String::from).to_vec(),
        groups,
    }])
}
