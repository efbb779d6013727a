//! The command `jerboa`; see [`jerboa_lib_render::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    jerboa_lib_render::cli::run(std::env::args_os())
}
