//! Machine code in memory, by what it is made of: equal residuals are compiled once, for all renderers of this process.
//!
//! The key is the structural hash of a residual and the settings; a hit is confirmed by comparison. Code that no renderer
//! uses is kept for a while, since an edit is often undone, and freed when there is much of it.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use jerboa_backend_cranelift::{Code, Options};
use jerboa_ir::Program;
use jerboa_ir::hash::{hash, is_same};
use rayon::prelude::*;

use super::clock::thread_time;
use super::error::Error;

/// Kernels that are kept although nobody uses them, the youngest: those of a few edits. One takes up to 3 MiB with its residual.
const UNUSED: usize = 16;

/// A kernel that was compiled. A hash that agrees by accident only means that both are here.
struct Entry {
    hash: u128,
    options: Options,
    program: Program,
    code: Arc<Code>,
}

/// In the order of their last use, the latest last.
static CACHE: Mutex<Vec<Entry>> = Mutex::new(Vec::new());

/// Machine code of each of these residuals, and the time that a thread ran for it (0 if it was there), in parallel.
pub fn compile(programs: &[&Program], options: &Options) -> Result<Vec<(Arc<Code>, Duration)>, Error> {
    let hashes: Vec<u128> = programs.iter().map(|p| hash(p)).collect();
    let first = |i: usize| (0..i).find(|j| hashes[*j] == hashes[i] && is_same(programs[*j], programs[i])).unwrap_or(i);
    let compiled = (0..programs.len())
        .into_par_iter()
        .with_max_len(1)
        .map(|i| {
            if first(i) != i {
                return Ok(None);
            }
            if let Some(code) = find(hashes[i], options, programs[i]) {
                return Ok(Some((code, Duration::ZERO)));
            }
            let start = thread_time();
            let code = jerboa_backend_cranelift::compile(&[programs[i]], options);
            let code = Arc::new(code.map_err(|e| Error::new(e.to_string()))?);
            let time = thread_time().saturating_sub(start);
            keep(Entry { hash: hashes[i], options: *options, program: programs[i].clone(), code: code.clone() });
            Ok(Some((code, time)))
        })
        .collect::<Result<Vec<_>, Error>>()?;
    let shared = |i: usize| match &compiled[first(i)] {
        Some((code, time)) => (code.clone(), if first(i) == i { *time } else { Duration::ZERO }),
        None => unreachable!("the first of its kind was compiled"),
    };
    Ok((0..programs.len()).map(shared).collect())
}

/// Let go of all code that no renderer uses, so that making it again takes its time.
pub fn forget_unused() {
    CACHE.lock().unwrap_or_else(PoisonError::into_inner).retain(|e| Arc::strong_count(&e.code) > 1);
}

/// Code that is there already.
fn find(hash: u128, options: &Options, program: &Program) -> Option<Arc<Code>> {
    let mut cache = CACHE.lock().unwrap_or_else(PoisonError::into_inner);
    let found = |e: &Entry| e.hash == hash && e.options == *options && is_same(&e.program, program);
    let at = cache.iter().position(found)?;
    let entry = cache.remove(at);
    let code = entry.code.clone();
    cache.push(entry);
    Some(code)
}

/// Keep code, and let go of the oldest that nobody uses.
fn keep(entry: Entry) {
    let mut cache = CACHE.lock().unwrap_or_else(PoisonError::into_inner);
    cache.push(entry);
    let unused = |e: &Entry| Arc::strong_count(&e.code) == 1;
    let mut surplus = cache.iter().filter(|e| unused(e)).count().saturating_sub(UNUSED);
    cache.retain(|e| {
        let goes = surplus > 0 && unused(e);
        surplus -= goes as usize;
        !goes
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_is_found_until_it_is_forgotten() {
        let text = "jerboa-ir 1\nentry found_until_forgotten = f\nfun f(x: u32, return: fn(u32))\n  jump return(x)\n";
        let program = jerboa_ir::parse(text).expect("a program");
        let compile = || compile(&[&program], &Options::default()).expect("it compiles").remove(0);
        let (code, time) = compile();
        assert!(time > Duration::ZERO);
        assert_eq!(compile().1, Duration::ZERO, "somebody has it");
        drop(code);
        forget_unused();
        assert!(compile().1 > Duration::ZERO, "nobody has it");
    }
}
