//! The wavefront CPU device, host half: each thread keeps many paths in flight and takes them from vertex to vertex, all at
//! once; see [`crate::device::stream`] for the kernels.
//!
//! Paths that end make room for new ones, so that a wave stays full while there is work. Results do not depend on how many
//! are in flight.

use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use jerboa_backend_cranelift::Binding;
use jerboa_ir::Layout;
use jerboa_ir::lang::{Buf, Col};

use super::ahead::{Ahead, Needs, PATHS};
use super::dispatch::{call, tables_bound};
use super::error::Error;
use super::generate::Generated;
use super::learn::watch::Watch;
use super::native::{Walkers, Wanted, streams};
use super::stages::{Clock, Stage, Stages};
use super::tables::Tables;
use super::work::Work;
use crate::schema::{Frame, Hits, NONE, Next, Order, Paths, Shadows, binding};

/// The device for one scene.
pub struct Wave {
    /// As [`super::device::DeviceKind::requests`] lists them.
    kernels: Vec<Arc<Generated>>,
    /// What each kernel reads.
    needs: Vec<Needs>,
    /// The kernel that traces shadow rays, if there are any.
    shadow: Option<usize>,
    /// The first class of shaders; the others follow.
    shade: usize,
    /// Paths in flight on each thread.
    slots: u32,
    /// Streams that no thread uses just now.
    idle: Mutex<Vec<Streams>>,
}

const GENERATE: usize = 0;
const TRACE: usize = 1;
const MISS: usize = 2;
/// The kernel `shadow`, if there is one, or the first class of shaders.
const BEHIND: usize = 3;

impl Wave {
    /// A device with so many paths in flight on each thread, at least 1.
    pub fn new(kernels: Vec<Arc<Generated>>, slots: u32) -> Wave {
        let needs = kernels.iter().map(|k| Needs::of(&k.residual.program)).collect();
        let shadow = kernels.get(BEHIND).is_some_and(|k| k.name == "shadow").then_some(BEHIND);
        let shade = BEHIND + usize::from(shadow.is_some());
        Wave { kernels, needs, shadow, shade, slots, idle: Mutex::default() }
    }

    /// The kernels.
    pub fn kernels(&self) -> &[Arc<Generated>] {
        &self.kernels
    }

    /// Trace all items, on this thread.
    ///
    /// # Errors
    /// When a kernel gives up: a fault of Jerboa.
    pub fn run(&self, tables: &Tables, work: &mut impl Work) -> Result<(), Error> {
        self.follow(tables, work, &mut Clock::new(None))
    }

    /// Trace all items, on this thread, and add what each stage took.
    ///
    /// # Errors
    /// As [`Wave::run`].
    pub fn run_clocked(&self, tables: &Tables, work: &mut impl Work, stages: &mut Stages) -> Result<(), Error> {
        Clock::new(Some(stages)).total(|clock| self.follow(tables, work, clock))
    }

    fn follow(&self, tables: &Tables, work: &mut impl Work, clock: &mut Clock) -> Result<(), Error> {
        let idle = || self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        let streams = idle().pop().unwrap_or_else(|| Streams::new(self.slots as usize));
        let mut thread =
            Thread { wave: self, clock, tables, bindings: tables_bound(tables), streams, rows: 0, begun: 0, live: 0 };
        let mut watch = work.learner().map(Watch::new);
        while !work.is_cancelled() {
            thread.refill(work)?;
            if thread.live == 0 {
                break;
            }
            thread.wave()?;
            if let Some(watch) = &mut watch {
                watch.look(&thread.streams.next, thread.live as usize);
            }
            thread.retire(work);
        }
        idle().push(thread.streams);
        Ok(())
    }
}

/// A stream in memory, row by row.
pub(super) struct Stream {
    words: Vec<u32>,
    /// Words of a row.
    columns: usize,
}

impl Stream {
    /// Room for so many rows.
    fn new<B: Buf>(rows: usize) -> Stream {
        assert!(B::LAYOUT == Layout::Rows || B::COLUMNS.len() == 1, "the host reads it row by row");
        Stream { words: vec![0; rows * B::COLUMNS.len()], columns: B::COLUMNS.len() }
    }

    fn bind(&mut self) -> Binding {
        let rows = self.words.len() / self.columns;
        Binding::new(&mut self.words, rows as u32)
    }

