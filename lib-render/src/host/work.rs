//! Work for a device: which samples to trace, and where they go.
//!
//! An *item* of a pass is one sample of one pixel of its window, see [`crate::device::cpu`]. A device asks for consecutive
//! items, traces them in any order and gives each back under its number; so it knows nothing of films and tiles.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use jerboa_ir::lang::Buf;
use jerboa_scenes::Camera;

use super::film::{Film, Window};
use super::learn::Learner;
use super::renderer::Handle;
use super::tables::{Pass, Place, frame};
use crate::schema::Samples;

/// A row of [`Samples`].
pub type Sample = [u32; Samples::COLUMNS.len()];

/// Consecutive items to trace.
pub struct Batch {
    /// Content of the table `Frame`.
    pub frame: Vec<u32>,
    /// The first item.
    pub first: u32,
    /// How many.
    pub count: u32,
    /// Number of the first, under which it is given back; the others count on.
    pub number: u32,
}

/// Where a device gets its items from and brings their samples to.
pub trait Work {
    /// The next items, at most `most`; `None` when there are no more.
    fn next(&mut self, most: u32) -> Option<Batch>;

    /// An item's sample.
    fn done(&mut self, number: u32, sample: Sample);

    /// Who learns from the paths, if anyone does.
    fn learner(&self) -> Option<Arc<Learner>> {
        None
    }

    /// Should the device leave what it has begun?
    fn is_cancelled(&self) -> bool {
        false
    }
}

/// All items of one pass, their samples column by column.
pub struct Whole {
    frame: Vec<u32>,
    items: u32,
    next: u32,
    /// The words of the stream [`Samples`].
    pub words: Vec<u32>,
}

impl Whole {
    /// The items of a pass; `place` is where the camera stands.
    pub fn new(camera: &Camera, place: Place, pass: &Pass) -> Whole {
        let items = pass.window.area() as u32 * pass.samples;
        let words = vec![0; items as usize * Samples::COLUMNS.len()];
        Whole { frame: frame(camera, place, pass).words, items, next: 0, words }
    }
}

impl Work for Whole {
    fn next(&mut self, most: u32) -> Option<Batch> {
        let (first, count) = (self.next, most.min(self.items - self.next));
        self.next += count;
        (count > 0).then(|| Batch { frame: self.frame.clone(), first, count, number: first })
    }

    fn done(&mut self, number: u32, sample: Sample) {
        for (column, word) in self.words.chunks_mut(self.items as usize).zip(sample) {
            column[number as usize] = word;
        }
    }
}

/// A pass over a film, tile by tile, shared by threads. A tile is a film of its own until it is complete: so there are no
/// races, and a cancelled pass leaves whole tiles.
pub struct Tiles<'a> {
    camera: &'a Camera,
    place: Place,
    pass: Pass,
    side: u32,
    windows: Vec<Window>,
    next: AtomicUsize,
    /// Groups of the film's samples.
    groups: u32,
    film: Mutex<&'a mut Film>,
    handle: &'a Handle,
    learner: Option<Arc<Learner>>,
    complete: AtomicUsize,
    closest: AtomicU64,
    shadow: AtomicU64,
}

impl<'a> Tiles<'a> {
    /// A pass over the window of a film, in tiles of `side` by `side` pixels; `place` is where the camera stands.
    pub fn new(
        camera: &'a Camera,
        place: Place,
        pass: Pass,
        side: u32,
        film: &'a mut Film,
        handle: &'a Handle,
    ) -> Self {
        let Window { x, y, width, height } = pass.window;
        let cut = |start: u32, len: u32| (0..len).step_by(side as usize).map(move |o| (start + o, side.min(len - o)));
        let windows = cut(y, height)
            .flat_map(|(y, height)| cut(x, width).map(move |(x, width)| Window { x, y, width, height }))
            .collect();
        Tiles {
            camera,
            place,
            pass,
            side,
            windows,
            next: AtomicUsize::new(0),
            groups: film.groups(),
            film: Mutex::new(film),
            handle,
            learner: None,
            complete: AtomicUsize::new(0),
            closest: AtomicU64::new(0),
            shadow: AtomicU64::new(0),
        }
    }

    /// The same, from which this one learns.
    #[must_use]
    pub fn teaching(self, learner: Option<Arc<Learner>>) -> Self {
        Tiles { learner, ..self }
    }

