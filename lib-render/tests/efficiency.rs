//! `jerboa bench error` as its users run it.

use std::process::{Command, Output};

fn bench(folder: &std::path::Path, words: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_jerboa"));
    command.args(["bench", "error"]).args(words.split_whitespace()).current_dir(folder).output().expect("it starts")
}

#[test]
fn a_report_has_every_run_and_every_contestant() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let words = "builtin:cornell-box --width 24 --height 18 --budget 0.3 --runs 2 --seed 7 -o page.html --csv runs.csv";
    let out = bench(folder.path(), words);
    let (told, doing) = (String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr));
    assert!(out.status.success(), "{doing}");
    assert!(told.starts_with("cornell-box, 24x18\n") && told.contains("the first gains"), "{told}");

    let runs = std::fs::read_to_string(folder.path().join("runs.csv")).expect("it was written");
    let lines: Vec<Vec<&str>> = runs.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let seeds: Vec<&str> = lines.iter().map(|cells| cells[5]).collect();
    assert_eq!(seeds, ["7", "8", "7", "8"], "two contestants, two seeds");
    for cells in &lines {
        let [spp, seconds, rendering, error] = [6, 7, 8, 9].map(|k| cells[k].parse::<f64>().expect("a number"));
        assert!(spp >= 1.0 && seconds > rendering && rendering > 0.0 && error > 0.0, "{cells:?}");
    }
    let page = std::fs::read_to_string(folder.path().join("page.html")).expect("it was written");
    for name in ["Jerboa --known structure", "Jerboa --known nothing", "<svg", "All scenes"] {
        assert!(page.contains(name), "{name}");
    }

    // What is there is not measured again, and stays as it is; another budget is added.
    let again = bench(folder.path(), &words.replace("--budget 0.3", "--budget 0.3,0.4"));
    let doing = String::from_utf8_lossy(&again.stderr);
    assert!(again.status.success() && doing.contains("cornell-box, 0.3 s: measured before"), "{doing}");
    let more = std::fs::read_to_string(folder.path().join("runs.csv")).expect("it was written");
    assert!(more.starts_with(&runs) && more.lines().count() == 9, "{more}");
    let others = bench(folder.path(), &words.replace("--budget 0.3", "--budget 0.5 --ours --known=all"));
    let doing = String::from_utf8_lossy(&others.stderr);
    assert!(!others.status.success() && doing.contains("runs.csv has cornell-box by other contestants"), "{doing}");
}

#[test]
fn what_cannot_be_measured_is_said_in_a_line() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (words, says) in [
        ("builtin:cornell-box -o page.txt", "cannot write page.txt: its name must end in .html"),
        ("missing.glb", "missing.glb"),
        ("builtin:cornell-box --runs 1", "--runs"),
        ("builtin:cornell-box --budget 0.1 --width 8 --ours --frob", "jerboa render builtin:cornell-box"),
    ] {
        let out = bench(folder.path(), words);
        let told = String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(1), "{words}: {told}");
        assert!(told.lines().count() == 1 && told.contains(says), "{words}: {told}");
    }
}
