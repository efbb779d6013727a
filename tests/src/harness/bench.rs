//! A bench for components: tables in memory and kernels made of entries.

use std::collections::HashMap;

use jerboa_backend_cranelift::{self as cranelift, Binding, Code, Status};
use jerboa_ir::interp::{Interp, Limits, Memory, Observer};
use jerboa_ir::lang::{self, Buf, Col};
use jerboa_ir::{BufId, BufKind, ContId, Lit, Program};
use jerboa_lib_render::host::tables::Tables;
use jerboa_lib_render::schema::declare_all;
use jerboa_peval::{self as peval, Arg, Facts, Generic};

/// SplitMix64 (Steele, Lea & Flood 2014), from a seed that the test prints.
pub struct Random(pub u64);

impl Random {
    /// Prints its seed.
    pub fn new(seed: u64) -> Random {
        println!("seed {seed:#x}");
        Random(seed)
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        (self.uniform() * n as f64) as usize
    }

    /// A point with coordinates uniform in [-1, 1).
    pub fn point(&mut self) -> [f32; 3] {
        [0; 3].map(|_| (2.0 * self.uniform() - 1.0) as f32)
    }
}

/// The words of an `Rng`: a random stream of its own for each `key`, at dimension 0.
pub fn stream(key: u32) -> [u32; 5] {
    let bits = Random(key.into()).bits();
    [bits as u32, (bits >> 32) as u32, 0, 0, 0]
}

/// How much to test: the variable of this name, or the size that is quick.
pub fn number(name: &str, quick: usize) -> usize {
    std::env::var(name).map_or(quick, |v| v.parse().unwrap_or_else(|_| panic!("{name} is a number, not `{v}`")))
}

/// A program, its kernels, and the memory they run on.
pub struct Bench {
    generic: Generic,
    kernels: HashMap<String, Code>,
    memory: Vec<Memory>,
}

impl Bench {
    /// Builds the program and compiles each of its entries with nothing known. Tables have one row of zeros.
    pub fn new(author: impl FnOnce()) -> Bench {
        let program = lang::build(|| {
            declare_all();
            author();
        });
        let memory = |kind: BufKind, columns: usize| {
            let rows = u32::from(matches!(kind, BufKind::Table { .. }));
            Memory { rows, words: vec![0; rows as usize * columns] }
        };
        let memory = program.buffers.iter().map(|b| memory(b.kind, b.columns.len())).collect();
        let generic = Generic::new(program);
        let names: Vec<String> = generic.program().entries.iter().map(|(name, _)| name.to_string()).collect();
        let kernels = names.into_iter().map(|name| (name.clone(), compile(&generic, &name))).collect();
        Bench { generic, kernels, memory }
    }

    fn buffer<B: Buf>(&self) -> usize {
        self.generic.program().buffers.iter().position(|b| &*b.name == B::NAME).expect("it is declared")
    }

    /// Give a buffer so many rows, all zeros.
    pub fn rows<B: Buf>(&mut self, rows: usize) {
        let at = self.buffer::<B>();
        let columns = self.generic.program().buffers[at].columns.len();
        self.memory[at] = Memory { rows: rows as u32, words: vec![0; rows * columns] };
    }

    /// Give a table so many rows of zeros more.
    pub fn add_rows<B: Buf>(&mut self, rows: usize) {
        let at = self.buffer::<B>();
        let columns = self.generic.program().buffers[at].columns.len();
        assert!(self.generic.program().buffers[at].layout == jerboa_ir::Layout::Rows, "tables lie row by row");
        self.memory[at].rows += rows as u32;
        self.memory[at].words.extend(std::iter::repeat_n(0, rows * columns));
    }

    /// Set a word of a buffer.
    pub fn set<B: Buf, T>(&mut self, column: Col<B, T>, row: usize, word: impl Word) {
        let at = self.buffer::<B>();
        let memory = &mut self.memory[at];
        let place = self.generic.program().buffer(BufId(at as u32)).word(memory.rows as usize, row, column.0 as usize);
        memory.words[place] = word.word();
    }

