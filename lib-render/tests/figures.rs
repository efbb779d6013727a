//! The paper's experiments as `jerboa bench` runs them, on small scenes with few samples: what they print, write and draw. How long
//! anything took is asserted nowhere.

use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

/// What `jerboa bench` with these words, which succeed, writes to stdout.
fn bench(folder: &TempDir, words: &str) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_jerboa"));
    command.arg("bench").args(words.split_whitespace()).current_dir(folder.path());
    let out = command.output().expect("the command starts");
    assert!(out.status.success(), "{words}: {}", String::from_utf8_lossy(&out.stderr));
    String::from_utf8(out.stdout).expect("text")
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// Runs an experiment, checks that its charts have the shape that `--help` tells and that their picture is one, and gives
/// them.
fn charts(words: &str) -> Vec<Value> {
    let folder = folder();
    let json = bench(&folder, &format!("{words} --json --plot chart.svg"));
    let charts: Vec<Value> = serde_json::from_str(&json).expect("a list");
    let picture = std::fs::read_to_string(folder.path().join("chart.svg")).expect("it was written");
    assert_eq!(fault_of_xml(&picture), None, "{picture}");
    let keys = |v: &Value| v.as_object().map(|o| o.keys().cloned().collect::<Vec<_>>().join(" ")).unwrap_or_default();
    for chart in &charts {
        assert_eq!(keys(chart), "groups title unit");
        assert!(picture.contains(chart["title"].as_str().expect("text")), "{picture}");
        for group in list(&chart["groups"]) {
            assert_eq!(keys(group), "bars name notes");
            let is_drawn = picture.contains(group["name"].as_str().expect("text"));
            assert_eq!(is_drawn, !list(&group["bars"]).is_empty(), "{picture}");
            for bar in list(&group["bars"]) {
                assert_eq!(keys(bar), "least median most series");
                let [least, median, most] = ["least", "median", "most"].map(|k| bar[k].as_f64().expect("a number"));
                assert!(0.0 <= least && least <= median && median <= most, "{bar}");
            }
        }
    }
    charts
}

fn list(value: &Value) -> &Vec<Value> {
    value.as_array().expect("a list")
}

/// Names of the bars of each group.
fn series(chart: &Value) -> Vec<Vec<&str>> {
    list(&chart["groups"])
        .iter()
        .map(|g| list(&g["bars"]).iter().map(|b| b["series"].as_str().expect("text")).collect())
        .collect()
}

/// What keeps a text from being well-formed, of the XML that we write.
fn fault_of_xml(text: &str) -> Option<String> {
    let mut open = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find('<') {
        let (content, tag) = rest.split_at(at);
        if content.contains('>') || content.replace("&amp;", "").replace("&lt;", "").replace("&gt;", "").contains('&') {
            return Some(format!("a mark in {content:?}"));
        }
        let Some((tag, after)) = tag[1..].split_once('>') else { return Some("a tag without an end".into()) };
        rest = after;
        let (tag, closed) = tag.strip_suffix('/').map_or((tag, false), |t| (t, true));
        if let Some(name) = tag.strip_prefix('/') {
            if open.pop() != Some(name) {
                return Some(format!("</{name}> closes nothing"));
            }
            continue;
        }
        let (name, attributes) = tag.split_once(' ').unwrap_or((tag, ""));
        let quotes = attributes.split('"').collect::<Vec<_>>();
        if quotes.len() % 2 == 0 || quotes.iter().step_by(2).any(|n| !n.is_empty() && !n.ends_with('=')) {
            return Some(format!("attributes of <{tag}>"));
        }
        if !closed {
            open.push(name);
        }
    }
    (!open.is_empty() || !rest.trim().is_empty()).then(|| format!("open: {open:?}, behind: {rest:?}"))
}

#[test]
fn ill_formed_pictures_are_noticed() {
    assert_eq!(fault_of_xml("<svg a=\"1\" b=\"2\">\n<text>x &lt; y</text><g/></svg>\n"), None);
    for text in
        ["<a>", "<a></b>", "<a b=1/>", "<a b=\"1/>", "<a>R&D</a>", "<a>1 > 2</a>", "<a/>x", "<a b=\"1\" \"2\"/>"]
    {
        assert!(fault_of_xml(text).is_some(), "{text}");
    }
}

