//! The command `jerboa`; see [`jerboa_lib_render::cli`].

use std::alloc::System;
use std::process::ExitCode;

use jerboa_lib_render::cli::faults::{OrExit, in_one_line};

#[global_allocator]
static ALLOCATOR: OrExit<System> = OrExit(System);

fn main() -> ExitCode {
    in_one_line(|| jerboa_lib_render::cli::run(std::env::args_os()))
}
