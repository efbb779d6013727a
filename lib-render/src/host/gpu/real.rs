//! A machine that is a GPU.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use jerboa_backend_spirv as spirv;
use jerboa_backend_spirv::gpu;
use jerboa_ir::lang::Buf;
use jerboa_peval::Residual;
use rayon::prelude::*;

use super::packing::Packing;
use super::{Extent, Launch, Machine};
use crate::host::clock::thread_time;
use crate::host::error::Error;
use crate::host::generate::{Keep, Request, residuals};
use crate::host::tables::Tables;
use crate::schema::{BUFFERS, Frame, Next, Paths, Ranges, binding};

impl From<gpu::Error> for Error {
    fn from(error: gpu::Error) -> Error {
        Error::new(error.to_string())
    }
}

/// Has this build code for GPUs?
pub const IS_BUILT: bool = true;

/// Is there a GPU that can run kernels? A driver that runs on the CPU is none.
pub fn is_there() -> bool {
    may_be_there() && gpu::adapters().iter().any(|a| a.kind().is_gpu() && a.unfit().is_none())
}

/// Is there a GPU that can run kernels, or a driver that does so on the CPU?
pub fn has_driver() -> bool {
    gpu::adapters().iter().any(|a| a.unfit().is_none())
}

/// Linux shows a GPU as a file, of its own drivers (DRM), NVIDIA's, or Windows'. Looking there takes microseconds, and asking
/// Vulkan tens of milliseconds, which nobody without a GPU should wait for.
fn may_be_there() -> bool {
    !cfg!(target_os = "linux") || ["/dev/dri", "/dev/nvidiactl", "/dev/dxg"].into_iter().any(|f| Path::new(f).exists())
}

/// A kernel for GPUs, with all that led to it.
pub struct Emitted {
    /// Its name.
    pub name: String,
    /// What specialisation left.
    pub residual: Residual,
    /// Time that a thread ran for its specialisation.
    pub specialize_time: Duration,
    /// Time that a thread ran for its module and SPIR-V.
    pub emit_time: Duration,
    /// What is given to the driver.
    module: spirv::Module,
}

impl Emitted {
    /// Words of SPIR-V.
    pub fn words(&self) -> usize {
        self.module.report().words
    }

    /// Its control flow.
    pub fn structured(&self) -> String {
        self.module.structured()
    }

    /// The naga module, as WGSL.
    pub fn naga(&self) -> String {
        self.module.naga()
    }

    /// Its SPIR-V.
    pub fn assembly(&self) -> String {
        self.module.assembly()
    }
}

/// The modules of kernels for these tables, from their residuals and the times that these took; in parallel.
///
/// # Errors
/// When GPUs cannot run a kernel: which one, and why.
pub fn emit(
    tables: &Tables,
    requests: &[Request],
    residuals: Vec<(Residual, Duration)>,
) -> Result<Vec<Emitted>, Error> {
    emit_packed(&Packing::new(tables, u64::MAX)?, requests, residuals)
}

fn emit_packed(
    packing: &Packing,
    requests: &[Request],
    residuals: Vec<(Residual, Duration)>,
) -> Result<Vec<Emitted>, Error> {
    let options = spirv::Options { packing: spirv::Packing(packing.memories.clone()), ..spirv::Options::default() };
    let one = |(request, (residual, specialize_time)): (&Request, (Residual, Duration))| {
        let start = thread_time();
        let module = spirv::emit(&residual.program, &request.entry, &options).map_err(|e| Error::new(e.to_string()))?;
        let emit_time = thread_time().saturating_sub(start);
        Ok(Emitted { name: request.name.clone(), residual, specialize_time, emit_time, module })
    };
    requests.par_iter().zip(residuals).with_max_len(1).map(one).collect()
}

/// A GPU with the kernels and tables of a scene.
pub struct RealMachine {
    gpu: Arc<gpu::Gpu>,
    emitted: Vec<Emitted>,
    kernels: Vec<gpu::Kernel>,
    packing: Packing,
    /// By the numbers of the packing, from 1 on.
    memories: Vec<gpu::Memory>,
    starts: Vec<u32>,
    rows: Vec<u32>,
    /// Wall time of specialisation.
    pub specialize_time: Duration,
    /// Wall time of modules and their SPIR-V.
    pub emit_time: Duration,
    /// Wall time of the driver's pipelines.
    pub pipeline_time: Duration,
}

