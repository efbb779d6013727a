//! The mutation check (T32): mistakes that published renderers and compilers make, as edits of this checkout.
//!
//! A suite that stays green on a wrong program proves nothing. So here are wrong programs: each [`Mutation`] puts a wrong
//! expression in the place of a right one. `src/bin/mutate.rs` builds a copy of the checkout that holds all of them, each
//! behind a switch (mutant schemata: Untch, Offutt, Harrold 1993), and runs the suite with one switched on, again and
//! again; `tests/mutations.rs` keeps the list in step with the sources.
//!
//! To add one: write it in the list of its part. It must change what some program, scene or file gives: an edit that
//! changes nothing, or only the variance or the speed, is no bug of this kind.

mod components;
mod host;
mod machinery;
mod scattering;

/// The environment variable that names the mutation that is switched on.
pub const SWITCH: &str = "JERBOA_MUTANT";

/// A wrong program, as an edit of one file.
#[derive(Clone, Copy, Debug)]
pub struct Mutation {
    /// What it is called on the command line.
    pub name: &'static str,
    /// Path from the root of the checkout, with `/`.
    pub file: &'static str,
    /// An expression that stands there, exactly once in the file. It is evaluated when the program runs: no constant, no
    /// pattern.
    pub before: &'static str,
    /// The wrong expression, of the same type.
    pub after: &'static str,
    /// The mistake, and who made it where that is known.
    pub mistake: &'static str,
}

impl Mutation {
    /// The folder of the crate it changes.
    pub fn folder(&self) -> &'static str {
        self.file.split('/').next().unwrap_or_default()
    }

    /// The targets whose tests look at this file most closely, if they are not those of its own crate: what stages is tested
    /// through machine code.
    pub fn closest(&self) -> &'static [&'static str] {
        let is_component = components().any(|m| m.name == self.name);
        if is_component { &["tests/components", "tests/scattering"] } else { &[] }
    }

    /// The file's text with the mistake behind its switch, or why there is no such text.
    pub fn seed(&self, text: &str) -> Result<String, String> {
        let Mutation { name, file, before, after, .. } = self;
        match text.matches(before).count() {
            1 => {
                let on = format!(
                    "{{ static ON: std::sync::OnceLock<bool> = std::sync::OnceLock::new(); \
                     *ON.get_or_init(|| std::env::var({SWITCH:?}).as_deref() == Ok({name:?})) }}"
                );
                Ok(text.replacen(before, &format!("(if {on} {{ {after} }} else {{ {before} }})"), 1))
            }
            n => Err(format!("`{name}`: {file} holds this text {n} times, not once: {before}")),
        }
    }
}

/// Every mutation: `ir`, `peval` and the back end, then components, then host modules and the loader.
pub fn all() -> impl Iterator<Item = &'static Mutation> {
    machinery::MUTATIONS.iter().chain(components()).chain(host::MUTATIONS)
}

/// Those of what stages.
fn components() -> impl Iterator<Item = &'static Mutation> {
    scattering::MUTATIONS.iter().chain(components::MUTATIONS)
}
