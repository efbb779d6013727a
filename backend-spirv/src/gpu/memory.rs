//! Words on the GPU.

use std::ops::Range;

use wgpu::{BufferDescriptor, BufferUsages, CommandEncoderDescriptor, MapMode};

use super::{Error, Gpu};

/// Words that travel at once, in a buffer that both sides see: 64 MiB.
const TRAVEL: usize = 1 << 24;

/// A buffer of 32-bit words on the GPU; zero until something is written. It is given back when it is dropped.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub struct Memory {
    pub(super) buffer: wgpu::Buffer,
    words: u32,
}

impl Memory {
    /// How many there are.
    pub fn words(&self) -> u32 {
        self.words
    }
}

impl Gpu {
    /// A buffer of so many words, at least one.
    ///
    /// # Errors
    ///
    /// There are more than the adapter allows in one buffer, or than it has memory for.
    pub fn memory(&self, words: u64) -> Result<Memory, Error> {
        let (bytes, most) = (words.max(1).saturating_mul(4), self.adapter().most_bytes());
        if bytes > most {
            return Err(Error::TooLarge { adapter: self.adapter().name().into(), bytes, most });
        }
        let usage = BufferUsages::STORAGE | BufferUsages::INDIRECT | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        let buffer = self.buffer(bytes, usage)?;
        Ok(Memory { buffer, words: (bytes / 4) as u32 })
    }

    /// Writes words from word `at` on. Launches that were submitted before do not see them, later ones do.
    ///
    /// # Errors
    ///
    /// They do not fit, or the device has no memory for them to travel in, or is lost.
    pub fn write(&self, memory: &Memory, at: u32, words: &[u32]) -> Result<(), Error> {
        inside("a write", memory, u64::from(at), words.len() as u64)?;
        for (i, part) in words.chunks(TRAVEL).enumerate() {
            let offset = 4 * (u64::from(at) + (i * TRAVEL) as u64);
            self.guarded("a write", || self.queue.write_buffer(&memory.buffer, offset, bytes(part)))?;
            if part.len() == TRAVEL {
                // One part at a time on its way, or a large table would be there twice.
                self.queue.submit([]);
                self.wait()?;
            }
        }
        Ok(())
    }

    /// Waits for all that was submitted, and reads these words.
    ///
    /// # Errors
    ///
    /// There are not so many, or the device has no memory for them to travel in, or is lost.
    pub fn read(&self, memory: &Memory, words: Range<u32>) -> Result<Vec<u32>, Error> {
        let count = words.end.saturating_sub(words.start) as usize;
        inside("a read", memory, u64::from(words.start), count as u64)?;
        let mut read = Vec::with_capacity(count);
        if count == 0 {
            self.wait()?;
            return Ok(read);
        }
        let stage = self.buffer(4 * count.min(TRAVEL) as u64, BufferUsages::MAP_READ | BufferUsages::COPY_DST)?;
        while read.len() < count {
            let (start, part) = (words.start as usize + read.len(), (count - read.len()).min(TRAVEL));
            self.guarded("a read", || {
                let mut encoder = self.device.create_command_encoder(&CommandEncoderDescriptor::default());
                encoder.copy_buffer_to_buffer(&memory.buffer, 4 * start as u64, &stage, 0, 4 * part as u64);
                self.queue.submit([encoder.finish()]);
                // Whether it is mapped shows below, when the words are asked for.
                stage.slice(..4 * part as u64).map_async(MapMode::Read, |_| ());
            })?;
            self.wait()?;
            let mapped = stage.slice(..4 * part as u64).get_mapped_range();
            let mapped = mapped.map_err(|e| Error::Refused { doing: "a read".into(), why: e.to_string() })?;
            read.extend(mapped.as_chunks().0.iter().map(|word| u32::from_le_bytes(*word)));
            drop(mapped);
            stage.unmap();
        }
        Ok(read)
    }

    /// A buffer of so many bytes.
    pub(super) fn buffer(&self, bytes: u64, usage: BufferUsages) -> Result<wgpu::Buffer, Error> {
        let descriptor = BufferDescriptor { label: None, size: bytes, usage, mapped_at_creation: false };
        self.guarded(&format!("a buffer of {bytes} bytes"), || self.device.create_buffer(&descriptor))
    }
}

/// That `count` words from `at` on are in `memory`.
fn inside(what: &str, memory: &Memory, at: u64, count: u64) -> Result<(), Error> {
    if at + count <= u64::from(memory.words) {
        return Ok(());
    }
    let why = format!("words {at} to {} of a buffer that has {}", at + count, memory.words);
    Err(Error::Misfit { what: what.into(), why })
}

/// Words as the GPU has them: little-endian, as the processors are that kernels run on.
pub(super) fn bytes(words: &[u32]) -> &[u8] {
    const { assert!(cfg!(target_endian = "little")) };
    // SAFETY: the same memory, four bytes for each word; every byte of it has a value, and u8 needs no alignment.
    unsafe { std::slice::from_raw_parts(words.as_ptr().cast(), size_of_val(words)) }
}
