//! From tables to kernels: build the generic program once, specialise it, compile what is left.
//!
//! The generic program is the same for every scene (Law 1). It is built when it is first needed and shared by all threads.
//! There are several, so that nobody waits for the entries of a GPU, or of tracers other than the [`TracerKind::COMMON`] ones, who
//! asks for none: see [`super::library`].

use std::sync::Arc;
use std::time::{Duration, Instant};

use jerboa_backend_cranelift as clif;
use jerboa_ir::Program;
use jerboa_ir::lang::build;
use jerboa_peval::{Arg, Generic, Residual, specialize};
use rayon::prelude::*;

use super::clock::thread_time;
use super::code_cache::compile;
use super::device::DeviceKind;
use super::error::Error;
use super::library::Library;
use super::tables::Tables;
use crate::camera::{CameraFn, make_camera};
use crate::components::Components;
use crate::device::both::trace_both;
use crate::device::cpu::{make_cpu_device, trace_light};
use crate::device::megakernel::make_megakernel_device;
use crate::device::stream::make_stream_device;
use crate::device::wavefront::make_wavefront_device;
use crate::schema::declare_all;
use crate::tracer::Tracer;
use crate::tracer::aov::{Aov, make_aov_tracer};
use crate::tracer::bidirectional::{make_eye_tracer, make_light_side_tracer};
use crate::tracer::debug::{Show, make_debug_tracer};
use crate::tracer::light::make_light_tracer;
use crate::tracer::occlusion::make_occlusion_tracer;
use crate::tracer::path::make_path_tracer;

/// What a renderer shows; each has kernels of its own.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum TracerKind {
    /// Light transport.
    #[default]
    Path,
    /// Shading normals, world, (n + 1) / 2.
    Normals,
    /// Base colour.
    Albedo,
    /// Distance from the camera, m.
    Depth,
    /// Light transport, by paths that start at lights: see [`crate::tracer::light`].
    Light,
    /// Light transport, by paths from both sides: see [`crate::tracer::bidirectional`].
    Bidirectional,
    /// Ambient occlusion: the open share of the sky over a surface.
    Occlusion,
    /// For layers of a file: see [`Aov::Normal`].
    AovNormal,
    /// For layers of a file: see [`Aov::Place`].
    AovPlace,
    /// What a tracer of this name shows that a user's crate has registered.
    Own(&'static str),
}

impl TracerKind {
    /// All of the library's.
    pub const ALL: [TracerKind; 9] = [
        TracerKind::Path,
        TracerKind::Normals,
        TracerKind::Albedo,
        TracerKind::Depth,
        TracerKind::Light,
        TracerKind::Bidirectional,
        TracerKind::Occlusion,
        TracerKind::AovNormal,
        TracerKind::AovPlace,
    ];

    /// Those of [`generic`] and [`gpu_generic`], in the order of the entries.
    pub const COMMON: [TracerKind; 1] = [TracerKind::Path];

    /// Those whose light falls on any pixel of the film, not on that of the path alone. They have the device
    /// [`DeviceKind::CpuScalar`] only.
    pub const SPLATTING: [TracerKind; 2] = [TracerKind::Light, TracerKind::Bidirectional];

    /// The others.
    const RARE: [TracerKind; 6] = [
        TracerKind::Normals,
        TracerKind::Albedo,
        TracerKind::Depth,
        TracerKind::Occlusion,
        TracerKind::AovNormal,
        TracerKind::AovPlace,
    ];

    /// Does its light fall on any pixel?
    pub fn is_splatting(self) -> bool {
        TracerKind::SPLATTING.contains(&self)
    }

    /// May its paths start at lights? A user's may.
    pub fn may_start_at_lights(self) -> bool {
        self.is_splatting() || matches!(self, TracerKind::Own(_))
    }

    /// The device that runs it where this one is asked for: another one of the CPU if this one cannot.
    ///
    /// # Errors
    /// When no device of that kind can: those of a GPU have no sums that all paths add to.
    pub fn device(self, asked: DeviceKind) -> Result<DeviceKind, Error> {
        match (self.is_splatting(), asked.is_gpu()) {
            (false, _) => Ok(asked),
            (true, false) => Ok(DeviceKind::CpuScalar),
            (true, true) => {
                let name = self.kernel();
                Err(Error::new(format!("the tracer `{name}` runs on the CPU only: ask for --device cpu")))
            }
        }
    }

