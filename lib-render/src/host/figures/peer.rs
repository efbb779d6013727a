//! Mitsuba 3 beside us: the peer of Table 2 and of `jerboa bench error`, in a process of its own.
//!
//! A script of ours (`peer.py`, which a Python that has the package `mitsuba` runs) reads the same glTF file and makes a
//! scene of it, then renders whenever it is told a seed; for speed against error it starts from the file each time. Jerboa needs none of it unless somebody asks for the comparison.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use serde_json::json;
use tempfile::TempDir;

use crate::host::error::Error;

/// What runs there.
const SCRIPT: &str = include_str!("peer.py");

/// How it renders.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Size of the film, pixels.
    pub size: [u32; 2],
    /// Samples per pixel.
    pub spp: u32,
    /// Largest number of path edges.
    pub max_depth: u32,
    /// Scattering from which on roulette may end a path, with at most 0.95.
    pub rr_depth: u32,
    /// Name of its sampler: `independent`, `multijitter` or another that it has.
    pub sampler: String,
    /// Width of its vectors; its best if none is given.
    pub lanes: Option<u32>,
}

/// A render from the opening of the file on.
#[derive(Clone, Debug)]
pub struct Whole {
    /// Wall time from the opening of the file to the finished film, s.
    pub seconds: f64,
    /// Of that, the time after loading: compilation and rendering, which the peer does together, s.
    pub render_seconds: f64,
    /// Samples per pixel: a sampler may round them up.
    pub spp: u32,
}

/// A peer in a process of its own.
pub struct Peer {
    /// Where it keeps what it compiled: a user's own cache stays as it is.
    _cache: TempDir,
    process: Child,
    words: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Peer {
    /// Starts it on a file, which it does not open yet.
    ///
    /// # Errors
    /// When the Python cannot be started.
    pub fn start(python: &Path, file: &Path, setting: &Setting) -> Result<Peer, Error> {
        let Setting { size: [width, height], spp, max_depth, rr_depth, sampler, lanes } = setting;
        let cache = tempfile::tempdir().map_err(|e| Error::new(format!("no folder for the peer's cache: {e}")))?;
        let words = json!({
            "width": width,
            "height": height,
            "spp": spp,
            "max_depth": max_depth,
            "rr_depth": rr_depth,
            "sampler": sampler,
            "lanes": lanes,
            "cache": cache.path(),
        });
        let mut process = Command::new(python)
            .args(["-c", SCRIPT])
            .arg(file)
            .arg(words.to_string())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| Error::new(format!("--peer {}: cannot be started: {e}", python.display())))?;
        let (words, answers) = (process.stdin.take(), process.stdout.take());
        let (Some(words), Some(answers)) = (words, answers) else { unreachable!("both were asked for") };
        Ok(Peer { _cache: cache, process, words, answers: BufReader::new(answers) })
    }

    /// Loads the scene: the wall time, s.
    ///
    /// # Errors
    /// When the process has ended, as it does where the Python has no Mitsuba; it says why on stderr.
    pub fn load(&mut self) -> Result<f64, Error> {
        self.number("load")
    }

    /// Renders with a seed: the wall time, s. The seed 0 warms up: its picture does not count for the variance.
    ///
    /// # Errors
    /// When the process has ended.
    pub fn render(&mut self, seed: u32) -> Result<f64, Error> {
        self.number(&format!("render {seed}"))
    }

    /// Forgets the scene and what it compiled, opens the file again and renders so many samples per pixel; the picture goes
    /// to `target`, as 32-bit floats, red, green and blue of each pixel.
    ///
    /// # Errors
    /// When the process has ended.
    pub fn whole(&mut self, seed: u32, spp: u32, target: &Path) -> Result<Whole, Error> {
        match self.ask(&format!("whole {seed} {spp} {}", target.display()))?[..] {
            [seconds, render_seconds, spp] => Ok(Whole { seconds, render_seconds, spp: spp as u32 }),
            _ => Err(Error::new("the peer answered something else: peer.py and peer.rs must agree")),
        }
    }

    /// Variance of a sample, as [`super::table_2`] defines it, of the pictures so far.
    ///
    /// # Errors
    /// When the process has ended.
    pub fn variance(&mut self) -> Result<f64, Error> {
        self.number("variance")
    }

    fn number(&mut self, word: &str) -> Result<f64, Error> {
        self.ask(word)?.first().copied().ok_or_else(|| Error::new("the peer gave an empty answer"))
    }

    /// Sends a line and reads the numbers that answer it.
    fn ask(&mut self, words: &str) -> Result<Vec<f64>, Error> {
        let mut line = String::new();
        let asked = writeln!(self.words, "{words}").and_then(|()| self.words.flush());
        let answered = asked.and_then(|()| self.answers.read_line(&mut line));
        let numbers = line.split_whitespace().map(|n| n.parse().ok()).collect::<Option<Vec<f64>>>();
        let numbers = numbers.filter(|n| answered.is_ok() && !n.is_empty());
        numbers.ok_or_else(|| Error::new("the peer has ended; what it wrote above says why"))
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // If it has ended already, there is nothing to end.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
