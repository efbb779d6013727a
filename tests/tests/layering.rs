//! Law 8, arrows point one way: the manifests and the `use` lines show no arrow but those written here.

use std::collections::BTreeSet;

use jerboa_tests::sources::{Source, is_word, sources};

/// Each crate of the workspace and the crates of ours that it may depend on.
const ARROWS: &[(&str, &[&str])] = &[
    ("ir", &[]),
    ("peval", &["ir"]),
    ("backend-cranelift", &["ir"]),
    ("backend-spirv", &["ir"]),
    ("scenes", &[]),
    ("lib-render", &["ir", "peval", "backend-cranelift", "backend-spirv", "scenes"]),
    ("tests", &["ir", "peval", "backend-cranelift", "backend-spirv", "scenes", "lib-render", "example-custom"]),
    ("examples/custom", &["ir", "scenes", "lib-render"]),
];

/// Folders of `lib-render/src` that hold its host half. The rest are component files, but for the front page.
const HOST_FOLDERS: &[&str] = &["host", "cli", "bin"];

/// What a component file may name of `jerboa_ir`: the embedded language, and the macros that give records and tables
/// their traits.
const LANGUAGE: &[&str] = &["lang", "impl_staged", "table", "stream"];

/// What a host file that reads scenes may name of the embedded language: how a buffer is declared. No value of it is staged.
const DECLARATIONS: &[&str] = &["jerboa_ir::lang::Buf", "jerboa_ir::lang::Spec", "jerboa_ir::lang::SpecTy"];

#[test]
fn manifests_hold_only_the_arrows_of_the_law() {
    report(manifests(&sources()));
}

#[test]
fn components_see_the_language_and_each_other() {
    report(components(&sources()));
}

#[test]
fn who_lays_out_the_scene_does_not_stage() {
    report(layout_is_host_code(&sources()));
}

#[test]
fn the_rules_are_not_idle() {
    let all = sources();
    let count = |wanted: fn(&str) -> bool| all.iter().filter(|s| s.is_rust() && wanted(&s.path)).count();
    assert!(count(is_component) >= 10, "component files are no longer where this test looks for them");
    assert!(count(is_host) >= 10, "host files are no longer where this test looks for them");
}

fn report(faults: Vec<String>) {
    assert!(faults.is_empty(), "{} arrows the wrong way:\n{}", faults.len(), faults.join("\n"));
}

// ---- manifests

/// Members without a rule, rules without a member, and dependencies that no rule allows.
fn manifests(all: &[Source]) -> Vec<String> {
    let mut faults = Vec::new();
    let text = |path: &str| all.iter().find(|s| s.path == path).map(|s| s.text.as_str());
    let members = members(text("Cargo.toml").unwrap_or_default());
    for name in &members {
        let Some((_, allowed)) = ARROWS.iter().find(|(krate, _)| krate == name) else {
            faults.push(format!("Cargo.toml: the crate `{name}` has no rule in this test"));
            continue;
        };
        let path = format!("{name}/Cargo.toml");
        let Some(manifest) = text(&path) else {
            faults.push(format!("{path}: missing"));
            continue;
        };
        for (line, dependency) in dependencies(manifest) {
            if let Some(ours) = dependency.strip_prefix("jerboa-").filter(|ours| !allowed.contains(ours)) {
                faults.push(format!("{path}:{line}: `{name}` may not depend on `{ours}`"));
            }
        }
    }
    for (name, _) in ARROWS.iter().filter(|(name, _)| !members.iter().any(|m| m == name)) {
        faults.push(format!("Cargo.toml: the crate `{name}` of the rules is not a member"));
    }
    faults
}

/// The list behind `members =`.
fn members(manifest: &str) -> Vec<String> {
    let list =
        manifest.split_once("\nmembers = [").and_then(|(_, rest)| rest.split_once(']')).map_or("", |(list, _)| list);
    list.split(',').map(|m| m.trim().trim_matches('"').to_string()).filter(|m| !m.is_empty()).collect()
}

/// Line and name of every dependency of any kind (normal, of tests, of the build, of one target).
fn dependencies(manifest: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    let mut inside = false;
    for (i, line) in manifest.lines().enumerate() {
        let line = line.trim();
        if let Some(section) = line.strip_prefix('[') {
            let section = section.trim_end_matches(']');
            inside = section.ends_with("dependencies");
            // [dependencies.name]
            if let Some((_, name)) = section.split_once("dependencies.") {
                found.push((i + 1, name));
            }
        } else if inside && !line.is_empty() && !line.starts_with('#') {
            let name = line.split(['.', '=', ' ']).next().unwrap_or(line);
            found.push((i + 1, name.trim_matches('"')));
        }
    }
    found
}

// ---- component files

