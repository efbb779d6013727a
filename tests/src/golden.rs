//! Golden files: a program, what to do with it, and what comes out, in one text that a person can read.
//!
//! ```text
//! ; run: interp pow 2.0 5i          commands, one a line; see `COMMANDS`
//! ; data materials: 0u 1.0, 1u 2.0  rows of a buffer, columns in order, for the commands that run the program
//! jerboa-ir 1                       the program
//! …
//! ; output: interp pow 2.0 5i       one part per command
//! 32.0
//! ```
//!
//! `BLESS=1 cargo test -p jerboa-tests --test filetests` rewrites the parts; read the difference before you commit it.
//! To add a command, add its row to [`COMMANDS`].

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use jerboa_backend_cranelift::lanes::{Width, lanes};
use jerboa_ir::interp::{self, Limits, Memory};
use jerboa_ir::{BufKind, Lit, Program, parse, print, verify, verify_residual};
use jerboa_peval::{Arg, Facts, Generic, Options, specialize, tidy_with};

/// What a command works on.
pub struct Input<'a> {
    /// The program.
    pub program: Program,
    /// Words behind the command.
    pub args: Vec<&'a str>,
    /// Content of the buffers.
    pub memory: Vec<Memory>,
}

/// A command: its name and what it gives. An `Err` is an output as well, behind `error: `.
pub type Command = (&'static str, fn(Input) -> Result<String, String>);

/// All commands. A text that does not parse gives its error for each of them.
pub const COMMANDS: &[Command] = &[
    // The canonical text.
    ("print", |input| Ok(print(&input.program))),
    // All faults, one a line.
    ("verify", |input| Ok(faults(verify(&input.program)))),
    // All faults as a residual program.
    ("verify-residual", |input| Ok(faults(verify_residual(&input.program)))),
    // ENTRY LITERAL…: the results, and the streams after the run.
    ("interp", run),
    // ENTRY ARG…, an argument being a literal or `?`: the residual.
    ("specialize", residual),
    // PASS: a residual after that one pass.
    ("tidy", tidy),
    // WIDTH, or `hint`: a residual with a loop over lanes for each `vectorize`.
    ("lanes", in_lanes),
    // ENTRY LITERAL…: as `interp`, in lanes.
    ("in-lanes", |input| run(Input { program: vector(&input.program, Width::Hint)?, ..input })),
];

/// Run every `.ir` file below a folder, in the order of names. Returns the number of files, or all differences.
pub fn run_folder(folder: &Path, bless: bool) -> Result<usize, String> {
    let mut files = Vec::new();
    collect(folder, &mut files)?;
    files.sort();
    let mut differences = String::new();
    for path in &files {
        if let Err(why) = run_file(path, bless) {
            writeln!(differences, "{}: {why}", path.display()).expect("writing to a string");
        }
    }
    if differences.is_empty() { Ok(files.len()) } else { Err(differences) }
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), String> {
    let entries = fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    for entry in entries {
        let path = entry.map_err(|e| format!("{}: {e}", folder.display()))?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else if path.extension().is_some_and(|ext| ext == "ir") {
            files.push(path);
        }
    }
    Ok(())
}

fn run_file(path: &Path, bless: bool) -> Result<(), String> {
    let text = fs::read_to_string(path).map_err(|e| e.to_string())?;
    let actual = with_outputs(&text)?;
    if bless && actual != text {
        fs::write(path, &actual).map_err(|e| e.to_string())?;
    }
    if bless || actual == text { Ok(()) } else { Err(difference(&text, &actual)) }
}

/// The text of a file with its outputs made anew.
pub fn with_outputs(text: &str) -> Result<String, String> {
    let head = &text[..text.find("\n; output: ").map_or(text.len(), |at| at + 1)];
    let directive = |word: &'static str| head.lines().filter_map(move |line| line.strip_prefix(word));
    let mut actual = head.trim_end().to_owned() + "\n";
    for command in directive("; run: ") {
        let words: Vec<&str> = command.split_whitespace().collect();
        let known = words.first().and_then(|name| COMMANDS.iter().find(|(n, _)| n == name));
        let (_, run) = known.ok_or_else(|| format!("no command `{command}`"))?;
        let output = parse(head).map_err(|e| e.to_string()).and_then(|program| {
            let memory = memory(&program, directive("; data "))?;
            run(Input { program, args: words[1..].to_vec(), memory })
        });
        let output = output.unwrap_or_else(|why| format!("error: {why}"));
        writeln!(actual, "\n; output: {command}\n{}", output.trim_end()).expect("writing to a string");
    }
    match actual.contains("\n; output: ") {
        true => Ok(actual),
        false => Err("the file has no line `; run: COMMAND`".to_owned()),
    }
}

/// Buffers as the `; data` lines fill them; others have one row of zeros if they are tables, else none.
fn memory<'a>(p: &Program, data: impl Iterator<Item = &'a str>) -> Result<Vec<Memory>, String> {
    let empty = |kind: BufKind, columns: usize| match kind {
        BufKind::Table { .. } => Memory { rows: 1, words: vec![0; columns] },
        BufKind::Stream => Memory::default(),
    };
    let mut memory: Vec<Memory> = p.buffers.iter().map(|b| empty(b.kind, b.columns.len())).collect();
    for line in data {
        let (name, rows) = line.split_once(':').ok_or_else(|| format!("no `:` in `; data {line}`"))?;
        let at = p.buffers.iter().position(|b| *b.name == *name).ok_or_else(|| format!("no buffer `{name}`"))?;
        let buffer = &p.buffers[at];
        let rows: Vec<Vec<Lit>> = rows.split(',').map(lits).collect::<Result<_, _>>()?;
        let mut words = vec![0; rows.len() * buffer.columns.len()];
        for (r, row) in rows.iter().enumerate() {
            if row.len() != buffer.columns.len() {
                return Err(format!("`{name}` has {} columns, row {r} has {}", buffer.columns.len(), row.len()));
            }
            for (c, lit) in row.iter().enumerate() {
                words[buffer.word(rows.len(), r, c)] = lit.word();
            }
        }
        memory[at] = Memory { rows: rows.len() as u32, words };
    }
    Ok(memory)
}

