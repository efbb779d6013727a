//! What a render is to reach, and what is kept of it on the way.
//!
//! A render that keeps its film does so after each pass, in a part ([`crate::host::part`]): who is killed loses the pass under
//! way, and the same words go on from there, to the very bits of a render that was left in peace. Whether there is too much
//! noise is asked at fixed numbers of samples, of exact sums: so when a render stops does not depend on the machine either.

use std::ops::ControlFlow;
use std::path::Path;

use jerboa_scenes::{Camera, Scene};

use super::args::{RangeArg, RenderArgs};
use crate::host::error::Error;
use crate::host::film::{Film, Window};
use crate::host::image_io::Image;
use crate::host::origin::{Origin, Span};
use crate::host::part::{self, Part};
use crate::host::renderer::{Options, Render};
use crate::host::variance::relative_error;

/// Fewest samples after which noise is looked at: two in each group.
const FIRST_LOOK: u32 = 16;

/// What a render is to reach.
pub(super) struct Goal<'a> {
    args: &'a RenderArgs,
    /// Which samples.
    pub(super) job: Render,
    /// Where the film is kept, and what the samples are of.
    kept: Option<(&'a Path, Origin)>,
}

impl<'a> Goal<'a> {
    /// That of the words, which are checked for what can be known before the render.
    ///
    /// # Errors
    /// When the film, or layers, cannot be written where they are to be.
    pub(super) fn new(args: &'a RenderArgs, scene: &Scene, camera: &Camera, options: &Options) -> Result<Self, Error> {
        let RenderArgs { seed, output, part, .. } = args;
        let [sample, end] = part.sample_range.map_or([0, args.spp], |RangeArg(range)| range);
        let path = if part.sample_range.is_some() { Some(output) } else { part.checkpoint.as_ref() };
        if let Some(path) = path {
            Image::check_target(path)?;
            Image::check_layers(path)?;
        }
        if part.checkpoint.as_ref() == Some(output) {
            return Err(Error::new(
                "--checkpoint and --output name the same file: the image would replace what is kept",
            ));
        }
        let kept = path.map(|path| (path.as_path(), Origin::new(scene, camera, options)));
        Ok(Goal { args, job: Render { sample, spp: end - sample, seed: *seed }, kept })
    }

    /// Do its samples come in groups, which tell the noise?
    pub(super) fn is_grouped(args: &RenderArgs) -> bool {
        args.part.variance || args.part.noise.is_some()
    }

    /// The film to begin with, and how many of the samples it has: those that were kept.
    ///
    /// # Errors
    /// When there is no memory for it, or what is kept is of another render.
    pub(super) fn film(&self, size: [u32; 2], window: Window) -> Result<(Film, u32), Error> {
        let make = if Goal::is_grouped(self.args) { Film::try_grouped } else { Film::try_crop };
        let film = make(size, window)?;
        let Some((path, origin)) = self.kept.as_ref().filter(|(path, _)| path.exists()) else { return Ok((film, 0)) };
        let refuse = |why: &dyn std::fmt::Display| {
            let path = path.display();
            Error::new(format!(
                "{path} is there, and this render cannot go on from it: {why}; remove it, or name another file"
            ))
        };
        let mut part = Part { film, origin: origin.clone() };
        part.merge(&Part::read(path)?).map_err(|e| refuse(&e))?;
        let Render { sample, spp, seed } = self.job;
        match part.origin.spans[..] {
            [Span { seed: s, first, end }] if (s, first) == (seed, sample) && end - first <= spp => {
                Ok((part.film, end - first))
            }
            _ => {
                let held: Vec<String> = part.origin.spans.iter().map(Span::to_string).collect();
                Err(refuse(&format!("it holds the samples {}", held.join(", "))))
            }
        }
    }

    /// After a pass: keeps the film that has so many of the samples, and says whether to go on.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(super) fn after(&self, film: &Film, done: u32) -> Result<ControlFlow<()>, Error> {
        if let Some((path, origin)) = &self.kept {
            let Render { sample, seed, .. } = self.job;
            part::write(path, film, &origin.of(Span { seed, first: sample, end: sample + done }))?;
        }
        Ok(if self.is_reached(film, done) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    }

    /// Is a film that has so many of the samples good enough? Looked at after 16, 32, 48, 64, 96, 128, 192, … of them: each
    /// look has a chance to find too little noise, so there are few; powers of two are where well distributed samples
    /// are best.
    pub(super) fn is_reached(&self, film: &Film, done: u32) -> bool {
        let is_look = done > 0 && done.is_multiple_of(FIRST_LOOK) && matches!(done >> done.trailing_zeros(), 1 | 3);
        self.args.part.noise.is_some_and(|target| is_look && relative_error(film) <= target)
    }
}
