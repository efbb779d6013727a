//! Mitsuba 3 beside us: the peer of Table 2, in a process of its own.
//!
//! A script of ours (`peer.py`, which a Python that has the package `mitsuba` runs) reads the same glTF file and makes a
//! scene of it, then renders whenever it is told a seed. Jerboa needs none of it unless somebody asks for the comparison.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use super::table_2::{Job, RR_DEPTH};
use crate::host::error::Error;

/// What runs there.
const SCRIPT: &str = include_str!("peer.py");

/// A peer that has loaded a scene.
pub struct Peer {
    process: Child,
    words: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Peer {
    /// Starts it on a file. `lanes` is the width of its vectors, its best unless given.
    ///
    /// # Errors
    /// When the Python cannot be started, or has no Mitsuba; it says why on stderr.
    pub fn start(python: &Path, file: &Path, job: &Job, lanes: Option<u32>) -> Result<Peer, Error> {
        let Job { size: [width, height], spp, max_depth, .. } = job;
        let numbers = [*width, *height, *spp, *max_depth, RR_DEPTH, lanes.unwrap_or(0)];
        let mut process = Command::new(python)
            .args(["-c", SCRIPT])
            .arg(file)
            .args(numbers.map(|n| n.to_string()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| Error::new(format!("--peer {}: cannot be started: {e}", python.display())))?;
        let (words, answers) = (process.stdin.take(), process.stdout.take());
        let (Some(words), Some(answers)) = (words, answers) else { unreachable!("both were asked for") };
        let mut peer = Peer { process, words, answers: BufReader::new(answers) };
        peer.ask("load")?;
        Ok(peer)
    }

    /// Renders with a seed: the wall time, s. The seed 0 warms up: its picture does not count for the variance.
    ///
    /// # Errors
    /// When the process has ended.
    pub fn render(&mut self, seed: u32) -> Result<f64, Error> {
        self.ask(&seed.to_string())
    }

    /// Variance of a sample, as [`super::table_2`] defines it, of the pictures so far.
    ///
    /// # Errors
    /// When the process has ended.
    pub fn variance(&mut self) -> Result<f64, Error> {
        self.ask("variance")
    }

    /// Sends a line and reads the number that answers it.
    fn ask(&mut self, word: &str) -> Result<f64, Error> {
        let mut line = String::new();
        let asked = writeln!(self.words, "{word}").and_then(|()| self.words.flush());
        let answered = asked.and_then(|()| self.answers.read_line(&mut line));
        let number = line.trim().parse().ok().filter(|_| answered.is_ok());
        number.ok_or_else(|| Error::new("the peer has ended; what it wrote above says why"))
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // If it has ended already, there is nothing to end.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