    /// A word.
    fn at<B, T>(&self, column: Col<B, T>, row: usize) -> u32 {
        self.row(row)[column.0 as usize]
    }

    /// The words of a row.
    #[inline]
    pub(super) fn row(&self, row: usize) -> &[u32] {
        &self.words[row * self.columns..][..self.columns]
    }

    /// The words of a row.
    #[inline]
    pub(super) fn row_mut(&mut self, row: usize) -> &mut [u32] {
        &mut self.words[row * self.columns..][..self.columns]
    }
}

/// The streams of one thread. After a wave the rows of paths that ended lie among the others, and new paths come behind:
/// so there are two rows of paths for each slot.
struct Streams {
    paths: Stream,
    next: Stream,
    hits: Stream,
    order: Stream,
    shadows: Stream,
    /// Who walks the tree, if it is the native walk.
    walkers: Option<Walkers>,
}

impl Streams {
    fn new(slots: usize) -> Streams {
        Streams {
            paths: Stream::new::<Paths>(2 * slots),
            next: Stream::new::<Next>(2 * slots),
            hits: Stream::new::<Hits>(2 * slots),
            order: Stream::new::<Order>(slots),
            shadows: Stream::new::<Shadows>(slots),
            walkers: None,
        }
    }
}

/// What a thread is at.
struct Thread<'w, 's> {
    wave: &'w Wave,
    clock: &'w mut Clock<'s>,
    tables: &'w Tables,
    bindings: Vec<Binding>,
    streams: Streams,
    /// Rows of `paths` that hold a path, ended or not.
    rows: u32,
    /// Rows before those of new paths.
    begun: u32,
    /// Paths among them that go on.
    live: u32,
}

impl Thread<'_, '_> {
    /// Start new paths in place of those that ended.
    fn refill(&mut self, work: &mut impl Work) -> Result<(), Error> {
        self.begun = self.rows;
        while self.live < self.wave.slots
            && let Some(mut batch) = work.next(self.wave.slots - self.live)
        {
            self.bindings[binding::<Frame>()] = Binding::new(&mut batch.frame, 1);
            let end = self.rows + batch.count;
            self.dispatch(Stage::Generate, GENERATE, batch.count, &[self.rows, end, batch.first, batch.number])?;
            self.rows = end;
            self.live += batch.count;
        }
        Ok(())
    }

    /// Take all live paths one vertex further: they become the rows of `next`.
    fn wave(&mut self) -> Result<(), Error> {
        self.trace(Stage::Secondary, 0..self.begun)?;
        self.trace(Stage::Camera, self.begun..self.rows)?;
        let ranges = self.sort();
        let (missed, hit) = ranges.split_last().expect("there is the range of misses");
        for (class, range) in hit.iter().enumerate().filter(|(_, range)| !range.is_empty()) {
            self.shade(self.wave.shade + class, range.clone())?;
        }
        self.dispatch(Stage::Miss, MISS, missed.len() as u32, &[missed.start, missed.end])?;
        self.shadow(0..missed.start)
    }

    /// Shade these rows of `order`: all at once, or some at a time where the memory is asked for what they read.
    fn shade(&mut self, kernel: usize, rows: Range<u32>) -> Result<(), Error> {
        let Some(mut ahead) = Ahead::new(self.tables, self.wave.needs[kernel]) else {
            return self.dispatch(Stage::Shade, kernel, rows.len() as u32, &[0, rows.start, rows.end]);
        };
        for first in rows.clone().step_by(PATHS as usize) {
            let end = rows.end.min(first + PATHS);
            let Streams { paths, hits, order, .. } = &self.streams;
            let part = &order.words[first as usize..end as usize];
            self.clock.stage(Stage::Shade, 0, || ahead.ask(part, paths, hits));
            self.dispatch(Stage::Shade, kernel, end - first, &[0, first, end])?;
        }
        Ok(())
    }

