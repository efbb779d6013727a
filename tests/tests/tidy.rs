//! The checkout keeps its habits: small files, no stubs, reasons beside what needs one.
//!
//! Each rule is a function from the files to its faults, so that the last test can show each of them a bad sample.

use jerboa_tests::sources::{Source, is_word, root, sources};

/// Most lines of a source file.
const MOST_LINES: usize = 600;

/// Files that may be longer: path, most lines, reason. One that has become short enough must leave the list.
const LONG_FILES: &[(&str, usize, &str)] = &[];

/// What may not stand in any file. In two halves, so that this file passes.
const STUBS: &[&str] = &[
    concat!("TO", "DO"),
    concat!("FIX", "ME"),
    concat!("XX", "X"),
    concat!("todo", "!("),
    concat!("unimplemented", "!("),
    concat!("dbg", "!("),
    concat!("#[ig", "nore"),
    concat!("allow(dead", "_code"),
    concat!("allow(missing", "_docs"),
];

/// Where only one machine has its files.
const MACHINE_PATHS: &[&str] =
    &[concat!("/wo", "rk/"), concat!("/ro", "ot/"), concat!("/ho", "me/"), concat!("/Us", "ers/")];

type Rule = fn(&[Source]) -> Vec<String>;

macro_rules! rules {
    ($($rule:ident)+) => {
        $(#[test]
        fn $rule() {
            report(rule::$rule(&sources()));
        })+

        /// Every rule, by name.
        const RULES: &[(&str, Rule)] = &[$((stringify!($rule), rule::$rule)),+];
    };
}

rules! {
    files_are_short
    nothing_is_a_stub
    no_path_of_a_machine
    unsafe_states_its_reason
    files_say_what_they_are
    front_pages_show_an_example
    models_name_their_source
    dependencies_have_a_reason
    pages_name_what_exists
}