fn lits(text: &str) -> Result<Vec<Lit>, String> {
    text.split_whitespace().map(lit).collect()
}

fn lit(word: &str) -> Result<Lit, String> {
    Lit::parse(word).ok_or_else(|| format!("`{word}` is no literal"))
}

fn faults(faults: Vec<jerboa_ir::Fault>) -> String {
    match faults.is_empty() {
        true => "ok".to_owned(),
        false => faults.iter().map(|fault| format!("{fault}\n")).collect(),
    }
}

fn run(mut input: Input) -> Result<String, String> {
    let (name, args) = input.args.split_first().ok_or("interp ENTRY LITERAL…")?;
    let entry = input.program.entry(name).ok_or_else(|| format!("no entry `{name}`"))?;
    sound(verify(&input.program))?;
    let args: Vec<Lit> = args.iter().map(|word| lit(word)).collect::<Result<_, _>>()?;
    let limits = Limits { fuel: 1_000_000, ..Limits::default() };
    let results = interp::run(&input.program, entry, &args, &mut input.memory, limits).map_err(|e| e.to_string())?;
    let words = |lits: &[Lit]| lits.iter().map(Lit::to_string).collect::<Vec<_>>().join(" ");
    let mut output = if results.is_empty() { "()\n".to_owned() } else { words(&results) + "\n" };
    for (buffer, memory) in input.program.buffers.iter().zip(&input.memory) {
        if buffer.kind != BufKind::Stream {
            continue;
        }
        let rows = memory.rows as usize;
        let row = |r: usize| -> Vec<Lit> {
            let columns = buffer.columns.iter().enumerate();
            let decode = |(c, decl): (usize, &jerboa_ir::ColumnDecl)| {
                let scalar = decl.ty.ty().as_scalar().unwrap_or(jerboa_ir::Scalar::U32);
                Lit::from_word(scalar, memory.words[buffer.word(rows, r, c)])
            };
            columns.map(decode).collect()
        };
        let rows: Vec<String> = (0..rows).map(|r| words(&row(r))).collect();
        writeln!(output, "{}: {}", buffer.name, rows.join(", ")).expect("writing to a string");
    }
    Ok(output)
}