    /// The nearest hits of these paths.
    fn trace(&mut self, stage: Stage, rows: Range<u32>) -> Result<(), Error> {
        let count = rows.len() as u32;
        let tables = self.tables;
        let Some(native) = &tables.native else {
            return self.dispatch(stage, TRACE, count, &[rows.start, rows.end]);
        };
        // Triangles with holes are in the kernels' tree, for the rays that come near.
        let begun = !native.is_all();
        if begun {
            let Streams { paths, hits, walkers, .. } = &mut self.streams;
            let walkers = walkers.get_or_insert_default();
            let hidden = self.clock.stage(stage, 0, || streams::hide(native, walkers, rows.clone(), paths, hits));
            self.dispatch(stage, TRACE, count, &[rows.start, rows.end])?;
            streams::show(&mut self.streams.paths, &hidden);
        }
        let Streams { paths, hits, walkers, .. } = &mut self.streams;
        let walkers = walkers.get_or_insert_default();
        let rays = if begun { 0 } else { count };
        let wanted = if stage == Stage::Camera { Wanted::NearestTogether } else { Wanted::Nearest };
        self.clock.stage(stage, rays, || streams::trace(native, walkers, wanted, tables, rows, begun, (paths, hits)));
        Ok(())
    }

    /// The light of these rows that nothing blocks.
    fn shadow(&mut self, rows: Range<u32>) -> Result<(), Error> {
        let Some(kernel) = self.wave.shadow else { return Ok(()) };
        let count = rows.len() as u32;
        let args = [rows.start, rows.end];
        let Some(native) = &self.tables.native else {
            return self.dispatch(Stage::Shadow, kernel, count, &args);
        };
        let goes_on = !native.is_all();
        let Streams { shadows, next, walkers, .. } = &mut self.streams;
        let walkers = walkers.get_or_insert_default();
        let rays = if goes_on { 0 } else { count };
        self.clock.stage(Stage::Shadow, rays, || {
            streams::shadow(native, walkers, rows, shadows, next);
        });
        if goes_on {
            self.dispatch(Stage::Shadow, kernel, count, &args)?;
        }
        Ok(())
    }

    /// Counting sort: the rows of live paths by class into `order`, ascending within a class. Gives the range of each class and,
    /// last, of what has hit nothing.
    fn sort(&mut self) -> Vec<Range<u32>> {
        let shaders = self.wave.kernels.len() - self.wave.shade;
        let Streams { paths, hits, order, .. } = &mut self.streams;
        // The last kernel shades what has none of its own.
        let place = |row: usize| match hits.at(Hits::CLASS, row) {
            NONE => shaders,
            class => (class as usize).min(shaders - 1),
        };
        let live = || (0..self.rows as usize).filter(|row| paths.at(Paths::ALIVE, *row) != 0);
        let mut ends = vec![0; shaders + 1];
        live().for_each(|row| ends[place(row)] += 1);
        let mut end = 0;
        for count in &mut ends {
            end += *count;
            *count = end - *count;
        }
        let starts = ends.clone();
        for row in live() {
            let end = &mut ends[place(row)];
            order.words[*end as usize] = row as u32;
            *end += 1;
        }
        starts.into_iter().zip(ends).map(|(start, end)| start..end).collect()
    }

    /// Bring back what ended; what is left becomes `paths`.
    fn retire(&mut self, work: &mut impl Work) {
        std::mem::swap(&mut self.streams.paths, &mut self.streams.next);
        let paths = &self.streams.paths;
        self.rows = self.live;
        for row in (0..self.rows as usize).filter(|row| paths.at(Paths::ALIVE, *row) == 0) {
            let sample = [Paths::R, Paths::G, Paths::B].map(|column| paths.at(column, row));
            let rays = [Paths::CLOSEST, Paths::SHADOW].map(|column| paths.at(column, row));
            let ([r, g, b], [closest, shadow]) = (sample, rays);
            work.done(paths.at(Paths::ITEM, row), [r, g, b, closest, shadow]);
            self.live -= 1;
        }
    }

    /// Run a kernel over so many rows.
    fn dispatch(&mut self, stage: Stage, kernel: usize, rows: u32, args: &[u32]) -> Result<(), Error> {
        let Streams { paths, next, hits, order, shadows, walkers: _ } = &mut self.streams;
        self.bindings[binding::<Paths>()] = paths.bind();
        self.bindings[binding::<Next>()] = next.bind();
        self.bindings[binding::<Hits>()] = hits.bind();
        self.bindings[binding::<Order>()] = order.bind();
        self.bindings[binding::<Shadows>()] = shadows.bind();
        let Thread { wave, bindings, clock, .. } = self;
        clock.stage(stage, rows, || call(&wave.kernels[kernel], bindings, args))
    }
}
