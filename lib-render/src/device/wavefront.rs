//! The wavefront GPU device, IR half (Laine, Karras & Aila 2013; paper, section 4.7): kernels with an invocation a row, over
//! the streams of the wavefront CPU device ([`super::stream`]), whose bodies these are.
//!
//! A *wave* takes all paths in flight one vertex further. What the CPU's host does between kernels is done by kernels here,
//! without atomics, so that the order of rows is the same in each run; and they leave the grids of the kernels that follow,
//! so that the host need not look on:
//!
//! ```text
//! generate    new paths                                            -> Paths
//! begin       rows of Paths, and blocks of them                    -> Ranges
//! trace       the nearest hit of each ray                          Paths -> Hits
//! count       an invocation a block: rows of each class            Hits -> Counts
//! scan        an invocation a class: rows in the blocks before     Counts -> Counts, Ranges
//! plan        one: where each class begins, and its grid           Ranges -> Ranges
//! scatter     an invocation a block: row numbers by class          Counts, Hits -> Order
//! shade       emission, shadow ray, next ray; for each class       Paths, Hits, Order -> Next, Shadows
//! miss        what lies behind everything                          Paths, Order -> Next
//! shadow      adds what no one blocks                              Shadows -> Next
//! retire      the samples of paths that ended                      Next -> Samples
//! accumulate  an invocation a pixel: the exact sum of its samples  Samples -> Pixels
//! ```
//!
//! Then `Next` becomes `Paths`, where the paths that ended are passed over.

use jerboa_ir::lang::{Block, Bool, Fun, Row, Staged, U32, entry};

use crate::core::color::Color;
use crate::device::Device;
use crate::device::pixel::PixelSum;
use crate::device::stream::{self, kernel_name};
use crate::ray::Hit;
use crate::schema::{Counts, Frame, Geometries, Hits, NONE, Next, Order, Paths, Ranges, Samples};
use crate::tracer::Tracer;
use crate::traverse::memory::Memory;
use crate::traverse::turns::Question;
use crate::traverse::{Tests, traverse_here};

/// Rows of [`Paths`] that an invocation counts.
pub const BLOCK: u32 = 256;
/// Invocations of a group.
pub const GROUP: u32 = 64;

/// Rows of [`Ranges`].
pub mod range {
    /// Rows of `Paths` that hold a path, ended or not.
    pub const PATHS: u32 = 0;
    /// Blocks of them.
    pub const BLOCKS: u32 = 1;
    /// Rows of `Next`; before a wave, what will be rows of `Paths`.
    pub const NEXT: u32 = 2;
    /// Rows of `Next` that may have a shadow ray.
    pub const SHADOWS: u32 = 3;
    /// Rows of `Order` of the first class of shaders; the others follow and, last, what has hit nothing.
    pub const CLASSES: u32 = 4;
}

/// A device that takes many paths from vertex to vertex. The kernels that need no tracer are declared with it.
pub fn make_wavefront_device() -> Device {
    kernel("begin", |b, i: U32| b.when(i.eq(0), begin));
    kernel("trace", |b, i: U32| {
        let paths = end(b, range::PATHS);
        b.when(i.lt(paths), |b| trace(b, i, false, stream::ask_nearest, stream::answer_nearest));
    });
    kernel("count", |b, (i, classes): (U32, U32)| {
        let blocks = end(b, range::BLOCKS);
        b.when(i.lt(blocks), |b| count(b, i, blocks, classes));
    });
    kernel("scan", |b, (i, classes): (U32, U32)| b.when(i.le(classes), |b| scan(b, i)));
    kernel("plan", |b, (i, classes): (U32, U32)| b.when(i.eq(0), |b| plan(b, classes)));
    kernel("scatter", |b, (i, classes): (U32, U32)| {
        let blocks = end(b, range::BLOCKS);
        b.when(i.lt(blocks), |b| scatter(b, i, blocks, classes));
    });
    kernel("shadow", |b, i: U32| {
        let rows = end(b, range::SHADOWS);
        b.when(i.lt(rows), |b| trace(b, i, true, stream::ask_blocked, stream::answer_blocked));
    });
    kernel("retire", |b, i: U32| {
        let rows = end(b, range::NEXT);
        b.when(i.lt(rows), |b| retire(b, i));
    });
    kernel("accumulate", |b, (i, count): (U32, U32)| b.when(i.lt(count), |b| accumulate(b, i)));
    Device { trace: shading }
}

/// Declare the kernels of a tracer.
fn shading(name: &str, tracer: Tracer) {
    let of_tracer = |stage| kernel_name(name, stage);
    kernel(&of_tracer("generate"), |b, (i, count, at, first, number): (U32, U32, U32, U32, U32)| {
        b.when(i.lt(count), |b| stream::generate(b, tracer, at + i, first + i, number + i));
        b.when(i.eq(0), |b| b.store(Ranges::END, range::NEXT, at + count));
    });
    kernel(&of_tracer("shade"), |b, (i, class, place): (U32, Row<Geometries>, U32)| {
        in_class(b, i, place, |b, i| stream::shade(b, tracer, class, i));
    });
    kernel(&of_tracer("miss"), |b, (i, place): (U32, U32)| in_class(b, i, place, |b, i| stream::miss(b, tracer, i)));
}

/// Declare an entry.
fn kernel<A: Staged>(stage: &str, body: impl FnOnce(&mut Block, A)) {
    let name = entry_name(stage);
    entry(&name, Fun::<A, ()>::named(&name, body));
}

/// Name of an entry, by its stage as [`kernel_name`] has it: the CPU's are another kernel of the same stage.
pub fn entry_name(stage: &str) -> String {
    format!("wavefront_{stage}")
}

