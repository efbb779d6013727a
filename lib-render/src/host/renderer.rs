//! A renderer in this process: load a scene, specialise, render.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use jerboa_backend_cranelift::{Binding, Status};
use jerboa_ir::lang::Buf;
use jerboa_scenes::{Camera, Scene};
use rayon::prelude::*;

use super::error::Error;
use super::film::{Film, Window};
use super::generate::{Generated, Keep, TracerKind, generate};
use super::tables::{Choices, Known, Pass, Tables, frame};
use crate::schema::{BUFFERS, Frame, Samples, binding};

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
        }
    }
}

/// A renderer that has written itself for one scene. It can be used from several threads at once.
pub struct Renderer {
    options: Options,
    tables: Tables,
    generated: Generated,
    /// Wall time of laying the scene out, without the tree.
    pub tables_time: Duration,
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
    cancelled: AtomicBool,
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

/// Side of a tile in pixels: a pass over one of its rows is little enough to wait for when a render is cancelled, and costs far
/// more than starting it.
const TILE: u32 = 16;

/// Most samples of a pixel in one pass over a tile. The first passes are shorter, so that a render that is ended early has
/// a sample everywhere.
const SAMPLES_PER_PASS: u32 = 16;

impl Renderer {
    /// Lay out the scene, specialise the renderer for it and compile it.
    ///
    /// # Errors
    /// When the evaluator or the code generator gives up: a fault of Jerboa, not of the scene.
    pub fn new(scene: &Scene, options: Options) -> Result<Renderer, Error> {
        let start = Instant::now();
        let tables = Tables::new(scene, &options.choices, options.known);
        let tables_time = start.elapsed().saturating_sub(tables.bvh_time);
        let generated = generate(&tables, options.tracer, options.keep)?;
        Ok(Renderer { options, tables, generated, tables_time })
    }

    /// The scene's tables.
    pub fn tables(&self) -> &Tables {
        &self.tables
    }

    /// The kernel, its residual and its reports.
    pub fn generated(&self) -> &Generated {
        &self.generated
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
    /// When the samples reach beyond 2^32, or the kernel gives up: a fault of Jerboa.
    pub fn render_with(&self, camera: &Camera, film: &mut Film, job: Render, handle: &Handle) -> Result<Stats, Error> {
        if job.sample.checked_add(job.spp).is_none() {
            let Render { sample, spp, .. } = job;
            return Err(Error::new(format!("{spp} samples from number {sample} on reach beyond 2^32: ask for fewer")));
        }
        let start = Instant::now();
        let mut stats = Stats::default();
        let (size, tiles) = (film.size(), tiles(film.window()));
        let mut first = 0;
        while first < job.spp && !handle.is_cancelled() {
            let samples = first.clamp(1, SAMPLES_PER_PASS).min(job.spp - first);
            let passes: Vec<Option<TileResult>> = tiles
                .par_iter()
                .map(|window| {
                    let pass = Pass { size, window: *window, sample: job.sample + first, samples, seed: job.seed };
                    let tile = self.tile(camera, &pass, handle)?;
                    if tile.is_some() {
                        handle.done.fetch_add(window.area() as u64 * u64::from(samples), Ordering::Relaxed);
                    }
                    Ok(tile)
                })
                .collect::<Result<_, Error>>()?;
            let whole = passes.iter().all(Option::is_some);
            for tile in passes.into_iter().flatten() {
                stats.closest_rays += tile.closest;
                stats.shadow_rays += tile.shadow;
                film.merge(&tile.film)?;
            }
            first += samples;
            if whole {
                stats.spp = first;
            }
        }
        film.asked_below(job.sample + first);
        stats.time = start.elapsed();
        Ok(stats)
    }

    /// One pass over a tile, row by row; none if the render was cancelled meanwhile.
    fn tile(&self, camera: &Camera, pass: &Pass, handle: &Handle) -> Result<Option<TileResult>, Error> {
        let mut out = TileResult { film: Film::new(pass.window), closest: 0, shadow: 0 };
        for y in pass.window.y..pass.window.y + pass.window.height {
            if handle.is_cancelled() {
                return Ok(None);
            }
            self.row(camera, &Pass { window: Window { y, height: 1, ..pass.window }, ..*pass }, &mut out)?;
        }
        Ok(Some(out))
    }

    /// One pass over a row of a tile, so few rays that cancelling need not end it (accuracy.md, N22): run the kernel over its
    /// items and add what it leaves.
    fn row(&self, camera: &Camera, pass: &Pass, out: &mut TileResult) -> Result<(), Error> {
        let items = pass.window.area() * pass.samples as usize;
        let samples = self.samples(camera, pass)?;
        let column = |c: usize, i: usize| samples[c * items + i];
        for i in 0..items {
            let at = [pass.window.x + i as u32 / pass.samples, pass.window.y];
            out.film.add(at, [0, 1, 2].map(|c| f32::from_bits(column(c, i))));
            out.closest += u64::from(column(3, i));
            out.shadow += u64::from(column(4, i));
        }
        Ok(())
    }

    /// What the kernel leaves for each sample of a pass: the words of the stream [`Samples`], column by column.
    pub fn samples(&self, camera: &Camera, pass: &Pass) -> Result<Vec<u32>, Error> {
        let items = pass.window.area() * pass.samples as usize;
        let mut samples = vec![0_u32; items * Samples::COLUMNS.len()];
        let mut frame = frame(camera, self.tables.origin, pass).words;
        self.call(&mut frame, &mut samples, items as u32)?;
        Ok(samples)
    }

    /// Run the kernel over items 0 .. count.
    fn call(&self, frame: &mut [u32], samples: &mut [u32], count: u32) -> Result<(), Error> {
        let table = |words: &[u32], rows: u32| Binding { words: words.as_ptr().cast_mut(), rows };
        let mut bindings: Vec<Binding> = self.tables.memory.iter().map(|m| table(&m.words, m.rows)).collect();
        bindings[binding::<Frame>()] = Binding::new(frame, 1);
        bindings[binding::<Samples>()] = Binding::new(samples, count);
        assert_eq!(bindings.len(), BUFFERS.len());
        let kernel = self.generated.code.kernel(self.generated.kernel).expect("it was compiled under this name");
        // SAFETY: each binding holds as many rows as it says, of the columns that the schema declares (`Tables::new`, tested);
        // only the stream is written, and it is this call's own. Unchecked indices come from the tree, whose children and
        // slots are in range by construction (`Bvh::build`). Threads of rayon and the main thread have the stack it asks for.
        match unsafe { kernel.call(&bindings, &[0, count], &mut []) } {
            Status::Done => Ok(()),
            Status::Limit => {
                Err(Error::new("the kernel recursed beyond its limit: a fault of Jerboa, please report the scene"))
            }
        }
    }
}

/// What a pass over a tile left.
struct TileResult {
    film: Film,
    closest: u64,
    shadow: u64,
}

/// The tiles of a window, row by row.
fn tiles(window: Window) -> Vec<Window> {
    let cut = |start: u32, len: u32| (0..len).step_by(TILE as usize).map(move |o| (start + o, TILE.min(len - o)));
    cut(window.y, window.height)
        .flat_map(|(y, height)| cut(window.x, window.width).map(move |(x, width)| Window { x, y, width, height }))
        .collect()
}