    /// Put the tables of a scene in place of all. They must be laid out with nothing known.
    pub fn load(&mut self, tables: &Tables) {
        assert_eq!(self.memory.len(), tables.memory.len(), "both hold every buffer of the schema, in its order");
        self.memory = tables.memory.iter().map(|m| Memory::clone(m)).collect();
    }

    /// Run a kernel; words in, words out.
    pub fn run(&mut self, entry: &str, args: &[u32]) -> Vec<u32> {
        let kernel = self.kernels[entry].kernel(entry).expect("it was compiled under this name");
        let bindings: Vec<Binding> = self.memory.iter_mut().map(|m| Binding::new(&mut m.words, m.rows)).collect();
        let mut results = vec![0; kernel.results()];
        // SAFETY: each binding is the memory of its buffer, which nobody else touches meanwhile; the tests fill nodes and
        // triangles consistently; the test's thread has the stack that Rust gives a thread.
        let status = unsafe { kernel.call(&bindings, args, &mut results) };
        assert_eq!(status, Status::Done);
        results
    }

    /// As [`Bench::run`], all words floats.
    pub fn run_floats(&mut self, entry: &str, args: &[f32]) -> Vec<f32> {
        let args: Vec<u32> = args.iter().map(|x| x.to_bits()).collect();
        self.run(entry, &args).into_iter().map(f32::from_bits).collect()
    }

    /// Continuations that the interpreter enters on a run: how long it takes, without a clock.
    pub fn steps(&mut self, entry: &str, args: &[u32]) -> u64 {
        struct Steps(u64);
        impl Observer for Steps {
            fn enter(&mut self, _: ContId) {
                self.0 += 1;
            }
        }
        let mut steps = Steps(0);
        self.interpret(entry, args, &mut steps);
        steps.0
    }

    /// As [`Bench::run`], by the interpreter, which must agree to the bit.
    pub fn run_both(&mut self, entry: &str, args: &[u32]) -> Vec<u32> {
        let compiled = self.run(entry, args);
        let words = self.interpret(entry, args, &mut ());
        // A NaN among results may have any bits; a result that is no float and looks like one is rarely wrong alone.
        let same = |(a, b): (&u32, &u32)| a == b || (f32::from_bits(*a).is_nan() && f32::from_bits(*b).is_nan());
        let agree = words.len() == compiled.len() && words.iter().zip(&compiled).all(same);
        assert!(agree, "`{entry}`: interpreter {words:x?}, machine code {compiled:x?}");
        compiled
    }

    /// As [`Bench::run`], by the interpreter, watched.
    fn interpret(&mut self, entry: &str, args: &[u32], observer: &mut impl Observer) -> Vec<u32> {
        let program = self.generic.program();
        let cont = program.entry(entry).expect("it was compiled under this name");
        let params = program.cont(cont).params.iter();
        let scalars = params.filter_map(|p| Some(p.ty.lanes()?.0));
        let lits: Vec<Lit> = scalars.zip(args).map(|(scalar, word)| Lit::from_word(scalar, *word)).collect();
        let run = Interp::new(program).run_observed(cont, &lits, &mut self.memory.clone(), Limits::default(), observer);
        run.expect("it runs").into_iter().map(Lit::word).collect()
    }
}

fn compile(generic: &Generic, name: &str) -> Code {
    let program: &Program = generic.program();
    let args = program.cont(program.entry(name).expect("it is an entry")).params.len() - 1;
    let options = peval::Options::default();
    let residual = peval::specialize(generic, name, &vec![Arg::Unknown; args], &Facts::none(), &options)
        .unwrap_or_else(|e| panic!("`{name}` cannot be specialised: {e}"));
    cranelift::compile(&[&residual.program], &cranelift::Options::default()).expect("it compiles")
}

/// What a word of memory can be made of.
pub trait Word {
    /// The word.
    fn word(self) -> u32;
}

impl Word for f32 {
    fn word(self) -> u32 {
        self.to_bits()
    }
}

impl Word for u32 {
    fn word(self) -> u32 {
        self
    }
}

impl Word for bool {
    fn word(self) -> u32 {
        self.into()
    }
}
