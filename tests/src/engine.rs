//! Engines, for tests of whole residuals: each runs a program on some inputs, and is compared with the interpreter.

use jerboa_backend_cranelift::{Opt, Options, compile};
use jerboa_ir::interp::{Interp, Limits, Memory, Stop};
use jerboa_ir::{Lit, Program, print};

use crate::machine::{call, canonical};

/// What a run leaves behind: results and memory, every NaN there the one NaN.
pub type Outcome = (Vec<Lit>, Vec<Memory>);

/// What runs the entry `main` of residuals.
pub trait Engine {
    /// What each input leads to. Every run begins with this memory.
    ///
    /// # Errors
    /// What went wrong, in words.
    fn run(&self, p: &Program, inputs: &[Vec<Lit>], memory: &[Memory]) -> Result<Vec<Outcome>, String>;
}

/// Machine code of the CPU.
pub struct Machine(pub Opt);

impl Engine for Machine {
    fn run(&self, p: &Program, inputs: &[Vec<Lit>], memory: &[Memory]) -> Result<Vec<Outcome>, String> {
        let code = compile(&[p], &Options { opt: self.0, verify: true, ..Options::default() });
        let code = code.map_err(|e| e.to_string())?;
        let (kernel, main) = (code.kernel("main").ok_or("no kernel")?, p.entry("main").ok_or("no entry")?);
        let run = |args: &Vec<Lit>| {
            let mut memory = memory.to_vec();
            let results = call(kernel, p, main, args, &mut memory).map_err(|stop| stop.to_string())?;
            Ok((results, canonical(p, memory)))
        };
        inputs.iter().map(run).collect()
    }
}

/// Inputs, and what they lead to.
#[derive(Default)]
pub struct Runs {
    /// The arguments of each run.
    pub inputs: Vec<Vec<Lit>>,
    /// What the interpreter says.
    pub expected: Vec<Outcome>,
}

impl Runs {
    /// Interpret `main` on these inputs. Those that reach a limit are left out.
    ///
    /// # Errors
    /// A fault of the program.
    ///
    /// # Panics
    /// When there is no `main`.
    pub fn interpret(p: &Program, inputs: Vec<Vec<Lit>>, memory: &[Memory], limits: Limits) -> Result<Runs, String> {
        let interp = Interp::new(p);
        let main = p.entry("main").expect("there is a main");
        let mut runs = Runs::default();
        for args in inputs {
            let mut memory = memory.to_vec();
            match interp.run(main, &args, &mut memory, limits) {
                Ok(results) => {
                    runs.inputs.push(args);
                    runs.expected.push((results, canonical(p, memory)));
                }
                Err(Stop::Fuel | Stop::Limit) => {}
                Err(stop) => return Err(format!("interpreter, on {args:?}: {stop}\n{}", print(p))),
            }
        }
        Ok(runs)
    }

    /// Does an engine say the same?
    ///
    /// # Errors
    /// What went wrong, or the first difference.
    pub fn compare(&self, engine: &dyn Engine, p: &Program, memory: &[Memory]) -> Result<(), String> {
        let outcomes = engine.run(p, &self.inputs, memory).map_err(|e| format!("{e}\n{}", print(p)))?;
        assert_eq!(outcomes.len(), self.inputs.len(), "an outcome for each input");
        for ((args, expected), got) in self.inputs.iter().zip(&self.expected).zip(&outcomes) {
            if got != expected {
                return Err(format!(
                    "on {args:?}:\n  expected {expected:?}\n  got      {got:?}\n{}memory {memory:?}",
                    print(p)
                ));
            }
        }
        Ok(())
    }
}