fn is_host(path: &str) -> bool {
    let Some(inner) = path.strip_prefix("lib-render/src/") else { return false };
    inner.split_once('/').is_some_and(|(folder, _)| HOST_FOLDERS.contains(&folder))
}

fn is_component(path: &str) -> bool {
    path.starts_with("lib-render/src/") && path != "lib-render/src/lib.rs" && !is_host(path)
}

/// What component files name that is neither the embedded language nor another component. Their tests run what they
/// build, so they may see the rest of `jerboa_ir` too.
fn components(all: &[Source]) -> Vec<String> {
    let manifest = all.iter().find(|s| s.path == "lib-render/Cargo.toml").map_or("", |s| s.text.as_str());
    let crates: Vec<String> = dependencies(manifest).iter().map(|(_, name)| name.replace('-', "_")).collect();
    let mut faults = Vec::new();
    for source in all.iter().filter(|s| s.is_rust() && is_component(&s.path)) {
        let code = source.code_without_tests();
        let with_tests = source.code();
        let staged = paths(&code);
        for path in paths(&with_tests) {
            let in_tests = !staged.contains(&path);
            let parts: Vec<&str> = path.split("::").collect();
            let why = match parts[0] {
                "crate" if parts.get(1).is_some_and(|m| HOST_FOLDERS.contains(m)) => {
                    "a component does not see the host half"
                }
                "jerboa_ir" if !in_tests && !parts.get(1).is_some_and(|m| LANGUAGE.contains(m)) => {
                    "a component sees only the embedded language of jerboa_ir"
                }
                "jerboa_ir" => continue,
                krate if crates.iter().any(|c| c == krate) => "a component uses no other crate",
                _ => continue,
            };
            faults.push(format!("{}: `{path}`: {why}", source.path));
        }
    }
    faults
}

/// The paths that Rust code names, `use` groups spelled out: `use a::{b, c::d}` gives `a::b` and `a::c::d`. A name brought
/// in by a `use` from this crate stands for that module, not for an outside crate of the same name.
fn paths(code: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut rest = String::new();
    // Take the `use` items out.
    let mut code = code;
    while let Some(at) = find_word(code, "use") {
        let end = code[at..].find(';').map_or(code.len(), |n| at + n);
        rest.push_str(&code[..at]);
        expand("", &code[at + 3..end], &mut found);
        code = &code[end..];
    }
    rest.push_str(code);
    // The others: words joined by `::`.
    let local: BTreeSet<String> = found
        .iter()
        .filter(|path| ["crate", "super", "self"].contains(&path.split("::").next().unwrap_or("")))
        .filter_map(|path| path.rsplit("::").next().map(String::from))
        .collect();
    for token in rest.split(|c: char| !is_word(c) && c != ':') {
        let token = token.trim_matches(':');
        if let Some((head, _)) = token.split_once("::")
            && !local.contains(head)
        {
            found.insert(token.into());
        }
    }
    found
}

/// Where the word stands alone.
fn find_word(code: &str, word: &str) -> Option<usize> {
    code.match_indices(word).map(|(at, _)| at).find(|at| {
        let before = code[..*at].chars().next_back();
        let after = code[at + word.len()..].chars().next();
        !before.is_some_and(|c| is_word(c) || c == '#') && after.is_some_and(char::is_whitespace)
    })
}

/// Spell out the tree of a `use`.
fn expand(prefix: &str, tree: &str, found: &mut BTreeSet<String>) {
    let tree = tree.trim();
    let Some(open) = tree.find('{') else {
        let name = tree.split_whitespace().next().unwrap_or("");
        found.insert(format!("{prefix}{}", name.trim_start_matches("::")));
        return;
    };
    let prefix = format!("{prefix}{}", tree[..open].trim_start_matches("::"));
    let inner = tree[open + 1..].trim_end().strip_suffix('}').unwrap_or(&tree[open + 1..]);
    let (mut depth, mut start) = (0, 0);
    for (i, c) in inner.char_indices().chain([(inner.len(), ',')]) {
        depth += i32::from(c == '{') - i32::from(c == '}');
        if c == ',' && depth == 0 {
            if !inner[start..i].trim().is_empty() {
                expand(&prefix, &inner[start..i], found);
            }
            start = i + 1;
        }
    }
}

// ---- Law 1's share

/// Host files that read scenes and also name the embedded language: knowledge of a scene would enter while staging.
fn layout_is_host_code(all: &[Source]) -> Vec<String> {
    let mut faults = Vec::new();
    for source in all.iter().filter(|s| s.is_rust() && is_host(&s.path)) {
        let named = paths(&source.code_without_tests());
        let reads_scenes = named.iter().any(|p| p.split("::").next() == Some("jerboa_scenes"));
        let stages = named.iter().find(|p| p.starts_with("jerboa_ir::lang") && !DECLARATIONS.contains(&p.as_str()));
        if let (true, Some(path)) = (reads_scenes, stages) {
            faults.push(format!("{}: reads `jerboa_scenes` and names `{path}`", source.path));
        }
    }
    faults
}

