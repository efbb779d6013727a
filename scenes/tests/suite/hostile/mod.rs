//! T28: hostile files. Each is loaded in a child process that may use 1 GiB of address space and 2 seconds of processor
//! time, and must end with a scene that holds together or a one-line error; never a panic, an abort, or a look outside
//! the folder.

mod corpus;
mod extensions;
mod mutate;
mod wavefront;

use crate::common::{check, write};
use jerboa_scenes::{Limits, Scene, Selection};
use std::path::Path;
use std::process::{Command, Stdio};

/// What the child is to do; set only by this file.
const ERRAND: &str = "JERBOA_HOSTILE_ERRAND";

const MEMORY_KIB: u64 = 1 << 20;

/// Runs `errand` in a child; returns its complaint unless it ends well.
fn in_child(errand: &str, seconds: u64) -> Result<(), String> {
    let limits = format!("ulimit -v {MEMORY_KIB} && ulimit -t {seconds} && exec \"$0\" \"$@\"");
    let child = Command::new("sh")
        .args(["-c", &limits])
        .arg(std::env::current_exe().unwrap())
        .args(["--exact", "hostile::child", "--nocapture", "--test-threads=1"])
        .env(ERRAND, errand)
        .env("RUST_BACKTRACE", "0")
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&child.stdout).into_owned() + &String::from_utf8_lossy(&child.stderr);
    if child.status.success() { Ok(()) } else { Err(format!("{}: {said}", child.status)) }
}

/// The child's side; without an errand it has nothing to do.
#[test]
fn child() {
    let Ok(errand) = std::env::var(ERRAND) else {
        return;
    };
    match errand.split_once(' ') {
        Some(("load", file)) => {
            let outcome = outcome(Path::new(file));
            std::fs::write(format!("{file}.outcome"), outcome).unwrap();
        }
        Some((kind @ ("mutate" | "streams"), rest)) => {
            let numbers: Vec<u64> = rest.split(' ').take(2).map(|n| n.parse().unwrap()).collect();
            let folder = rest.splitn(3, ' ').nth(2).unwrap();
            let run = if kind == "mutate" { mutate::run } else { mutate::run_streams };
            run(numbers[0], numbers[1], Path::new(folder));
        }
        _ => panic!("unknown errand {errand}"),
    }
}

/// What loading a file led to, in a few words, without the folder's name.
fn outcome(file: &Path) -> String {
    // Files of animations are looked at while they move, those of variants in their first.
    let is = |kind: &str| file.file_name().is_some_and(|name| name.to_string_lossy().starts_with(kind));
    let (time, variant) = (is("animated").then_some(0.5), is("variant").then(|| "0".into()));
    let selection = Selection { time, variant, ..Selection::default() };
    let text = match Scene::load_selected(file, &selection, &Limits::default()) {
        Ok(scene) => {
            check(&scene);
            let warnings = scene.warnings.iter().map(|w| format!("; {w}"));
            format!("ok, {} triangles{}", scene.triangle_count(), warnings.collect::<String>())
        }
        Err(error) => format!("error: {error}"),
    };
    assert!(!text.contains('\n'), "more than a line: {text}");
    text.replace(&format!("{}/", file.parent().unwrap().display()), "")
}

/// The corpus against the golden file; `BLESS=1` rewrites that.
#[test]
fn every_hostile_file_has_its_outcome() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("scene");
    std::fs::create_dir(&folder).unwrap();
    // Sound data outside the folder: a loader that follows the path there would succeed.
    write(root.path(), "outside.bin", corpus::triangle_bytes());
    std::os::unix::fs::symlink("../outside.bin", folder.join("link.bin")).unwrap();

    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/suite/hostile/outcomes.txt");
    let mut text = String::from("# BLESS=1 cargo test -p jerboa-scenes hostile\n");
    for (name, bytes) in corpus::cases() {
        let file = write(&folder, &name, bytes);
        // Libraries are read by the files that name them.
        if name.ends_with(".mtl") {
            continue;
        }
        let outcome = match in_child(&format!("load {}", file.display()), 2) {
            Ok(()) => std::fs::read_to_string(format!("{}.outcome", file.display())).unwrap(),
            Err(complaint) => panic!("{name}: {complaint}"),
        };
        text +=
            &format!("{name}: {outcome}\n").replace(&format!("{name}: error: {name}: "), &format!("{name}: error: "));
    }
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&golden, &text).unwrap();
    }
    let expected = std::fs::read_to_string(&golden).unwrap();
    for (now, then) in text.lines().zip(expected.lines()) {
        assert_eq!(now, then);
    }
    assert_eq!(text.lines().count(), expected.lines().count());
}

/// Sound files with a few random faults. `JERBOA_MUTATIONS` sets their number, `JERBOA_SEED` the first seed.
#[test]
fn mutated_files_do_no_harm() {
    mutated("mutate");
}

/// And sound Draco streams.
#[test]
fn mutated_streams_do_no_harm() {
    mutated("streams");
}

fn mutated(kind: &str) {
    let number = |name: &str, default: u64| std::env::var(name).map_or(default, |n| n.parse().unwrap());
    let (seed, count) = (number("JERBOA_SEED", 1), number("JERBOA_MUTATIONS", 2000));
    println!("seeds {seed} to {}", seed + count - 1);
    // Batches, so that the bound on time stays near that of a single file.
    const BATCH: u64 = 500;
    for first in (seed..seed + count).step_by(BATCH as usize) {
        let folder = tempfile::tempdir().unwrap();
        let size = BATCH.min(seed + count - first);
        if let Err(complaint) = in_child(&format!("{kind} {first} {size} {}", folder.path().display()), 60) {
            let at = std::fs::read_to_string(folder.path().join("seed")).unwrap_or_default();
            panic!("JERBOA_SEED={at} JERBOA_MUTATIONS=1: {complaint}");
        }
    }
}
