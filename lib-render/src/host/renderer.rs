//! A renderer in this process: load a scene, specialise, render.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use jerboa_scenes::{Camera, Scene};
use rayon::prelude::*;

use super::device::{DeviceKind, Traversal};
use super::error::Error;
use super::film::{Film, Window};
use super::generate::{Generated, Keep, Kernels, TracerKind, generate};
use super::gpu::{self, RealMachine, Schedule};
use super::learn::Learner;
use super::learn::lessons::Lessons;
use super::library::Library;
use super::scalar;
use super::splats;
use super::tables::{CameraKind, Choices, Known, Pass, Tables, frame};
use super::wave::Wave;
use super::work::{Tiles, Whole, Work};

/// Options of a renderer.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// What the renderer is specialised for.
    pub known: Known,
    /// What it shows.
    pub tracer: TracerKind,
    /// Choices that a kernel sees.
    pub choices: Choices,
    /// Samples per pixel that [`Renderer::render`] adds.
    pub spp: u32,
    /// Seed: another one gives another, independent image.
    pub seed: u32,
    /// What to keep for dumps.
    pub keep: Keep,
    /// Where it runs.
    pub device: DeviceKind,
    /// Who walks the tree there.
    pub traversal: Traversal,
    /// How the device cuts its work. The image does not depend on it.
    pub cut: Cut,
}

/// How a device cuts its work.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Cut {
    /// Side of a tile in pixels.
    pub tile: u32,
    /// Paths in flight on each thread, at least 1.
    pub slots: u32,
}

impl Default for Cut {
    fn default() -> Cut {
        Cut { tile: 16, slots: 4096 }
    }
}

impl Default for Options {
    /// Light transport, specialised for structure, 64 samples per pixel.
    fn default() -> Options {
        Options {
            known: Known::default(),
            tracer: TracerKind::default(),
            choices: Choices::default(),
            spp: 64,
            seed: 0,
            keep: Keep::default(),
            device: DeviceKind::default(),
            traversal: Traversal::default(),
            cut: Cut::default(),
        }
    }
}

/// A renderer that has written itself for one scene. It can be used from several threads at once.
pub struct Renderer {
    pub(super) options: Options,
    pub(super) tables: Tables,
    pub(super) device: Device,
    /// What renders have taught, where it learns.
    pub(super) lessons: Lessons,
    /// Wall time of laying the scene out, without the tree.
    pub tables_time: Duration,
    /// Wall time of specialisation, and of waiting for the generic program where this is the first renderer of the process.
    pub specialize_time: Duration,
    /// Wall time of code generation; on a GPU with that of the driver's pipelines.
    pub codegen_time: Duration,
}

/// A device with its kernels.
pub(super) enum Device {
    Cpu(Wave),
    CpuScalar(Arc<Generated>),
    /// One render at a time.
    Gpu(Box<Mutex<gpu::Device<RealMachine>>>),
}

impl Device {
    /// Kernels as [`DeviceKind::requests`] lists them, for a device of the CPU.
    pub(super) fn new(mut kernels: Vec<Arc<Generated>>, options: &Options) -> Device {
        match options.device {
            DeviceKind::CpuScalar => Device::CpuScalar(kernels.remove(0)),
            _ => Device::Cpu(Wave::new(kernels, options.cut.slots)),
        }
    }

    /// The device for these tables, and the wall times of specialisation and of code generation.
    pub(super) fn made(tables: &Tables, options: &Options) -> Result<(Device, Duration, Duration), Error> {
        check_tracer(tables, options)?;
        let requests = options.device.requests(tables, options.tracer);
        if options.device.is_gpu() {
            let machine = RealMachine::new(tables, &requests, options.keep)?;
            let times = (machine.specialize_time, machine.emit_time + machine.pipeline_time);
            let device = gpu::Device::new(machine, Schedule::of(options.device, &requests));
            return Ok((Device::Gpu(Box::new(Mutex::new(device))), times.0, times.1));
        }
        let Kernels { kernels, specialize_time, codegen_time } = generate(tables, &requests, options.keep)?;
        Ok((Device::new(kernels, options), specialize_time, codegen_time))
    }
}