#[test]
fn table_2_tells_the_speed_at_every_level() {
    let charts =
        charts("table-2 builtin:empty builtin:quad-light --width 8 --height 8 --spp 2 --rounds 2 --max-depth 3");
    assert_eq!(charts[0]["unit"], "Msamples/s");
    let levels = vec!["nothing", "structure", "all"];
    assert_eq!(series(&charts[0]), [levels.clone(), levels, vec![]], "two scenes and their mean");
    let notes = |k: usize| &charts[0]["groups"][k]["notes"];
    // A ray that meets nothing is a sample; what is black has no variance to speak of.
    assert_eq!((&notes(0)["rays a sample"], &notes(0)["variance"]), (&1.0.into(), &Value::Null));
    let rays = notes(1)["rays a sample"].as_f64().expect("a number");
    assert!(rays > 1.0 && rays < 5.0, "{rays} rays with at most three edges and two vertices");
    assert!(notes(1)["variance"].as_f64().is_some_and(|v| v > 0.0));
    let gains = [0, 1, 2].map(|k| notes(k)["gain by structure"].as_f64().expect("a number"));
    assert!(((gains[0] * gains[1]).sqrt() / gains[2] - 1.0).abs() < 1e-9, "{gains:?}");
}

#[test]
fn figure_2_shares_out_all_of_the_time() {
    let charts = charts("figure-2 builtin:quad-light --width 16 --height 16 --spp 2 --rounds 1");
    let [shares, shading] = &charts[..] else { panic!("two charts: {charts:?}") };
    assert_eq!(series(shares), [["camera rays", "secondary rays", "shadow rays", "shading", "other"]; 2]);
    for group in list(&shares["groups"]) {
        let parts: Vec<f64> = list(&group["bars"]).iter().map(|b| b["median"].as_f64().expect("a number")).collect();
        assert!((parts.iter().sum::<f64>() - 100.0).abs() < 1e-6, "{group}");
        assert!(parts.iter().all(|p| *p > 0.0), "a floor under a lamp takes all of them: {group}");
    }
    assert_eq!(series(shading), [["nothing", "structure", "all", "structure, no lanes"]]);
    assert!(list(&shading["groups"][0]["bars"]).iter().all(|b| b["least"].as_f64() > Some(0.0)));
}

#[test]
fn figure_3_shades_every_batch_at_every_level() {
    let charts = charts("figure-3 --rounds 1");
    assert_eq!(series(&charts[0]), [["nothing", "structure", "all"]; 6]);
}

#[test]
fn figure_4_flips_both_filters() {
    let charts = charts("figure-4 --rounds 1");
    let names: Vec<&Value> = list(&charts[0]["groups"]).iter().map(|g| &g["name"]).collect();
    assert_eq!(names, ["neither", "texture", "attributes", "both"]);
    assert_eq!(series(&charts[0]), [["in lanes", "not in lanes"]; 4]);
}

/// Devices that Figure 5 is about: two on the CPU, and two on a GPU in a build that has code for it.
const DEVICES: usize = if cfg!(feature = "gpu") { 4 } else { 2 };

#[test]
fn figure_5_makes_the_kernels_of_every_device() {
    let charts = charts("figure-5 builtin:empty --rounds 2");
    let groups = list(&charts[0]["groups"]);
    assert_eq!(groups.len(), 3 * DEVICES, "three levels on each device");
    for group in groups {
        // Code that was there already would take no time. There may be no driver, and is none of the CPU.
        let [ours, driver] = list(&group["bars"]).split_at(2).into();
        let took = |bar: &Value| bar["least"].as_f64() > Some(0.0);
        assert!(ours.iter().all(took) && driver.iter().all(|b| b.is_null() || took(b)), "{group}");
        let [kernels, code] = ["kernels", "kB of code"].map(|k| group["notes"][k].as_f64().expect("a number"));
        let is_one = group["name"].as_str().is_some_and(|n| n.contains("cpu-scalar") || n.contains("megakernel"));
        assert!(code > 1.0 && (kernels == 1.0) == is_one, "{group}");
    }
}

