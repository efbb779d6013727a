//! What is emitted.

use jerboa_ir::Scalar;

use crate::launch::Binding;
use crate::{Grid, spirv};

/// A kernel for GPUs: a module that naga's validator has accepted, and its SPIR-V.
#[derive(Clone, Debug)]
pub struct Module {
    pub(crate) name: String,
    pub(crate) grid: Grid,
    pub(crate) naga: naga::Module,
    pub(crate) info: naga::valid::ModuleInfo,
    pub(crate) words: Vec<u32>,
    pub(crate) structured: String,
    pub(crate) report: Report,
    pub(crate) arguments: u32,
    pub(crate) results: u32,
    pub(crate) bindings: Vec<Binding>,
}

impl Module {
    /// The entry's name, in the program and in the module.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// How invocations are numbered.
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// The kernel as structured text: blocks, choices, labels, loops and exits, with the nodes that each block computes.
    pub fn structured(&self) -> String {
        self.structured.clone()
    }

    /// The naga module as WGSL.
    pub fn naga(&self) -> String {
        let flags = naga::back::wgsl::WriterFlags::empty();
        naga::back::wgsl::write_string(&self.naga, &self.info, flags)
            .unwrap_or_else(|e| format!("// naga does not write this module as WGSL: {e}\n"))
    }

    /// SPIR-V 1.3, in the exact form.
    pub fn spirv(&self) -> &[u32] {
        &self.words
    }

    /// The SPIR-V as text.
    pub fn assembly(&self) -> String {
        spirv::assembly(&self.words)
    }

    /// The naga module: for the other GPU interfaces, which have no exact form.
    pub fn ir(&self) -> &naga::Module {
        &self.naga
    }

    /// What naga's validator found.
    pub fn info(&self) -> &naga::valid::ModuleInfo {
        &self.info
    }

    /// What it costs.
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// Words of arguments, with which the launch begins.
    pub fn arguments(&self) -> u32 {
        self.arguments
    }

    /// Words of results.
    pub fn results(&self) -> u32 {
        self.results
    }

    /// The storage buffers of group 0; the place is the binding number.
    pub fn bindings(&self) -> &[Binding] {
        &self.bindings
    }
}

/// What a kernel costs.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Report {
    /// Functions, the entry included.
    pub functions: usize,
    /// Places where a function is called; drivers unfold them.
    pub calls: usize,
    /// Blocks of the residual.
    pub blocks: usize,
    /// Expressions of naga.
    pub expressions: usize,
    /// Words of SPIR-V.
    pub words: usize,
    /// Values that go through a variable because they are used out of the naga block that computes them.
    pub spills: usize,
    /// Local arrays.
    pub arrays: Vec<Array>,
}

/// A local array.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Array {
    /// The function that makes it.
    pub function: String,
    /// The type of its elements.
    pub scalar: Scalar,
    /// Their number.
    pub len: u32,
}