impl RealMachine {
    /// The best adapter, with these kernels and tables.
    ///
    /// # Errors
    /// When there is no adapter, it has not enough memory, or a kernel is not for it.
    pub fn new(tables: &Tables, requests: &[Request], keep: Keep) -> Result<RealMachine, Error> {
        let start = Instant::now();
        let (gpu, residuals) = rayon::join(|| gpu::Gpu::open(&gpu::Choice::Any), || residuals(tables, requests, keep));
        let (gpu, residuals) = (gpu?, residuals?);
        let specialize_time = start.elapsed();
        let start = Instant::now();
        let packing = Packing::new(tables, gpu.adapter().most_bytes())?;
        let emitted = emit_packed(&packing, requests, residuals)?;
        let emit_time = start.elapsed();
        let start = Instant::now();
        let kernels = emitted.par_iter().with_max_len(1).map(|k| gpu.kernel(&k.module)).collect::<Result<_, _>>()?;
        let pipeline_time = start.elapsed();
        let mut machine = RealMachine {
            emitted,
            kernels,
            memories: packing.tables.iter().map(|words| gpu.memory(*words)).collect::<Result<_, _>>()?,
            starts: packing.starts.clone(),
            rows: tables.memory.iter().map(|m| m.rows).collect(),
            gpu,
            packing,
            specialize_time,
            emit_time,
            pipeline_time,
        };
        for (buffer, memory) in tables.memory.iter().enumerate() {
            machine.write(buffer, &memory.words)?;
        }
        machine.reserve(&[])?;
        Ok(machine)
    }

    /// The kernels, as [`crate::host::device::DeviceKind::requests`] lists them; of each the wall time of the driver's pipeline,
    /// and that of a first launch with nothing to do, since some drivers compile only then.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn warmed(&self) -> Result<Vec<(&Emitted, [Duration; 2])>, Error> {
        let all = self.emitted.iter().zip(&self.kernels);
        all.map(|(emitted, kernel)| Ok((emitted, [kernel.pipeline_time(), self.gpu.warm(kernel)?]))).collect()
    }

    fn write(&self, buffer: usize, words: &[u32]) -> Result<(), Error> {
        if words.is_empty() {
            return Ok(());
        }
        Ok(self.gpu.write(self.memory(buffer), self.starts[buffer], words)?)
    }

    fn memory(&self, buffer: usize) -> &gpu::Memory {
        &self.memories[self.packing.memories[buffer] as usize - 1]
    }
}

impl Machine for RealMachine {
    fn most_bytes(&self) -> u64 {
        self.gpu.adapter().most_bytes()
    }

    fn reserve(&mut self, rows: &[(usize, u32)]) -> Result<(), Error> {
        let grows = rows.iter().any(|(stream, rows)| self.rows[*stream] < *rows);
        if !grows && self.memories.len() > self.packing.tables.len() {
            return Ok(());
        }
        for (stream, rows) in rows {
            self.rows[*stream] = self.rows[*stream].max(*rows);
        }
        let (starts, words) = self.packing.streams(&self.rows);
        // What is there goes first.
        self.memories.truncate(self.packing.tables.len());
        for words in words {
            self.memories.push(self.gpu.memory(words)?);
        }
        self.starts = starts;
        Ok(())
    }

    fn set_frame(&mut self, words: &[u32]) -> Result<(), Error> {
        self.write(binding::<Frame>(), words)
    }

    fn run(&mut self, passes: &[Vec<Launch>]) -> Result<(), Error> {
        let bound = |buffer: usize| {
            let (start, rows) = (self.starts[buffer], self.rows[buffer]);
            gpu::Bound { memory: self.memory(buffer), start, rows }
        };
        let buffers: Vec<gpu::Bound> = (0..BUFFERS.len()).map(bound).collect();
        let mut swapped = buffers.clone();
        swapped.swap(binding::<Paths>(), binding::<Next>());
        let launch = |launch: &Launch| gpu::Launch {
            kernel: &self.kernels[launch.kernel],
            arguments: launch.arguments.clone(),
            buffers: if launch.swapped { &swapped } else { &buffers },
            results: None,
            extent: match launch.extent {
                Extent::Items(items) => gpu::Extent::Items(items),
                Extent::Range(range) => {
                    let word = range * Ranges::COLUMNS.len() as u32 + Ranges::GROUPS_X.0;
                    let grids = binding::<Ranges>();
                    gpu::Extent::Indirect { memory: self.memory(grids), word: self.starts[grids] + word }
                }
            },
        };
        let passes: Vec<Vec<gpu::Launch>> = passes.iter().map(|pass| pass.iter().map(launch).collect()).collect();
        Ok(self.gpu.run(&passes)?)
    }

    fn read(&mut self, stream: usize, rows: Range<u32>) -> Result<Vec<u32>, Error> {
        let (start, columns) = (self.starts[stream], BUFFERS[stream].3.len() as u32);
        Ok(self.gpu.read(self.memory(stream), start + rows.start * columns..start + rows.end * columns)?)
    }
}
