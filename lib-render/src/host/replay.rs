//! A pass in the interpreter: the meaning that machine code is compared with, and the way to follow one path.

use jerboa_ir::interp::{Interp, Limits, Observer};
use jerboa_ir::lang::Buf;
use jerboa_ir::{Lit, Program};
use jerboa_scenes::Camera;

use super::error::Error;
use super::tables::memory::Memory;
use super::tables::{Pass, Tables, frame};
use crate::schema::{Frame, Samples, binding};

/// Run the kernel of this name over a pass, in the generic program or in a residual of it. Gives the words of the
/// stream [`Samples`], column by column.
///
/// # Errors
/// When the program reads unchecked out of range or needs too much memory: a fault of Jerboa.
pub fn interpret(
    program: &Program,
    kernel: &str,
    tables: &Tables,
    camera: &Camera,
    pass: &Pass,
    observer: &mut impl Observer,
) -> Result<Vec<u32>, Error> {
    let items = pass.window.area() as u32 * pass.samples;
    let mut memory: Vec<Memory> = tables.memory.iter().map(|m| Memory::clone(m)).collect();
    memory[binding::<Frame>()] = frame(camera, tables.place(camera), pass);
    memory[binding::<Samples>()] = Memory { rows: items, words: vec![0; items as usize * Samples::COLUMNS.len()] };
    let entry = program.entry(kernel).ok_or_else(|| Error::new(format!("there is no kernel `{kernel}`")))?;
    let args = [Lit::U32(0), Lit::U32(items)];
    let interp = Interp::new(program);
    interp
        .run_observed(entry, &args, &mut memory, Limits::default(), observer)
        .map_err(|stop| Error::new(format!("interpreting `{kernel}`: {stop}")))?;
    Ok(std::mem::take(&mut memory[binding::<Samples>()].words))
}
