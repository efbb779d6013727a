//! The scalar CPU device, host half: one kernel, which follows each path of a batch from the camera to its end.

use jerboa_backend_cranelift::Binding;
use jerboa_ir::lang::Buf;

use super::dispatch::{call, tables_bound};
use super::error::Error;
use super::generate::Generated;
use super::tables::Tables;
use super::work::Work;
use crate::schema::{Frame, LIGHT_VERTICES, LightVertices, Pixels, Samples, binding};

/// Items of a batch: so few rays that cancelling need not end it (accuracy.md, N22), and far more work than starting it.
const BATCH: u32 = 256;

/// Trace all items. Light that falls on any pixel is added to `splats`, rows of [`Pixels`]: one for each pixel of the film,
/// or none where the tracer has no such light.
///
/// # Errors
/// When the kernel gives up: a fault of Jerboa.
pub fn run(kernel: &Generated, tables: &Tables, work: &mut impl Work, splats: &mut [u32]) -> Result<(), Error> {
    let mut samples = [0; BATCH as usize * Samples::COLUMNS.len()];
    let mut bindings = tables_bound(tables);
    let kept = if splats.is_empty() { 0 } else { LIGHT_VERTICES };
    let mut vertices = vec![0; kept as usize * LightVertices::COLUMNS.len()];
    bindings[binding::<LightVertices>()] = Binding::new(&mut vertices, kept);
    bindings[binding::<Pixels>()] = Binding::new(splats, (splats.len() / Pixels::COLUMNS.len()) as u32);
    while !work.is_cancelled()
        && let Some(mut batch) = work.next(BATCH)
    {
        bindings[binding::<Frame>()] = Binding::new(&mut batch.frame, 1);
        bindings[binding::<Samples>()] = Binding::new(&mut samples, batch.count);
        call(kernel, &bindings, &[batch.first, batch.count])?;
        for i in 0..batch.count {
            let column = |c: usize| samples[c * batch.count as usize + i as usize];
            work.done(batch.number + i, std::array::from_fn(column));
        }
    }
    Ok(())
}
