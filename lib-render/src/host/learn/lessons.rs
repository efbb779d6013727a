//! Which samples of a render teach, and which are led by what they taught.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use jerboa_scenes::Camera;

use super::{LESSONS, Learner};
use crate::host::device::DeviceKind;
use crate::host::error::Error;
use crate::host::film::{Film, Window};
use crate::host::generate::TracerKind;
use crate::host::renderer::{Device, Handle, Options, Renderer, With};
use crate::host::tables::{Pass, Tables};

/// What is being taught, or was last.
#[derive(Default)]
pub struct Lessons(Mutex<Option<Lesson>>);

/// One render's.
struct Lesson {
    of: Key,
    stage: Stage,
}

/// How far it is.
enum Stage {
    /// Someone has watched so many samples of the whole film.
    Watched(Arc<Learner>, u32),
    /// The lessons are over.
    Over(Arc<Led>),
}

/// What samples behind the lessons are made with.
struct Led {
    tables: Tables,
    /// Where tables lie within the device: another one. A GPU has both then, each with the whole scene.
    device: Option<Device>,
}

/// What the first samples are a function of, beside the scene: camera, size of the film, seed.
type Key = (Camera, [u32; 2], u32);

/// Whether a pass was completed, and its numbers of rays, closest hit and shadow.
type Passed = (bool, [u64; 2]);

impl Lessons {
    fn lock(&self) -> MutexGuard<'_, Option<Lesson>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Who watches this pass: one over the whole film, that follows on what was watched, and is the first sample alone or none of
    /// it. Nobody else has the watcher, until it is given back by [`Lessons::put`].
    fn take_watcher(&self, of: &Key, pass: &Pass) -> Option<Arc<Learner>> {
        let mut lesson = self.lock();
        let is_next = |seen: u32| seen == pass.sample && (seen > 0 || pass.samples == 1);
        let is_at = lesson.as_ref().filter(|l| l.of == *of).map(|l| &l.stage);
        let learner = match is_at {
            Some(Stage::Over(_)) => None,
            Some(Stage::Watched(learner, seen)) if is_next(*seen) => Some(learner.clone()),
            _ => is_next(0).then(|| Arc::new(Learner::new(pass.size))),
        };
        let learner = learner.filter(|_| pass.window == whole(pass.size))?;
        *lesson = None;
        Some(learner)
    }

    /// That is how far a render's lesson is now.
    fn put(&self, of: Key, stage: Stage) {
        *self.lock() = Some(Lesson { of, stage });
    }

    /// What the lessons of that render led to.
    fn led(&self, of: &Key) -> Option<Arc<Led>> {
        match &self.lock().as_ref().filter(|l| l.of == *of)?.stage {
            Stage::Over(led) => Some(led.clone()),
            Stage::Watched(..) => None,
        }
    }
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
            (complete, rays) = self.lesson(&of, film, pass, handle)?;
        }
        if complete && rest.samples > 0 {
            let led = match self.lessons.led(&of) {
                Some(led) => led,
                None => self.teach(of, handle)?,
            };
            let device = led.device.as_ref().unwrap_or(&self.device);
            let with = With { tables: &led.tables, device, learner: None };
            let (done, more) = self.pass_with(with, camera, film, rest, handle)?;
            (complete, rays) = (done, [rays[0] + more[0], rays[1] + more[1]]);
        }
        Ok((complete, rays))
    }

    /// Add a pass of first samples, and watch it if it is the next lesson.
    fn lesson(&self, of: &Key, film: &mut Film, pass: Pass, handle: &Handle) -> Result<Passed, Error> {
        let can_watch = matches!(self.device, Device::Cpu(_));
        let learner = can_watch.then(|| self.lessons.take_watcher(of, &pass)).flatten();
        let with = With { tables: &self.tables, device: &self.device, learner: learner.clone() };
        let (complete, rays) = self.pass_with(with, &of.0, film, pass, handle)?;
        if let (true, Some(learner)) = (complete, learner) {
            let seen = pass.sample + pass.samples;
            let led = self.taught(&learner, seen)?;
            self.lessons.put(of.clone(), led.map_or(Stage::Watched(learner, seen), Stage::Over));
        }
        Ok((complete, rays))
    }

    /// Make the first samples for what they teach alone, on the CPU.
    fn teach(&self, of: Key, handle: &Handle) -> Result<Arc<Led>, Error> {
        let (camera, size, seed) = &of;
        let other = match self.device {
            Device::Cpu(_) => None,
            _ => Some(Device::made(&self.tables, &Options { device: DeviceKind::Cpu, ..self.options })?.0),
        };
        let device = other.as_ref().unwrap_or(&self.device);
        let mut film = Film::try_crop(*size, whole(*size))?;
        let learner = Arc::new(Learner::new(*size));
        let mut led = None;
        for [sample, end] in [[0, 1], [1, LESSONS]] {
            let pass = Pass { size: *size, window: whole(*size), sample, samples: end - sample, seed: *seed };
            let with = With { tables: &self.tables, device, learner: Some(learner.clone()) };
            let (complete, _) = self.pass_with(with, camera, &mut film, pass, &handle.unheard())?;
            if !complete {
                return Ok(Arc::new(Led { tables: self.tables.clone(), device: None }));
            }
            led = self.taught(&learner, end)?;
        }
        let led = led.expect("the last lesson was given");
        self.lessons.put(of, Stage::Over(led.clone()));
        Ok(led)
    }

    /// After so many samples: what those that follow are made with, once the lessons are over.
    fn taught(&self, learner: &Learner, seen: u32) -> Result<Option<Arc<Led>>, Error> {
        if seen == 1 {
            learner.first_is_done();
        }
        if seen < LESSONS {
            return Ok(None);
        }
        let Some(learned) = learner.learned() else {
            return Ok(Some(Arc::new(Led { tables: self.tables.clone(), device: None })));
        };
        let tables = self.tables.with(learned.tables());
        let has_tables = matches!(self.device, Device::Gpu(_));
        let device = has_tables.then(|| Device::made(&tables, &self.options)).transpose()?.map(|made| made.0);
        Ok(Some(Arc::new(Led { tables, device })))
    }
}
