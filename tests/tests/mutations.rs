//! The list of mutations keeps up with the sources: each can be seeded in one place of the code, and none is named twice.

use std::collections::BTreeSet;

use jerboa_tests::mutations::{Mutation, all};
use jerboa_tests::sources::{Source, root};

#[test]
fn every_mutation_finds_its_text_once() {
    let mut faults = Vec::new();
    for m in all() {
        match std::fs::read_to_string(root().join(m.file)) {
            Ok(text) => {
                let parsed = m.seed(&text).and_then(|seeded| match syn::parse_file(&seeded) {
                    Ok(_) => Ok(()),
                    Err(e) => Err(format!("`{}`: its text is no expression where it stands: {e}", m.name)),
                });
                faults.extend(parsed.err());
                if !Source::sample(m.file, &text).code().contains(m.before) {
                    faults.push(format!("`{}`: its text is no code of {}", m.name, m.file));
                }
            }
            Err(e) => faults.push(format!("`{}`: {} cannot be read: {e}", m.name, m.file)),
        }
    }
    assert!(faults.is_empty(), "{} mutations have rotted:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn mutations_have_names_of_their_own_and_change_something() {
    let names: BTreeSet<&str> = all().map(|m| m.name).collect();
    assert_eq!(names.len(), all().count(), "two mutations have one name");
    assert!(all().count() >= 30);
    for Mutation { name, before, after, mistake, .. } in all() {
        assert!(before != after && !mistake.is_empty(), "`{name}`");
    }
}

#[test]
fn a_mutation_is_seeded_in_exactly_one_place() {
    let m = Mutation { name: "m", file: "a.rs", before: "x", after: "y", mistake: "" };
    let seeded = m.seed("a(x)").unwrap();
    assert!(seeded.starts_with("a((if {") && seeded.ends_with("{ y } else { x }))"), "{seeded}");
    assert!(m.seed("x x").unwrap_err().contains("2 times"));
    assert!(m.seed("").unwrap_err().contains("0 times"));
}