fn residual(input: Input) -> Result<String, String> {
    let (name, args) = input.args.split_first().ok_or("specialize ENTRY ARG…")?;
    sound(verify(&input.program))?;
    let arg = |word: &&str| if *word == "?" { Ok(Arg::Unknown) } else { lit(word).map(Arg::Known) };
    let args: Vec<Arg> = args.iter().map(arg).collect::<Result<_, _>>()?;
    let generic = Generic::new(input.program);
    let residual = specialize(&generic, name, &args, &Facts::none(), &Options::default()).map_err(|e| e.to_string())?;
    let text = print(&residual.program);
    let faults = verify_residual(&residual.program);
    sound(faults).map_err(|faults| format!("{faults}{text}"))?;
    Ok(text)
}

fn tidy(input: Input) -> Result<String, String> {
    sound(verify_residual(&input.program))?;
    let [pass] = input.args[..] else { return Err("tidy PASS".into()) };
    let tidied = tidy_with(&input.program, pass).ok_or_else(|| format!("no pass `{pass}`"))?;
    sound(verify_residual(&tidied)).map_err(|faults| format!("{faults}{}", print(&tidied)))?;
    Ok(print(&tidied))
}

fn in_lanes(input: Input) -> Result<String, String> {
    let width = match input.args[..] {
        ["hint"] => Width::Hint,
        ["4"] => Width::Lanes(4),
        ["8"] => Width::Lanes(8),
        ["16"] => Width::Lanes(16),
        _ => return Err("lanes hint|4|8|16".into()),
    };
    vector(&input.program, width).map(|p| print(&p))
}

fn vector(p: &Program, width: Width) -> Result<Program, String> {
    sound(verify_residual(p))?;
    let vector = lanes(p, width).map_err(|e| e.to_string())?;
    sound(verify_residual(&vector)).map_err(|faults| format!("{faults}{}", print(&vector)))?;
    Ok(vector)
}

fn sound(found: Vec<jerboa_ir::Fault>) -> Result<(), String> {
    if found.is_empty() { Ok(()) } else { Err(faults(found)) }
}

/// The lines that differ between the file and what came out, with two lines around them.
fn difference(expected: &str, actual: &str) -> String {
    const AROUND: usize = 2;
    let (old, new): (Vec<&str>, Vec<&str>) = (expected.lines().collect(), actual.lines().collect());
    let same = old.iter().zip(&new).take_while(|(a, b)| a == b).count();
    let behind = old[same..].iter().rev().zip(new[same..].iter().rev()).take_while(|(a, b)| a == b).count();
    let mut text = format!("line {} on (- in the file, + now; BLESS=1 accepts what is now)\n", same + 1);
    let mut list = |mark: &str, lines: &[&str]| {
        lines.iter().for_each(|line| text += &format!("  {mark} {line}\n"));
    };
    list(" ", &old[same.saturating_sub(AROUND)..same]);
    list("-", &old[same..old.len() - behind]);
    list("+", &new[same..new.len() - behind]);
    list(" ", &old[old.len() - behind..][..behind.min(AROUND)]);
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_shows_its_lines_only() {
        let difference = difference("a\nb\nc\nd\ne\n", "a\nb\nx\nd\ne\n");
        assert_eq!(
            difference,
            "line 3 on (- in the file, + now; BLESS=1 accepts what is now)\n    a\n    b\n  - c\n  + x\n    d\n    e\n"
        );
    }

    #[test]
    fn files_without_command_or_with_an_unknown_one_are_errors() {
        assert!(with_outputs("jerboa-ir 1\n").unwrap_err().contains("no line"));
        assert!(with_outputs("; run: dance\njerboa-ir 1\n").unwrap_err().contains("dance"));
    }
}
