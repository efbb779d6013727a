//! Who renders: this program by words of its command line, each time in a process of its own, or a peer.
//!
//! A process of its own starts from nothing, as a user does: no generic program, no compiled kernel is left from the run
//! before.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use serde_json::Value;

use crate::host::error::Error;
use crate::host::figures::peer::{Peer, Setting, Whole};
use crate::host::image_io::{Image, luminance};

/// Somebody who renders a scene.
pub enum Contestant {
    /// This program.
    Ours(Ours),
    /// Another renderer.
    Peer(Theirs),
}

/// This program, by words of its command line.
pub struct Ours {
    /// What it is called in the report.
    pub name: String,
    /// The program.
    pub program: PathBuf,
    /// The scene as the command line names it.
    pub scene: String,
    /// Words of `jerboa render` beside scene, size, samples, seed and output.
    pub words: Vec<String>,
}

/// A peer that waits for seeds.
pub struct Theirs {
    /// What it is called in the report.
    pub name: String,
    /// Its process.
    pub peer: Peer,
}

/// A film and what it took.
#[derive(Clone, Debug)]
pub struct Run {
    /// Its seed.
    pub seed: u32,
    /// Samples per pixel.
    pub spp: u32,
    /// Wall time from the opening of the file to the finished film, s.
    pub seconds: f64,
    /// Of that, rendering alone; with a peer that compiles while it renders, all that follows loading, s.
    pub render_seconds: f64,
    /// Luminance of each pixel.
    pub luminance: Vec<f32>,
}

impl Contestant {
    /// A peer by its process.
    ///
    /// # Errors
    /// As [`Peer::start`].
    pub fn peer(name: String, python: &Path, file: &Path, setting: &Setting) -> Result<Contestant, Error> {
        Ok(Contestant::Peer(Theirs { name, peer: Peer::start(python, file, setting)? }))
    }

    /// What it is called in the report.
    pub fn name(&self) -> &str {
        match self {
            Contestant::Ours(ours) => &ours.name,
            Contestant::Peer(theirs) => &theirs.name,
        }
    }

    /// Renders so many samples per pixel from scratch.
    ///
    /// # Errors
    /// When the process fails (a child says why on stderr), or its film cannot be read.
    pub fn run(&mut self, size: [u32; 2], spp: u32, seed: u32) -> Result<Run, Error> {
        let folder = tempfile::tempdir().map_err(|e| Error::new(format!("no folder for films: {e}")))?;
        match self {
            Contestant::Ours(ours) => ours.run(size, spp, seed, &folder.path().join("film.exr")),
            Contestant::Peer(theirs) => theirs.run(size, spp, seed, &folder.path().join("film.f32")),
        }
    }
}

impl Ours {
    fn run(&self, [width, height]: [u32; 2], spp: u32, seed: u32, film: &Path) -> Result<Run, Error> {
        let fault = |what: &str| Error::new(format!("jerboa render {} {}: {what}", self.scene, self.words.join(" ")));
        let numbers = [("--width", width), ("--height", height), ("--spp", spp), ("--seed", seed)];
        let mut command = Command::new(&self.program);
        command.arg("render").arg(&self.scene).arg("--json").arg("-o").arg(film).args(&self.words);
        command.args(numbers.iter().flat_map(|(word, n)| [word.to_string(), n.to_string()]));
        let start = Instant::now();
        let output = command.output().map_err(|e| fault(&format!("cannot be started: {e}")))?;
        let seconds = start.elapsed().as_secs_f64();
        if !output.status.success() {
            return Err(fault(String::from_utf8_lossy(&output.stderr).trim()));
        }
        let told: Value = serde_json::from_slice(&output.stdout).map_err(|e| fault(&format!("its words: {e}")))?;
        let number = |value: &Value| value.as_f64().ok_or_else(|| fault("its words lack a number"));
        let luminance = Image::read(film)?.pixels.into_iter().map(|p| luminance(p) as f32).collect();
        let render_seconds = number(&told["seconds"]["render"])?;
        let spp = number(&told["spp"])? as u32;
        Ok(Run { seed, spp, seconds, render_seconds, luminance })
    }
}

impl Theirs {
    fn run(&mut self, [width, height]: [u32; 2], spp: u32, seed: u32, film: &Path) -> Result<Run, Error> {
        let Whole { seconds, render_seconds, spp } = self.peer.whole(seed, spp, film)?;
        let bytes = std::fs::read(film).map_err(|e| Error::new(format!("the peer's film: {e}")))?;
        let (channels, rest) = bytes.as_chunks::<4>();
        let (pixels, last) = channels.as_chunks::<3>();
        let count = width as usize * height as usize;
        if !rest.is_empty() || !last.is_empty() || pixels.len() != count {
            return Err(Error::new(format!("the peer's film has {} bytes, not 12 for each pixel", bytes.len())));
        }
        let luminance = pixels.iter().map(|p| luminance(p.map(f32::from_le_bytes)) as f32).collect();
        Ok(Run { seed, spp, seconds, render_seconds, luminance })
    }
}
