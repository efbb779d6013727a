//! The thread that renders: pass after pass, each of them shown.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::{Live, Picture, Shared};
use crate::host::error::Error;
use crate::host::film::Film;
use crate::host::renderer::{Handle, SAMPLES_PER_PASS};
use crate::host::tables::Pass;

/// A pass that takes longer is not followed by one of more samples: what is shown stays young.
const BRISK: Duration = Duration::from_millis(200);

/// Adds pass after pass.
pub(super) struct Painter<'s> {
    shared: &'s Shared,
    film: Film,
    /// What is on the film: a revision, and samples of every pixel.
    revision: u64,
    spp: u32,
    /// Samples of the next pass.
    samples: u32,
}

impl<'s> Painter<'s> {
    /// One with an empty film.
    pub(super) fn new(shared: &'s Shared, film: Film) -> Painter<'s> {
        Painter { shared, film, revision: 0, spp: 0, samples: 1 }
    }

    /// Paints until the session ends.
    pub(super) fn run(&mut self) -> Result<(), Error> {
        while let Some((live, handle)) = self.next() {
            let options = &live.renderer.options;
            let samples = self.samples.min(options.spp - self.spp);
            let pass = Pass {
                size: self.film.size(),
                window: self.film.window(),
                sample: self.spp,
                samples,
                seed: options.seed,
            };
            let start = Instant::now();
            let (complete, _) = live.renderer.pass(&live.camera, &mut self.film, pass, &handle)?;
            if !complete {
                continue;
            }
            if start.elapsed() < BRISK {
                self.samples = (2 * samples).min(SAMPLES_PER_PASS);
            }
            self.spp += samples;
            let picture = Picture { revision: self.revision, spp: self.spp, image: self.film.mean() };
            self.shared.lock().picture = Some(Arc::new(picture));
            self.shared.changed.notify_all();
        }
        Ok(())
    }

    /// Waits until there is something to paint; nothing at the end. Starts the film again for a new revision.
    fn next(&mut self) -> Option<(Live, Arc<Handle>)> {
        let mut state = self.shared.lock();
        while !state.stopped {
            if state.live.revision != self.revision {
                self.film = Film::crop(self.film.size(), self.film.window());
                (self.revision, self.spp, self.samples) = (state.live.revision, 0, 1);
            }
            if self.spp < state.live.renderer.options.spp {
                state.handle = Arc::default();
                return Some((state.live.clone(), state.handle.clone()));
            }
            state = self.shared.wait(state);
        }
        None
    }
}