// ---- the checks can fail

#[test]
fn a_wrong_manifest_is_refused() {
    let names: Vec<String> = ARROWS.iter().map(|(name, _)| format!("{name:?}")).collect();
    let good = || {
        let mut all = vec![Source::sample("Cargo.toml", &format!("[workspace]\nmembers = [{}]\n", names.join(", ")))];
        all.extend(ARROWS.iter().map(|(name, _)| Source::sample(&format!("{name}/Cargo.toml"), "[dependencies]\n")));
        all
    };
    assert_eq!(manifests(&good()), Vec::<String>::new());
    for wrong in [
        "[dependencies]\njerboa-scenes.workspace = true\n",
        "[dependencies]\njerboa-scenes = { path = \"../scenes\" }\n",
        "[dev-dependencies]\njerboa-scenes.workspace = true\n",
        "[target.'cfg(unix)'.dependencies]\njerboa-scenes.workspace = true\n",
        "[build-dependencies.jerboa-scenes]\npath = \"../scenes\"\n",
    ] {
        let mut all = good();
        all.iter_mut().filter(|s| s.path == "peval/Cargo.toml").for_each(|s| s.text = wrong.into());
        let faults = manifests(&all);
        assert_eq!(
            faults,
            ["peval/Cargo.toml:2: `peval` may not depend on `scenes`"].map(|f| match wrong.starts_with("[build") {
                true => f.replace(":2", ":1"),
                false => f.into(),
            })
        );
    }
    let mut all = good();
    all[0].text = all[0].text.replace("\"ir\"", "\"wheel\"");
    assert_eq!(manifests(&all).len(), 2, "an unknown member, and a missing one");
}

#[test]
fn a_component_that_looks_elsewhere_is_refused() {
    let manifest = "[dependencies]\njerboa-ir.workspace = true\njerboa-scenes.workspace = true\njerboa-peval.workspace = true\nimage.workspace = true\n";
    let check = |path: &str, text: &str| {
        components(&[Source::sample("lib-render/Cargo.toml", manifest), Source::sample(path, text)])
    };
    let component = "lib-render/src/bsdf/wrong.rs";
    for (wrong, named) in [
        ("use crate::host::film::Film;", "crate::host::film::Film"),
        ("use crate::{core::vec, host::film};", "crate::host::film"),
        ("fn f() { crate::host::film::g() }", "crate::host::film::g"),
        ("use jerboa_scenes::Scene;", "jerboa_scenes::Scene"),
        ("fn f(s: &jerboa_scenes::Scene) {}", "jerboa_scenes::Scene"),
        ("use jerboa_peval as p;", "jerboa_peval"),
        ("use jerboa_ir::{impl_staged, World};", "jerboa_ir::World"),
        ("use jerboa_ir::*;", "jerboa_ir::*"),
        ("use image::Rgb;", "image::Rgb"),
        ("#[cfg(test)]\nmod tests { use crate::host::film; }", "crate::host::film"),
    ] {
        let faults = check(component, wrong);
        assert!(faults.len() == 1 && faults[0].contains(&format!("`{named}`")), "{wrong}: {faults:?}");
        assert_eq!(check("lib-render/src/host/right.rs", wrong).len(), 0, "the host half may: {wrong}");
    }
    for right in [
        "use jerboa_ir::{impl_staged, lang::{Bool, Fun}};\nuse crate::core::vec::Vec3;\nuse std::ops::Add;",
        "use crate::image;\nfn f() { image::sample() }",
        "// use crate::host::film;\nconst S: &str = \"jerboa_scenes::Scene\";",
        "#[cfg(test)]\nmod tests { use jerboa_ir::interp::run; }",
    ] {
        assert_eq!(check(component, right), Vec::<String>::new(), "{right}");
    }
}

#[test]
fn a_host_file_that_stages_scene_data_is_refused() {
    let check = |text: &str| layout_is_host_code(&[Source::sample("lib-render/src/host/tables.rs", text)]).len();
    assert_eq!(check("use jerboa_scenes::Scene;\nuse jerboa_ir::lang::F32;"), 1);
    assert_eq!(check("use jerboa_scenes::Scene;\nuse crate::schema::Materials;"), 0);
    assert_eq!(check("use jerboa_scenes::Scene;\nuse jerboa_ir::lang::Buf;"), 0);
    assert_eq!(check("use jerboa_ir::lang::build;"), 0);
}
