//! Runs kernels of the SPIR-V back end on the interpreter's kind of data, and holds their modules against `spirv-val`.
//!
//! All inputs of a program travel in one submission: each is a launch with stream memory and results of its own. Behind each
//! buffer lies a word that must be there afterwards still, so a store out of range is seen wherever it goes.

use std::io::Write;
use std::process::{Command, Stdio};
use std::sync::{Arc, LazyLock};

use jerboa_backend_spirv::gpu::{Bound, Choice, Extent, Gpu, Launch, Memory as Words};
use jerboa_backend_spirv::{Binding, Grid, Module, Options, Packing, emit};
use jerboa_ir::cfg::Cfg;
use jerboa_ir::interp::{Interp, Limits, Memory};
use jerboa_ir::*;

use crate::engine::{Engine, Outcome};
use crate::machine::canonical;
use crate::sweep::Sweep;

/// What lies behind each buffer.
const GUARD: u32 = 0x5eed_ca7e;

/// The GPU that the tests of this process share. Without one the test of this name is skipped, and says so; on a machine for
/// continuous integration (`CI` is set) it fails.
///
/// # Panics
/// With `CI`, without a GPU.
pub fn gpu(test: &str) -> Option<Arc<Gpu>> {
    static GPU: LazyLock<Result<Arc<Gpu>, String>> =
        LazyLock::new(|| Gpu::open(&Choice::Any).map_err(|e| e.to_string()));
    match &*GPU {
        Ok(gpu) => Some(gpu.clone()),
        Err(why) => skip(test, "no Vulkan adapter", "mesa-vulkan-drivers", why),
    }
}

/// Is there `spirv-val`? Otherwise as [`gpu`].
///
/// # Panics
/// With `CI`, without `spirv-val`.
pub fn spirv_val(test: &str) -> Option<SpirvVal> {
    static VERSION: LazyLock<Result<(), String>> =
        LazyLock::new(|| Command::new("spirv-val").arg("--version").output().map(|_| ()).map_err(|e| e.to_string()));
    match &*VERSION {
        Ok(()) => Some(SpirvVal(())),
        Err(why) => skip(test, "no spirv-val", "spirv-tools", why),
    }
}

fn skip<T>(test: &str, what: &str, package: &str, why: &str) -> Option<T> {
    assert!(std::env::var_os("CI").is_none(), "{test}: {what} ({why}); on Debian install {package}");
    println!("skipped: {test}, {what} ({why})");
    None
}

/// The validator of the SPIR-V tools, which is there.
#[derive(Clone, Copy)]
pub struct SpirvVal(());

impl SpirvVal {
    /// Is this a module that every Vulkan 1.1 must take?
    ///
    /// # Errors
    /// Its words.
    ///
    /// # Panics
    /// When the command cannot be run.
    pub fn check(self, spirv: &[u32]) -> Result<(), String> {
        let mut command = Command::new("spirv-val");
        command.args(["--target-env", "vulkan1.1"]).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("spirv-val starts");
        let bytes: Vec<u8> = spirv.iter().flat_map(|word| word.to_le_bytes()).collect();
        child.stdin.take().expect("it is piped").write_all(&bytes).expect("spirv-val reads");
        let output = child.wait_with_output().expect("spirv-val ends");
        match output.status.success() {
            true => Ok(()),
            false => Err(format!("spirv-val: {}", String::from_utf8_lossy(&[output.stdout, output.stderr].concat()))),
        }
    }
}

/// What the back end refuses in a residual, by a word of its message: GPUs have no stack, and do not promise that an `fma`
/// rounds once.
///
/// # Panics
/// When the program is no residual with an entry `main`.
pub fn refusal(p: &Program) -> Option<&'static str> {
    let main = p.entry("main").expect("there is a main");
    let cfg = Cfg::new(p, &[main]).expect("a residual is first-order");
    let is_fma = |n: &NodeId| matches!(p.node(*n), Node::Prim { op: Op::Fma, .. });
    match cfg.functions.iter().any(|f| f.recursive) {
        true => Some("recurses"),
        false => Reach::of(p).nodes.iter().any(is_fma).then_some("fma"),
    }
}

/// The GPU as an engine.
pub struct Spirv {
    /// Where it runs.
    pub gpu: Arc<Gpu>,
    /// Does each module have to pass it?
    pub validator: Option<SpirvVal>,
    /// Does each buffer of the program have a storage buffer of its own?
    pub spread: bool,
}

