//! What shading will read of the tables is asked of the memory before a kernel reads it.
//!
//! A kernel shades eight paths by thousands of instructions, so a processor does not come to the reads of the next eight while
//! it waits for these, and they wait for each other: a triangle, its corners; a slot of the environment's alias tables, the
//! texels around what that draws. But a hit and the path's random numbers say where all of them are. So before some paths are
//! shaded their reads are gone through here, for all of them one step after the other, by instructions that wait for nothing.
//!
//! *Nothing but time depends on it.* What is asked for in vain is not read, and what is not asked for is read all the same.

use jerboa_ir::lang::{Buf, Col, U32};
use jerboa_ir::{Node, Program, Reach};

use super::alias;
use super::tables::Tables;
use super::wave::Stream;
use crate::core::rng::{DIM_LIGHT, DIMENSIONS_PER_VERTEX};
use crate::schema::*;

/// Paths whose reads are asked for at once: some 15 lines of 64 bytes each are a quarter of a second cache of 1 MiB.
pub const PATHS: u32 = 256;

/// Words of texels of an environment that are few enough for such a cache: then nothing is asked for.
const FEW: usize = (1 << 20) / size_of::<u32>();

/// Words of a row for each corner of a triangle, in every table that has one.
const CORNER: usize = 4;

/// Which tables a kernel reads.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Needs {
    /// Of [`corners`].
    corners: [bool; 4],
    /// Does it sample the environment?
    environment: bool,
}

impl Needs {
    /// Of a kernel with this residual.
    pub fn of(residual: &Program) -> Needs {
        let mut is_read = [false; BUFFERS.len()];
        for id in Reach::of(residual).nodes {
            if let Node::Read { column, .. } = residual.node(id) {
                is_read[column.buf.index()] = true;
            }
        }
        Needs { corners: corners().map(|table| is_read[table]), environment: is_read[binding::<EnvironmentColumns>()] }
    }
}

/// The tables that have a row for each corner of a triangle.
fn corners() -> [usize; 4] {
    const {
        assert!(Vertices::COLUMNS.len() == CORNER && Normals::COLUMNS.len() == CORNER);
        assert!(Uvs::COLUMNS.len() == CORNER && Tangents::COLUMNS.len() == CORNER);
    }
    [binding::<Vertices>(), binding::<Normals>(), binding::<Uvs>(), binding::<Tangents>()]
}

/// The tables that a kernel reads.
pub struct Ahead<'t> {
    primitives: &'t [u32],
    corners: [&'t [u32]; 4],
    sky: Sky<'t>,
    /// What is drawn for the paths that were asked for last.
    drawn: Vec<Drawn>,
}

impl<'t> Ahead<'t> {
    /// None if it would not pay: it does where light comes from a large environment, and is drawn by independent numbers.
    pub fn new(tables: &'t Tables, needs: Needs) -> Option<Ahead<'t>> {
        let is_sobol = tables.memory[binding::<Sampling>()].words[Sampling::IS_SOBOL.0 as usize] != 0;
        let sky = Sky::new(tables).filter(|sky| needs.environment && sky.texels.len() > FEW && !is_sobol)?;
        let words = |table: usize| &tables.memory[table].words[..];
        let vertices = words(binding::<Vertices>()).len();
        let mut corners = corners().map(words);
        for (table, is_read) in corners.iter_mut().zip(needs.corners) {
            // A table that no geometry needs has one row.
            if !is_read || table.len() < vertices {
                *table = &[];
            }
        }
        Some(Ahead { primitives: words(binding::<Primitives>()), corners, sky, drawn: Vec::new() })
    }

    /// Asks for what shading these rows of `paths` reads: [`PATHS`] of them, or fewer.
    pub(super) fn ask(&mut self, order: &[u32], paths: &Stream, hits: &Stream) {
        let primitive = |path: &u32| {
            let number = hits.row(*path as usize)[Hits::PRIMITIVE.0 as usize] as usize;
            self.primitives.get(number * Primitives::COLUMNS.len()..)?.first_chunk::<{ Primitives::COLUMNS.len() }>()
        };
        self.drawn.clear();
        for path in order {
            if let Some([first, .., last]) = primitive(path) {
                prefetch(first);
                prefetch(last);
            }
            self.drawn.push(self.sky.draw_row(path_words(paths.row(*path as usize))));
        }
        for corners in order.iter().filter_map(primitive) {
            for i in [Primitives::I0, Primitives::I1, Primitives::I2] {
                let row = corners[i.0 as usize] as usize;
                self.corners.iter().filter_map(|table| table.get(row * CORNER)).for_each(prefetch);
            }
        }
        self.drawn.iter().for_each(|drawn| self.sky.ask(*drawn));
    }
}

/// The four texels, row by row of the map, that light sampling by these random numbers (start, step and dimension of an
/// `Rng`) reads of an environment; none if the scene has none.
pub fn texels(tables: &Tables, [start, step, dim]: [u32; 3]) -> Option<[usize; 4]> {
    let sky = Sky::new(tables)?;
    Some(sky.texels(sky.draw_row(words(start, step, dim))))
}

/// Asks the memory for a word.
#[inline]
fn prefetch(at: &u32) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: every x86-64 has the instruction.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(at).cast()) }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = at;
}