fn report(faults: Vec<String>) {
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

/// Is it a source file of a crate, neither test nor bench?
fn is_src(path: &str) -> bool {
    path.ends_with(".rs") && path.contains("/src/")
}

mod rule {
    use super::*;

    /// Rust files have at most [`MOST_LINES`] lines.
    pub fn files_are_short(all: &[Source]) -> Vec<String> {
        let mut faults = Vec::new();
        for source in all.iter().filter(|s| s.is_rust()) {
            let lines = source.text.lines().count();
            let allowance = LONG_FILES.iter().find(|(path, ..)| *path == source.path);
            let most = allowance.map_or(MOST_LINES, |(_, most, _)| *most);
            if lines > most {
                faults.push(format!("{}: {lines} lines, more than {most}: split it", source.path));
            } else if allowance.is_some() && lines <= MOST_LINES {
                faults.push(format!("{}: {lines} lines: needs no allowance any more", source.path));
            }
        }
        for (path, ..) in LONG_FILES.iter().filter(|(path, ..)| !all.iter().any(|s| s.path == *path)) {
            faults.push(format!("{path}: has an allowance but does not exist"));
        }
        faults
    }

    /// No file has a stub, a silenced check or a note to do it later.
    pub fn nothing_is_a_stub(all: &[Source]) -> Vec<String> {
        lines_with(all, STUBS, "do it now, or say in the changelog what is missing")
    }

    /// No file names a place of one machine.
    pub fn no_path_of_a_machine(all: &[Source]) -> Vec<String> {
        lines_with(all, MACHINE_PATHS, "no other machine has it")
    }

    /// Each `unsafe` block, implementation or function has a line `// SAFETY:` just above (functions: `# Safety`).
    pub fn unsafe_states_its_reason(all: &[Source]) -> Vec<String> {
        let mut faults = Vec::new();
        for source in all.iter().filter(|s| s.is_rust()) {
            let code = source.code();
            let lines: Vec<&str> = source.text.lines().collect();
            for (i, line) in code.lines().enumerate() {
                let used = word_at(line, "unsafe").map(|at| line[at + "unsafe".len()..].trim_start());
                // The type of an unsafe function promises nothing by itself.
                let is_type =
                    |rest: &str| rest.starts_with("fn(") || rest.starts_with("extern") && rest.contains("fn(");
                if used.is_some_and(|rest| !is_type(rest)) {
                    let above = lines[..i].iter().rev().map(|l| l.trim());
                    let mut above = above.take_while(|l| l.starts_with("//") || l.starts_with("#["));
                    if !above.any(|l| l.contains("SAFETY:") || l.contains("# Safety")) {
                        faults.push(format!("{}:{}: `unsafe` without a SAFETY line above", source.path, i + 1));
                    }
                }
            }
        }
        faults
    }

    /// Each source file begins with the sentence that says what it is.
    pub fn files_say_what_they_are(all: &[Source]) -> Vec<String> {
        let bare = all.iter().filter(|s| is_src(&s.path) && !s.text.starts_with("//! "));
        bare.map(|s| format!("{}: begins without `//!`", s.path)).collect()
    }

    /// Each crate's front page has an example that `cargo test` runs.
    pub fn front_pages_show_an_example(all: &[Source]) -> Vec<String> {
        let mut faults = Vec::new();
        for source in all.iter().filter(|s| s.path.ends_with("/src/lib.rs")) {
            let page = source.text.lines().filter_map(|l| l.strip_prefix("//!"));
            let mut fences = page.filter_map(|l| l.trim().strip_prefix("```"));
            let shown = fences.by_ref().step_by(2).any(|info| info.is_empty() || info == "rust");
            if !shown {
                faults.push(format!("{}: the front page has no example that runs", source.path));
            }
        }
        faults
    }

    /// Each scattering model and each approximation of mathematics says where it comes from: in a comment, `Source:`, or
    /// a year of publication, or the paper's section.
    pub fn models_name_their_source(all: &[Source]) -> Vec<String> {
        let mut faults = Vec::new();
        for source in all.iter().filter(|s| is_model(&s.path)) {
            let comments = source.comments();
            let cites = comments.contains("Source:") || comments.contains("paper, section") || has_year(&comments);
            if !cites {
                faults.push(format!("{}: names no source", source.path));
            }
        }
        if !all.iter().any(|s| is_model(&s.path)) {
            faults.push("lib-render/src/bsdf: no model is where this rule looks for them".into());
        }
        faults
    }

    /// Each outside dependency of the workspace has a comment above it; a family (`cranelift-*`) shares one.
    pub fn dependencies_have_a_reason(all: &[Source]) -> Vec<String> {
        let manifest = all.iter().find(|s| s.path == "Cargo.toml").map_or("", |s| s.text.as_str());
        let mut faults = Vec::new();
        let mut section = "";
        let mut above = "";
        for (i, line) in manifest.lines().enumerate() {
            let family = |line: &str| line.split(['-', ' ', '=']).next().unwrap_or("").to_string();
            if line.starts_with('[') {
                section = line;
            } else if section == "[workspace.dependencies]" && line.contains('=') && !line.starts_with('#') {
                let ours = line.contains("path = ");
                if !ours && !above.starts_with("# ") && family(above) != family(line) {
                    faults.push(format!("Cargo.toml:{}: `{}` has no reason above it", i + 1, family(line)));
                }
            }
            above = line;
        }
        // A version written in a member escapes the list.
        for source in all.iter().filter(|s| s.path.ends_with("/Cargo.toml")) {
            let lines = source.text.lines().enumerate();
            let own = lines.filter(|(_, l)| l.contains("version = \"") || l.contains("path = \"../"));
            faults.extend(own.map(|(i, _)| format!("{}:{}: take it from the workspace", source.path, i + 1)));
        }
        faults
    }

    /// Links of pages lead somewhere, and what the pages at the root call a file, or `file::function`, is one. (Pages that
    /// show how to add something name files that do not exist yet.)
    pub fn pages_name_what_exists(all: &[Source]) -> Vec<String> {
        let mut faults = Vec::new();
        for page in all.iter().filter(|s| s.path.ends_with(".md")) {
            let folder = page.path.rsplit_once('/').map_or("", |(folder, _)| folder);
            let links = page.text.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next());
            for link in links.filter(|l| !l.is_empty() && !l.contains("://")) {
                let target = resolve(folder, link);
                // Pictures are not among the sources.
                let is_picture = target.ends_with(".png") && root().join(&target).is_file();
                if !is_picture && !exists(all, &target) {
                    faults.push(format!("{}: the link `{link}` leads nowhere", page.path));
                }
            }
            if folder.is_empty() {
                // Every second piece stands between backquotes.
                for name in page.text.split('`').skip(1).step_by(2).filter(|name| is_path(all, name)) {
                    let (path, function) = name.split_once("::").unwrap_or((name, ""));
                    let text = all.iter().find(|s| s.path == path).map_or("", |s| s.text.as_str());
                    if !exists(all, path) || !(function.is_empty() || text.contains(&format!("fn {function}("))) {
                        faults.push(format!("{}: there is no `{name}`", page.path));
                    }
                }
            }
        }
        faults
    }
}

/// Every line that contains one of the words.
fn lines_with(all: &[Source], words: &[&str], why: &str) -> Vec<String> {
    let mut faults = Vec::new();
    for source in all {
        for (i, line) in source.text.lines().enumerate() {
            if let Some(word) = words.iter().find(|word| line.contains(**word)) {
                faults.push(format!("{}:{}: `{word}`: {why}", source.path, i + 1));
            }
        }
    }
    faults
}

/// Is there such a file, or a folder with files?
fn exists(all: &[Source], path: &str) -> bool {
    all.iter().any(|s| s.path.strip_prefix(path).is_some_and(|rest| rest.is_empty() || rest.starts_with('/')))
}

