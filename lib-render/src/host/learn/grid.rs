//! The cells of what is learned, and what a path is worth that leaves each.

use std::sync::atomic::Ordering;

use super::{LightSums, real};
use crate::host::tables::memory::{Memory, Table};
use crate::schema::{CELLS, DIRECTIONS, LearnedGrid, LearnedLight};

/// Cells along an axis.
const SIDE: usize = CELLS as usize;
/// Sets of directions.
const SETS: usize = DIRECTIONS as usize;
/// Rows of [`LearnedLight`].
pub const ROWS: usize = SIDE * SIDE * SIDE * SETS;

/// Share of all places that may lie outside the box of cells on each side of an axis: those at the faces reach on without end, so
/// that a few far ones do not make all cells large.
const OUTSIDE: usize = 500;
/// Rays by which a cell believes the coarser one around it. With 8 some cells are dark by chance: kitchen takes 1.06 to 1.14 times the work
/// for the same error (`tests/runs/roulette.txt`).
const PRIOR: f64 = 32.0;
/// Least worth, over that of all: what was dark may have been so by chance.
const LEAST: f64 = 0.1;

/// Where the cells are.
pub struct Grid {
    least: [f32; 3],
    per_metre: [f32; 3],
}

impl Grid {
    /// Cells around these places, whose order changes nothing.
    pub fn around(places: &mut [[f32; 3]]) -> Grid {
        let mut grid = Grid { least: [0.0; 3], per_metre: [0.0; 3] };
        for axis in 0..3 {
            places.sort_unstable_by(|a, b| a[axis].total_cmp(&b[axis]));
            let outside = places.len() / OUTSIDE;
            let ends = places.get(outside).zip(places.get(places.len().wrapping_sub(1 + outside)));
            if let Some((least, most)) = ends.map(|(a, b)| (a[axis], b[axis])).filter(|(a, b)| a < b) {
                grid.least[axis] = least;
                grid.per_metre[axis] = (CELLS as f32 / (most - least)).min(f32::MAX);
            }
        }
        grid
    }

    /// The row of a ray, as [`crate::tracer::learned::light_row`] finds it.
    pub fn row(&self, org: [f32; 3], dir: [f32; 3]) -> u32 {
        let cell = |axis: usize| {
            let cell = (org[axis] - self.least[axis]) * self.per_metre[axis];
            cell.max(0.0).min((CELLS - 1) as f32) as u32
        };
        let signs: u32 = (0..3).map(|axis| u32::from(dir[axis] > 0.0) << axis).sum();
        let [x, y, z] = dir.map(f32::abs);
        let axis = if x >= y && x >= z { 0 } else { 2 - u32::from(y >= z) };
        ((cell(2) * CELLS + cell(1)) * CELLS + cell(0)) * DIRECTIONS + axis * 8 + signs
    }

    /// Its table.
    pub fn table(&self) -> Memory {
        use LearnedGrid as G;
        let mut table = Table::<G>::new();
        let mut row = table.push();
        row.set(G::IS_LEARNED, true);
        row.set_all([G::X, G::Y, G::Z], self.least);
        row.set_all([G::PER_X, G::PER_Y, G::PER_Z], self.per_metre);
        table.finish()
    }
}

/// Means over rays: squares of light, and numbers of rays.
type Means = [f64; 2];

/// Sums over the rays of a row: how many, squares, and numbers of rays.
#[derive(Clone, Copy, Default)]
struct Sums([f64; 3]);

impl Sums {
    fn plus(self, other: Sums) -> Sums {
        Sums(std::array::from_fn(|i| self.0[i] + other.0[i]))
    }

    /// Means, where [`PRIOR`] more rays have those.
    fn with(self, prior: Means) -> Means {
        let Sums([count, sums @ ..]) = self;
        std::array::from_fn(|i| (sums[i] + PRIOR * prior[i]) / (count + PRIOR))
    }
}

