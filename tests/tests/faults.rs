//! What happens when something gives out (T30): memory, the disk, a thread, patience. One line that says so, an exit code that is
//! not 0, and the file that was there before still whole.
//!
//! *Memory*: every request for it in a render, one at a time, in a process of its own. The command's allocator ends the process
//! with a line, since neither Rust's collections nor Cranelift go on without memory: so this is all requests, large or small, on
//! every thread. A process that is ended so, or killed, while it saves leaves the file that it was writing to the side. Memory
//! that the system has promised and then has not is not seen by any allocator. *The disk*: a limit on the size of files
//! stands for a disk that is full, as the write fails in the same place. How long cancelling takes is measured by
//! `cargo run --release -p jerboa-tests --bin stability -- cancel`.
//!
//! JERBOA_FAULTS sets how many requests for memory are refused, and moments at which a process is killed; JERBOA_CYCLES how often
//! code is made and freed.
#![cfg(unix)]

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use jerboa_lib_render::host::film::Film;
use jerboa_lib_render::host::image_io::Image;
use jerboa_lib_render::host::renderer::{Handle, Options, Render, Renderer};
use jerboa_scenes::Scene;
use jerboa_tests::harness::bench::{Random, number};

/// The process that goes wrong.
const FAULTS: &str = env!("CARGO_BIN_EXE_faults");

/// What a render leaves alone if it fails.
const OLD: &str = "the old file";

/// A folder with an old file in it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("faults-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder for this test");
        let folder = Folder(path);
        std::fs::write(folder.file(), OLD).expect("a file to be left alone");
        folder
    }

    fn file(&self) -> PathBuf {
        self.0.join("out.exr")
    }

    fn is_as_it_was(&self) -> bool {
        std::fs::read_to_string(self.file()).is_ok_and(|text| text == OLD)
    }

    /// The words of a small render to the file.
    fn render(&self) -> Vec<String> {
        let file = self.file();
        let words = "render builtin:cornell-box --tracer depth --spp 1 --width 64 --height 64 --threads 2 -o";
        words.split(' ').map(String::from).chain([file.to_str().expect("a name in Unicode").into()]).collect()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // A folder of the build that stays is no failure.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn run(words: impl IntoIterator<Item = impl AsRef<std::ffi::OsStr>>) -> Output {
    let mut command = Command::new(FAULTS);
    command.args(words).env_remove("RUST_BACKTRACE").output().expect("it runs")
}

/// It failed with exit code 1 and one line on stderr, which is given.
fn one_line(output: &Output) -> String {
    let text = String::from_utf8(output.stderr.clone()).expect("it speaks Unicode");
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.starts_with("jerboa: ") && text.ends_with('\n') && text.lines().count() == 1, "{text}");
    assert!(output.stdout.is_empty());
    text.trim_end().into()
}

#[test]
fn without_memory_it_says_so() {
    let folder = Folder::new("memory");
    let counted = run([vec!["count".into()], folder.render()].concat());
    let last = String::from_utf8_lossy(&counted.stderr).lines().last().and_then(|n| n.parse().ok());
    let requests: usize = last.expect("it counts");
    std::fs::write(folder.file(), OLD).expect("a file to be left alone");
    let mut random = Random::new(30);
    for _ in 0..number("JERBOA_FAULTS", 12) {
        // Threads make their number vary a little.
        let n = random.below(requests - requests / 50);
        let line = one_line(&run([vec!["starve".into(), n.to_string()], folder.render()].concat()));
        assert!(line.starts_with("jerboa: out of memory: "), "request {n} of {requests}: {line}");
        assert!(folder.is_as_it_was(), "request {n} of {requests}");
    }
}

#[test]
fn a_panic_on_a_thread_is_one_line() {
    let line = one_line(&run(["panic"]));
    assert!(
        line.starts_with("jerboa: a fault of Jerboa, please report it: of this test (tests/src/bin/faults.rs:"),
        "{line}"
    );
}

