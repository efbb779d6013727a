//! What an emitted module is made for: how invocations are numbered, where buffers lie, how large it may be.

use jerboa_ir::{BufId, BufKind, Program};

use crate::Error;

/// A kernel reads and writes at most so many storage buffers, the launch and the results included. WebGPU promises no more
/// (its default limit `maxStorageBuffersPerShaderStage`), and nearly every GPU has them.
pub const STORAGE_BUFFERS: usize = 8;

/// Invocations of a workgroup: a multiple of the width of every GPU's vectors (8 on lavapipe, 32 and 64 on hardware).
pub const WORKGROUP: u32 = 64;

/// How often a kernel runs, and what its first parameter is.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Grid {
    /// Many invocations, in workgroups of [`WORKGROUP`]. The entry's first parameter, a `u32`, is the number of the
    /// invocation: (group.y · groups.x + group.x) · [`WORKGROUP`] + the number within the group. The kernel itself checks
    /// that its number is in range; it returns nothing.
    #[default]
    Items,
    /// One invocation. All parameters are arguments of the launch, results go to a buffer of their own.
    Single,
}

/// In which storage buffer each buffer of the program lies.
///
/// By [`BufId`], a number from 1 without gaps (0 is the launch). Tables and streams never share one. Empty: all tables lie
/// in one and all streams in another.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Packing(pub Vec<u32>);

impl Packing {
    /// All tables in one storage buffer and all streams in another.
    pub fn simple(program: &Program) -> Packing {
        let is_table = |b: &jerboa_ir::Buffer| matches!(b.kind, BufKind::Table { .. });
        let streams = if program.buffers.iter().any(is_table) { 2 } else { 1 };
        Packing(program.buffers.iter().map(|b| if is_table(b) { 1 } else { streams }).collect())
    }

    /// The program's buffers in each storage buffer, from number 1 on.
    pub(crate) fn groups(&self, kernel: &str, program: &Program) -> Result<Vec<Vec<BufId>>, Error> {
        let simple;
        let numbers = match self.0.is_empty() {
            true => {
                simple = Packing::simple(program);
                &simple.0
            }
            false => &self.0,
        };
        let wrong = |why: String| Err(Error::Packing { kernel: kernel.to_owned(), why });
        if numbers.len() != program.buffers.len() {
            return wrong(format!("it places {} buffers of {}", numbers.len(), program.buffers.len()));
        }
        let count = numbers.iter().max().map_or(0, |n| *n as usize);
        if count >= STORAGE_BUFFERS {
            return wrong(format!(
                "it uses storage buffer {count}; a kernel has {STORAGE_BUFFERS}, the launch among them"
            ));
        }
        let mut groups: Vec<Vec<BufId>> = vec![Vec::new(); count];
        for (i, number) in numbers.iter().enumerate() {
            match number.checked_sub(1) {
                Some(group) => groups[group as usize].push(BufId(i as u32)),
                None => {
                    return wrong(format!("it puts `{}` into storage buffer 0, the launch", program.buffers[i].name));
                }
            }
        }
        for (i, group) in groups.iter().enumerate() {
            let stream = |b: &&BufId| program.buffer(**b).kind == BufKind::Stream;
            match (group.iter().find(stream), group.iter().find(|b| !stream(b))) {
                (None, None) => return wrong(format!("storage buffer {} is left out", i + 1)),
                (Some(stream), Some(table)) => {
                    let (stream, table) = (&program.buffer(*stream).name, &program.buffer(*table).name);
                    return wrong(format!("stream `{stream}` and table `{table}` share storage buffer {}", i + 1));
                }
                _ => {}
            }
        }
        Ok(groups)
    }
}

/// How large a kernel may be. Drivers take time that grows faster than the kernel: Mesa's lavapipe 22.3 compiled 8,000 words
/// of traversals in 0.25 s, 30,600 in 2.1 s and 90,900 in 17 s (two cores of a recent Xeon, 2026).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Budget {
    /// Words of SPIR-V.
    pub words: usize,
}

impl Default for Budget {
    /// 160,000 words: by the figures above less than a minute of a driver's time at worst. The largest kernel that we have, the
    /// megakernel without knowledge of the scene, has 137,800; of those that know its structure staircase's was the largest, with
    /// 84,600, which lavapipe compiles in 4 s.
    fn default() -> Budget {
        Budget { words: 160_000 }
    }
}

/// What [`crate::emit`] makes.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Options {
    /// How often the kernel runs.
    pub grid: Grid,
    /// Where buffers lie.
    pub packing: Packing,
    /// How large it may be.
    pub budget: Budget,
}