/// The end of a range.
fn end(b: &mut Block, range: u32) -> U32 {
    b.load(Ranges::END, range)
}

/// Set a range, and the grid over its rows.
fn set_range(b: &mut Block, range: U32, first: U32, end: U32) {
    let groups = (end - first + (GROUP - 1)) / GROUP;
    let one = U32::from(1);
    b.store_record(Ranges::FIRST, range, (first, end, groups, one, one));
}

/// Do it with row i of a class.
fn in_class(b: &mut Block, i: U32, place: U32, body: impl FnOnce(&mut Block, U32)) {
    let range = place + range::CLASSES;
    let (first, end): (U32, U32) = b.load_record(Ranges::FIRST, range);
    let row = first + i;
    b.when(row.lt(end), |b| body(b, row));
}

/// The rows of this wave.
fn begin(b: &mut Block) {
    let paths = end(b, range::NEXT);
    set_range(b, range::PATHS.into(), 0.into(), paths);
    set_range(b, range::BLOCKS.into(), 0.into(), (paths + (BLOCK - 1)) / BLOCK);
}

/// Answer the question of row i, if it asks any.
fn trace(
    b: &mut Block,
    i: U32,
    any_hit: bool,
    ask: impl Fn(&mut Block, U32) -> Question,
    answer: impl Fn(&mut Block, U32, Hit),
) {
    let Question { is_asked, ray, accept } = ask(b, i);
    b.when(is_asked, |b| {
        let memory = Memory::new(b, 1);
        let hit = traverse_here(b, Tests::default(), memory, (ray, any_hit.into(), accept));
        answer(b, i, hit);
    });
}

/// Count the rows of a block by class.
fn count(b: &mut Block, block: U32, blocks: U32, classes: U32) {
    each(b, 0.into(), classes + 1u32, |b, place| b.store(Counts::COUNT, place * blocks + block, 0u32));
    each_live(b, block, classes, |b, _, place| {
        next_of(b, place * blocks + block);
    });
}

/// Number what is counted here: the number of those before, which is one more for the next.
fn next_of(b: &mut Block, at: U32) -> U32 {
    let before: U32 = b.load(Counts::COUNT, at);
    b.store(Counts::COUNT, at, before + 1u32);
    before
}

/// Sum the counts of a class over the blocks: each becomes the sum before it.
fn scan(b: &mut Block, place: U32) {
    let blocks = end(b, range::BLOCKS);
    let start = (U32::from(0), U32::from(0));
    let (_, sum) = b.while_(
        start,
        |_, (block, _)| block.lt(blocks),
        |b, (block, sum)| {
            let at = place * blocks + block;
            let count: U32 = b.load(Counts::COUNT, at);
            b.store(Counts::COUNT, at, sum);
            (block + 1u32, sum + count)
        },
    );
    b.store(Ranges::END, place + range::CLASSES, sum);
}

/// Put the classes one after the other.
fn plan(b: &mut Block, classes: U32) {
    let place = |b: &mut Block, place: U32, first: U32| {
        let range = place + range::CLASSES;
        let count: U32 = b.load(Ranges::END, range);
        set_range(b, range, first, first + count);
        first + count
    };
    let start = (U32::from(0), U32::from(0));
    let (_, hits) =
        b.while_(start, |_, (class, _)| class.lt(classes), |b, (class, first)| (class + 1u32, place(b, class, first)));
    let live = place(b, classes, hits);
    set_range(b, range::SHADOWS.into(), 0.into(), hits);
    set_range(b, range::NEXT.into(), 0.into(), live);
}

/// Put the numbers of a block's rows where their class has room for them.
fn scatter(b: &mut Block, block: U32, blocks: U32, classes: U32) {
    each_live(b, block, classes, |b, row, place| {
        let first: U32 = b.load(Ranges::FIRST, place + range::CLASSES);
        let before = next_of(b, place * blocks + block);
        b.store(Order::PATH, first + before, row);
    });
}

/// Each row of a block whose path has a ray, and the place of its class. The last kernel shades what has none of its own.
fn each_live(b: &mut Block, block: U32, classes: U32, body: impl FnOnce(&mut Block, U32, U32)) {
    let (first, paths) = (block * BLOCK, end(b, range::PATHS));
    each(b, first, (first + BLOCK).min(paths), |b, row| {
        let alive: Bool = b.load(Paths::ALIVE, row);
        b.when(alive, |b| {
            let class: U32 = b.load(Hits::CLASS, row);
            let place = class.eq(NONE).select(classes, class.min(classes - 1u32));
            body(b, row, place);
        });
    });
}

/// All numbers from one up to another.
fn each(b: &mut Block, first: U32, end: U32, body: impl FnOnce(&mut Block, U32)) {
    b.while_(
        first,
        |_, i| i.lt(end),
        |b, i| {
            body(b, i);
            i + 1u32
        },
    );
}

/// Bring the sample of a path that ended to its place.
fn retire(b: &mut Block, i: U32) {
    let alive: Bool = b.load(Next::ALIVE, i);
    b.when(!alive, |b| {
        let (sample, number): ((Color, U32, U32), U32) = b.load_record(Next::R, i);
        b.store_record(Samples::R, number, sample);
    });
}

/// Sum the samples of pixel i of the piece.
fn accumulate(b: &mut Block, i: U32) {
    let samples = Row::<Frame>::at(0u32).get(Frame::SAMPLES);
    let start = (U32::from(0), PixelSum::zero());
    let (_, sum) = b.while_(
        start,
        |_, (sample, _)| sample.lt(samples),
        |b, (sample, sum)| {
            let (radiance, closest, shadow): (Color, U32, U32) = b.load_record(Samples::R, i * samples + sample);
            (sample + 1u32, sum.with(radiance, closest, shadow))
        },
    );
    sum.store(b, i);
}
