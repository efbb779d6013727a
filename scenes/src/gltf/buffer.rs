//! Buffers and the views into them, and the budget for what is decoded from them.

use super::Loader;
use super::folder::{Resolved, resolve};
use super::json::Json;
use crate::Error;
use std::borrow::Cow;
use std::rc::Rc;

/// The bytes of a buffer: the GLB's own chunk, or read from elsewhere.
pub(super) type Bytes<'a> = Rc<Cow<'a, [u8]>>;

impl<'a> Loader<'a> {
    /// The buffer view that the index at `reference` points to: its buffer, first byte, length, and JSON.
    pub fn view(&mut self, reference: &Json<'a>) -> Result<(Bytes<'a>, usize, usize, Json<'a>), Error> {
        let (_, view) = reference.refer(&self.root, "bufferViews", "buffer views")?;
        let bytes = self.buffer(&view.need("buffer")?)?;
        let offset = view.integer_or("byteOffset", 0)?;
        let length = view.need("byteLength")?.integer()?;
        if offset.checked_add(length).is_none_or(|end| end > bytes.len() as u64) {
            let reason = format!("bytes {offset} to {offset} + {length} of a buffer of {}", bytes.len());
            return Err(view.fault(reason));
        }
        Ok((bytes, offset as usize, length as usize, view))
    }

    /// The buffer that the index at `reference` points to, read once.
    fn buffer(&mut self, reference: &Json<'a>) -> Result<Bytes<'a>, Error> {
        let (index, at) = reference.refer(&self.root, "buffers", "buffers")?;
        if let Some(known) = self.buffers.get(&index) {
            return Ok(known.clone());
        }
        let length = at.need("byteLength")?.integer()?;
        let bytes: Cow<'a, [u8]> = match (at.get("uri"), self.bin) {
            (Some(uri), _) => match resolve(&uri, self.limits)? {
                Resolved::Bytes(bytes) => bytes.into(),
                Resolved::Missing(reason) => return Err(uri.uri_fault(reason)),
            },
            (None, Some(bin)) if index == 0 => bin.into(),
            (None, _) => return Err(at.fault("no uri, and no binary chunk in the file")),
        };
        if length > bytes.len() as u64 {
            return Err(at.need("byteLength")?.fault(format!("{length} bytes, but there are only {}", bytes.len())));
        }
        let bytes = Rc::new(bytes);
        self.buffers.insert(index, bytes.clone());
        Ok(bytes)
    }

    /// Takes `count` values of `size` bytes from the budget for geometry.
    pub fn spend(&mut self, at: &Json, count: usize, size: usize) -> Result<(), Error> {
        let cost = count as u64 * size as u64;
        match self.geometry_left.checked_sub(cost) {
            Some(left) => self.geometry_left = left,
            None => {
                let limit = format!("{} bytes in all (geometry_bytes)", self.limits.geometry_bytes);
                return Err(
                    at.limit_fault(format!("the geometry up to here, {count} elements of {size} bytes more,"), limit)
                );
            }
        }
        Ok(())
    }
}
