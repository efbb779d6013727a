//! From tables to a renderer: build the generic program once, specialise it, compile what is left.
//!
//! The generic program is the same for every scene (Law 1). It is built when it is first needed and shared by all threads.

use std::sync::LazyLock;
use std::time::{Duration, Instant};

use jerboa_backend_cranelift as clif;
use jerboa_ir::Program;
use jerboa_ir::lang::build;
use jerboa_peval::{Arg, Generic, Residual, specialize};

use super::error::Error;
use super::tables::Tables;
use crate::camera::make_perspective_camera;
use crate::device::cpu::make_cpu_device;
use crate::schema::declare_all;
use crate::tracer::debug::{Show, make_debug_tracer};
use crate::tracer::path::make_path_tracer;

/// What a renderer shows; each is a kernel of its own.
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
}

impl TracerKind {
    /// All of them, in the order of the entries.
    pub const ALL: [TracerKind; 4] = [TracerKind::Path, TracerKind::Normals, TracerKind::Albedo, TracerKind::Depth];

    /// Name of the kernel.
    pub fn kernel(self) -> &'static str {
        match self {
            TracerKind::Path => "path",
            TracerKind::Normals => "normals",
            TracerKind::Albedo => "albedo",
            TracerKind::Depth => "depth",
        }
    }
}

/// Every entry over every component, for all scenes.
pub fn every_entry() -> Program {
    build(|| {
        declare_all();
        let (camera, device) = (make_perspective_camera(), make_cpu_device());
        for kind in TracerKind::ALL {
            let tracer = match kind {
                TracerKind::Path => make_path_tracer(camera),
                TracerKind::Normals => make_debug_tracer(camera, Show::Normals),
                TracerKind::Albedo => make_debug_tracer(camera, Show::Albedo),
                TracerKind::Depth => make_debug_tracer(camera, Show::Depth),
            };
            (device.trace)(kind.kernel(), tracer);
        }
    })
}

/// The generic program.
pub fn generic() -> &'static Generic {
    static GENERIC: LazyLock<Generic> = LazyLock::new(|| Generic::new(every_entry()));
    &GENERIC
}

/// What to keep besides the code.
#[derive(Clone, Copy, Debug, Default)]
pub struct Keep {
    /// The evaluator's log of decisions.
    pub log: bool,
    /// CLIF and disassembly.
    pub dumps: bool,
}

/// A kernel for one scene, with all that led to it.
pub struct Generated {
    /// Name of the kernel.
    pub kernel: &'static str,
    /// What specialisation left.
    pub residual: Residual,
    /// Machine code.
    pub code: clif::Code,
    /// Wall time of specialisation.
    pub specialize_time: Duration,
    /// Wall time of code generation.
    pub codegen_time: Duration,
}

/// Specialise a kernel for these tables.
pub fn residual(tables: &Tables, kind: TracerKind, keep: Keep) -> Result<Residual, Error> {
    let options = jerboa_peval::Options { log: keep.log, ..Default::default() };
    specialize(generic(), kind.kernel(), &[Arg::Unknown, Arg::Unknown], &tables.facts, &options)
        .map_err(|e| Error::new(e.to_string()))
}

/// Specialise and compile a kernel for these tables.
pub fn generate(tables: &Tables, kind: TracerKind, keep: Keep) -> Result<Generated, Error> {
    let start = Instant::now();
    let residual = residual(tables, kind, keep)?;
    let specialize_time = start.elapsed();
    let start = Instant::now();
    let options = clif::Options { dumps: keep.dumps, ..Default::default() };
    let code = clif::compile(&[&residual.program], &options).map_err(|e| Error::new(e.to_string()))?;
    Ok(Generated { kernel: kind.kernel(), residual, code, specialize_time, codegen_time: start.elapsed() })
}
