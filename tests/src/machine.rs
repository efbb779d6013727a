//! Runs machine code on the interpreter's kind of data.

use jerboa_backend_cranelift::{Binding, Kernel, Status};
use jerboa_ir::interp::{Memory, Stop};
use jerboa_ir::{ColTy, ContId, Lit, Program, Scalar};

/// Run the kernel that was made of this entry, which reads nothing unchecked. Arguments and results as in
/// [`jerboa_ir::interp::Interp::run`].
///
/// # Errors
/// [`Stop::Limit`] if the kernel says so.
///
/// # Panics
/// When the memory does not fit the declarations.
pub fn call(kernel: Kernel, p: &Program, entry: ContId, args: &[Lit], memory: &mut [Memory]) -> Result<Vec<Lit>, Stop> {
    for (buffer, m) in p.buffers.iter().zip(&*memory) {
        assert_eq!(m.words.len(), m.rows as usize * buffer.columns.len(), "words of `{}`", buffer.name);
    }
    let bindings: Vec<Binding> = memory.iter_mut().map(|m| Binding::new(&mut m.words, m.rows)).collect();
    let args: Vec<u32> = args.iter().map(|a| a.word()).collect();
    let mut words = vec![0; kernel.results()];
    // SAFETY: every buffer has the words that its rows take, each binding has memory of its own that nobody else has,
    // nothing is read unchecked, and this thread has the 2 MiB of stack that Rust gives at least.
    let status = unsafe { kernel.call(&bindings, &args, &mut words) };
    let ret = p.cont(entry).params.last().and_then(|ret| ret.ty.params()).expect("an entry returns");
    let scalars = ret.iter().flat_map(|ty| {
        let (scalar, lanes) = ty.lanes().expect("residuals return data");
        std::iter::repeat_n(scalar, lanes)
    });
    match status {
        Status::Done => Ok(scalars.zip(words).map(|(s, w)| Lit::from_word(s, w)).collect()),
        Status::Limit => Err(Stop::Limit),
    }
}

/// Every NaN in memory becomes the one NaN, as a load makes it.
pub fn canonical(p: &Program, mut memory: Vec<Memory>) -> Vec<Memory> {
    for (buffer, m) in p.buffers.iter().zip(&mut memory) {
        for (col, _) in buffer.columns.iter().enumerate().filter(|(_, c)| c.ty == ColTy::Scalar(Scalar::F32)) {
            for row in 0..m.rows as usize {
                let word = &mut m.words[buffer.word(m.rows as usize, row, col)];
                *word = Lit::from_word(Scalar::F32, *word).word();
            }
        }
    }
    memory
}