#[test]
fn a_full_disk_leaves_the_old_file() {
    let folder = Folder::new("disk");
    // Blocks of 512 or 1024 bytes, of which the image takes 12 KiB at least.
    let limited = |prelude: &str| {
        let mut shell = Command::new("sh");
        shell.args(["-c", &format!("{prelude} ulimit -f 4; exec \"$0\" run \"$@\""), FAULTS]).args(folder.render());
        shell.output().expect("there is a shell")
    };
    let line = one_line(&limited("trap '' XFSZ;"));
    assert!(line.starts_with("jerboa: cannot write ") && line.contains("out.exr: "), "{line}");
    assert!(folder.is_as_it_was());
    assert_eq!(std::fs::read_dir(&folder.0).expect("it is there").count(), 1, "what was written is gone");
    // Where the system ends the process by a signal, the shell says so.
    assert!(!limited("").status.success());
    assert!(folder.is_as_it_was());
}

#[test]
fn where_nothing_can_be_written_it_says_so() {
    let folder = Folder::new("rights");
    let mut words = folder.render();
    *words.last_mut().expect("a name") = "/proc/out.exr".into();
    let line = one_line(&run([vec!["run".into()], words].concat()));
    assert!(line.starts_with("jerboa: cannot write /proc/out.exr: "), "{line}");
    let rights = |mode: u32| {
        let rights = std::os::unix::fs::PermissionsExt::from_mode(mode);
        std::fs::set_permissions(&folder.0, rights).expect("it is our own folder");
    };
    rights(0o555);
    // Who may do everything is not kept from it by rights.
    if std::fs::write(folder.0.join("probe"), "").is_err() {
        let line = one_line(&run([vec!["run".into()], folder.render()].concat()));
        assert!(line.contains("out.exr: "), "{line}");
        assert!(folder.is_as_it_was());
    }
    rights(0o755);
}

#[test]
fn who_is_killed_while_saving_leaves_the_old_file() {
    let folder = Folder::new("killed");
    let mut child =
        Command::new(FAULTS).arg("save").arg(folder.file()).stdout(Stdio::piped()).spawn().expect("it runs");
    let mut line = String::new();
    BufReader::new(child.stdout.take().expect("it is piped")).read_line(&mut line).expect("it says when");
    assert_eq!(line, "half\n");
    child.kill().expect("it runs until now");
    child.wait().expect("it is ours");
    assert!(folder.is_as_it_was());

    let mut random = Random::new(9);
    for _ in 0..number("JERBOA_FAULTS", 12).div_ceil(2) {
        let mut child =
            Command::new(FAULTS).arg("run").args(folder.render()).stdout(Stdio::null()).spawn().expect("it runs");
        std::thread::sleep(Duration::from_secs_f64(0.5 * random.uniform()));
        child.kill().expect("it is ours");
        child.wait().expect("it is ours");
        let whole = || Image::read(&folder.file()).is_ok_and(|i| (i.width, i.height) == (64, 64));
        assert!(folder.is_as_it_was() || whole());
    }
    assert!(run([vec!["run".into()], folder.render()].concat()).status.success(), "the next save is none the worse");
}

/// A film whose render is cancelled at any time has whole tiles of whole passes, and the next render on it is sound.
#[test]
fn cancelling_leaves_whole_tiles() {
    let scene = Scene::load("builtin:white-box").unwrap_or_else(|e| panic!("{e}"));
    let renderer = Renderer::new(&scene, Options::default()).unwrap_or_else(|e| panic!("{e}"));
    let (camera, mut random) = (scene.camera_or_default(), Random::new(100));
    for _ in 0..8 {
        let (mut film, handle) = (Film::of_size([64, 48]), Handle::default());
        let job = Render { sample: 0, spp: 1 << 20, seed: 1 };
        let wait = Duration::from_secs_f64(0.05 * random.uniform());
        let stats = std::thread::scope(|scope| {
            scope.spawn(|| {
                std::thread::sleep(wait);
                handle.cancel();
            });
            renderer.render_with(&camera, &mut film, job, &handle).unwrap_or_else(|e| panic!("{e}"))
        });
        for (x, y) in (0..48).flat_map(|y| (0..64).map(move |x| (x, y))) {
            let corner = [x / 16 * 16, y / 16 * 16];
            assert_eq!(film.count([x, y]), film.count(corner), "one tile, one number");
            assert!(film.count([x, y]) >= stats.spp);
        }
    }
}

#[test]
fn code_that_is_freed_is_gone() {
    let output = run(["cycles".to_string(), number("JERBOA_CYCLES", 40).to_string()]);
    let text = String::from_utf8_lossy(&output.stdout);
    let grown: u64 = text.trim().parse().unwrap_or_else(|_| panic!("{text}"));
    assert!(grown < 5 * 1024, "{grown} KiB more");
}