    /// Name of its kernel on the scalar device.
    pub fn kernel(self) -> &'static str {
        match self {
            TracerKind::Path => "path",
            TracerKind::Normals => "normals",
            TracerKind::Albedo => "albedo",
            TracerKind::Depth => "depth",
            TracerKind::Light => "light",
            TracerKind::Bidirectional => "bidirectional",
            TracerKind::Occlusion => "occlusion",
            TracerKind::AovNormal => "aov_normal",
            TracerKind::AovPlace => "aov_place",
            TracerKind::Own(name) => name,
        }
    }
}

/// Tracers whose entries are in one generic program.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Entries {
    /// [`TracerKind::COMMON`].
    Common,
    /// The library's others.
    Rare,
    /// Those of a user's crate.
    Own,
}

impl Entries {
    /// All of them.
    pub const ALL: [Entries; 3] = [Entries::Common, Entries::Rare, Entries::Own];

    /// Those with this tracer.
    pub fn of(tracer: TracerKind) -> Entries {
        match tracer {
            TracerKind::Own(_) => Entries::Own,
            _ if TracerKind::COMMON.contains(&tracer) => Entries::Common,
            _ => Entries::Rare,
        }
    }
}

/// The generic program of these components: every entry of the CPU's or the GPU's devices over some tracers, for all scenes.
pub fn program(components: &Components, gpu: bool, entries: Entries) -> Program {
    let author = || {
        declare_all();
        let camera = make_camera();
        let devices = match gpu {
            true => [make_megakernel_device(), make_wavefront_device()],
            false => [make_cpu_device(), make_stream_device()],
        };
        let trace = |name: &str, tracer| devices.iter().for_each(|device| (device.trace)(name, tracer));
        match entries {
            Entries::Common => TracerKind::COMMON.into_iter().for_each(|kind| trace(kind.kernel(), make(kind, camera))),
            Entries::Rare => TracerKind::RARE.into_iter().for_each(|kind| trace(kind.kernel(), make(kind, camera))),
            Entries::Own => components.tracers().iter().for_each(|(name, make)| trace(name, make(camera))),
        }
        if entries == Entries::Rare && !gpu {
            from_lights();
        }
    };
    components.within(|| build(author))
}

/// A tracer of the library whose paths start at the camera.
fn make(kind: TracerKind, camera: CameraFn) -> Tracer {
    match kind {
        TracerKind::Path => make_path_tracer(camera),
        TracerKind::Normals => make_debug_tracer(camera, Show::Normals),
        TracerKind::Albedo => make_debug_tracer(camera, Show::Albedo),
        TracerKind::Depth => make_debug_tracer(camera, Show::Depth),
        TracerKind::Occlusion => make_occlusion_tracer(camera),
        TracerKind::AovNormal => make_aov_tracer(camera, Aov::Normal),
        TracerKind::AovPlace => make_aov_tracer(camera, Aov::Place),
        TracerKind::Light | TracerKind::Bidirectional => unreachable!("paths of theirs start at lights"),
        TracerKind::Own(_) => unreachable!("a user's crate makes it"),
    }
}

/// The entries of the CPU over tracers whose paths start at lights.
fn from_lights() {
    trace_light(TracerKind::Light.kernel(), make_light_tracer());
    let eye = make_eye_tracer(make_camera());
    trace_both(TracerKind::Bidirectional.kernel(), eye, make_light_side_tracer());
}

/// Every entry of the CPU's devices over the common tracers and the library's components.
pub fn every_entry() -> Program {
    program(&Components::new(), false, Entries::Common)
}

/// Every entry of the GPU's devices, likewise.
pub fn every_gpu_entry() -> Program {
    program(&Components::new(), true, Entries::Common)
}

/// The generic program of [`every_entry`], made once.
pub fn generic() -> &'static Generic {
    generic_of(DeviceKind::Cpu, TracerKind::Path)
}

