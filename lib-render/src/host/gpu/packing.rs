//! Where the buffers of the schema lie on a GPU, which binds few at a time.

use jerboa_ir::BufKind;
use jerboa_ir::lang::Buf;

use crate::host::error::Error;
use crate::host::tables::Tables;
use crate::schema::{BUFFERS, Next, Paths, Ranges};

/// Memories for tables, at most: seven can be bound beside the launch, and three hold streams.
const FOR_TABLES: usize = 4;

/// In which memory each buffer lies, and where.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Packing {
    /// For each buffer the number of its memory, from 1 on.
    pub memories: Vec<u32>,
    /// For each table its first word; for streams see [`Packing::streams`].
    pub starts: Vec<u32>,
    /// Words of each memory with tables.
    pub tables: Vec<u64>,
}

/// Streams that share a memory, by the first of them. What kernels read grids from is apart, since a launch may not write there.
const STREAMS: u32 = 3;

fn group(name: &str) -> u32 {
    match name {
        _ if name == Paths::NAME || name == Next::NAME => 0,
        _ if name == Ranges::NAME => 1,
        _ => 2,
    }
}

impl Packing {
    /// Tables into as few memories as can be, each of so many bytes at most, in the order of their numbers; then the streams.
    ///
    /// # Errors
    /// When they do not fit: which table is too large, or that there is too much in all.
    pub fn new(tables: &Tables, most_bytes: u64) -> Result<Packing, Error> {
        let is_table = |buffer: usize| BUFFERS[buffer].1 != BufKind::Stream;
        let mut packing =
            Packing { memories: vec![0; BUFFERS.len()], starts: vec![0; BUFFERS.len()], tables: Vec::new() };
        for (buffer, memory) in tables.memory.iter().enumerate().filter(|(buffer, _)| is_table(*buffer)) {
            let words = memory.words.len() as u64;
            let fits = |used: &u64| 4 * (used + words) <= most_bytes;
            if !fits(&0) {
                return Err(too_large(&format!("the table `{}`", BUFFERS[buffer].0), 4 * words, most_bytes));
            }
            let place = packing.tables.iter().position(fits).unwrap_or_else(|| {
                packing.tables.push(0);
                packing.tables.len() - 1
            });
            packing.memories[buffer] = place as u32 + 1;
            packing.starts[buffer] = packing.tables[place] as u32;
            packing.tables[place] += words;
        }
        if packing.tables.len() > FOR_TABLES {
            let words: u64 = packing.tables.iter().sum();
            return Err(too_large("all tables together", 4 * words, FOR_TABLES as u64 * most_bytes));
        }
        for buffer in (0..BUFFERS.len()).filter(|buffer| !is_table(*buffer)) {
            packing.memories[buffer] = packing.tables.len() as u32 + 1 + group(BUFFERS[buffer].0);
        }
        Ok(packing)
    }

    /// First word of each stream, and words of each memory with streams, if streams have so many rows.
    pub fn streams(&self, rows: &[u32]) -> (Vec<u32>, Vec<u64>) {
        let (mut starts, mut words) = (self.starts.clone(), vec![0; STREAMS as usize]);
        for (buffer, (name, kind, _, columns)) in BUFFERS.iter().enumerate() {
            if *kind == BufKind::Stream {
                let used: &mut u64 = &mut words[group(name) as usize];
                starts[buffer] = *used as u32;
                *used += u64::from(rows[buffer]) * columns.len() as u64;
            }
        }
        (starts, words)
    }
}

fn too_large(what: &str, bytes: u64, most: u64) -> Error {
    let mib = |bytes: u64| bytes.div_ceil(1 << 20);
    Error::new(format!(
        "{what} of the scene takes {} MiB, and the GPU allows {} MiB: use a CPU device, or smaller textures",
        mib(bytes),
        mib(most)
    ))
}

#[cfg(test)]
mod tests {
    use jerboa_scenes::Scene;

    use super::*;
    use crate::host::tables::{Choices, Known};
    use crate::schema::{Hits, Tree, binding};

    fn tables() -> Tables {
        let scene = Scene::load("builtin:textures").expect("a built-in loads");
        Tables::new(&scene, &Choices::default(), Known::Structure)
    }

    #[test]
    fn tables_share_as_few_memories_as_can_be() {
        let tables = tables();
        let words: u64 = tables.memory.iter().map(|m| m.words.len() as u64).sum();
        let packing = Packing::new(&tables, u64::MAX).expect("it fits");
        assert_eq!(packing.tables, [words]);
        let packing = Packing::new(&tables, 3 * words).expect("it fits");
        assert!(packing.tables.len() > 1 && packing.tables.iter().all(|used| *used <= 3 * words / 4));
        assert_eq!(packing.tables.iter().sum::<u64>(), words);
    }

    #[test]
    fn what_is_too_large_is_named() {
        let mut tables = tables();
        let tree = std::sync::Arc::make_mut(&mut tables.memory[binding::<Tree>()]);
        tree.words.resize(1 << 19, 0);
        let error = Packing::new(&tables, 1 << 20).expect_err("it does not fit").to_string();
        assert_eq!(
            error,
            "the table `Tree` of the scene takes 2 MiB, and the GPU allows 1 MiB: use a CPU device, or smaller textures"
        );
    }

    #[test]
    fn streams_lie_behind_each_other_and_grids_apart() {
        let packing = Packing::new(&tables(), u64::MAX).expect("it fits");
        let (starts, words) = packing.streams(&vec![10; BUFFERS.len()]);
        assert_eq!((starts[binding::<Paths>()], starts[binding::<Next>()]), (0, 320));
        assert_eq!((words[0], words[1]), (640, 50));
        assert_eq!(packing.memories[binding::<Ranges>()], 3);
        assert_ne!(packing.memories[binding::<Hits>()], 3);
    }
}