/// Can the tracer that is asked for render what is in these tables?
pub(super) fn check_tracer(tables: &Tables, options: &Options) -> Result<(), Error> {
    if options.tracer.is_splatting() && tables.camera != CameraKind::Pinhole {
        return Err(Error::new("paths from lights end in pinholes only: choose another camera or tracer"));
    }
    if options.tracer.is_splatting() && options.choices.cull_back_faces {
        return Err(Error::new("back faces are culled for paths from the camera only: choose another tracer"));
    }
    if options.tracer == TracerKind::Bidirectional && tables.lights.shapes + tables.lights.suns > 0 {
        return Err(Error::new(
            "the bidirectional tracer does not know lights with a size (extras.radius, extras.angle): choose another \
             tracer, or take the sizes away",
        ));
    }
    if let (TracerKind::Bidirectional, Some(name)) = (options.tracer, tables.own_light()) {
        return Err(Error::new(format!(
            "light \"{name}\" is of a user's crate, and the bidirectional tracer cannot weigh what it does not know: choose the \
             path tracer or the light tracer, or take the light away"
        )));
    }
    Ok(())
}

/// Which samples to render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Render {
    /// Number of the first sample.
    pub sample: u32,
    /// Samples per pixel.
    pub spp: u32,
    /// Seed: another one gives another, independent image.
    pub seed: u32,
}

/// Watches a render from another thread, and can end it.
#[derive(Debug, Default)]
pub struct Handle {
    cancelled: Arc<AtomicBool>,
    done: AtomicU64,
}

impl Handle {
    /// Ask the render to end soon; the film then holds whole passes of some tiles.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Was it asked to end?
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// One for work that is not counted; it ends with this one.
    pub(super) fn unheard(&self) -> Handle {
        Handle { cancelled: self.cancelled.clone(), done: AtomicU64::new(0) }
    }

    /// So many samples more are finished.
    pub(crate) fn add_done(&self, samples: u64) {
        self.done.fetch_add(samples, Ordering::Relaxed);
    }

    /// Samples finished so far, over all pixels.
    pub fn samples_done(&self) -> u64 {
        self.done.load(Ordering::Relaxed)
    }
}

/// What a render did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stats {
    /// Samples per pixel that every pixel of the film has got.
    pub spp: u32,
    /// Closest-hit rays.
    pub closest_rays: u64,
    /// Shadow rays.
    pub shadow_rays: u64,
    /// Wall time.
    pub time: Duration,
}

/// What a pass is made with.
pub(super) struct With<'a> {
    pub tables: &'a Tables,
    pub device: &'a Device,
    /// Who watches its paths, if anyone does.
    pub learner: Option<Arc<Learner>>,
}

/// What looks at a film after each pass, see [`Renderer::render_on`].
pub type After<'a> = dyn FnMut(&Film, u32) -> Result<ControlFlow<()>, Error> + 'a;

/// Most samples of a pixel in one pass over a tile. The first passes are shorter, so that a render that is ended early has
/// a sample everywhere.
pub(super) const SAMPLES_PER_PASS: u32 = 16;

impl Renderer {
    /// Lay out the scene, specialise the renderer for it and compile it.
    ///
    /// # Errors
    /// When the scene names a component that there is not; the evaluator or the code generator gives up: a fault of Jerboa,
    /// not of the scene; or there is no GPU, or one too small for the scene, where one is asked for.
    pub fn new(scene: &Scene, options: Options) -> Result<Renderer, Error> {
        Renderer::of(Library::standard(), scene, options)
    }

