//! A process to go wrong in, for `tests/tests/faults.rs` (T30): the command `jerboa` and parts of it, with a fault put in.
//!
//! | words | what happens |
//! |---|---|
//! | `run WORDS…` | the command, as it is |
//! | `count WORDS…` | the command; then how often it asked for memory, on stderr |
//! | `starve N WORDS…` | the command, whose N-th request for memory fails |
//! | `panic` | a thread of a pool panics |
//! | `save PATH` | half of an image is written to PATH, then nothing happens until the process is killed |
//! | `cycles N` | code is made and freed N times; then by how many KiB the process has grown since the 20th |

use std::alloc::{GlobalAlloc, Layout, System};
use std::ffi::OsString;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};

use jerboa_backend_cranelift as clif;
use jerboa_lib_render::cli;
use jerboa_lib_render::cli::faults::{OrExit, in_one_line};
use jerboa_lib_render::host::device::DeviceKind;
use jerboa_lib_render::host::generate::{Keep, TracerKind, residual};
use jerboa_lib_render::host::image_io::write_atomic;
use jerboa_lib_render::host::renderer::{Options, Renderer};
use jerboa_lib_render::host::tables::{Choices, Known, Tables};
use jerboa_scenes::Scene;
use rayon::prelude::*;

/// Memory of the system, of which one request is refused.
struct Starving;

/// Requests so far.
static REQUESTS: AtomicU64 = AtomicU64::new(0);

/// The request that fails, counted from 0.
static REFUSED: AtomicU64 = AtomicU64::new(u64::MAX);

impl Starving {
    /// Counts a request. Is it the one?
    fn refuses(&self) -> bool {
        REQUESTS.fetch_add(1, Ordering::Relaxed) == REFUSED.load(Ordering::Relaxed)
    }
}

// SAFETY: all is passed on to the system's allocator, or a null pointer is given, which is allowed at any time.
unsafe impl GlobalAlloc for Starving {
    // SAFETY: what is asked of the caller is asked for the system's allocator.
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's word is passed on.
        if self.refuses() { std::ptr::null_mut() } else { unsafe { System.alloc(layout) } }
    }

    // SAFETY: what is asked of the caller is asked for the system's allocator.
    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller's word is passed on.
        if self.refuses() { std::ptr::null_mut() } else { unsafe { System.realloc(block, layout, size) } }
    }

    // SAFETY: what is asked of the caller is asked for the system's allocator.
    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller's word is passed on.
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: OrExit<Starving> = OrExit(Starving);

fn main() -> ExitCode {
    let mut words = std::env::args_os().skip(1);
    let what = words.next().unwrap_or_default();
    let rest: Vec<OsString> = words.collect();
    let number = |i: usize| rest[i].to_str().and_then(|n| n.parse::<u64>().ok()).expect("a whole number");
    match what.to_str() {
        Some("run") => command(&rest),
        Some("count") => {
            REQUESTS.store(0, Ordering::Relaxed);
            let code = command(&rest);
            eprintln!("{}", REQUESTS.load(Ordering::Relaxed));
            code
        }
        Some("starve") => {
            let (n, rest) = (number(0), &rest[1..]);
            REQUESTS.store(0, Ordering::Relaxed);
            REFUSED.store(n, Ordering::Relaxed);
            command(rest)
        }
        Some("panic") => in_one_line(|| {
            (0..64).into_par_iter().with_max_len(1).for_each(|i| assert!(i != 7, "of this test"));
            ExitCode::SUCCESS
        }),
        Some("save") => save(Path::new(&rest[0])),
        Some("cycles") => cycles(number(0)),
        _ => panic!("no such word"),
    }
}

/// The command `jerboa`.
fn command(words: &[OsString]) -> ExitCode {
    let words = ["jerboa".into()].into_iter().chain(words.iter().cloned()).collect::<Vec<_>>();
    in_one_line(|| cli::run(words))
}

fn save(path: &Path) -> ExitCode {
    let saved = write_atomic(path, |file| {
        file.write_all(b"half")?;
        println!("half");
        loop {
            std::thread::park();
        }
    });
    saved.map_or(ExitCode::FAILURE, |()| ExitCode::SUCCESS)
}

fn cycles(n: u64) -> ExitCode {
    let scene = Scene::load("builtin:cornell-box").expect("a built-in loads");
    let tables = Tables::new(&scene, &Choices::default(), Known::Structure);
    let requests = DeviceKind::Cpu.requests(&tables, TracerKind::Path);
    let small = requests.iter().filter(|r| ["shadow", "miss", "shade.1"].contains(&r.name.as_str()));
    let residuals: Vec<_> = small.map(|r| residual(&tables, r, Keep::default()).expect("it is specialised")).collect();
    let mut before = None;
    for cycle in 0..n + 20 {
        if cycle == 20 {
            before = resident();
        }
        let programs: Vec<_> = residuals.iter().map(|r| &r.program).collect();
        clif::compile(&programs, &clif::Options::default()).expect("it compiles");
        Renderer::new(&scene, Options::default()).expect("it is specialised");
    }
    println!("{}", resident().zip(before).map_or(0, |(after, before)| after.saturating_sub(before)));
    ExitCode::SUCCESS
}

/// KiB of this process that are in memory, where the system tells.
fn resident() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    status.lines().find_map(|l| l.strip_prefix("VmRSS:"))?.trim().split(' ').next()?.parse().ok()
}
