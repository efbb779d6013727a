//! Linked machine code: who owns it, and how it is called.

use std::mem::ManuallyDrop;

use cranelift_jit::{ArenaMemoryProvider, JITBuilder, JITModule};
use cranelift_module::{FuncId, Linkage, Module, ModuleRelocTarget, default_libcall_names};
use jerboa_ir::Program;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::Error;
use crate::abi::{Binding, Status};
use crate::compile::{self, HOST, KernelReport, Machine, Unlinked};
use crate::target::{Options, Target, fused_multiply_add};

/// Machine code of some kernels. Freed when it is dropped.
pub struct Code {
    /// Nothing touches it between linking and freeing.
    module: ManuallyDrop<JITModule>,
    kernels: Vec<Linked>,
    number: FxHashMap<String, usize>,
}

// SAFETY: after construction the module is not touched until `drop`, which has the only reference; all else is plain data
// and executable memory that nobody writes.
unsafe impl Sync for Code {}
// SAFETY: the module owns its memory and has no tie to a thread.
unsafe impl Send for Code {}

/// A kernel's code in its place.
struct Linked {
    function: extern "C" fn(*const Binding, *const u32, *mut u32) -> u32,
    bindings: usize,
    args: usize,
    results: usize,
    report: KernelReport,
    dumps: Option<(String, String)>,
}

/// Compiles every entry of these residuals, in parallel on rayon's threads. Each entry becomes a kernel of its own with
/// the functions it needs.
pub fn compile(programs: &[&Program], options: &Options) -> Result<Code, Error> {
    Code::for_target(programs, options, &Target::host(options)?)
}

impl Code {
    pub(crate) fn for_target(programs: &[&Program], options: &Options, target: &Target) -> Result<Code, Error> {
        let entries: Vec<_> =
            programs.iter().flat_map(|p| p.entries.iter().map(|(name, cont)| (*p, name, *cont))).collect();
        let kernels: Vec<Unlinked> = entries
            .par_iter()
            .map(|(p, name, cont)| compile::kernel(target, options, p, name, *cont))
            .collect::<Result<_, _>>()?;
        link(target, kernels)
    }

    /// The kernel of this name.
    pub fn kernel(&self, name: &str) -> Option<Kernel<'_>> {
        self.number.get(name).map(|i| Kernel { linked: &self.kernels[*i] })
    }

    /// What each kernel cost, in the order of the entries.
    pub fn reports(&self) -> impl Iterator<Item = &KernelReport> {
        self.kernels.iter().map(|k| &k.report)
    }

    /// The CLIF of a kernel's functions, if there is such a kernel and [`Options::dumps`] was set.
    pub fn clif(&self, name: &str) -> Option<&str> {
        self.dumps(name).map(|(clif, _)| &**clif)
    }

    /// The disassembly of a kernel's functions, if there is such a kernel and [`Options::dumps`] was set.
    pub fn asm(&self, name: &str) -> Option<&str> {
        self.dumps(name).map(|(_, asm)| &**asm)
    }

    fn dumps(&self, name: &str) -> Option<&(String, String)> {
        self.number.get(name).and_then(|i| self.kernels[*i].dumps.as_ref())
    }
}

impl Drop for Code {
    fn drop(&mut self) {
        // SAFETY: the module is not used again, here or elsewhere.
        let module = unsafe { ManuallyDrop::take(&mut self.module) };
        // SAFETY: the code's addresses are in `kernels` and in `Kernel`s, which borrow this value; none outlives it.
        unsafe { module.free_memory() };
    }
}

impl std::fmt::Debug for Code {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.reports()).finish()
    }
}

/// A kernel that can be called, from any number of threads at once.
#[derive(Clone, Copy)]
pub struct Kernel<'c> {
    linked: &'c Linked,
}