    /// Likewise, of the components of this library.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn of(library: &Library, scene: &Scene, options: Options) -> Result<Renderer, Error> {
        library.check(scene, options.tracer)?;
        let options = Options { device: options.tracer.device(options.device)?, ..options };
        let start = Instant::now();
        let traversal = match options.device {
            DeviceKind::Cpu => options.traversal,
            _ => Traversal::Ir,
        };
        let whole_sky = options.choices.whole_sky || options.tracer.may_start_at_lights();
        let learned_roulette = options.choices.learned_roulette && options.tracer == TracerKind::Path;
        let options = Options { choices: Choices { whole_sky, learned_roulette, ..options.choices }, ..options };
        let lay_out = || (Tables::of(library, scene, &options.choices, options.known, traversal), Instant::now());
        // The generic program is made once in a process, and no scene is needed for it.
        let ((tables, laid_out), _) = rayon::join(lay_out, || _ = library.generic(options.device, options.tracer));
        let tables_time = (laid_out - start).saturating_sub(tables.bvh_time);
        let waited = laid_out.elapsed();
        let (device, specialize_time, codegen_time) = Device::made(&tables, &options)?;
        let specialize_time = waited + specialize_time;
        let lessons = Lessons::default();
        Ok(Renderer { options, tables, device, lessons, tables_time, specialize_time, codegen_time })
    }

    /// A renderer of the same scene that shows something else. Tables are shared.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn showing(&self, tracer: TracerKind) -> Result<Renderer, Error> {
        let options = Options { tracer, device: tracer.device(self.options.device)?, ..self.options };
        let tables = self.tables.clone();
        tables.library.check_tracer(tracer)?;
        let (device, specialize_time, codegen_time) = Device::made(&tables, &options)?;
        let lessons = Lessons::default();
        Ok(Renderer { options, tables, device, lessons, tables_time: Duration::ZERO, specialize_time, codegen_time })
    }

    /// The scene's tables.
    pub fn tables(&self) -> &Tables {
        &self.tables
    }

    /// The kernels of a device of the CPU, their residuals and reports, as [`DeviceKind::requests`] lists them; none of a GPU's.
    pub fn kernels(&self) -> &[Arc<Generated>] {
        match &self.device {
            Device::Cpu(wave) => wave.kernels(),
            Device::CpuScalar(kernel) => std::slice::from_ref(kernel),
            Device::Gpu(_) => &[],
        }
    }

    /// Add as many samples as the options say, those that follow on what the film has: tiles in parallel on rayon's
    /// current pool.
    ///
    /// # Errors
    /// As [`Renderer::render_with`].
    pub fn render(&self, camera: &Camera, film: &mut Film) -> Result<Stats, Error> {
        let Options { spp, seed, .. } = self.options;
        let job = Render { sample: film.next_sample(), spp, seed };
        self.render_with(camera, film, job, &Handle::default())
    }

    /// Add these samples, with a handle on it. A cancelled render is no error: the film holds what was done.
    ///
    /// # Errors
    /// When the camera is not of the kind that the renderer is specialised for, the samples reach beyond 2^32, a kernel gives up: a fault of Jerboa, or the GPU is lost or out of memory.
    pub fn render_with(&self, camera: &Camera, film: &mut Film, job: Render, handle: &Handle) -> Result<Stats, Error> {
        self.render_on(camera, film, job, 0, handle, &mut |_, _| Ok(ControlFlow::Continue(())))
    }

    /// As [`Renderer::render_with`], of a film that has the first `done` samples of the job. After each pass that was
    /// completed `after` sees the film and the number of the job's samples in it, and says whether to go on. On every device
    /// a pass ends at each multiple of 16.
    ///
    /// # Errors
    /// As [`Renderer::render_with`], and those of `after`.
    pub fn render_on(
        &self,
        camera: &Camera,
        film: &mut Film,
        job: Render,
        done: u32,
        handle: &Handle,
        after: &mut After<'_>,
    ) -> Result<Stats, Error> {
        if job.sample.checked_add(job.spp).is_none() {
            let Render { sample, spp, .. } = job;
            return Err(Error::new(format!("{spp} samples from number {sample} on reach beyond 2^32: ask for fewer")));
        }
        let start = Instant::now();
        let mut stats = Stats { spp: done, ..Stats::default() };
        let (size, window) = (film.size(), film.window());
        // Who leaves sums leaves one for all samples of a pass.
        let at_once = if film.groups() > 1 && self.leaves_sums() { 1 } else { SAMPLES_PER_PASS };
        let mut first = done;
        while first < job.spp && !handle.is_cancelled() {
            let samples = first.clamp(1, at_once).min(job.spp - first);
            let pass = Pass { size, window, sample: job.sample + first, samples, seed: job.seed };
            let (complete, [closest, shadow]) = self.learning(camera, film, pass, handle)?;
            stats.closest_rays += closest;
            stats.shadow_rays += shadow;
            first += samples;
            if complete {
                stats.spp = first;
                if after(film, first)?.is_break() {
                    break;
                }
            }
        }
        film.asked_below(job.sample + first);
        stats.time = start.elapsed();
        Ok(stats)
    }

    /// Does the device sum the samples of a pixel itself, or light of any pixel?
    fn leaves_sums(&self) -> bool {
        matches!(self.device, Device::Gpu(_)) || self.options.tracer.is_splatting()
    }

    /// Add one pass. Says whether it was completed, and how many closest-hit and shadow rays it took.
    pub(super) fn pass(
        &self,
        camera: &Camera,
        film: &mut Film,
        pass: Pass,
        handle: &Handle,
    ) -> Result<(bool, [u64; 2]), Error> {
        let with = With { tables: &self.tables, device: &self.device, learner: None };
        self.pass_with(with, camera, film, pass, handle)
    }

    /// Likewise, with these.
    pub(super) fn pass_with(
        &self,
        With { tables, device, learner }: With<'_>,
        camera: &Camera,
        film: &mut Film,
        pass: Pass,
        handle: &Handle,
    ) -> Result<(bool, [u64; 2]), Error> {
        self.tables.camera.check(camera)?;
        if let Device::Gpu(device) = device {
            let frame = frame(camera, self.tables.place(camera), &pass).words;
            let mut device = device.lock().unwrap_or_else(PoisonError::into_inner);
            return device.pass(film, &pass, &frame, handle);
        }
        if let (Device::CpuScalar(kernel), true) = (device, self.options.tracer.is_splatting()) {
            return splats::pass(kernel, &self.tables, camera, film, pass, self.options.cut.tile, handle);
        }
        let tiles = Tiles::new(camera, self.tables.place(camera), pass, self.options.cut.tile, film, handle);
        let tiles = tiles.teaching(learner);
        (0..rayon::current_num_threads())
            .into_par_iter()
            .with_max_len(1)
            .try_for_each(|_| run(device, tables, &mut tiles.worker()))?;
        Ok((tiles.is_complete(), tiles.rays()))
    }

    /// What the device leaves for each sample of a pass, but for light that falls on other pixels: the words of the stream [`crate::schema::Samples`], column by column.
    ///
    /// # Errors
    /// When the camera is of another kind, or a kernel gives up: a fault of Jerboa; or on a GPU, which leaves sums of pixels.
    pub fn samples(&self, camera: &Camera, pass: &Pass) -> Result<Vec<u32>, Error> {
        self.tables.camera.check(camera)?;
        let mut work = Whole::new(camera, self.tables.place(camera), pass);
        if let (Device::CpuScalar(kernel), true) = (&self.device, self.options.tracer.is_splatting()) {
            let [width, height] = pass.size;
            let mut all = splats::buffer(Window { x: 0, y: 0, width, height })?;
            scalar::run(kernel, &self.tables, &mut work, &mut all)?;
            return Ok(work.words);
        }
        run(&self.device, &self.tables, &mut work)?;
        Ok(work.words)
    }
}

/// Do some work on this thread.
fn run(device: &Device, tables: &Tables, work: &mut impl Work) -> Result<(), Error> {
    match device {
        Device::Cpu(wave) => wave.run(tables, work),
        Device::CpuScalar(kernel) => scalar::run(kernel, tables, work, &mut []),
        Device::Gpu(_) => Err(Error::new("a GPU leaves sums of pixels, no samples: ask a device of the CPU")),
    }
}
