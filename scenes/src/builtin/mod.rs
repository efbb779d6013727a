//! Scenes made by code: `builtin:NAME`, each for a purpose. Where light has a closed form, the function that makes the
//! scene states it.
//!
//! Most are hard on a renderer, and each of those is named after its difficulty: together they are the gallery of hard cases
//! that `jerboa bench stability` renders and compares with reference values.

mod geometry;
mod glass;
mod lights;
mod rooms;
mod shapes;
mod surfaces;
mod table;
mod textures;

use crate::{Error, Scene};

/// A scene made by code.
pub struct Builtin {
    /// What stands behind `builtin:`.
    pub name: &'static str,
    /// What the scene is for, in a line.
    pub purpose: &'static str,
    /// For a scene of the gallery of hard cases: what makes it hard, and what is right there.
    pub hard: Option<Hard>,
    make: fn() -> Scene,
}

/// Why a scene is in the gallery of hard cases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hard {
    /// What a naive renderer does there, in a line.
    pub naive: &'static str,
    /// What a right one shows.
    pub reference: Reference,
}

/// Mean luminance over the whole picture, the film as wide as the scene's camera asks for its height. (The radiance of a
/// pixel is the mean over its square, so the mean over the picture does not depend on the number of pixels.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// The mean, up to the scene's scale in W·sr⁻¹·m⁻².
    pub mean: f64,
    /// Its standard error; 0 for a closed form.
    pub standard_error: f64,
    /// Where it comes from.
    pub source: Source,
}

/// Where a reference comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A formula, or a quadrature of one in double precision to all digits shown.
    ClosedForm,
    /// `jerboa bench stability --scene NAME --spp SPP --sampler independent --seed 1 --json`: our own renderer, summed exactly, with the
    /// seed 1, which no other default uses.
    Rendered {
        /// Samples per pixel.
        spp: u32,
    },
}

/// Every built-in scene, the default first.
pub fn list() -> &'static [Builtin] {
    table::BUILTINS
}

/// The gallery of hard cases: the scenes that have a reference value.
pub fn gallery() -> impl Iterator<Item = (&'static Builtin, Hard)> {
    list().iter().filter_map(|b| Some((b, b.hard?)))
}

/// Builds the scene of a name (without `builtin:`).
pub fn build(name: &str) -> Result<Scene, Error> {
    let found = list().iter().find(|b| b.name == name);
    let builtin = found.ok_or_else(|| Error::Builtin { name: name.into() })?;
    Ok(Scene { name: name.into(), ..(builtin.make)() })
}
