//! A pass of a tracer whose light falls on any pixel, see [`crate::device::cpu::trace_light`].
//!
//! Each thread has a row of exact sums for each pixel of the whole film; in the end they are added up, so neither order nor
//! threads change a bit. The paths of all pixels are traced, whatever the window: light of any of them may fall into it. A
//! pass is whole or absent, since half of one would be darker all over. Where the film keeps groups of samples apart, all
//! samples of a pass are of one.

use jerboa_ir::lang::Buf;
use jerboa_scenes::Camera;
use rayon::prelude::*;

use super::error::Error;
use super::film::{Film, Window, sums};
use super::generate::Generated;
use super::renderer::Handle;
use super::scalar;
use super::tables::{Pass, Tables};
use super::work::Tiles;
use crate::schema::Pixels;

/// Words of a row of sums.
const ROW: usize = Pixels::COLUMNS.len();

/// Add one pass, on rayon's current pool. Says whether it was completed, and how many closest-hit and shadow rays it took.
///
/// # Errors
/// When the kernel gives up, a fault of Jerboa; or there is no memory for the film.
pub(super) fn pass(
    kernel: &Generated,
    tables: &Tables,
    camera: &Camera,
    film: &mut Film,
    pass: Pass,
    tile: u32,
    handle: &Handle,
) -> Result<(bool, [u64; 2]), Error> {
    let [width, height] = pass.size;
    let window = Window { x: 0, y: 0, width, height };
    let mut whole = film.over(window)?;
    let tiles = Tiles::new(camera, tables.place(camera), Pass { window, ..pass }, tile, &mut whole, handle);
    let thread = |_| -> Result<Vec<u32>, Error> {
        let mut splats = buffer(window)?;
        scalar::run(kernel, tables, &mut tiles.worker(), &mut splats)?;
        Ok(splats)
    };
    let threads = 0..rayon::current_num_threads();
    let all: Vec<_> = threads.into_par_iter().with_max_len(1).map(thread).collect::<Result<_, _>>()?;
    let (is_complete, rays) = (tiles.is_complete(), tiles.rays());
    if is_complete {
        all.iter().for_each(|splats| add(&mut whole, &pass, splats));
        film.merge_common(&whole);
    }
    Ok((is_complete, rays))
}

/// Sums of nothing for a row of each pixel.
pub(super) fn buffer(window: Window) -> Result<Vec<u32>, Error> {
    let (mut words, count) = (Vec::new(), window.area() * ROW);
    let Window { width, height, .. } = window;
    let no_memory = |_| Error::new(format!("no memory for the sums of {width}x{height} pixels on each thread"));
    words.try_reserve_exact(count).map_err(no_memory)?;
    words.resize(count, 0);
    Ok(words)
}

/// Add what a thread has summed of a pass.
fn add(film: &mut Film, pass: &Pass, splats: &[u32]) {
    let (dropped, [width, _]) = (Pixels::DROPPED.0 as usize, pass.size);
    for (pixel, row) in (0..).zip(splats.chunks(ROW)) {
        film.add_sum([pixel % width, pixel / width], pass.sample, sums(row), 0, row[dropped]);
    }
}
