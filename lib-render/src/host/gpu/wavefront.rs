//! The wavefront GPU device, host half: see [`crate::device::wavefront`] for the kernels.
//!
//! The host submits some waves at a time, each a pass of its own, and then looks how many rows of paths are left; where paths
//! have ended it starts new ones behind those rows.

use super::{Extent, Launch, Machine, Piece};
use crate::device::wavefront::{BLOCK, range};
use crate::host::error::Error;
use crate::host::renderer::Handle;
use crate::schema::*;

/// The stages of the device, and so its kernels, in the order of their numbers; does a kernel depend on the tracer, and how many
/// parameters has it? Behind them is a kernel `shade` for each class, and `shadow` where vertices may ask for light.
pub const STAGES: [(&str, bool, usize); 10] = [
    ("generate", true, 5),
    ("begin", false, 1),
    ("trace", false, 1),
    ("count", false, 2),
    ("scan", false, 2),
    ("plan", false, 2),
    ("scatter", false, 2),
    ("miss", true, 2),
    ("retire", false, 1),
    ("accumulate", false, 2),
];

const GENERATE: usize = 0;
const BEGIN: usize = 1;
const TRACE: usize = 2;
const COUNT: usize = 3;
const SCAN: usize = 4;
const PLAN: usize = 5;
const SCATTER: usize = 6;
const MISS: usize = 7;
const RETIRE: usize = 8;
const ACCUMULATE: usize = 9;
/// The first class of shaders; the others follow, then `shadow`.
const SHADE: usize = STAGES.len();

/// The kernels behind those of [`STAGES`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Shading {
    /// How many `shade`.
    pub classes: u32,
    /// Is there a `shadow`?
    pub asks: bool,
}

/// Waves between two looks: half of all paths of a room end in so many.
const WAVES: usize = 4;

/// Trace a piece. Says whether it was completed, that is, not cancelled.
///
/// # Errors
/// When the device has no memory or is lost.
pub fn trace(machine: &mut impl Machine, shading: Shading, piece: Piece, handle: &Handle) -> Result<bool, Error> {
    let items = piece.pixels * piece.samples;
    // Half of the paths wait until others have ended, so that waves stay full for longer.
    let slots = items.div_ceil(2);
    machine.reserve(&streams(shading.classes, piece, slots))?;
    let (mut given, mut rows, mut swapped) = (0, 0, false);
    loop {
        let mut passes = Vec::new();
        let more = (slots - rows).min(items - given);
        if more > 0 {
            let arguments = vec![more, rows, piece.first * piece.samples + given, given];
            passes.push(vec![Launch { kernel: GENERATE, arguments, extent: Extent::Items(more), swapped }]);
            (given, rows) = (given + more, rows + more);
        }
        if rows == 0 {
            break;
        }
        for _ in 0..WAVES {
            passes.push(wave(shading, swapped));
            swapped = !swapped;
        }
        machine.run(&passes)?;
        if handle.is_cancelled() {
            return Ok(false);
        }
        let next = machine.read(binding::<Ranges>(), range::NEXT..range::NEXT + 1)?;
        rows = next[Ranges::END.0 as usize];
    }
    let extent = Extent::Items(piece.pixels);
    machine.run(&[vec![Launch { kernel: ACCUMULATE, arguments: vec![piece.pixels], extent, swapped }]])?;
    Ok(true)
}

/// Rows of each stream for so many paths.
fn streams(classes: u32, piece: Piece, slots: u32) -> [(usize, u32); 9] {
    [
        (binding::<Paths>(), slots),
        (binding::<Next>(), slots),
        (binding::<Hits>(), slots),
        (binding::<Order>(), slots),
        (binding::<Shadows>(), slots),
        (binding::<Samples>(), piece.pixels * piece.samples),
        (binding::<Pixels>(), piece.pixels),
        (binding::<Ranges>(), range::CLASSES + classes + 1),
        (binding::<Counts>(), slots.div_ceil(BLOCK) * (classes + 1)),
    ]
}

/// Take all live paths one vertex further.
fn wave(Shading { classes, asks }: Shading, swapped: bool) -> Vec<Launch> {
    use Extent::{Items, Range};
    let launch = |kernel, arguments: &[u32], extent| Launch { kernel, arguments: arguments.into(), extent, swapped };
    let mut wave = vec![
        launch(BEGIN, &[], Items(1)),
        launch(TRACE, &[], Range(range::PATHS)),
        launch(COUNT, &[classes], Range(range::BLOCKS)),
        launch(SCAN, &[classes], Items(classes + 1)),
        launch(PLAN, &[classes], Items(1)),
        launch(SCATTER, &[classes], Range(range::BLOCKS)),
    ];
    wave.extend((0..classes).map(|class| launch(SHADE + class as usize, &[0, class], Range(range::CLASSES + class))));
    wave.push(launch(MISS, &[classes], Range(range::CLASSES + classes)));
    wave.extend(asks.then(|| launch(SHADE + classes as usize, &[], Range(range::SHADOWS))));
    wave.push(launch(RETIRE, &[], Range(range::NEXT)));
    wave
}
