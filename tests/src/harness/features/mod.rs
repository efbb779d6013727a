//! T25, a feature that a scene does not use has left nothing in its residual: the tables.
//!
//! A row is a [`Feature`]: whether a render uses it, and what stands in a residual for its sake alone. One table for each part of
//! the library: [`materials`], [`textures`], [`geometry`], [`lights`], [`renders`], and [`code`], of sources that several features
//! share. [`everywhere`] is what is no feature's, since every picture needs it.

pub mod code;
pub mod everywhere;
pub mod geometry;
pub mod lights;
pub mod materials;
pub mod renders;
pub mod textures;
mod used;

use std::collections::BTreeSet;

use jerboa_ir::{Node, Op, Program, Ty, print};
use jerboa_lib_render::bsdf::models::MODELS;

use super::subjects::Subject;
use crate::sources::root;
pub use used::is_lit;

/// A feature of a scene or of a render.
pub struct Feature {
    /// What it is, for messages.
    pub name: &'static str,
    /// Does the render use it? Asked of the scene and the choices, not of the renderer's tables.
    pub used: fn(&Subject) -> bool,
    /// Columns that say so, or beginnings of their names. They are structure, hence known, and in no residual.
    pub facts: &'static [&'static str],
    /// What stands in a residual for its sake alone: columns, or beginnings of their names, and sources of the library.
    pub leaves: &'static [&'static str],
}

/// All rows.
pub fn features() -> impl Iterator<Item = &'static Feature> {
    let tables = [materials::TABLE, textures::TABLE, textures::USES, geometry::TABLE, lights::TABLE, renders::TABLE];
    tables.into_iter().flatten().chain(code::TABLE)
}

/// Sources that are called like a model of scattering, and the model: their rows are the list of models itself.
pub fn models() -> impl Iterator<Item = (String, &'static str)> {
    let with_source = |model: &'static str| (format!("bsdf/{}.rs", model.replace('-', "_")), model);
    let has_row = |file: &str| features().any(|feature| feature.leaves.contains(&file));
    let all = MODELS.iter().map(move |model| with_source(model.name));
    all.filter(move |(file, _)| root().join("lib-render/src").join(file).is_file() && !has_row(file))
}

/// Has a material of the render this model?
pub fn has_model(subject: &Subject, name: &str) -> bool {
    used::has_model(subject, name)
}

/// What a residual holds.
pub struct Content(BTreeSet<String>);

impl Content {
    /// The columns that it reads, loads or stores, and the sources of the library whose code is in it.
    pub fn of(program: &Program) -> Content {
        let text = print(program);
        let start = text.find("\nfun ").expect("a residual has a function");
        let words = text[start..].split(|c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == '.'));
        let columns = words.filter(|word| word.starts_with(|c: char| c.is_ascii_uppercase()) && word.contains('.'));
        let code = program.locs.iter().enumerate().filter(|(id, _)| is_work(program, *id));
        let files = code.filter_map(|(_, loc)| loc.file.strip_prefix("lib-render/src/"));
        Content(columns.chain(files).map(String::from).collect())
    }

    /// Is this source among them, or a column that begins so?
    pub fn has(&self, mark: &str) -> bool {
        self.0.range(mark.to_string()..).next().is_some_and(|found| found.starts_with(mark))
    }

    /// The sources.
    pub fn files(&self) -> impl Iterator<Item = &String> {
        self.0.iter().filter(|found| found.ends_with(".rs"))
    }
}

/// Is a node work of the source that it comes from? Reads, and what is done to indices, are shared by whoever asks for the same: they
/// have the line of the first. Nobody shares what is done to the bits of words.
fn is_work(program: &Program, id: usize) -> bool {
    let Node::Prim { op, .. } = &program.nodes[id] else { return false };
    program.types[id] != Ty::u32() || matches!(op, Op::And | Op::Or | Op::Xor)
}