impl Engine for Spirv {
    fn run(&self, p: &Program, inputs: &[Vec<Lit>], memory: &[Memory]) -> Result<Vec<Outcome>, String> {
        let module = self.module(p, "main", Grid::Single)?;
        let main = p.cont(p.entry("main").ok_or("no entry")?);
        let results = main.params.last().and_then(|ret| ret.ty.params()).ok_or("an entry returns")?;
        let scalars = results.iter().flat_map(|ty| {
            let (scalar, lanes) = ty.lanes().expect("residuals return data");
            std::iter::repeat_n(scalar, lanes)
        });
        let scalars: Vec<Scalar> = scalars.collect();
        let mut outcomes = Vec::new();
        for (words, memory) in self.launch(&module, p, inputs, memory, 1)? {
            let lits: Vec<Lit> = scalars.iter().zip(&words).map(|(s, w)| Lit::from_word(*s, *w)).collect();
            if let Some((lit, word)) = lits.iter().zip(&words).find(|(l, w)| l.ty() != Ty::f32() && l.word() != **w) {
                return Err(format!("{lit:?} is returned as {word:#x}"));
            }
            outcomes.push((lits, memory));
        }
        Ok(outcomes)
    }
}

impl Spirv {
    /// A module, which has passed the validators.
    ///
    /// # Errors
    /// Why there is none.
    pub fn module(&self, p: &Program, entry: &str, grid: Grid) -> Result<Module, String> {
        let packing = if self.spread { Packing((1..=p.buffers.len() as u32).collect()) } else { Packing::simple(p) };
        let module = emit(p, entry, &Options { grid, packing, ..Options::default() }).map_err(|e| e.to_string())?;
        match self.validator.map(|v| v.check(module.spirv())) {
            Some(Err(why)) => Err(format!("{why}{}", module.assembly())),
            _ => Ok(module),
        }
    }

    /// All rows of a sweep through a grid, as what they leave in memory.
    ///
    /// # Errors
    /// Why it did not run.
    pub fn sweep(&self, sweep: &Sweep, rows: u32) -> Result<Vec<Memory>, String> {
        let module = self.module(&sweep.program, "sweep", Grid::Items)?;
        let inputs = [sweep.uniform.clone()];
        let outcomes = self.launch(&module, &sweep.program, &inputs, &sweep.memory, rows)?;
        Ok(outcomes.into_iter().map(|(_, memory)| memory).next().unwrap_or_default())
    }

    /// Run so many rows of a sweep in the interpreter and through a grid. False where a row takes more than the limits, so that
    /// there is nothing to compare.
    ///
    /// # Errors
    /// The first word that differs, or why it did not run.
    ///
    /// # Panics
    /// When the program is no sweep.
    pub fn compare_rows(&self, sweep: &Sweep, rows: u32, limits: Limits) -> Result<bool, String> {
        let p = &sweep.program;
        if let Some(fault) = verify_residual(p).first() {
            return Err(format!("{fault}\n{}", print(p)));
        }
        let entry = p.entry("sweep").expect("it is a sweep");
        let interp = Interp::new(p);
        let mut expected = sweep.memory.clone();
        for row in 0..rows {
            let args = [&[Lit::U32(row)], &sweep.uniform[..]].concat();
            if interp.run(entry, &args, &mut expected, limits).is_err() {
                return Ok(false);
            }
        }
        let expected = canonical(p, expected);
        let got = self.sweep(sweep, rows).map_err(|e| format!("{e}\n{}", print(p)))?;
        match difference(p, &expected, &got) {
            None => Ok(true),
            Some(what) => Err(format!("{what}\n{}memory {:?}", print(p), sweep.memory)),
        }
    }

