//! Batches of made-up hits that a kernel shades, beside no ray that is traced: the bench of Figures 3 and 4.

use jerboa_backend_cranelift::{self as clif, Binding, Status};
use jerboa_ir::lang::Buf;
use jerboa_peval::{Arg, Generic, specialize};
use jerboa_scenes::Image;

use super::Spread;
use super::kernels::{Asked, Shaded};
use crate::host::clock::thread_time;
use crate::host::error::Error;
use crate::host::tables::Tables;

/// Rays of a batch, as in the paper.
pub const RAYS: u32 = 4096;

/// Rows of the streams: columns at a distance of a power of two would fall on the same few lines of the cache.
const ROWS: usize = RAYS as usize + 48;

/// A batch is shaded so often for one value, so that it takes some milliseconds.
const REPETITIONS: u32 = 16;

/// Specialises an entry for what is known of these tables, and compiles it.
///
/// # Errors
/// When the evaluator or the code generator gives up: a fault of Jerboa.
pub fn compile(
    generic: &Generic,
    entry: &str,
    args: &[Arg],
    tables: &Tables,
    options: &clif::Options,
) -> Result<clif::Code, Error> {
    let residual = specialize(generic, entry, args, &tables.facts, &Default::default());
    let residual = residual.map_err(|e| Error::new(e.to_string()))?;
    clif::compile(&[&residual.program], options).map_err(|e| Error::new(e.to_string()))
}

/// Makes code and times it in each round, all kernels in turn. Gives what each kernel showed.
///
/// Code is made anew because its place in memory counts: the same code at another address took 22 ns a ray more or less, of 57.
/// So none is freed before the last round, or the next would lie in its place.
///
/// # Errors
/// As `round`.
pub fn anew<C>(rounds: u32, mut round: impl FnMut() -> Result<(C, Vec<f64>), Error>) -> Result<Vec<Spread>, Error> {
    let rounds = (0..rounds).map(|_| round()).collect::<Result<Vec<_>, Error>>()?;
    let of = |k: usize| Spread::of(&rounds.iter().map(|(_, times)| times[k]).collect::<Vec<f64>>());
    Ok((0..rounds[0].1.len()).map(of).collect())
}

/// Texels for textures: so few that they fit the cache, since reading memory is not what is measured.
pub fn texels() -> Image {
    const SIDE: u32 = 64;
    let texel = |i: u32| [i * 7, i / SIDE * 3, i * i, 255].map(|c| c as u8);
    Image { name: "texels".into(), width: SIDE, height: SIDE, rgba: (0..SIDE * SIDE).map(texel).collect() }
}

/// A batch.
#[derive(Clone, Debug)]
pub struct Batch {
    /// Its rays, column by column.
    asked: Vec<u32>,
    /// What came of them.
    pub shaded: Vec<u32>,
}

impl Batch {
    /// Random points of primitives, seen and lit from above, always the same ones. `primitive` chooses by the number of the ray
    /// and a random one, `material` by the number of the ray.
    pub fn new(primitive: impl Fn(u32, u32) -> u32, material: impl Fn(u32) -> u32) -> Batch {
        let mut random = Random(1);
        let mut columns = vec![Vec::new(); Asked::COLUMNS.len()];
        for i in 0..RAYS {
            let (u, v) = (random.uniform(), random.uniform());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let directions = [random.upwards(), random.upwards(), [0.0, 0.0, 1.0]];
            let hit = [primitive(i, random.word()), 1_f32.to_bits(), u.to_bits(), v.to_bits()];
            let directions = directions.as_flattened().iter().map(|x| x.to_bits());
            let rest = [random.word(), random.word() | 1, 0, material(i)];
            let row = hit.into_iter().chain(directions).chain(rest);
            columns.iter_mut().zip(row).for_each(|(column, word)| column.push(word));
        }
        columns.iter_mut().for_each(|column: &mut Vec<u32>| column.resize(ROWS, 0));
        Batch { asked: columns.concat(), shaded: vec![0; Shaded::COLUMNS.len() * ROWS] }
    }

    /// Calls the one kernel of this code, which was compiled for these tables and the two streams.
    ///
    /// # Errors
    /// When it gives up: a fault of Jerboa.
    pub fn run(&mut self, code: &clif::Code, tables: &Tables, args: &[u32]) -> Result<(), Error> {
        let table = |words: &[u32], rows: u32| Binding { words: words.as_ptr().cast_mut(), rows };
        let mut bindings: Vec<Binding> = tables.memory.iter().map(|m| table(&m.words, m.rows)).collect();
        bindings.push(Binding::new(&mut self.asked, ROWS as u32));
        bindings.push(Binding::new(&mut self.shaded, ROWS as u32));
        let name = code.reports().next().map_or("", |r| &r.name);
        let kernel = code.kernel(name).expect("it is the code of one kernel");
        // SAFETY: each binding holds as many rows as it says, of the columns that are declared; only the last one is written,
        // and it is this call's own.
        match unsafe { kernel.call(&bindings, args, &mut []) } {
            Status::Done => Ok(()),
            Status::Limit => Err(Error::new("the kernel recursed beyond its limit: a fault of Jerboa")),
        }
    }

    /// Time of this thread that `shade` takes for a ray of the batch, ns.
    ///
    /// # Errors
    /// As `shade`.
    pub fn time(&mut self, mut shade: impl FnMut(&mut Batch) -> Result<(), Error>) -> Result<f64, Error> {
        let start = thread_time();
        for _ in 0..REPETITIONS {
            shade(self)?;
        }
        let time = thread_time().saturating_sub(start);
        Ok(1e9 * time.as_secs_f64() / f64::from(REPETITIONS * RAYS))
    }
}

/// A linear congruence (Knuth 1998, section 3.3.4), of which the upper half is used.
struct Random(u64);

impl Random {
    fn word(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 32) as u32
    }

    /// In [0, 1).
    fn uniform(&mut self) -> f32 {
        (self.word() >> 8) as f32 / (1 << 24) as f32
    }

    /// A unit vector with a positive last coordinate.
    fn upwards(&mut self) -> [f32; 3] {
        let (z, turn) = (0.1 + 0.9 * self.uniform(), std::f32::consts::TAU * self.uniform());
        let r = (1.0 - z * z).sqrt();
        [r * turn.cos(), r * turn.sin(), z]
    }
}
