//! Scenes made by code: `builtin:NAME`, each with a purpose.

mod rooms;
mod shapes;

use crate::{Error, Scene};

/// A scene made by code.
pub struct Builtin {
    /// What stands behind `builtin:`.
    pub name: &'static str,
    /// What the scene is for, in a line.
    pub purpose: &'static str,
    make: fn() -> Scene,
}

const fn entry(name: &'static str, purpose: &'static str, make: fn() -> Scene) -> Builtin {
    Builtin {
        name,
        purpose,
        make,
    }
}

static BUILTINS: [Builtin; 1] = [entry(
    "cornell-box",
    "two boxes in a box with a red and a green wall: the default scene",
    rooms::cornell_box,
)];

/// Every built-in scene, the default first.
pub fn list() -> &'static [Builtin] {
    &BUILTINS
}

/// Builds the scene of a name.
pub fn build(name: &str) -> Result<Scene, Error> {
    let found = BUILTINS.iter().find(|b| b.name == name);
    let builtin = found.ok_or_else(|| Error::Builtin { name: name.into() })?;
    Ok(Scene {
        name: name.into(),
        ..(builtin.make)()
    })
}
