//! A small world for component tests: the scene's tables by hand, programs run by the interpreter.

use jerboa_ir::interp::{Interp, Limits, Memory};
use jerboa_ir::lang::{Block, Buf, Col, Fun, Staged, build, entry};
use jerboa_ir::{Lit, Program, Scalar};
use jerboa_lib_render::schema::declare_all;

/// A component made ready to run.
pub struct Bench {
    program: Program,
    memory: Vec<Memory>,
}

impl Bench {
    /// A program with one entry, `f`; every table has `rows` rows of zeros.
    pub fn new<A: Staged, R: Staged>(rows: u32, f: impl FnOnce(&mut Block, A) -> R) -> Bench {
        let program = build(|| {
            declare_all();
            entry("main", Fun::<A, R>::lam(f));
        });
        let memory = program.buffers.iter().map(|b| Memory { rows, words: vec![0; b.columns.len() * rows as usize] });
        Bench { memory: memory.collect(), program }
    }

    /// Set a column of a row: a number, a flag, or the index of a row.
    pub fn set<B: Buf, T>(&mut self, column: Col<B, T>, row: usize, value: impl Word) -> &mut Bench {
        let at = self.program.buffers.iter().position(|b| &*b.name == B::NAME).expect("declared");
        let (buffer, memory) = (&self.program.buffers[at], &mut self.memory[at]);
        memory.words[buffer.word(memory.rows as usize, row, column.0 as usize)] = value.word();
        self
    }

    /// Run it many times.
    pub fn run(&mut self, args: impl IntoIterator<Item = Vec<f32>>) -> Vec<Vec<f32>> {
        let main = self.program.entry("main").expect("there is one entry");
        let params = &self.program.cont(main).params;
        let kinds: Vec<Scalar> = params[..params.len() - 1].iter().filter_map(|p| p.ty.as_scalar()).collect();
        let interp = Interp::new(&self.program);
        let number = |lit: Lit| match lit {
            Lit::F32(bits) => f32::from_bits(bits),
            Lit::Bool(x) => f32::from(u8::from(x)),
            Lit::U32(x) => x as f32,
            Lit::I32(x) => x as f32,
        };
        let mut one = |args: Vec<f32>| {
            let lit = |(x, kind): (f32, &Scalar)| match kind {
                Scalar::F32 => Lit::f32(x),
                Scalar::U32 => Lit::U32(x as u32),
                Scalar::I32 => Lit::I32(x as i32),
                Scalar::Bool => Lit::Bool(x != 0.0),
            };
            let lits: Vec<Lit> = args.into_iter().zip(&kinds).map(lit).collect();
            let out = interp.run(main, &lits, &mut self.memory, Limits::default()).expect("it runs");
            out.into_iter().map(number).collect()
        };
        args.into_iter().map(&mut one).collect()
    }
}

/// What a column can be set to.
pub trait Word {
    /// The word in memory.
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
