//! What a device brings is a loop and memory; what it renders with is written once (paper, section 4.7): the functions of
//! the components are the same text in the generic program of the CPU's devices and in that of the GPU's.

use std::collections::{HashMap, HashSet};

use jerboa_ir::print;
use jerboa_lib_render::host::generate::{generic, gpu_generic};

/// Every distinct function of a program's text that a component made (a `lam`), with its names replaced by numbers in order
/// of appearance: names in a text count occurrences in all of it.
fn lams(text: &str) -> HashSet<String> {
    let lines: Vec<&str> = text.lines().collect();
    let depth = |line: &str| line.len() - line.trim_start().len();
    let starts = lines.iter().enumerate().filter(|(_, line)| line.trim_start().starts_with("fun lam"));
    starts
        .map(|(start, line)| {
            let body = lines[start + 1..].iter().take_while(|inner| depth(inner) > depth(line));
            renamed(&std::iter::once(line).chain(body).map(|l| &l[depth(line)..]).collect::<Vec<_>>())
        })
        .collect()
}

/// The lines with names replaced, and without the lists of free names.
fn renamed(lines: &[&str]) -> String {
    let mut names: HashSet<&str> = HashSet::new();
    for line in lines {
        let (code, free) = line.split_once("  ; free:").unwrap_or((line, ""));
        names.extend(free.split(',').map(str::trim));
        let code = code.trim_start();
        if let Some((name, _)) = code.split_once(" = ") {
            names.insert(name);
        } else if let Some((head, parameters)) = code.split_once('(').filter(|_| code.contains(" @")) {
            names.extend(head.split(' ').next_back());
            names.extend(parameters.split(", ").filter_map(|p| Some(p.split_once(": ")?.0)));
        }
    }
    let mut numbers: HashMap<&str, usize> = HashMap::new();
    let mut out = String::new();
    for line in lines {
        let mut rest = line.split("  ; free:").next().unwrap_or_default();
        while let Some(start) = rest.find(is_of_word) {
            let end = rest[start..].find(|c| !is_of_word(c)).map_or(rest.len(), |n| start + n);
            let word = &rest[start..end];
            out += &rest[..start];
            if names.contains(word) || is_numbered(word) {
                let next = numbers.len();
                out += &format!("#{}", numbers.entry(word).or_insert(next));
            } else {
                out += word;
            }
            rest = &rest[end..];
        }
        out += rest;
        out.push('\n');
    }
    out
}

/// Words hold dots, so that `Table.COLUMN` and `1.5` are one each.
fn is_of_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '.'
}

/// A value (`y12`, or `g12` of the whole program), or a name that is there more than once (`x_2`): where a function captures
/// one, nothing declares it.
fn is_numbered(word: &str) -> bool {
    let is_number = |s: &str| !s.is_empty() && s.bytes().all(|b| b.is_ascii_digit());
    let value = word.strip_prefix(['y', 'g']).is_some_and(is_number);
    value || word.rsplit_once('_').is_some_and(|(name, n)| is_number(n) && !name.contains('.'))
}

#[test]
fn components_are_the_same_functions_on_every_device() {
    let (cpu, gpu) = (lams(&print(generic().program())), lams(&print(gpu_generic().program())));
    assert!(cpu.len() > 40, "{} functions: the search finds too little", cpu.len());
    // A test for cut-outs captures the state of its path, which is in registers on one device and in memory on the other.
    let is_cutout = |f: &&String| f.lines().next().is_some_and(|head| head.contains("fn(bool)"));
    for (name, one, other) in [("CPU", &cpu, &gpu), ("GPU", &gpu, &cpu)] {
        let alone: Vec<_> = one.difference(other).filter(|f| !is_cutout(f)).collect();
        assert!(alone.is_empty(), "{} functions on the {name} alone, one of them:\n{}", alone.len(), alone[0]);
    }
    // The tracers are among them.
    assert!(cpu.intersection(&gpu).any(|f| f.lines().count() > 5000), "no tracer was compared");
}
