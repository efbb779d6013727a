//! The last words of a process that cannot go on: one line, and exit code 1, whether memory is out or Jerboa is at fault.

use std::alloc::{GlobalAlloc, Layout};
use std::io::Write;
use std::panic::{UnwindSafe, catch_unwind};
use std::process::{ExitCode, exit};
use std::sync::atomic::{AtomicBool, Ordering};

/// An allocator that ends the process with a readable line when `A` has no memory left: few of those who allocate could go on
/// without, and Rust's own way is to abort.
pub struct OrExit<A>(
    /// Where memory comes from.
    pub A,
);

// SAFETY: all four pass on what they are given to `A`, and what it gives; they add only that they may not return.
unsafe impl<A: GlobalAlloc> GlobalAlloc for OrExit<A> {
    // SAFETY: what is asked of the caller is asked for `A`.
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's word is passed on.
        or_exit(unsafe { self.0.alloc(layout) }, layout.size())
    }

    // SAFETY: what is asked of the caller is asked for `A`.
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's word is passed on.
        or_exit(unsafe { self.0.alloc_zeroed(layout) }, layout.size())
    }

    // SAFETY: what is asked of the caller is asked for `A`.
    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller's word is passed on.
        or_exit(unsafe { self.0.realloc(block, layout, size) }, size)
    }

    // SAFETY: what is asked of the caller is asked for `A`.
    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller's word is passed on.
        unsafe { self.0.dealloc(block, layout) }
    }
}

/// The block, unless there is none.
fn or_exit(block: *mut u8, size: usize) -> *mut u8 {
    if block.is_null() {
        tell(format_args!(
            "out of memory: {size} bytes more are needed; close other programs, use a smaller film or --crop, or a smaller scene"
        ));
        exit(1);
    }
    block
}

/// Runs the command. A panic, on whatever thread, is a fault of Jerboa and is told in one line; with RUST_BACKTRACE as Rust
/// tells it.
pub fn in_one_line(command: impl FnOnce() -> ExitCode + UnwindSafe) -> ExitCode {
    if std::env::var_os("RUST_BACKTRACE").is_none_or(|v| v == "0") {
        std::panic::set_hook(Box::new(|panic| {
            let text = panic.payload_as_str().unwrap_or("it panicked").lines().next().unwrap_or_default();
            let place = panic.location().map_or(String::new(), |l| format!(" ({}:{})", l.file(), l.line()));
            tell(format_args!("a fault of Jerboa, please report it: {text}{place}"));
        }));
    }
    catch_unwind(command).unwrap_or(ExitCode::FAILURE)
}

/// Writes one line to stderr, unless another thread has. Takes no memory.
fn tell(line: std::fmt::Arguments) {
    static TOLD: AtomicBool = AtomicBool::new(false);
    if !TOLD.swap(true, Ordering::Relaxed) {
        // Nobody is left to tell if stderr is closed too.
        let _ = writeln!(std::io::stderr(), "jerboa: {line}");
    }
}