/// What a path is worth in each row, from sums over rays: of a row's own, of the cells of twice the side around it, and so on to
/// all of the directions and to all. Nothing where no light was found.
pub fn worths(rows: &[LightSums]) -> Option<Memory> {
    let of_row = |row: &LightSums| {
        let [count, rays] = [&row.count, &row.rays].map(|n| n.load(Ordering::Relaxed) as f64);
        Sums([count, real(&row.squares), rays])
    };
    let mut levels = vec![rows.iter().map(of_row).collect::<Vec<_>>()];
    let mut side = SIDE;
    while side > 1 {
        levels.push(coarser(&levels[levels.len() - 1], side));
        side /= 2;
    }
    let coarsest = levels.pop()?;
    let Sums([count, squares, rays]) = coarsest.iter().copied().fold(Sums::default(), Sums::plus);
    let all = [squares / count, rays / count];
    let worth = |[squares, rays]: Means| (squares / rays).sqrt();
    if worth(all).is_nan() || worth(all) == 0.0 {
        return None;
    }
    let mut means: Vec<Means> = coarsest.into_iter().map(|sums| sums.with(all)).collect();
    for level in levels.into_iter().rev() {
        means = finer(&level, &means, side);
        side *= 2;
    }
    let mut table = Table::<LearnedLight>::with_rows(ROWS);
    for means in means {
        table.push().set(LearnedLight::WORTH, worth(means).max(LEAST * worth(all)) as f32);
    }
    Some(table.finish())
}

/// Sums over cells of twice the side, of those with so many along an axis.
fn coarser(sums: &[Sums], side: usize) -> Vec<Sums> {
    let mut coarse = vec![Sums::default(); sums.len() / 8];
    for (row, sums) in sums.iter().enumerate() {
        let into = &mut coarse[around(row, side)];
        *into = into.plus(*sums);
    }
    coarse
}

/// Means of cells of half the side of those that have these, with so many along an axis, from their sums.
fn finer(sums: &[Sums], means: &[Means], side: usize) -> Vec<Means> {
    sums.iter().enumerate().map(|(row, sums)| sums.with(means[around(row, 2 * side)])).collect()
}

/// The row of the cell of twice the side that a row's cell lies in, where there are so many along an axis.
fn around(row: usize, side: usize) -> usize {
    let (cell, set) = (row / SETS, row % SETS);
    let [x, y, z] = [cell % side, cell / side % side, cell / (side * side)].map(|at| at / 2);
    let half = side / 2;
    ((z * half + y) * half + x) * SETS + set
}

#[cfg(test)]
mod tests {
    use jerboa_ir::Lit;
    use jerboa_ir::interp::{self, Limits};
    use jerboa_ir::lang::{F32, Fun, U32, build, entry};

    use super::*;
    use crate::core::vec::vec3;
    use crate::host::random::Random;
    use crate::schema::{BUFFERS, binding, declare_all};
    use crate::tracer::learned::light_row;

    /// Host and kernels count cells and directions alike: else light is learned in one place and looked up in another.
    #[test]
    fn kernels_find_the_row_that_was_filled() {
        let program = build(|| {
            declare_all();
            entry(
                "row",
                Fun::<(F32, F32, F32, F32, F32, F32), U32>::named("row", |_, (x, y, z, a, b, c)| {
                    light_row(vec3(x, y, z), vec3(a, b, c))
                }),
            );
        });
        let row = program.entry("row").expect("it is its entry");
        let grid = Grid::around(&mut [[-1.0, 0.0, 5.0], [3.0, 0.5, 9.0], [2.0, 0.25, 6.0]]);
        let mut memory: Vec<Memory> = BUFFERS.iter().map(|b| Memory { rows: 1, words: vec![0; b.3.len()] }).collect();
        memory[binding::<LearnedGrid>()] = grid.table();
        let mut random = Random(7);
        let mut float = |scale: f32| (random.uniform() as f32 - 0.5) * scale;
        for _ in 0..1000 {
            let org = [4.0, 1.0, 6.0].map(|c: f32| c / 2.0 + float(2.0 * c));
            let dir = [0; 3].map(|_| float(2.0));
            let args: Vec<Lit> = org.into_iter().chain(dir).map(|x| Lit::F32(x.to_bits())).collect();
            let found = interp::run(&program, row, &args, &mut memory, Limits::default()).expect("it runs");
            assert_eq!(found, [Lit::U32(grid.row(org, dir))], "{org:?} {dir:?}");
        }
    }
}
