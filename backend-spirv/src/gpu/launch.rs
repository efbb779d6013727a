//! Running kernels.

use std::time::{Duration, Instant};

use wgpu::{
    BindGroupDescriptor, BindGroupEntry, BindingResource, BufferBinding, BufferUsages, CommandEncoderDescriptor,
    ComputePassDescriptor,
};

use super::device::lock;
use super::memory::bytes;
use super::{Error, Gpu, Kernel, MOST_GROUPS, Memory};
use crate::Binding;

/// Where a launch's words may start: a multiple of so many, for every adapter (256 bytes).
const ALIGN: usize = 64;

/// Words of a grid: workgroups in x, y and z.
const GRID: usize = 3;

/// Where a buffer of the program lies.
#[derive(Clone, Copy, Debug)]
pub struct Bound<'a> {
    /// In which memory.
    pub memory: &'a Memory,
    /// Its first word there.
    pub start: u32,
    /// Its rows.
    pub rows: u32,
}

/// How many invocations.
#[derive(Clone, Copy, Debug)]
pub enum Extent<'a> {
    /// So many, rounded up to whole workgroups; see [`groups`].
    Items(u32),
    /// As three words of a memory say when the launch begins: workgroups in x, y (at most [`MOST_GROUPS`] each) and z (1).
    /// If the launch binds this memory to write to it, the words are copied first, since a dispatch may not do both.
    Indirect {
        /// Holds the words.
        memory: &'a Memory,
        /// The first of them.
        word: u32,
    },
}

/// One launch of a kernel.
#[derive(Clone, Debug)]
pub struct Launch<'a> {
    /// What runs.
    pub kernel: &'a Kernel,
    /// Its arguments as words: a float as its bits, a bool as 0 or 1.
    pub arguments: Vec<u32>,
    /// Where each buffer of the program lies, in the program's order. What shares a binding shares a memory.
    pub buffers: &'a [Bound<'a>],
    /// Takes the entry's results, if it has any.
    pub results: Option<&'a Memory>,
    /// How many invocations.
    pub extent: Extent<'a>,
}

/// The workgroups in x and y that make up `items` invocations, `workgroup` each: as even as 65,535 along a side allows. The
/// invocation's number is `(group.y * groups.x + group.x) * workgroup + local`, so some numbers at the end are beyond `items`.
pub fn groups(items: u32, workgroup: u32) -> [u32; 2] {
    let all = items.div_ceil(workgroup);
    let rows = all.div_ceil(MOST_GROUPS).max(1);
    [all.div_ceil(rows), rows]
}

impl Gpu {
    /// Submits launches: each inner list is a compute pass, whose launches run in order, each seeing what those before it
    /// wrote. Returns at once; [`Gpu::wait`] and [`Gpu::read`] see the end.
    ///
    /// # Errors
    ///
    /// A launch does not fit its kernel (nothing is submitted then), or the device is lost.
    pub fn run(&self, passes: &[Vec<Launch>]) -> Result<(), Error> {
        let mut words = Vec::new();
        for launch in passes.iter().flatten() {
            launch.check()?;
            launch.write(&mut words);
        }
        // From the upload to the submission, lest another thread's launches take the place of these.
        let mut held = lock(&self.launches);
        let launches = match held.take().filter(|b| b.size() >= 4 * words.len() as u64) {
            Some(buffer) => buffer,
            None => {
                let bytes = 4 * words.len().next_power_of_two().max(1 << 12) as u64;
                self.buffer(bytes, BufferUsages::STORAGE | BufferUsages::INDIRECT | BufferUsages::COPY_DST)?
            }
        };
        self.guarded("launches", || {
            self.queue.write_buffer(&launches, 0, bytes(&words));
            let mut encoder = self.device.create_command_encoder(&CommandEncoderDescriptor::default());
            let mut at = 0;
            for pass in passes {
                let mut compute = None;
                for launch in pass {
                    if let Some((memory, word)) = launch.grid_to_copy() {
                        // A copy stands between passes.
                        compute = None;
                        let (from, to) = (4 * u64::from(word), 4 * (at + launch.words()) as u64);
                        encoder.copy_buffer_to_buffer(&memory.buffer, from, &launches, to, 4 * GRID as u64);
                    }
                    let begin = || encoder.begin_compute_pass(&ComputePassDescriptor::default()).forget_lifetime();
                    launch.encode(self, compute.get_or_insert_with(begin), &launches, at);
                    at += launch.room();
                }
            }
            self.queue.submit([encoder.finish()]);
        })?;
        *held = Some(launches);
        Ok(())
    }

    /// Launches a kernel with nothing to do, and returns how long that took: what a driver has left to compile until the
    /// first dispatch. Waits for all that was submitted before and after.
    ///
    /// # Errors
    ///
    /// The device is out of memory or lost.
    pub fn warm(&self, kernel: &Kernel) -> Result<Duration, Error> {
        self.wait()?;
        // A memory for each binding, as one may not be bound both to read and to write.
        let memories = kernel.bindings.iter().map(|_| self.memory(1)).collect::<Result<Vec<Memory>, Error>>()?;
        let results = self.memory(kernel.results.into())?;
        let mut buffers = vec![Bound { memory: &results, start: 0, rows: 0 }; kernel.buffers()];
        for (binding, memory) in kernel.bindings.iter().zip(&memories) {
            if let Binding::Tables(group) | Binding::Streams(group) = binding {
                group.iter().for_each(|buf| buffers[buf.index()].memory = memory);
            }
        }
        let launch = Launch {
            kernel,
            arguments: vec![0; kernel.arguments as usize],
            buffers: &buffers,
            results: (kernel.results > 0).then_some(&results),
            extent: Extent::Items(0),
        };
        let start = Instant::now();
        self.run(&[vec![launch]])?;
        self.wait()?;
        Ok(start.elapsed())
    }
}

