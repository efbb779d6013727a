//! What a kernel is given: the storage buffers of group 0, and the words of binding 0, the *launch*.
//!
//! | words of the launch | what they are |
//! |---|---|
//! | arguments | the entry's parameters in order (without the number of the invocation), a vector by its lanes |
//! | two per buffer of the program, by number | its first word within its storage buffer, and its number of rows |
//! | the last | 0: a zero that no driver can fold (see `function/top.rs`) |
//!
//! A stream without rows has the first word 0. Every module of one program and packing has the same bindings, whether its
//! kernel uses them or not, but for the results; what is only read may lie where the grid of an indirect launch does.

use jerboa_ir::cfg::Cfg;
use jerboa_ir::{Body, BufId, Mem, Program};

/// What a storage buffer holds. Its binding number is its place in [`crate::Module::bindings`]; there are no gaps.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Binding {
    /// The launch; read only.
    Launch,
    /// These tables of the program, or streams to none of which the kernel stores; read only.
    Tables(Vec<BufId>),
    /// These streams of the program; read and written.
    Streams(Vec<BufId>),
    /// The results, a word for each; written.
    Results,
}

impl Binding {
    /// May kernels write to it? Then its access in the module is read and write, otherwise read only.
    pub fn is_written(&self) -> bool {
        matches!(self, Binding::Streams(_) | Binding::Results)
    }

    /// All bindings of a kernel with this graph.
    pub(crate) fn all(program: &Program, cfg: &Cfg, groups: Vec<Vec<BufId>>, results: u32) -> Vec<Binding> {
        let blocks = cfg.functions.iter().flat_map(|f| &f.blocks);
        let stored: Vec<BufId> = blocks
            .filter_map(|block| match &program.cont(block.cont).body {
                Body::Store { mem: Mem::Stream(column), .. } => Some(column.buf),
                _ => None,
            })
            .collect();
        let group = |group: Vec<BufId>| match group.iter().any(|buf| stored.contains(buf)) {
            true => Binding::Streams(group),
            false => Binding::Tables(group),
        };
        let mut bindings = vec![Binding::Launch];
        bindings.extend(groups.into_iter().map(group));
        bindings.extend((results > 0).then_some(Binding::Results));
        bindings
    }
}

/// Places in the launch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Launch {
    /// Words of arguments.
    pub arguments: u32,
    /// Buffers of the program.
    pub buffers: u32,
}

impl Launch {
    /// First word of a buffer within its storage buffer.
    pub fn start(self, buf: BufId) -> u32 {
        self.arguments + 2 * buf.0
    }

    /// Number of rows of a buffer.
    pub fn rows(self, buf: BufId) -> u32 {
        self.start(buf) + 1
    }

    /// The word that is 0.
    pub fn zero(self) -> u32 {
        self.arguments + 2 * self.buffers
    }
}
