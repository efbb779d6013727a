//! A folder in which the command `jerboa` is run as its users run it.

use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

/// A folder to run the command in.
pub struct Desk(TempDir);

impl Desk {
    /// An empty one.
    pub fn new() -> Desk {
        Desk(tempfile::tempdir().expect("a temporary folder"))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// The command with these words, not yet started.
    pub fn command(&self, words: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_jerboa"));
        command.args(words.split_whitespace()).current_dir(self.path());
        command
    }

    /// What the command with these words leaves.
    pub fn run(&self, words: &str) -> Output {
        self.command(words).output().expect("the command starts")
    }

    /// What a command that succeeds writes to stdout.
    pub fn ok(&self, words: &str) -> String {
        let out = self.run(words);
        assert!(out.status.success(), "{words}: {}", String::from_utf8_lossy(&out.stderr));
        String::from_utf8(out.stdout).expect("text")
    }

    /// The line that a command that fails writes to stderr; warnings aside.
    pub fn error(&self, words: &str) -> String {
        let out = self.run(words);
        let text = String::from_utf8(out.stderr).expect("text");
        assert_eq!(out.status.code(), Some(1), "{words}: {text}");
        assert!(out.stdout.is_empty(), "{words}: wrote to stdout");
        let lines: Vec<&str> = text.lines().filter(|l| !l.starts_with("jerboa: warning: ")).collect();
        let [line] = lines[..] else { panic!("{words}: one line is expected, not:\n{text}") };
        line.strip_prefix("jerboa: ").unwrap_or_else(|| panic!("{words}: {line}")).to_string()
    }

    /// The only files in the folder.
    pub fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.path()).expect("the folder");
        let mut names: Vec<String> =
            entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}
