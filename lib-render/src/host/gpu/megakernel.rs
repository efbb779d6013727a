//! The megakernel GPU device, host half: see [`crate::device::megakernel`].

use jerboa_ir::lang::Buf;

use super::{Extent, Launch, Machine, Piece};
use crate::host::error::Error;
use crate::host::renderer::Handle;
use crate::schema::{Paths, Pixels, binding};

/// Trace a piece: launches until each pixel has its samples. Says whether it was completed, that is, not cancelled.
///
/// # Errors
/// When the device has no memory or is lost.
pub fn trace(machine: &mut impl Machine, piece: Piece, handle: &Handle) -> Result<bool, Error> {
    let Piece { first, pixels, samples } = piece;
    machine.reserve(&[(binding::<Pixels>(), pixels), (binding::<Paths>(), pixels)])?;
    let mut fresh = 1;
    loop {
        let arguments = vec![pixels, first, fresh];
        machine.run(&[vec![Launch { kernel: 0, arguments, extent: Extent::Items(pixels), swapped: false }]])?;
        if handle.is_cancelled() {
            return Ok(false);
        }
        let sums = machine.read(binding::<Pixels>(), 0..pixels)?;
        let is_done = |row: &[u32]| row[Pixels::COUNT.0 as usize] + row[Pixels::DROPPED.0 as usize] == samples;
        if sums.chunks(Pixels::COLUMNS.len()).all(is_done) {
            return Ok(true);
        }
        fresh = 0;
    }
}
