//! A machine that is a GPU.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use jerboa_backend_spirv as spirv;
use jerboa_backend_spirv::gpu;
use jerboa_ir::Program;
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

/// Is there a GPU that can run kernels? A driver that runs on the CPU is none.
pub fn is_there() -> bool {
    may_be_there() && gpu::adapters().iter().any(|a| a.kind().is_gpu() && a.unfit().is_none())
}

/// Linux shows a GPU as a file, of its own drivers (DRM), NVIDIA's, or Windows'. Looking there takes microseconds, and asking
/// Vulkan tens of milliseconds, which nobody without a GPU should wait for.
fn may_be_there() -> bool {
    !cfg!(target_os = "linux") || ["/dev/dri", "/dev/nvidiactl", "/dev/dxg"].into_iter().any(|f| Path::new(f).exists())
}

/// A kernel on a GPU, with all that led to it.
pub struct OnGpu {
    /// Its name.
    pub name: String,
    /// What specialisation left.
    pub residual: Residual,
    /// What is given to the driver.
    pub module: spirv::Module,
    /// Time that a thread ran for its specialisation.
    pub specialize_time: Duration,
    /// Time that a thread ran for its module and SPIR-V.
    pub emit_time: Duration,
    kernel: gpu::Kernel,
}

impl OnGpu {
    /// Wall time of the driver's pipeline.
    pub fn pipeline_time(&self) -> Duration {
        self.kernel.pipeline_time()
    }
}

/// A GPU with the kernels and tables of a scene.
pub struct RealMachine {
    gpu: Arc<gpu::Gpu>,
    kernels: Vec<OnGpu>,
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

/// The text of a kernel on its way to a GPU.
///
/// # Errors
/// When GPUs cannot run it: which kernel, and why.
pub fn emit(tables: &Tables, program: &Program, entry: &str) -> Result<spirv::Module, Error> {
    emit_packed(&Packing::new(tables, u64::MAX)?, program, entry)
}

fn emit_packed(packing: &Packing, program: &Program, entry: &str) -> Result<spirv::Module, Error> {
    let packing = spirv::Packing(packing.memories.clone());
    let options = spirv::Options { packing, ..spirv::Options::default() };
    spirv::emit(program, entry, &options).map_err(|e| Error::new(e.to_string()))
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
        let timed = |request: &Request, residual: &Residual| {
            let start = thread_time();
            let module = emit_packed(&packing, &residual.program, &request.entry)?;
            Ok((module, thread_time().saturating_sub(start)))
        };
        let modules = requests.par_iter().zip(&residuals).with_max_len(1).map(|(request, (r, _))| timed(request, r));
        let modules = modules.collect::<Result<Vec<_>, Error>>()?;
        let emit_time = start.elapsed();
        let start = Instant::now();
        let made = modules.par_iter().with_max_len(1).map(|(module, _)| gpu.kernel(module));
        let made = made.collect::<Result<Vec<gpu::Kernel>, _>>()?;
        let pipeline_time = start.elapsed();
        let all = requests.iter().zip(residuals).zip(modules.into_iter().zip(made));
        let one = |((request, (residual, specialize_time)), ((module, emit_time), kernel)): ((&Request, _), _)| OnGpu {
            name: request.name.clone(),
            residual,
            module,
            specialize_time,
            emit_time,
            kernel,
        };
        let mut machine = RealMachine {
            kernels: all.map(one).collect(),
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

    /// The kernels, as [`crate::host::device::DeviceKind::requests`] lists them.
    pub fn kernels(&self) -> &[OnGpu] {
        &self.kernels
    }

    /// Wall time that the driver takes until it launches a kernel for the first time, with nothing to do: some compile only then.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn first_launch(&self, kernel: &OnGpu) -> Result<Duration, Error> {
        Ok(self.gpu.warm(&kernel.kernel)?)
    }

    /// What it runs on: the adapter's name, and how kernels reach it.
    pub fn name(&self) -> String {
        format!("{}, {} mode", self.gpu.adapter().name(), self.gpu.mode().name())
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
            kernel: &self.kernels[launch.kernel].kernel,
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