    /// The work of one thread.
    pub fn worker(&self) -> Worker<'_, 'a> {
        Worker { tiles: self, open: Vec::new(), current: None, given: 0 }
    }

    /// Is every tile complete?
    pub fn is_complete(&self) -> bool {
        self.complete.load(Ordering::Relaxed) == self.windows.len()
    }

    /// Rays of the complete tiles, closest hit and shadow.
    pub fn rays(&self) -> [u64; 2] {
        [&self.closest, &self.shadow].map(|n| n.load(Ordering::Relaxed))
    }

    /// The next tile that no thread has begun.
    fn claim(&self) -> Option<Open> {
        let window = *self.windows.get(self.next.fetch_add(1, Ordering::Relaxed))?;
        let pass = Pass { window, ..self.pass };
        let items = window.area() as u32 * pass.samples;
        Some(Open { pass, items, left: items, film: Film::tile(window, self.groups), closest: 0, shadow: 0 })
    }

    /// Add a complete tile to the film.
    fn merge(&self, tile: &Open) {
        let mut film = self.film.lock().unwrap_or_else(PoisonError::into_inner);
        film.merge(&tile.film).expect("tiles are cut from the film's window");
        self.closest.fetch_add(tile.closest, Ordering::Relaxed);
        self.shadow.fetch_add(tile.shadow, Ordering::Relaxed);
        self.complete.fetch_add(1, Ordering::Relaxed);
        self.handle.add_done(u64::from(tile.items));
    }
}

/// A tile that has been begun.
struct Open {
    pass: Pass,
    items: u32,
    /// Items that have not come back.
    left: u32,
    film: Film,
    closest: u64,
    shadow: u64,
}

/// The work of one thread on [`Tiles`]: a few tiles are open at once, since paths end in any order.
pub struct Worker<'t, 'a> {
    tiles: &'t Tiles<'a>,
    /// Open tiles; an item's number begins with its place here.
    open: Vec<Option<Open>>,
    /// The tile that items are taken from.
    current: Option<usize>,
    /// So many of its items have been given out.
    given: u32,
}

impl Worker<'_, '_> {
    /// Numbers of one tile: a place in the list and an item.
    fn stride(&self) -> u32 {
        let side = self.tiles.side;
        side * side * self.tiles.pass.samples
    }

    /// Open another tile.
    fn open(&mut self) -> Option<usize> {
        let tile = self.tiles.claim()?;
        let place = self.open.iter().position(Option::is_none).unwrap_or_else(|| {
            self.open.push(None);
            self.open.len() - 1
        });
        self.open[place] = Some(tile);
        self.given = 0;
        Some(place)
    }
}

impl Work for Worker<'_, '_> {
    fn next(&mut self, most: u32) -> Option<Batch> {
        let place = self.current.take().or_else(|| self.open())?;
        let tile = self.open[place].as_ref().expect("it is open until its last item is given out and back");
        let (first, count) = (self.given, most.min(tile.items - self.given));
        self.given += count;
        self.current = (self.given < tile.items).then_some(place);
        let frame = frame(self.tiles.camera, self.tiles.place, &tile.pass).words;
        Some(Batch { frame, first, count, number: place as u32 * self.stride() + first })
    }

    fn done(&mut self, number: u32, [r, g, b, closest, shadow]: Sample) {
        let (place, item) = ((number / self.stride()) as usize, number % self.stride());
        let tile = self.open[place].as_mut().expect("an item of an open tile");
        let (window, pixel) = (tile.pass.window, item / tile.pass.samples);
        let sample = tile.pass.sample + item % tile.pass.samples;
        let at = [window.x + pixel % window.width, window.y + pixel / window.width];
        let light = [r, g, b].map(f32::from_bits);
        tile.film.add_sample(at, sample, light);
        if let Some(learner) = &self.tiles.learner {
            learner.add_sample(at, light, closest + shadow);
        }
        tile.closest += u64::from(closest);
        tile.shadow += u64::from(shadow);
        tile.left -= 1;
        if tile.left == 0
            && let Some(tile) = self.open[place].take()
        {
            self.tiles.merge(&tile);
        }
    }

    fn learner(&self) -> Option<Arc<Learner>> {
        self.tiles.learner.clone()
    }

    fn is_cancelled(&self) -> bool {
        self.tiles.handle.is_cancelled()
    }
}