/// The generic program of [`every_gpu_entry`], made once.
pub fn gpu_generic() -> &'static Generic {
    generic_of(DeviceKind::GpuWavefront, TracerKind::Path)
}

/// The generic program of the standard library that has the entries of a tracer on a device.
pub fn generic_of(device: DeviceKind, tracer: TracerKind) -> &'static Generic {
    Library::standard().generic(device, tracer)
}

/// What to keep besides the code.
#[derive(Clone, Copy, Debug, Default)]
pub struct Keep {
    /// The evaluator's log of decisions.
    pub log: bool,
    /// CLIF and disassembly.
    pub dumps: bool,
}

/// A kernel that a device asks for.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Request {
    /// The device.
    pub device: DeviceKind,
    /// The tracer: device and tracer say in which generic program the entry is.
    pub tracer: TracerKind,
    /// Its name.
    pub name: String,
    /// The entry of the generic program.
    pub entry: String,
    /// What is known of the entry's parameters.
    pub args: Vec<Arg>,
}

/// A kernel for one scene, with all that led to it.
pub struct Generated {
    /// Its name.
    pub name: String,
    /// What specialisation left.
    pub residual: Residual,
    /// Machine code; kernels with equal residuals share it.
    pub code: Arc<clif::Code>,
    /// Time that a thread ran for its specialisation.
    pub specialize_time: Duration,
    /// Time that a thread ran for its code; 0 if the code was there already.
    pub codegen_time: Duration,
}

/// Specialise a kernel for these tables.
pub fn residual(tables: &Tables, request: &Request, keep: Keep) -> Result<Residual, Error> {
    let options = jerboa_peval::Options { log: keep.log, ..Default::default() };
    let generic = tables.library.generic(request.device, request.tracer);
    specialize(generic, &request.entry, &request.args, &tables.facts, &options).map_err(|e| Error::new(e.to_string()))
}

/// Kernels, and the wall times of making them.
pub struct Kernels {
    /// One for each request, in order.
    pub kernels: Vec<Arc<Generated>>,
    /// Wall time of specialisation.
    pub specialize_time: Duration,
    /// Wall time of code generation.
    pub codegen_time: Duration,
}

/// Specialise kernels for these tables, in parallel; each with the time that a thread ran for it.
pub fn residuals(tables: &Tables, requests: &[Request], keep: Keep) -> Result<Vec<(Residual, Duration)>, Error> {
    let specialized = |request| {
        let start = thread_time();
        Ok((residual(tables, request, keep)?, thread_time().saturating_sub(start)))
    };
    requests.par_iter().with_max_len(1).map(specialized).collect()
}

/// Specialise and compile kernels for these tables, in parallel.
pub fn generate(tables: &Tables, requests: &[Request], keep: Keep) -> Result<Kernels, Error> {
    let start = Instant::now();
    let residuals = residuals(tables, requests, keep)?;
    let specialize_time = start.elapsed();
    let start = Instant::now();
    let options = clif::Options { dumps: keep.dumps, ..Default::default() };
    let code = compile(&residuals.iter().map(|(r, _)| &r.program).collect::<Vec<_>>(), &options)?;
    let codegen_time = start.elapsed();
    let kernel = |((request, (residual, specialize_time)), (code, codegen_time)): ((&Request, _), _)| Generated {
        name: request.name.clone(),
        residual,
        code,
        specialize_time,
        codegen_time,
    };
    let kernels = requests.iter().zip(residuals).zip(code).map(kernel).map(Arc::new).collect();
    Ok(Kernels { kernels, specialize_time, codegen_time })
}

impl Generated {
    /// The kernel, to be called.
    pub fn kernel(&self) -> clif::Kernel<'_> {
        self.code.kernel(self.compiled()).expect("it is the code of one kernel")
    }

    /// The CLIF of its functions, if dumps were asked for.
    pub fn clif(&self) -> Option<&str> {
        self.code.clif(self.compiled())
    }

    /// The disassembly of its functions, if dumps were asked for.
    pub fn asm(&self) -> Option<&str> {
        self.code.asm(self.compiled())
    }

    /// The name under which it was compiled: that of an equal kernel, perhaps.
    fn compiled(&self) -> &str {
        self.code.reports().next().map_or("", |r| &r.name)
    }
}
