//! The page that maps hard cases to their proofs says the truth: what it names exists, and nothing is left out.

use jerboa_scenes::builtin;
use jerboa_tests::sources::{Source, sources};

const PAGE: &str = "docs/hard-cases.md";

/// What the last cell begins with where there is no proof yet; a reason follows.
const NOT_YET: &str = "Not yet: ";

/// Tests of the acceptance list that the page must prove.
const ACCEPTANCE: [u32; 21] = [4, 5, 6, 7, 8, 9, 10, 11, 12, 15, 16, 17, 18, 19, 20, 21, 22, 25, 26, 27, 29];

/// Case and proof of each row of the page's tables.
fn rows(page: &str) -> Vec<(&str, &str)> {
    let lines = page.lines().filter(|l| l.starts_with("| ") && !l.starts_with("| case |"));
    let row = |line: &'_ str| -> Option<(usize, usize)> {
        let mut bars = line.match_indices(" | ").map(|(at, _)| at);
        Some((bars.next()?, bars.next()?))
    };
    let cells = |line| {
        let (first, second) = row(line).unwrap_or_else(|| panic!("three cells are expected: {line}"));
        (line[2..first].trim(), line[second + 3..].trim_end_matches('|').trim())
    };
    lines.map(cells).collect()
}

/// Every second piece stands between backquotes.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// Faults of a proof: names of tests and scenes that do not exist.
fn faults(all: &[Source], case: &str, proof: &str) -> Vec<String> {
    if proof.starts_with(NOT_YET) {
        return Vec::new();
    }
    let (mut faults, mut proofs) = (Vec::new(), 0);
    for name in quoted(proof) {
        if let Some(scene) = name.strip_prefix("builtin:") {
            let exists = builtin::gallery().any(|(b, _)| b.name == scene);
            faults.extend((!exists).then(|| format!("{case}: no scene of the gallery is called `{scene}`")));
        } else if let Some((path, function)) = name.split_once("::") {
            let exists = all.iter().any(|s| s.path == path && has_test(&s.text, function));
            faults.extend((!exists).then(|| format!("{case}: there is no test `{name}`")));
        } else {
            let exists = all.iter().any(|s| s.path == name);
            faults.extend((!exists).then(|| format!("{case}: there is no file `{name}`")));
            continue;
        }
        proofs += 1;
    }
    faults.extend((proofs == 0).then(|| format!("{case}: neither a test nor a scene")));
    faults
}

/// Is there a function of this name, with `#[test]` within the lines above?
fn has_test(text: &str, function: &str) -> bool {
    let lines: Vec<&str> = text.lines().collect();
    let is_it = |l: &str| l.trim_start().starts_with(&format!("fn {function}("));
    lines
        .iter()
        .enumerate()
        .any(|(i, l)| is_it(l) && lines[i.saturating_sub(3)..i].iter().any(|l| l.trim() == "#[test]"))
}

fn page(all: &[Source]) -> &str {
    &all.iter().find(|s| s.path == PAGE).expect("the page is there").text
}

#[test]
fn every_hard_case_has_a_proof_that_exists() {
    let all = sources();
    let rows = rows(page(&all));
    let faults: Vec<String> = rows.iter().flat_map(|(case, proof)| faults(&all, case, proof)).collect();
    assert!(faults.is_empty(), "{PAGE}, {} faults:\n{}", faults.len(), faults.join("\n"));
    assert_eq!(rows.iter().filter(|(_, proof)| proof.starts_with(NOT_YET)).count(), 1, "what is not proven yet");
}

#[test]
fn no_hard_case_is_left_out() {
    let all = sources();
    let rows = rows(page(&all));
    let numbers = (1..=25).map(|n| format!("N{n}")).chain(ACCEPTANCE.map(|n| format!("T{n}")));
    let missing: Vec<String> = numbers.filter(|n| !rows.iter().any(|(case, _)| case == n)).collect();
    assert_eq!(missing, Vec::<String>::new(), "{PAGE}");
    let scenes = builtin::gallery().map(|(b, _)| b.name);
    let unnamed: Vec<&str> = scenes.filter(|s| !page(&all).contains(&format!("`builtin:{s}`"))).collect();
    assert_eq!(unnamed, Vec::<&str>::new(), "{PAGE}: scenes of the gallery without a case");
}

#[test]
fn a_proof_that_does_not_exist_is_refused() {
    let text = "#[test]\n// Why.\nfn is_one() {}\n\n\n\nfn is_none() {}\n";
    let all = [Source::sample("a/b.rs", text)];
    assert_eq!(
        rows("| case | what | proof |\n|---|---|---|\n| N1 | x | `a/b.rs::is_one` |\n"),
        [("N1", "`a/b.rs::is_one`")]
    );
    for good in ["`a/b.rs::is_one`; see `a/b.rs`", "`builtin:empty`", "Not yet: later"] {
        assert_eq!(faults(&all, "N1", good), Vec::<String>::new(), "{good}");
    }
    for bad in [
        "`a/b.rs::is_none`",
        "`a/b.rs::gone`",
        "`c.rs::is_one`",
        "`builtin:glass`",
        "`a/b.rs`",
        "by looking",
        "`a/b.rs::is_one`, `d.txt`",
    ] {
        assert_eq!(faults(&all, "N1", bad).len(), 1, "{bad}");
    }
}