/// The path that a link in a page of this folder leads to.
fn resolve(folder: &str, link: &str) -> String {
    let mut parts: Vec<&str> = folder.split('/').filter(|p| !p.is_empty()).collect();
    for part in link.split('/') {
        match part {
            "." => {}
            ".." => drop(parts.pop()),
            _ => parts.push(part),
        }
    }
    parts.join("/")
}

/// Does it look like a path in the checkout? It begins with a folder of the root.
fn is_path(all: &[Source], name: &str) -> bool {
    let Some((folder, rest)) = name.split_once('/') else { return false };
    !rest.contains([' ', '*', '<']) && all.iter().any(|s| s.path.split_once('/').is_some_and(|(f, _)| f == folder))
}

/// Where the word stands alone.
fn word_at(text: &str, word: &str) -> Option<usize> {
    text.match_indices(word).map(|(at, _)| at).find(|at| {
        let before = text[..*at].chars().next_back();
        let after = text[at + word.len()..].chars().next();
        !before.is_some_and(is_word) && !after.is_some_and(is_word)
    })
}

/// Does the file hold formulas of somebody else? Scattering models, and mathematics that every scene rests on.
fn is_model(path: &str) -> bool {
    let Some(inner) = path.strip_prefix("lib-render/src/") else { return false };
    let (folder, name) = inner.rsplit_once('/').unwrap_or(("", inner));
    let models = ["bsdf", "core/math"].contains(&folder) && !["mod.rs", "tests.rs"].contains(&name);
    models
        || ["core/fresnel.rs", "core/microfacet.rs", "core/onb.rs", "core/rng.rs", "core/sampling.rs"].contains(&inner)
}

/// Does a number from 1900 to 2099 stand alone in it?
fn has_year(text: &str) -> bool {
    text.split(|c: char| !is_word(c)).any(|w| w.len() == 4 && w.parse::<u32>().is_ok_and(|y| (1900..2100).contains(&y)))
}

#[test]
fn each_rule_refuses_a_bad_sample() {
    let manifest = "[workspace.dependencies]\n# Why.\nwheel-a = \"1\"\nwheel-b = \"1\"\n";
    let good = [
        Source::sample("Cargo.toml", manifest),
        Source::sample("ir/Cargo.toml", "[dependencies]\nwheel-a.workspace = true\n"),
        Source::sample("ir/src/lib.rs", "//! What it is.\n//!\n//! ```\n//! assert!(true);\n//! ```\n"),
        Source::sample("docs/b.md", "See [that](../ir/src/lib.rs) and `cargo a/b`."),
        Source::sample(
            "lib-render/src/bsdf/a.rs",
            "//! Walter et al. 2007.\n// SAFETY: it is.\nunsafe { f() }\ntype F = unsafe extern \"C\" fn();\n",
        ),
    ];
    for (name, rule) in RULES {
        assert_eq!(rule(&good), Vec::<String>::new(), "{name}");
    }
    let long = "\n".repeat(MOST_LINES + 1);
    let stub = format!("fn f() {{ {}) }}", STUBS[3]);
    let machine = format!("see {}a", MACHINE_PATHS[0]);
    let bad: &[(&str, &str, &str)] = &[
        ("files_are_short", "ir/tests/a.rs", &long),
        ("nothing_is_a_stub", "ir/tests/a.rs", &stub),
        ("no_path_of_a_machine", "README.md", &machine),
        ("unsafe_states_its_reason", "ir/tests/a.rs", "// SAFETY: of something else\n\nlet a = unsafe { f() };"),
        ("unsafe_states_its_reason", "ir/tests/a.rs", "unsafe impl Send for A {}"),
        ("files_say_what_they_are", "ir/src/a.rs", "use a::b;"),
        ("front_pages_show_an_example", "ir/src/lib.rs", "//! It.\n//! ```text\n//! a\n//! ```\n//! More.\n"),
        ("models_name_their_source", "lib-render/src/bsdf/b.rs", "//! A model.\nconst YEAR: u32 = 2007;\n"),
        ("pages_name_what_exists", "README.md", "See `ir/src/gone.rs`."),
        ("pages_name_what_exists", "README.md", "See `ir/src/lib.rs::gone`."),
        ("pages_name_what_exists", "docs/a.md", "See [this](../ir/src/gone.rs)."),
        ("dependencies_have_a_reason", "Cargo.toml", "[workspace.dependencies]\na = \"1\"\n"),
        ("dependencies_have_a_reason", "ir/Cargo.toml", "[dependencies]\na = { version = \"1\" }\n"),
    ];
    for (name, rule) in RULES {
        let mut samples = bad.iter().filter(|(of, ..)| of == name).peekable();
        assert!(samples.peek().is_some(), "{name} has no bad sample");
        for (_, path, text) in samples {
            let mut all: Vec<Source> = good.iter().filter(|s| s.path != *path).cloned().collect();
            all.push(Source::sample(path, text));
            assert_eq!(rule(&all).len(), 1, "{name} lets {path} pass: {text}");
        }
    }
}
