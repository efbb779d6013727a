//! What the first samples of a render teach about its light, for roulette: the host half of [`crate::tracer::learned`].
//!
//! The first [`LESSONS`] samples of all pixels are watched; those that follow are led by what was found. The first one says
//! where paths go, and how bright the image is; the others fill the cells. What is learned is a function of scene, camera, size
//! of the film and seed alone: sums are of integers, which know no order, so threads, tiles, parts and crops change no bit (Law 9). A
//! render that begins behind those samples, or of a part of the film, makes them for itself.
//!
//! The number of cells was chosen; 64 to a side, or 96 sets of directions, gained nothing (`tests/runs/roulette.txt`). Such numbers
//! change what is saved, never the mean.
//!
//! * [`lessons`]: which samples teach,
//! * [`watch`]: paths of one thread, vertex by vertex,
//! * [`grid`]: the cells, and what is found in each,
//! * [`pixels`]: what light counts in each pixel.

pub mod grid;
pub mod lessons;
pub mod pixels;
pub mod watch;

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use super::film::RANGE;
use super::image_io::luminance;
use super::tables::memory::Memory;
use crate::schema::{LearnedGrid, LearnedLight, LearnedPixels, binding};
use grid::Grid;
use watch::Found;

/// Samples of each pixel that are watched: the passes up to the first full one (chosen, not tuned).
pub const LESSONS: u32 = 16;

/// What was learned, as tables.
pub struct Learned {
    grid: Memory,
    light: Memory,
    pixels: Memory,
}

impl Learned {
    /// The tables, and their bindings.
    pub fn tables(self) -> [(usize, Memory); 3] {
        let Learned { grid, light, pixels } = self;
        [(binding::<LearnedGrid>(), grid), (binding::<LearnedLight>(), light), (binding::<LearnedPixels>(), pixels)]
    }
}

/// Watches the first samples of a render. Used from several threads at once.
pub struct Learner {
    size: [u32; 2],
    /// Of the first sample.
    first: Mutex<First>,
    /// From the second sample on.
    ground: OnceLock<Ground>,
}

/// What the first sample tells.
#[derive(Default)]
struct First {
    /// Where paths were scattered.
    places: Vec<[f32; 3]>,
    /// Sum of the luminances of all pixels, in units of 2^-64.
    light: i128,
}

/// What the first sample has told, and the sums over the others.
struct Ground {
    grid: Grid,
    /// Luminance that counts as 1: that of the image.
    unit: f64,
    /// For each row of [`LearnedLight`].
    light: Vec<LightSums>,
    /// For each pixel of the film.
    pixels: Vec<PixelSums>,
}

/// Sums over the rays that leave a cell in a set of directions.
#[derive(Default)]
pub struct LightSums {
    /// How many.
    pub count: AtomicU64,
    /// Squares of the light that each found, in fixed numbers.
    pub squares: AtomicU64,
    /// Rays that it took.
    pub rays: AtomicU64,
}

/// Sums over the samples of a pixel.
#[derive(Default)]
pub struct PixelSums {
    /// Luminances, in fixed numbers.
    pub sum: AtomicU64,
    /// Their squares, likewise.
    pub squares: AtomicU64,
    /// Rays.
    pub rays: AtomicU64,
}

/// Most light that counts, in means of the image: more is rare, and may not rule what is done.
const MOST: f64 = 1024.0;
/// Fraction bits of fixed numbers: 2^24 squares of the most have room in 64 bits.
const FRACTION_BITS: i32 = 20;

/// Units of [`First::light`] in 1: 2^64.
const FIRST_UNIT: f64 = (1u128 << 64) as f64;

/// A number of at most [`MOST`]², as an integer. What is below 0 or no number is 0.
fn fixed(x: f64) -> u64 {
    (x * f64::from(FRACTION_BITS).exp2()) as u64
}

/// The number that sums to this integer.
pub(super) fn real(sum: &AtomicU64) -> f64 {
    sum.load(Ordering::Relaxed) as f64 * f64::from(-FRACTION_BITS).exp2()
}

fn add(sum: &AtomicU64, more: u64) {
    sum.fetch_add(more, Ordering::Relaxed);
}

impl Learner {
    /// Nothing is seen yet of a film of this size.
    pub fn new(size: [u32; 2]) -> Learner {
        Learner { size, first: Mutex::default(), ground: OnceLock::new() }
    }

    /// Is this the first sample?
    fn is_first(&self) -> bool {
        self.ground.get().is_none()
    }

    /// Paths of the first sample were scattered there.
    fn add_places(&self, more: &mut Vec<[f32; 3]>) {
        self.first().places.append(more);
    }

    fn first(&self) -> MutexGuard<'_, First> {
        self.first.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The first sample of each pixel is complete.
    fn first_is_done(&self) {
        let First { mut places, light } = std::mem::take(&mut *self.first());
        let pixels = self.size[0] as usize * self.size[1] as usize;
        self.ground.get_or_init(|| Ground {
            grid: Grid::around(&mut places),
            unit: light as f64 * FIRST_UNIT.recip() / pixels as f64,
            light: (0..grid::ROWS).map(|_| LightSums::default()).collect(),
            pixels: (0..pixels).map(|_| PixelSums::default()).collect(),
        });
    }

    /// The row of cells and directions that a ray is of.
    fn row(&self, org: [f32; 3], dir: [f32; 3]) -> u32 {
        self.ground.get().map_or(0, |ground| ground.grid.row(org, dir))
    }

    /// A path has ended that had left a row.
    fn add_light(&self, row: u32, Found { light, rays }: Found) {
        let Some(ground) = self.ground.get() else { return };
        let sums = &ground.light[row as usize];
        add(&sums.count, 1);
        add(&sums.squares, fixed((light / ground.unit).min(MOST).powi(2)));
        add(&sums.rays, u64::from(rays));
    }

    /// A sample of a pixel, given as column and row of the film, took so many rays.
    pub fn add_sample(&self, [x, y]: [u32; 2], sample: [f32; 3], rays: u32) {
        let Some(ground) = self.ground.get() else {
            // The film drops what is not finite or beyond its range: so has the sum room for 2^32 samples.
            if sample.iter().all(|s| s.abs() <= RANGE) {
                self.first().light += (luminance(sample) * FIRST_UNIT) as i128;
            }
            return;
        };
        let sums = &ground.pixels[(y * self.size[0] + x) as usize];
        let light = (luminance(sample) / ground.unit).min(MOST);
        add(&sums.sum, fixed(light));
        add(&sums.squares, fixed(light * light));
        add(&sums.rays, u64::from(rays));
    }

    /// What was learned; nothing where all was dark, or there is no noise.
    pub fn learned(&self) -> Option<Learned> {
        let Ground { grid, unit, light, pixels } = self.ground.get()?;
        let light = grid::worths(light)?;
        let pixels = pixels::scales(pixels, self.size, LESSONS - 1)?;
        (*unit > 0.0 && unit.is_finite()).then(|| Learned { grid: grid.table(), light, pixels })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_that_the_film_drops_teach_nothing_of_brightness() {
        let learner = Learner::new([1, 1]);
        for sample in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN, f32::MAX, 1.0] {
            (0..2).for_each(|_| learner.add_sample([0, 0], [sample; 3], 1));
        }
        assert_eq!(learner.first().light, 2 * (luminance([1.0; 3]) * FIRST_UNIT) as i128);
    }
}
