//! `jerboa dump`, `jerboa explain`: what the renderer became for a scene, and why.

use std::time::Duration;

use jerboa_backend_cranelift::lanes::{Width, lanes, vectorizes};
use jerboa_ir::{Program, print};
use jerboa_peval::Residual;

use super::args::{DumpArgs, ExplainArgs, KnownArg, StageArg};
use super::scene::{choices_of, load};
use crate::host::device::DeviceKind;
use crate::host::error::Error;
use crate::host::generate::{Keep, Request, TracerKind, generate, generic_of, residual};
use crate::host::gpu;
use crate::host::tables::Tables;

/// The text of a stage, one kernel after the other. The generic program and the residual of one kernel read back.
pub(super) fn dump(args: &DumpArgs) -> Result<String, Error> {
    let (scene, _) = load(&args.scene, &args.select)?;
    let tables = Tables::new(&scene, &choices_of(&args.sampling), args.known.into());
    let on_gpu = matches!(args.stage, StageArg::Structured | StageArg::Naga | StageArg::Spirv);
    let device = if on_gpu { DeviceKind::GpuWavefront } else { DeviceKind::default() };
    let kernels = kernels(&tables, device, args.kernel.as_deref())?;
    match args.stage {
        // The generic program is one for all scenes, and for all kernels of a device over this tracer and its like.
        StageArg::Generic => Ok(print(generic_of(kernels[0].device, kernels[0].tracer).program())),
        StageArg::Clif | StageArg::Asm => {
            let generated = generate(&tables, &kernels, Keep { dumps: true, log: false })?.kernels;
            let dumped = generated.iter().map(|g| if args.stage == StageArg::Clif { g.clif() } else { g.asm() });
            Ok(dumped.map(|text| text.expect("dumps were asked for")).collect())
        }
        stage => kernels.iter().map(|kernel| of_residual(&tables, kernel, stage)).collect(),
    }
}

/// The text of a stage that is made of one residual.
fn of_residual(tables: &Tables, kernel: &Request, stage: StageArg) -> Result<String, Error> {
    let residual = residual(tables, kernel, Keep::default())?;
    match stage {
        StageArg::Structured | StageArg::Naga | StageArg::Spirv => for_gpu(tables, kernel, residual, stage),
        StageArg::Lanes => in_lanes(&residual.program),
        _ => Ok(print(&residual.program)),
    }
}

/// The text of a kernel on its way to a GPU.
fn for_gpu(tables: &Tables, kernel: &Request, residual: Residual, stage: StageArg) -> Result<String, Error> {
    let emitted = gpu::emit(tables, std::slice::from_ref(kernel), vec![(residual, Duration::ZERO)])?;
    let text = |k: &gpu::Emitted| match stage {
        StageArg::Structured => k.structured(),
        StageArg::Naga => k.naga(),
        _ => k.assembly(),
    };
    Ok(emitted.iter().map(text).collect())
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
    let (scene, _) = load(&args.scene, &args.select)?;
    let tables = Tables::new(&scene, &choices_of(&args.sampling), KnownArg::default().into());
    let mut text = String::new();
    for kernel in kernels(&tables, DeviceKind::default(), args.kernel.as_deref())? {
        let residual = residual(&tables, &kernel, Keep { log: true, dumps: false })?;
        text += &format!("kernel {}\n{}{}", kernel.name, residual.log, residual.report);
    }
    Ok(text)
}

/// The kernel of a name, on any device; or all that light transport takes on this one.
fn kernels(tables: &Tables, device: DeviceKind, name: Option<&str>) -> Result<Vec<Request>, Error> {
    let Some(name) = name else { return Ok(device.requests(tables, TracerKind::Path)) };
    let mut all: Vec<Request> = Vec::new();
    for request in DeviceKind::ALL.iter().flat_map(|d| TracerKind::ALL.iter().flat_map(|t| d.requests(tables, *t))) {
        if !all.iter().any(|r| r.name == request.name) {
            all.push(request);
        }
    }
    let names = || all.iter().map(|r| r.name.as_str()).collect::<Vec<_>>().join(", ");
    let found = all.iter().find(|r| r.name == name);
    found
        .map(|r| vec![r.clone()])
        .ok_or_else(|| Error::new(format!("there is no kernel `{name}`; there are {}", names())))
}
