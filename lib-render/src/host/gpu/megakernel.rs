//! The megakernel GPU device, host half: see [`crate::device::megakernel`].

use super::{Extent, Launch, Machine, Piece};
use crate::host::error::Error;
use crate::schema::{Pixels, binding};

/// Trace a piece: one launch.
///
/// # Errors
/// When the device has no memory or is lost.
pub fn trace(machine: &mut impl Machine, piece: Piece) -> Result<(), Error> {
    machine.reserve(&[(binding::<Pixels>(), piece.pixels)])?;
    let arguments = vec![piece.pixels, piece.first];
    machine.run(&[vec![Launch { kernel: 0, arguments, extent: Extent::Items(piece.pixels), swapped: false }]])
}