impl Kernel<'_> {
    /// Number of argument words: one for each lane of the entry's parameters, in order.
    pub fn args(&self) -> usize {
        self.linked.args
    }

    /// Number of result words: one for each lane of what the entry returns, in order; 0 for the kernels of a renderer.
    pub fn results(&self) -> usize {
        self.linked.results
    }

    /// Runs the kernel. `bindings` is indexed by binding number. A `bool` is the word 0 or 1 (as an argument: not 0), a
    /// NaN among the results may have any bits.
    ///
    /// # Panics
    /// When the numbers of arguments or results are not [`Self::args`] and [`Self::results`], or there are fewer bindings
    /// than the program has buffers.
    ///
    /// # Safety
    /// For each buffer that the kernel touches, `bindings` holds its memory: so many rows as it says, at least one for a
    /// table, with a word for each column, aligned to 4 bytes, less than 2^32 words in all. While the kernel runs nobody
    /// writes to a table, nor to a stream's words that the kernel touches, nor reads words that it writes; the memory of
    /// two bindings is disjoint unless both are only read. Indices that the program reads unchecked are less than the
    /// number of rows. The calling thread has [`crate::STACK_LIMIT`] bytes of stack left.
    pub unsafe fn call(&self, bindings: &[Binding], args: &[u32], results: &mut [u32]) -> Status {
        assert_eq!(args.len(), self.linked.args, "words of arguments of kernel `{}`", self.linked.report.name);
        assert_eq!(results.len(), self.linked.results, "words of results of kernel `{}`", self.linked.report.name);
        assert!(bindings.len() >= self.linked.bindings, "bindings of kernel `{}`", self.linked.report.name);
        match (self.linked.function)(bindings.as_ptr(), args.as_ptr(), results.as_mut_ptr()) {
            0 => Status::Done,
            _ => Status::Limit,
        }
    }
}

/// What placing and linking can meet: the names are unique and the references are to functions of the same kernel.
fn no_memory(e: impl std::fmt::Display) -> Error {
    Error::Memory(e.to_string())
}

/// Gives all functions their place and resolves their references.
fn link(target: &Target, kernels: Vec<Unlinked>) -> Result<Code, Error> {
    let mut builder = JITBuilder::with_isa(target.isa.clone(), default_libcall_names());
    builder.symbol("fused_multiply_add", fused_multiply_add as *const u8);
    // One range of addresses, so that calls reach; at worst each function takes pages of its own, of at most 16 KiB.
    let functions = || kernels.iter().flat_map(|k| &k.functions);
    let reserved = functions().map(|f| (f.bytes.len() + 64).next_multiple_of(1 << 14)).sum::<usize>().max(1 << 14);
    builder.memory_provider(Box::new(ArenaMemoryProvider::new_with_size(reserved).map_err(no_memory)?));
    let mut code =
        Code { module: ManuallyDrop::new(JITModule::new(builder)), kernels: Vec::new(), number: FxHashMap::default() };
    let module = &mut *code.module;

    let mut fma_signature = module.make_signature();
    fma_signature.params = [cranelift_codegen::ir::types::F32; 3].map(cranelift_codegen::ir::AbiParam::new).to_vec();
    fma_signature.returns = fma_signature.params[..1].to_vec();
    let host = module.declare_function("fused_multiply_add", Linkage::Import, &fma_signature).map_err(no_memory)?;
    let mut entries = Vec::new();
    for (i, kernel) in kernels.iter().enumerate() {
        let ids = place(module, kernel, i, host)?;
        entries.extend(ids.last().copied());
    }
    module.finalize_definitions().map_err(no_memory)?;

    for (kernel, entry) in kernels.into_iter().zip(entries) {
        let address = code.module.get_finalized_function(entry);
        // SAFETY: this function was compiled with this very signature, see `Compiler::entry`.
        let function = unsafe {
            std::mem::transmute::<*const u8, extern "C" fn(*const Binding, *const u32, *mut u32) -> u32>(address)
        };
        let Unlinked { name, bindings, args, results, report, dumps, .. } = kernel;
        code.kernels.push(Linked { function, bindings, args, results, report, dumps });
        if code.number.insert(name.clone(), code.kernels.len() - 1).is_some() {
            return Err(Error::SameName(name));
        }
    }
    Ok(code)
}

/// Gives a kernel's functions their places.
fn place(module: &mut JITModule, kernel: &Unlinked, number: usize, host: FuncId) -> Result<Vec<FuncId>, Error> {
    let mut ids = Vec::with_capacity(kernel.functions.len());
    for (i, f) in kernel.functions.iter().enumerate() {
        // Names are for `perf`; two functions of a kernel may have the same.
        let unique = format!("{} #{number}.{i}", f.name);
        ids.push(module.declare_function(&unique, Linkage::Local, &f.signature).map_err(no_memory)?);
    }
    for (Machine { bytes, alignment, relocs, .. }, id) in kernel.functions.iter().zip(&ids) {
        let mut relocs = relocs.clone();
        for reloc in &mut relocs {
            if let ModuleRelocTarget::User { namespace, index } = &mut reloc.name {
                *index = if *namespace == HOST { host.as_u32() } else { ids[*index as usize].as_u32() };
                *namespace = 0;
            }
        }
        module.define_function_bytes(*id, *alignment, bytes, &relocs).map_err(no_memory)?;
    }
    Ok(ids)
}

#[cfg(test)]
mod tests;
