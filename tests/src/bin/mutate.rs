//! The mutation check (T32), as a command: does the suite notice what is wrong?
//!
//! ```sh
//! cargo run -p jerboa-tests --bin mutate -- [NAME…] [--list]
//! ```
//!
//! Clones the last commit to `target/mutations`, seeds every mutation of `jerboa_tests::mutations` there behind a switch,
//! and builds the tests once, as the test command does. Then, for each mutation (or those named), it runs them with that
//! one switched on until one is red: first the crate that the mutation changes (for a component: the tests of components),
//! then the rest, quick targets before slow ones, examples last. Only the test that compares the list with the sources is
//! left out. A target counts only if it is green with everything switched off. The checkout itself is not touched; the
//! clone is kept, so that the next build is incremental.
//!
//! Prints a row for each mutation: the first test that failed, or that it survived, and how long that took. A target that
//! takes ten times as long as it should and two minutes more, or more memory than [`MEMORY_KIB`], counts as red. The exit
//! code says whether 28 of 30 were caught, by a suite that is green.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use jerboa_tests::mutations::{Mutation, SWITCH, all};
use jerboa_tests::sources::{root, shared_scenes};
use serde_json::Value;

/// Address space of a target: a mutant that never stops growing must not take the machine.
const MEMORY_KIB: u64 = 12 << 20;

/// How long a target may take of which nothing is known yet.
const LONGEST: Duration = Duration::from_secs(1800);

/// Where the seconds of green targets are kept, below `target/mutations`.
const SECONDS: &str = "seconds.json";

/// Of so many mutations, so many must be caught.
const CAUGHT: (usize, usize) = (28, 30);

