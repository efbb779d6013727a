//! Which samples of a render teach, and which are led by what they taught.

use std::sync::{Arc, Mutex, PoisonError};

use jerboa_scenes::Camera;

use super::{LESSONS, Learner};
use crate::host::device::DeviceKind;
use crate::host::error::Error;
use crate::host::film::{Film, Window};
use crate::host::generate::TracerKind;
use crate::host::renderer::{Handle, Options, Renderer};
use crate::host::tables::{Pass, Tables};

/// What is being taught, or was last.
#[derive(Default)]
pub struct Lessons(Mutex<Option<Lesson>>);

/// One render's.
struct Lesson {
    of: Key,
    learner: Arc<Learner>,
    /// Samples of the whole film that were watched.
    seen: u32,
    /// After the last one.
    tables: Option<Arc<Tables>>,
}

/// What the first samples are a function of, beside the scene: camera, size of the film, seed.
type Key = (Camera, [u32; 2], u32);

/// Whether a pass was completed, and its numbers of rays, closest hit and shadow.
type Passed = (bool, [u64; 2]);

/// Refuse roulette by what was learned where no one learns.
///
/// # Errors
/// On another device than [`DeviceKind::Cpu`], and for another tracer than the path tracer.
pub(in crate::host) fn check(options: &Options) -> Result<(), Error> {
    if options.choices.learned_roulette && (options.device != DeviceKind::Cpu || options.tracer != TracerKind::Path) {
        return Err(Error::new(
            "roulette is learned by the path tracer on the device cpu alone: choose --device cpu and --tracer path, or \
             --roulette throughput",
        ));
    }
    Ok(())
}

impl Lessons {
    fn lock(&self) -> std::sync::MutexGuard<'_, Option<Lesson>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Who watches this pass: one over the whole film, that follows on what was watched, and is the first sample alone or none of
    /// it.
    fn watcher(&self, of: &Key, pass: &Pass) -> Option<Arc<Learner>> {
        let mut lesson = self.lock();
        if pass.sample == 0 {
            *lesson = Some(Lesson { of: of.clone(), learner: Learner::new(pass.size).into(), seen: 0, tables: None });
        }
        let is_next = |l: &&Lesson| l.of == *of && l.seen == pass.sample && (l.seen > 0 || pass.samples == 1);
        let is_whole = pass.window == whole(pass.size);
        lesson.as_ref().filter(is_next).filter(|_| is_whole).map(|l| l.learner.clone())
    }

    /// A pass was watched to its end.
    fn seen(&self, of: &Key, pass: &Pass, tables: &Tables) {
        if let Some(lesson) = self.lock().as_mut().filter(|l| l.of == *of && l.seen == pass.sample) {
            lesson.seen += pass.samples;
            lesson.tables = taught(&lesson.learner, lesson.seen, tables);
        }
    }

    /// What was taught.
    fn tables(&self, of: &Key) -> Option<Arc<Tables>> {
        self.lock().as_ref().filter(|l| l.of == *of).and_then(|l| l.tables.clone())
    }
}

/// After so many samples: the tables with what was learned, once it was all.
fn taught(learner: &Learner, seen: u32, tables: &Tables) -> Option<Arc<Tables>> {
    if seen == 1 {
        learner.first_is_done();
    }
    let learned = || learner.learned().map_or_else(|| tables.clone(), |learned| tables.with_learned(learned));
    (seen == LESSONS).then(|| Arc::new(learned()))
}

fn whole([width, height]: [u32; 2]) -> Window {
    Window { x: 0, y: 0, width, height }
}

impl Renderer {
    /// Add one pass, as [`Renderer::pass`]: of first samples, which teach where they can, or led by what they taught.
    ///
    /// # Errors
    /// As [`Renderer::render_with`].
    pub(in crate::host) fn learning(
        &self,
        camera: &Camera,
        film: &mut Film,
        pass: Pass,
        handle: &Handle,
    ) -> Result<Passed, Error> {
        if !self.options.choices.learned_roulette || self.options.tracer != TracerKind::Path {
            return self.pass(camera, film, pass, handle);
        }
        let of = (camera.clone(), pass.size, pass.seed);
        let first = pass.samples.min(LESSONS.saturating_sub(pass.sample));
        let rest = Pass { sample: pass.sample + first, samples: pass.samples - first, ..pass };
        let (mut complete, mut rays) = (true, [0; 2]);
        if first > 0 {
            let pass = Pass { samples: first, ..pass };
            let learner = self.lessons.watcher(&of, &pass);
            let is_watched = learner.is_some();
            (complete, rays) = self.pass_with(&self.tables, learner, camera, film, pass, handle)?;
            if complete && is_watched {
                self.lessons.seen(&of, &pass, &self.tables);
            }
        }
        if complete && rest.samples > 0 {
            let tables = match self.lessons.tables(&of) {
                Some(tables) => tables,
                None => self.teach(of, handle)?,
            };
            let (done, more) = self.pass_with(&tables, None, camera, film, rest, handle)?;
            (complete, rays) = (done, [rays[0] + more[0], rays[1] + more[1]]);
        }
        Ok((complete, rays))
    }

    /// Make the first samples for what they teach alone.
    fn teach(&self, of: Key, handle: &Handle) -> Result<Arc<Tables>, Error> {
        let (camera, size, seed) = &of;
        let mut film = Film::try_crop(*size, whole(*size))?;
        let learner = Arc::new(Learner::new(*size));
        let mut tables = None;
        for [sample, end] in [[0, 1], [1, LESSONS]] {
            let pass = Pass { size: *size, window: whole(*size), sample, samples: end - sample, seed: *seed };
            let (complete, _) =
                self.pass_with(&self.tables, Some(learner.clone()), camera, &mut film, pass, &handle.unheard())?;
            if !complete {
                return Ok(Arc::new(self.tables.clone()));
            }
            tables = taught(&learner, end, &self.tables);
        }
        let tables = tables.expect("the last lesson was given");
        *self.lessons.lock() = Some(Lesson { of, learner, seen: LESSONS, tables: Some(tables.clone()) });
        Ok(tables)
    }
}