/// The words that draw a direction to the environment at the vertex of a path.
#[inline]
fn path_words(path: &[u32]) -> [u32; 3] {
    let [start, step, vertex] =
        [Paths::RNG_START, Paths::RNG_STEP, Paths::VERTEX].map(|column| path[column.0 as usize]);
    words(start, step, vertex.wrapping_mul(DIMENSIONS_PER_VERTEX).wrapping_add(DIM_LIGHT))
}

/// The three words after the one that chooses a light.
#[inline]
fn words(start: u32, step: u32, dim: u32) -> [u32; 3] {
    [1, 2, 3].map(|i| hash(start.wrapping_add(dim.wrapping_add(i).wrapping_mul(step))))
}

/// As [`crate::core::rng::hash`].
#[inline]
fn hash(x: u32) -> u32 {
    let x = (x ^ (x >> 17)).wrapping_mul(0xed5a_d4bb);
    let x = (x ^ (x >> 11)).wrapping_mul(0xac4c_1b51);
    let x = (x ^ (x >> 15)).wrapping_mul(0x3184_8bab);
    x ^ (x >> 14)
}

/// The environment's tables.
struct Sky<'t> {
    columns: &'t [u32],
    rows: &'t [u32],
    texels: &'t [u32],
    log_columns: u32,
    width: usize,
    height: usize,
}

/// A row that was drawn, and the words that draw in it.
#[derive(Clone, Copy)]
struct Drawn {
    row: usize,
    column: u32,
    offset: u32,
}

impl<'t> Sky<'t> {
    /// None if the scene has no environment.
    fn new(tables: &'t Tables) -> Option<Sky<'t>> {
        let words = |table: usize| &tables.memory[table].words[..];
        let of = |column: Col<Environment, U32>| words(binding::<Environment>())[column.0 as usize];
        let [width, height] = [Environment::WIDTH, Environment::HEIGHT].map(|column| of(column) as usize);
        (width > 0).then(|| Sky {
            columns: words(binding::<EnvironmentColumns>()),
            rows: words(binding::<EnvironmentRows>()),
            texels: words(binding::<EnvironmentTexels>()),
            log_columns: of(Environment::LOG_COLUMN_SLOTS),
            width,
            height,
        })
    }

    /// The slots of a row.
    #[inline]
    fn slots(&self, row: usize) -> &[u32] {
        &self.columns[row << self.log_columns..][..1 << self.log_columns]
    }

    /// Draws a row by the second word, and asks for the slot of its columns.
    #[inline]
    fn draw_row(&self, [column, row, offset]: [u32; 3]) -> Drawn {
        let row = alias::draw(self.rows, row);
        prefetch(&self.slots(row)[(column >> (32 - self.log_columns)) as usize]);
        Drawn { row, column, offset }
    }

    /// Draws a column, and gives the four texels around a point of the tent of what is drawn, row by row.
    #[inline]
    fn texels(&self, Drawn { row, column, offset }: Drawn) -> [usize; 4] {
        let column = alias::draw(self.slots(row), column);
        // Half a word each is how far the point is from the middle of the texel, and its first bit tells the side.
        let [right, below] = [offset >> 31, offset >> 15 & 1].map(|bit| bit as usize);
        let second = column + right;
        let first = if second == 0 { self.width } else { second } - 1;
        let columns = [first, if second < self.width { second } else { 0 }];
        let rows = [(row + below).max(1) - 1, (row + below).min(self.height - 1)];
        [0, 1, 2, 3].map(|i| rows[i / 2] * self.width + columns[i % 2])
    }

    /// Draws a column, and asks for the texels.
    #[inline]
    fn ask(&self, drawn: Drawn) {
        let word = |texel: usize| self.texels.get(texel * EnvironmentTexels::COLUMNS.len());
        self.texels(drawn).into_iter().filter_map(word).for_each(prefetch);
    }
}