    /// Run so many items of a kernel for each input.
    fn launch(
        &self,
        module: &Module,
        p: &Program,
        inputs: &[Vec<Lit>],
        memory: &[Memory],
        items: u32,
    ) -> Result<Vec<Left>, String> {
        let gpu = &*self.gpu;
        let failed = |e: jerboa_backend_spirv::gpu::Error| e.to_string();
        let kernel = gpu.kernel(module).map_err(failed)?;
        let layout = Layouts::new(p, memory, module, inputs.len());
        let bindings: Vec<Words> = layout.words.iter().map(|words| upload(gpu, words)).collect::<Result<_, _>>()?;
        let count = module.results();
        let results = |_: &Vec<Lit>| (count > 0).then(|| gpu.memory(u64::from(count))).transpose().map_err(failed);
        let results: Vec<Option<Words>> = inputs.iter().map(results).collect::<Result<_, _>>()?;
        let bounds: Vec<Vec<Bound>> = (0..inputs.len()).map(|i| layout.bounds(i, memory, &bindings)).collect();
        let launch = |i: usize| Launch {
            kernel: &kernel,
            arguments: inputs[i].iter().map(|lit| lit.word()).collect(),
            buffers: &bounds[i],
            results: results[i].as_ref(),
            extent: Extent::Items(items),
        };
        gpu.run(&[(0..inputs.len()).map(launch).collect()]).map_err(failed)?;
        let read = |words: &Words| gpu.read(words, 0..words.words()).map_err(failed);
        let after: Vec<Vec<u32>> = bindings.iter().map(read).collect::<Result<_, _>>()?;
        let outcome = |i: usize| {
            let words = results[i].as_ref().map(read).transpose()?.unwrap_or_default();
            Ok((words, canonical(p, layout.memory(i, memory, &after)?)))
        };
        (0..inputs.len()).map(outcome).collect()
    }
}

/// The first word that differs.
fn difference(p: &Program, expected: &[Memory], got: &[Memory]) -> Option<String> {
    for (buffer, (a, b)) in p.buffers.iter().zip(expected.iter().zip(got)) {
        for (at, (expected, got)) in a.words.iter().zip(&b.words).enumerate() {
            if expected != got {
                return Some(format!("word {at} of `{}` is {got:#x}, not {expected:#x}", buffer.name));
            }
        }
    }
    None
}

/// The buffers of the program in a storage buffer.
fn group(binding: &Binding) -> Option<&[BufId]> {
    match binding {
        Binding::Tables(group) | Binding::Streams(group) => Some(group),
        Binding::Launch | Binding::Results => None,
    }
}

fn upload(gpu: &Gpu, words: &[u32]) -> Result<Words, String> {
    let memory = gpu.memory(words.len() as u64).map_err(|e| e.to_string())?;
    gpu.write(&memory, 0, words).map_err(|e| e.to_string())?;
    Ok(memory)
}

/// What a launch leaves: the words of its results, and memory.
type Left = (Vec<u32>, Vec<Memory>);

/// Where each input has each buffer: tables are shared, streams are not.
struct Layouts {
    /// The storage buffer of each buffer, from 0.
    storage: Vec<usize>,
    /// The words of each storage buffer.
    words: Vec<Vec<u32>>,
    /// For each input and each buffer its first word.
    at: Vec<Vec<usize>>,
}

impl Layouts {
    fn new(p: &Program, memory: &[Memory], module: &Module, inputs: usize) -> Layouts {
        let groups: Vec<&[BufId]> = module.bindings().iter().filter_map(group).collect();
        let holds = |buf: usize| groups.iter().position(|group| group.contains(&BufId(buf as u32)));
        let storage: Vec<usize> = (0..memory.len()).map(|buf| holds(buf).expect("each buffer is bound")).collect();
        let mut words: Vec<Vec<u32>> = vec![vec![]; groups.len()];
        let mut at: Vec<Vec<usize>> = Vec::new();
        for input in 0..inputs {
            let mut place = |buf: usize| {
                if input > 0 && p.buffers[buf].kind != BufKind::Stream {
                    return at[0][buf];
                }
                let words = &mut words[storage[buf]];
                let start = words.len();
                words.extend(&memory[buf].words);
                words.push(GUARD);
                start
            };
            let places = (0..memory.len()).map(&mut place).collect();
            at.push(places);
        }
        Layouts { storage, words, at }
    }

    fn bounds<'a>(&self, input: usize, memory: &[Memory], bindings: &'a [Words]) -> Vec<Bound<'a>> {
        let bound = |(buf, m): (usize, &Memory)| Bound {
            memory: &bindings[self.storage[buf]],
            start: if m.rows == 0 { 0 } else { self.at[input][buf] as u32 },
            rows: m.rows,
        };
        memory.iter().enumerate().map(bound).collect()
    }

    /// What an input has left.
    fn memory(&self, input: usize, before: &[Memory], after: &[Vec<u32>]) -> Result<Vec<Memory>, String> {
        let buffer = |(buf, m): (usize, &Memory)| {
            let words = &after[self.storage[buf]][self.at[input][buf]..][..=m.words.len()];
            match words.split_last() {
                Some((&GUARD, words)) => Ok(Memory { rows: m.rows, words: words.to_vec() }),
                _ => Err(format!("input {input}: the word behind buffer {buf} is overwritten")),
            }
        };
        before.iter().enumerate().map(buffer).collect()
    }
}
