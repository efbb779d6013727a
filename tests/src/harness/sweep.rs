//! Kernels that loop inside machine code: a staged function of a few words, asked for many cells at once.
//!
//! A [`Sweep`] fills memory with what the function gives for cell 0, 1, 2, …; so a function of one float can be asked for
//! all of its 2^32 arguments in a minute. The same entry also runs in the interpreter.
//!
//! ```
//! use jerboa_ir::lang::U32;
//! use jerboa_tests::harness::sweep::Sweep;
//!
//! let squares = Sweep::new(|_, cell, first: U32| (first + cell) * (first + cell));
//! let mut words = [0; 3];
//! squares.fill(&[10], [&[], &[]], &mut words);
//! assert_eq!(words, [100, 121, 144]);
//! assert_eq!(squares.interpret(&[10], [&[], &[]], 3), words);
//! ```

use jerboa_backend_cranelift::{self as cranelift, Binding, Code, Status};
use jerboa_ir::interp::{self, Limits, Memory};
use jerboa_ir::lang::{self, Block, Fun, I32, Staged, U32, entry, range, spec};
use jerboa_ir::{Lit, Program, stream};
use jerboa_peval::{self as peval, Arg, Facts, Generic};

stream! {
    /// First words that a function of two reads, a cell each.
    pub Left {
        /// The word.
        WORD: U32;
    }
}
stream! {
    /// Second words.
    pub Right {
        /// The word.
        WORD: U32;
    }
}
stream! {
    /// What the function gives.
    pub Words {
        /// The word.
        WORD: U32;
    }
}

/// A staged function of cells, compiled.
pub struct Sweep {
    generic: Generic,
    code: Code,
}

impl Sweep {
    /// `f` gives the word of a cell from its number and from arguments that all cells share. It may load from [`Left`]
    /// and [`Right`].
    pub fn new<A: Staged>(f: impl FnOnce(&mut Block, U32, A) -> U32) -> Sweep {
        let program = lang::build(|| {
            lang::declare(&[spec::<Left>(), spec::<Right>(), spec::<Words>()]);
            entry(
                "fill",
                Fun::<(I32, A), ()>::lam(|b, (cells, shared)| {
                    b.for_(range(0, cells), (), |b, i, ()| {
                        let word = f(b, i.bits(), shared);
                        b.store(Words::WORD, i.bits(), word);
                    });
                }),
            );
        });
        let generic = Generic::new(program);
        let arguments = vec![Arg::Unknown; 1 + A::types().len()];
        let residual = peval::specialize(&generic, "fill", &arguments, &Facts::none(), &peval::Options::default())
            .unwrap_or_else(|e| panic!("the sweep cannot be specialised: {e}"));
        let code = cranelift::compile(&[&residual.program], &cranelift::Options::default()).expect("it compiles");
        Sweep { generic, code }
    }

    /// The program before specialisation.
    pub fn program(&self) -> &Program {
        self.generic.program()
    }

    /// Fills `words` by machine code. `shared` are the words of the arguments that all cells share; `inputs` what is in
    /// [`Left`] and [`Right`].
    pub fn fill(&self, shared: &[u32], inputs: [&[u32]; 2], words: &mut [u32]) {
        let rows = |n: usize| u32::try_from(n).expect("fewer than 2^32 cells");
        let input = |x: &[u32]| Binding { words: x.as_ptr().cast_mut(), rows: rows(x.len()) };
        let cells = i32::try_from(words.len()).expect("fewer than 2^31 cells");
        let bindings = [input(inputs[0]), input(inputs[1]), Binding::new(words, rows(words.len()))];
        let arguments = [&[cells as u32], shared].concat();
        let kernel = self.code.kernel("fill").expect("it was compiled under this name");
        // SAFETY: the bindings are three slices with as many rows as words, the last one ours alone; the kernel only loads
        // from the first two and only stores to the last; the thread has the stack that Rust gives a thread.
        let status = unsafe { kernel.call(&bindings, &arguments, &mut []) };
        assert_eq!(status, Status::Done);
    }

    /// The first `cells` words by the interpreter, from the program before specialisation.
    pub fn interpret(&self, shared: &[u32], inputs: [&[u32]; 2], cells: usize) -> Vec<u32> {
        let program = self.program();
        let entry = program.entry("fill").expect("it is its entry");
        let scalars = program.cont(entry).params.iter().filter_map(|p| Some(p.ty.lanes()?.0));
        let words = [&[cells as u32], shared].concat();
        let arguments: Vec<Lit> = scalars.zip(words).map(|(scalar, word)| Lit::from_word(scalar, word)).collect();
        let of = |words: &[u32]| Memory { rows: words.len() as u32, words: words.to_vec() };
        let mut memory = [of(inputs[0]), of(inputs[1]), of(&vec![0; cells])];
        interp::run(program, entry, &arguments, &mut memory, Limits::default()).expect("it runs");
        let [.., filled] = memory;
        filled.words
    }
}