fn main() -> ExitCode {
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(message) => {
            eprintln!("mutate: {message}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<bool, String> {
    let mutations = asked_for()?;
    if std::env::args().any(|word| word == "--list") {
        mutations.iter().for_each(|m| println!("{}\n    {}: {}", m.name, m.file, m.mistake));
        return Ok(true);
    }
    let mut suite = Suite::new()?;
    println!("| mutation | file | verdict | seconds |\n|---|---|---|---|");
    let mut caught = 0;
    for m in &mutations {
        let start = Instant::now();
        let verdict = match suite.first_red(m)? {
            Some((target, failure)) => {
                caught += 1;
                format!("{target}: {failure}")
            }
            None => "SURVIVED".to_owned(),
        };
        println!("| {} | {} | {verdict} | {} |", m.name, m.file, start.elapsed().as_secs());
    }
    println!("\n{caught} of {} caught at commit {}", mutations.len(), suite.commit);
    Ok(suite.left_out == 0 && caught * CAUGHT.1 >= mutations.len() * CAUGHT.0)
}

/// The mutations that the command line names, or all.
fn asked_for() -> Result<Vec<&'static Mutation>, String> {
    let names: Vec<String> = std::env::args().skip(1).filter(|word| word != "--list").collect();
    if names.is_empty() {
        return Ok(all().collect());
    }
    let find = |name: &String| all().find(|m| m.name == name).ok_or(format!("no mutation `{name}`; --list shows them"));
    names.iter().map(find).collect()
}

/// Tests that run together.
#[derive(Clone)]
struct Target {
    /// The folder of the crate; empty for the examples of all.
    folder: String,
    /// Folder and name, as cargo has it, or `examples`.
    name: String,
    /// What to run.
    command: Vec<String>,
}

/// The clone of a commit with every mutation in it, and what is known of its tests.
struct Suite {
    /// Where clone, build and notes are.
    folder: PathBuf,
    commit: String,
    targets: Vec<Target>,
    /// Seconds that a target took when it was green, by name; kept from run to run.
    seconds: BTreeMap<String, f64>,
    /// Targets that are green with everything switched off.
    green: BTreeSet<String>,
    /// Number of targets that are not.
    left_out: usize,
}

impl Suite {
    /// Clone, seed and build.
    fn new() -> Result<Suite, String> {
        let folder = root().join("target/mutations");
        let checkout = folder.join("checkout");
        fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        if !checkout.is_dir() {
            git(&folder, &["clone", "--quiet", "--shared", "--no-checkout", &root().to_string_lossy(), "checkout"])?;
        }
        let commit = git(&root(), &["rev-parse", "HEAD"])?.trim().to_owned();
        if git(&checkout, &["rev-parse", "HEAD"])?.trim() != commit || !checkout.join("Cargo.toml").is_file() {
            git(&checkout, &["fetch", "--quiet", "origin", &commit])?;
            git(&checkout, &["checkout", "--quiet", "--force", "--detach", &commit])?;
        }
        for file in all().map(|m| m.file).collect::<BTreeSet<_>>() {
            let text = git(&checkout, &["show", &format!("{commit}:{file}")])?;
            let seeded = all().filter(|m| m.file == file).try_fold(text, |text, m| m.seed(&text))?;
            let file = checkout.join(file);
            // What is seeded already keeps its date, so that cargo builds nothing.
            if fs::read_to_string(&file).ok().as_ref() != Some(&seeded) {
                fs::write(&file, seeded).map_err(|e| format!("{}: {e}", file.display()))?;
            }
        }
        let seconds = fs::read(folder.join(SECONDS)).ok().and_then(|text| serde_json::from_slice(&text).ok());
        let seconds = seconds.unwrap_or_default();
        let mut suite = Suite { folder, commit, targets: vec![], seconds, green: BTreeSet::new(), left_out: 0 };
        suite.targets = suite.build()?;
        Ok(suite)
    }

    /// A command in the clone.
    fn command(&self, words: &[&str]) -> Command {
        let mut command = Command::new(words[0]);
        command.args(&words[1..]).current_dir(self.folder.join("checkout"));
        // Nobody debugs a mutant, and what it reads lies beside the checkout, not beside the clone.
        command.env("CARGO_TARGET_DIR", self.folder.join("build")).env("CARGO_PROFILE_DEV_DEBUG", "false");
        if let Some(shared) = shared_scenes().and_then(|scenes| scenes.parent()?.canonicalize().ok()) {
            command.env("JERBOA_SHARED", shared);
        }
        command.env_remove(SWITCH).stdin(Stdio::null());
        command
    }

    /// Build all tests; the targets they are.
    fn build(&self) -> Result<Vec<Target>, String> {
        let output = self
            .command(&["cargo", "test", "--locked", "--workspace", "--no-run", "--message-format=json"])
            .stderr(Stdio::inherit())
            .output()
            .map_err(|e| format!("cargo cannot be started: {e}"))?;
        let messages: Vec<Value> = output.stdout.split(|c| *c == b'\n').flat_map(serde_json::from_slice).collect();
        if !output.status.success() {
            let error = messages.iter().find(|m| m["message"]["level"] == "error");
            let text = error.and_then(|m| m["message"]["rendered"].as_str()).unwrap_or_default();
            return Err(format!("the mutants do not build\n{text}"));
        }
        let mut targets: Vec<Target> = messages.iter().filter_map(target).collect();
        let examples = ["cargo", "test", "--locked", "--workspace", "--doc"].map(String::from).to_vec();
        targets.push(Target { folder: String::new(), name: "examples".into(), command: examples });
        Ok(targets)
    }

    /// Test what is closest to the mutation, then the rest, quick targets first, until one is red: the target, and the
    /// failure that it printed first.
    fn first_red(&mut self, m: &Mutation) -> Result<Option<(String, String)>, String> {
        let mut targets = self.targets.clone();
        let far = |t: &Target| match m.closest() {
            [] => t.folder != m.folder(),
            closest => !closest.contains(&t.name.as_str()),
        };
        let seconds = |t: &Target| self.seconds.get(&t.name).copied().unwrap_or(0.0);
        let examples = |t: &Target| t.folder.is_empty();
        targets
            .sort_by(|a, b| (far(a), examples(a)).cmp(&(far(b), examples(b))).then(seconds(a).total_cmp(&seconds(b))));
        for target in targets {
            let Some(failure) = self.test(&target, Some(m))? else { continue };
            if self.is_green(&target)? {
                return Ok(Some((target.name, failure)));
            }
        }
        Ok(None)
    }

    /// Is a target green with everything switched off? One that is not can catch nothing, and is left out from then on.
    fn is_green(&mut self, target: &Target) -> Result<bool, String> {
        if self.green.contains(&target.name) {
            return Ok(true);
        }
        if let Some(failure) = self.test(target, None)? {
            println!("{} is left out: it is red without any mutation: {failure}", target.name);
            self.targets.retain(|t| t.name != target.name);
            self.left_out += 1;
            return Ok(false);
        }
        Ok(self.green.insert(target.name.clone()))
    }

    /// Run a target with this mutation switched on; the first failure.
    fn test(&mut self, target: &Target, m: Option<&Mutation>) -> Result<Option<String>, String> {
        let log = self.folder.join("log");
        let say = |e: std::io::Error| format!("{}: {e}", log.display());
        let said = File::create(&log).map_err(say)?;
        let limited = format!("ulimit -v {MEMORY_KIB}; exec \"$@\"");
        let mut words = vec!["sh", "-c", &limited, "sh"];
        words.extend(target.command.iter().map(String::as_str));
        let mut command = self.command(&words);
        command.stdout(said.try_clone().map_err(say)?).stderr(said).process_group(0);
        if !target.folder.is_empty() {
            command.current_dir(self.folder.join("checkout").join(&target.folder));
        }
        command.envs(m.map(|m| (SWITCH, m.name)));
        let limit = self.seconds.get(&target.name).map_or(LONGEST, |s| Duration::from_secs_f64(s * 10.0 + 120.0));
        let start = Instant::now();
        let status = wait(command, limit)?;
        if status == Some(true) {
            self.seconds.insert(target.name.clone(), start.elapsed().as_secs_f64());
            let notes = serde_json::to_string(&self.seconds).map_err(|e| e.to_string())?;
            fs::write(self.folder.join(SECONDS), notes).map_err(|e| format!("{SECONDS}: {e}"))?;
            return Ok(None);
        }
        let said = fs::read(&log).map_err(say)?;
        let said = String::from_utf8_lossy(&said);
        let failed = said.lines().find_map(|line| line.strip_prefix("test ")?.strip_suffix(" ... FAILED"));
        let why = if status.is_none() { "ran out of time" } else { "ended without naming a test" };
        Ok(Some(failed.unwrap_or(why).to_owned()))
    }
}

/// The target that cargo built, if its message says that it built tests; not the one that holds the list to the sources.
fn target(message: &Value) -> Option<Target> {
    let name = message["target"]["name"].as_str()?;
    let executable = message["executable"].as_str()?;
    let is_test = message["profile"]["test"] == true && message["target"]["kind"][0] != "bin" && name != "mutations";
    let folder = Path::new(message["manifest_path"].as_str()?).parent()?.file_name()?.to_str()?;
    is_test.then(|| Target {
        folder: folder.into(),
        name: format!("{folder}/{name}"),
        command: vec![executable.into()],
    })
}

/// Was the command successful? Nothing where it took longer than it may; then all its processes are ended.
fn wait(mut command: Command, limit: Duration) -> Result<Option<bool>, String> {
    let mut child = command.spawn().map_err(|e| format!("sh cannot be started: {e}"))?;
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait().map_err(|e| e.to_string())? {
            return Ok(Some(status.success()));
        }
        if start.elapsed() > limit {
            let group = format!("-{}", child.id());
            Command::new("kill").args(["-KILL", "--", &group]).status().map_err(|e| e.to_string())?;
            child.wait().map_err(|e| e.to_string())?;
            return Ok(None);
        }
        sleep(Duration::from_millis(50));
    }
}

/// What git prints.
fn git(folder: &Path, args: &[&str]) -> Result<String, String> {
    let output = Command::new("git")
        .args(args)
        .current_dir(folder)
        .output()
        .map_err(|e| format!("git cannot be started: {e}"))?;
    if !output.status.success() {
        return Err(format!("git {}: {}", args.join(" "), String::from_utf8_lossy(&output.stderr).trim()));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}