#[test]
fn text_has_a_line_for_each_group() {
    let folder = folder();
    let text = bench(&folder, "figure-5 builtin:empty --rounds 2");
    let lines: Vec<&str> = text.lines().collect();
    let words: Vec<&str> = lines[0].split_whitespace().collect();
    let head = "Specialisation and code generation, ms specialisation code generation driver kernels kB of code";
    assert_eq!(words.join(" "), head);
    assert_eq!(lines.len(), 1 + 3 * DEVICES, "{text}");
    assert!(lines[1].starts_with("empty, cpu, nothing ") && lines[1].contains('±'), "{text}");
    assert!(lines.iter().all(|l| l.chars().count() == lines[0].chars().count()), "{text}");
    assert!(!folder.path().join("chart.svg").exists());
}

/// A peer that answers 0.5 to everything, as the script does, and a file for it.
#[cfg(unix)]
fn folder_with_peer() -> TempDir {
    use std::os::unix::fs::PermissionsExt;

    let folder = folder();
    let peer = folder.path().join("peer");
    std::fs::write(&peer, "#!/bin/sh\nwhile read word; do echo 0.5; done\n").expect("written");
    std::fs::set_permissions(&peer, PermissionsExt::from_mode(0o755)).expect("its owner may");
    let json = b"{\"asset\":{\"version\":\"2.0\"}}   ";
    let words = [0x4654_6c67, 2, 20 + json.len() as u32, json.len() as u32, 0x4e4f_534a];
    let glb = [words.map(u32::to_le_bytes).as_flattened(), json].concat();
    std::fs::write(folder.path().join("void.glb"), glb).expect("written");
    folder
}

#[cfg(unix)]
#[test]
fn a_peer_takes_its_turn() {
    let words = "table-2 void.glb --width 8 --height 8 --spp 1 --rounds 1 --json --peer ./peer --peer-lanes 8";
    let charts: Vec<Value> = serde_json::from_str(&bench(&folder_with_peer(), words)).expect("a list");
    assert_eq!(series(&charts[0])[0], ["nothing", "structure", "all", "Mitsuba 3, 8 lanes"]);
    let group = &charts[0]["groups"][0];
    // 64 samples in half a second.
    assert_eq!(group["bars"][3]["median"].as_f64(), Some(64.0 / 0.5 / 1e6));
    assert_eq!(group["notes"]["peer's variance"].as_f64(), Some(0.5));
}

/// What `jerboa bench` with these words, which fail, writes to stderr.
fn failure(folder: &TempDir, words: &str) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_jerboa"));
    command.arg("bench").args(words.split_whitespace()).current_dir(folder.path());
    let out = command.output().expect("the command starts");
    assert!(!out.status.success() && out.stdout.is_empty(), "{words}");
    String::from_utf8(out.stderr).expect("text")
}

#[cfg(unix)]
#[test]
fn a_peer_that_is_none_is_said_in_a_line() {
    let folder = folder_with_peer();
    for (peer, line) in [
        ("nobody", "jerboa: --peer nobody: cannot be started: No such file"),
        ("true", "jerboa: the peer has ended; what it wrote above says why\n"),
    ] {
        let said = failure(&folder, &format!("table-2 void.glb --width 8 --rounds 1 --peer {peer}"));
        assert!(said.lines().any(|l| format!("{l}\n").starts_with(line)), "{peer}: {said}");
    }
}

#[test]
fn what_cannot_be_is_said_in_a_line() {
    let folder = folder();
    for (words, line) in [
        ("figure-3 --plot chart.png", "jerboa: cannot write chart.png: its name must end in .svg\n"),
        ("figure-2 nowhere.glb", "jerboa: nowhere.glb: cannot be read: No such file"),
        ("figure-5 --rounds 0", "jerboa: invalid value '0' for '--rounds <N>'"),
        ("table-2 --peer-lanes 4", "jerboa: the following required arguments were not provided: --peer"),
        ("table-2 --peer python --peer-lanes 5", "jerboa: invalid value '5' for '--peer-lanes <4|8|16>'"),
    ] {
        assert!(failure(&folder, words).starts_with(line), "{words}: {}", failure(&folder, words));
    }
    assert!(!folder.path().join("chart.png").exists());
}
