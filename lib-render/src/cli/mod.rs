//! The command line: words in, one readable line out when something is wrong.
//!
//! [`args`] declares the words, each other file does what its subcommand says. Whatever fails, the command writes
//! one line to stderr and exits with code 1, be it for lack of memory or a fault of our own ([`faults`]); a reader that closes the pipe early (`jerboa … | head`) is no failure.

pub mod args;
pub mod faults;
mod shown;
mod scene;
mod render;
mod progress;
mod goal;
mod merge;
mod inspect;
mod time;
mod trace;
mod compare;
mod devices;
mod contest;
mod bench;
mod edits;
mod rays;
mod effort;
mod figures;
mod efficiency;

use crate::host::error::Error;
use args::{BenchCommand, Cli, Command};
use clap::Parser;
use std::ffi::OsString;
use std::io::{ErrorKind, Write};
use std::process::ExitCode;

/// Runs the command line `words`, whose first is the program's name, and returns the process's exit code.
pub fn run(words: impl IntoIterator<Item = OsString>) -> ExitCode {
    let done = match Cli::try_parse_from(words) {
        Ok(cli) => dispatch(cli.command),
        Err(help) if !help.use_stderr() => print(&help.render().to_string()),
        Err(usage) => Err(one_line(&usage)),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Nobody is left to tell if stderr is closed too.
            let _ = writeln!(std::io::stderr(), "jerboa: {error}");
            ExitCode::FAILURE
        }
    }
}

fn dispatch(command: Command) -> Result<(), Error> {
    match command {
        Command::Render(args) => print(&render::run(&args)?),
        Command::Merge(args) => print(&merge::run(&args)?),
        Command::Dump(args) => print(&inspect::dump(&args)?),
        Command::Time(args) => print(&time::run(&args)?),
        Command::Explain(args) => print(&inspect::explain(&args)?),
        Command::Trace(args) => print(&trace::run(&args)?),
        Command::Compare(args) => print(&compare::report(&args)?),
        Command::Devices(args) => print(&devices::run(&args)),
        Command::Bench { command: BenchCommand::Devices(args) } => print(&contest::run(&args)?),
        Command::Bench { command: BenchCommand::Edits(args) } => print(&edits::run(&args)?),
        Command::Bench { command: BenchCommand::Error(args) } => print(&efficiency::run(&args)?),
        Command::Bench { command: BenchCommand::Rays(args) } => print(&rays::run(&args)?),
        Command::Bench { command: BenchCommand::Table3(args) } => print(&effort::run(&args)?),
        Command::Bench { command: BenchCommand::Table2(args) } => print(&figures::table_2(&args)?),
        Command::Bench { command: BenchCommand::Figure2(args) } => print(&figures::figure_2(&args)?),
        Command::Bench { command: BenchCommand::Figure3(args) } => print(&figures::figure_3(&args)?),
        Command::Bench { command: BenchCommand::Figure4(args) } => print(&figures::figure_4(&args)?),
        Command::Bench { command: BenchCommand::Figure5(args) } => print(&figures::figure_5(&args)?),
        Command::Bench { command: BenchCommand::Stability(args) } => {
            let (table, failed) = bench::stability(&args)?;
            print(&table)?;
            if failed.is_empty() {
                Ok(())
            } else {
                Err(Error::new(format!("not as it should be: {}", failed.join(", "))))
            }
        }
    }
}

/// Runs `work` on so many threads, one per core if none are asked for.
fn in_pool<T: Send>(threads: Option<u32>, work: impl FnOnce() -> Result<T, Error> + Send) -> Result<T, Error> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0) as usize).build();
    pool.map_err(|e| Error::new(format!("cannot start the threads: {e}")))?.install(work)
}

/// Writes `text` to stdout. A closed pipe means that the reader has seen enough.
fn print(text: &str) -> Result<(), Error> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Error::new(format!("cannot write to stdout: {e}"))),
        _ => Ok(()),
    }
}

/// The first paragraph of a usage error, which says what is wrong, on one line.
fn one_line(usage: &clap::Error) -> Error {
    if usage.kind() == clap::error::ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        return Error::new(
            "a command is missing: `jerboa render` makes a first picture (jerboa --help lists the words)",
        );
    }
    let text = usage.render().to_string();
    let paragraph = text.lines().take_while(|line| !line.trim().is_empty()).map(str::trim);
    let line = paragraph.collect::<Vec<_>>().join(" ");
    Error::new(format!("{} (jerboa --help lists the words)", line.trim_start_matches("error: ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn usage_error(words: &str) -> String {
        one_line(&Cli::try_parse_from(words.split(' ')).expect_err("a usage error")).to_string()
    }

    #[test]
    fn usage_errors_are_one_line() {
        let unknown = usage_error("jerboa compare a.exr b.exr --frob");
        assert_eq!(unknown, "unexpected argument '--frob' found (jerboa --help lists the words)");
        assert!(usage_error("jerboa compare a.exr").contains("A"));
        assert!(usage_error("jerboa").starts_with("a command is missing"));
        for words in ["jerboa compare", "jerboa frob", "jerboa compare a.exr b.exr --diff"] {
            let line = usage_error(words);
            assert!(!line.contains('\n') && line.len() > 40, "{line}");
        }
    }
}