impl Launch<'_> {
    /// That it fits its kernel.
    fn check(&self) -> Result<(), Error> {
        let misfit =
            |why: String| Err(Error::Misfit { what: format!("a launch of the kernel `{}`", self.kernel.name), why });
        let (arguments, buffers) = (self.kernel.arguments as usize, self.kernel.buffers());
        if self.arguments.len() != arguments {
            return misfit(format!("it has {} words of arguments, {arguments} are expected", self.arguments.len()));
        }
        if self.buffers.len() != buffers {
            return misfit(format!("it has {} buffers, the program {buffers}", self.buffers.len()));
        }
        let room = self.results.map_or(0, Memory::words);
        if room < self.kernel.results {
            return misfit(format!("its results take {} words, {room} are there", self.kernel.results));
        }
        for (number, binding) in self.kernel.bindings.iter().enumerate() {
            let (Binding::Tables(group) | Binding::Streams(group)) = binding else { continue };
            let holder = self.memory(binding);
            if let Some(buf) = group.iter().find(|buf| Some(self.buffers[buf.index()].memory) != holder) {
                return misfit(format!("buffer {} lies in another memory than the rest of binding {number}", buf.0));
            }
        }
        if let Some(i) = self.buffers.iter().position(|b| b.start > b.memory.words()) {
            return misfit(format!("buffer {i} starts at word {}, beyond its memory's end", self.buffers[i].start));
        }
        match self.extent {
            Extent::Items(items) => {
                let numbers = groups(items, self.kernel.workgroup).map(u64::from).iter().product::<u64>();
                if numbers * u64::from(self.kernel.workgroup) > 1 << 32 {
                    return misfit(format!("{items} invocations are too many"));
                }
            }
            Extent::Indirect { memory, word } => {
                if u64::from(word) + GRID as u64 > u64::from(memory.words()) {
                    return misfit(format!("its grid is at word {word} of a memory of {}", memory.words()));
                }
            }
        }
        Ok(())
    }

    /// The memory of a binding; the launch itself has none of its own.
    fn memory(&self, binding: &Binding) -> Option<&Memory> {
        match binding {
            Binding::Launch => None,
            Binding::Tables(group) | Binding::Streams(group) => Some(self.buffers[group[0].index()].memory),
            Binding::Results => self.results,
        }
    }

    /// The grid, if it lies where the launch may write: then it has to be copied, since a dispatch may not do both.
    fn grid_to_copy(&self) -> Option<(&Memory, u32)> {
        let Extent::Indirect { memory, word } = self.extent else { return None };
        let mut written = self.kernel.bindings.iter().filter(|binding| binding.is_written());
        written.any(|binding| self.memory(binding) == Some(memory)).then_some((memory, word))
    }

    /// How many words the kernel sees.
    fn words(&self) -> usize {
        self.arguments.len() + 2 * self.buffers.len() + 1
    }

    /// Words that it takes among the launches: those, and after them a copy of its grid.
    fn room(&self) -> usize {
        (self.words() + GRID).next_multiple_of(ALIGN)
    }

    /// Arguments, where each buffer is, and a zero that no driver can know.
    fn write(&self, words: &mut Vec<u32>) {
        let end = words.len() + self.room();
        words.extend(&self.arguments);
        words.extend(self.buffers.iter().flat_map(|b| [b.start, b.rows]));
        words.resize(end, 0);
    }

    /// Adds it to a pass; its words are at `at` of `launches`.
    fn encode(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass, launches: &wgpu::Buffer, at: usize) {
        let size = wgpu::BufferSize::new(4 * self.words() as u64);
        let told = BindingResource::Buffer(BufferBinding { buffer: launches, offset: 4 * at as u64, size });
        let memories = self.kernel.bindings.iter().filter_map(|binding| self.memory(binding));
        let memories = memories.map(|memory| memory.buffer.as_entire_binding());
        let numbered = (0..).zip([told].into_iter().chain(memories));
        let entries: Vec<BindGroupEntry> =
            numbered.map(|(binding, resource)| BindGroupEntry { binding, resource }).collect();
        let descriptor = BindGroupDescriptor { label: None, layout: &self.kernel.layout, entries: &entries };
        pass.set_pipeline(&self.kernel.pipeline);
        pass.set_bind_group(0, &gpu.device.create_bind_group(&descriptor), &[]);
        match self.extent {
            Extent::Items(items) => {
                let [x, y] = groups(items, self.kernel.workgroup);
                pass.dispatch_workgroups(x, y, 1);
            }
            Extent::Indirect { .. } if self.grid_to_copy().is_some() => {
                pass.dispatch_workgroups_indirect(launches, 4 * (at + self.words()) as u64);
            }
            Extent::Indirect { memory, word } => pass.dispatch_workgroups_indirect(&memory.buffer, 4 * u64::from(word)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_holds_all_items_and_few_more() {
        for items in [0, 1, 64, 65, 4_194_240, 4_194_241, 16_777_216, 1 << 31] {
            let [x, y] = groups(items, 64);
            let numbers = u64::from(x) * u64::from(y) * 64;
            assert!(x <= MOST_GROUPS && y <= MOST_GROUPS && numbers >= u64::from(items), "{items}: {x} x {y}");
            assert!(numbers < u64::from(items) + 64 * u64::from(y + 1), "{items}: {x} x {y}");
        }
        assert_eq!(groups(0, 64), [0, 1]);
    }
}
