//! `jerboa bench table-3`: the size of the renderer's parts (paper, Table 3).

use std::fmt::Write;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::args::Table3Args;
use crate::host::effort::Effort;
use crate::host::error::Error;

/// A part: its name, and the files or folders that it consists of.
type Part = (&'static str, &'static [&'static str]);

/// The devices, each with both of its halves. What stages and is in none of them is the core.
const DEVICES: [Part; 4] = [
    ("traversal", &["traverse", "geometry/triangle.rs"]),
    ("CPU, streams", &["device/stream.rs", "host/wave.rs", "host/work.rs", "host/dispatch.rs", "host/device.rs"]),
    ("CPU, a path at a time", &["device/cpu.rs", "host/scalar.rs"]),
    ("GPU, both", &["device/megakernel.rs", "device/wavefront.rs", "device/pixel.rs", "host/gpu"]),
];

/// What does not stage: neither core nor device.
const OUTSIDE: [&str; 3] = ["host", "cli", "bin"];

/// Counts the sources below a folder and returns the table.
pub(super) fn run(args: &Table3Args) -> Result<String, Error> {
    let files = sources(&args.folder)?;
    let missing = |item: &&&str| !files.iter().any(|(path, _)| path.starts_with(item));
    if let Some(item) = DEVICES.iter().flat_map(|(_, list)| *list).find(missing) {
        let message = format!("{}: {item} is not there; these are not the sources I know", args.folder.display());
        return Err(Error::new(message));
    }
    let mut parts: Vec<(&str, Effort)> = vec![("core", Effort::default())];
    parts.extend(DEVICES.map(|(name, _)| (name, Effort::default())));
    for (path, text) in &files {
        let device = DEVICES.iter().position(|(_, list)| list.iter().any(|item| path.starts_with(item)));
        match device {
            Some(device) => parts[1 + device].1.add(text),
            None if OUTSIDE.iter().any(|folder| path.starts_with(folder)) => {}
            None => parts[0].1.add(text),
        }
    }
    Ok(if args.json { as_json(&parts) } else { as_text(&parts) })
}

/// Every Rust file below a folder, in the order of the paths, which are relative to it.
fn sources(folder: &Path) -> Result<Vec<(PathBuf, String)>, Error> {
    let fail = |path: &Path, e: std::io::Error| {
        let hint = "name the folder lib-render/src of a checkout";
        Error::new(format!("{}: cannot be read: {e}; {hint}", path.display()))
    };
    let (mut files, mut folders) = (Vec::new(), vec![folder.to_path_buf()]);
    while let Some(at) = folders.pop() {
        for entry in std::fs::read_dir(&at).map_err(|e| fail(&at, e))? {
            let path = entry.map_err(|e| fail(&at, e))?.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = std::fs::read_to_string(&path).map_err(|e| fail(&path, e))?;
                files.push((path.strip_prefix(folder).unwrap_or(&path).to_path_buf(), text));
            }
        }
    }
    files.sort();
    Ok(files)
}

fn as_json(parts: &[(&str, Effort)]) -> String {
    let object = |(name, e): &(&str, Effort)| {
        let (operators, operands) = (e.operators(), e.operands());
        json!({
            "part": name,
            "lines": e.lines(),
            "distinct_operators": operators.0,
            "operators": operators.1,
            "distinct_operands": operands.0,
            "operands": operands.1,
            "effort": e.effort(),
        })
    };
    format!("{}\n", Value::Array(parts.iter().map(object).collect()))
}

fn as_text(parts: &[(&str, Effort)]) -> String {
    let mut text = String::from("part                      lines   effort, millions\n");
    for (name, e) in parts {
        writeln!(text, "{name:<24} {:>6} {:>18.3}", e.lines(), e.effort() / 1e6).expect("a string takes it");
    }
    text
}
