//! Residuals that were written by hand: each is emitted, accepted by naga's validator (which `emit` always asks) and by
//! `spirv-val` where that is installed, and has the form that it should. No GPU is needed.

mod control;
mod memory;
mod refused;

use std::process::{Command, Stdio};

use jerboa_backend_spirv::{Error, Grid, Module, Options, emit};
use jerboa_ir::{Program, parse};

/// A residual from its text.
fn residual(text: &str) -> Program {
    parse(&format!("jerboa-ir 1\n{text}")).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// The first entry of a residual for one invocation.
fn try_single(text: &str) -> Result<Module, Error> {
    let p = residual(text);
    emit(&p, &p.entries[0].0, &Options { grid: Grid::Single, ..Options::default() })
}

/// The same, accepted by `spirv-val`.
fn single(text: &str) -> Module {
    let module = try_single(text).unwrap_or_else(|e| panic!("{e}"));
    validate(&module);
    module
}

/// How often a word stands in the WGSL of a module.
fn count(module: &Module, word: &str) -> usize {
    module.naga().matches(word).count()
}

/// Asks `spirv-val` (Debian: spirv-tools), if it is there.
fn validate(module: &Module) {
    let mut command = Command::new("spirv-val");
    command
        .args(["--target-env", "vulkan1.1", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let Ok(mut child) = command.spawn() else {
        println!("skipped: spirv-val on `{}`: it is not installed (Debian: spirv-tools)", module.name());
        return;
    };
    let bytes: Vec<u8> = module.spirv().iter().flat_map(|word| word.to_le_bytes()).collect();
    std::io::Write::write_all(&mut child.stdin.take().expect("it was piped"), &bytes).expect("it reads all");
    let output = child.wait_with_output().expect("it ends");
    assert!(
        output.status.success(),
        "{}{}\n{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr),
        module.assembly()
    );
}
