//! Scenes made by code: `builtin:NAME`, each for a purpose. Where light has a closed form, the function that makes the
//! scene states it.

mod geometry;
mod lights;
mod rooms;
mod shapes;
mod surfaces;
mod textures;

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
    Builtin { name, purpose, make }
}

static BUILTINS: [Builtin; 35] = [
    entry("cornell-box", "two boxes in a box with a red and a green wall: the default scene", rooms::cornell_box),
    entry("far-away", "the Cornell box a million metres from the origin: the same picture", rooms::far_away),
    entry("furnace-sphere", "inside a glowing sphere of albedo 1/2: radiance 1 everywhere", rooms::furnace_sphere),
    entry("closed-box-50", "inside a glowing box of albedo .5: radiance 1 everywhere", rooms::closed_box::<50>),
    entry("closed-box-80", "inside a glowing box of albedo .8: radiance 1 everywhere", rooms::closed_box::<80>),
    entry("closed-box-90", "inside a glowing box of albedo .9: radiance 1 everywhere", rooms::closed_box::<90>),
    entry("closed-box-95", "inside a glowing box of albedo .95: radiance 1 everywhere", rooms::closed_box::<95>),
    entry("closed-box-99", "inside a glowing box of albedo .99: radiance 1 everywhere", rooms::closed_box::<99>),
    entry("white-box", "inside a box that absorbs nothing, with a lamp: long paths must end", rooms::white_box),
    entry("black-box", "inside a black box, a million outside: exactly 0, no leak at edges", rooms::black_box),
    entry("black-sphere", "inside a coarse smooth black sphere, a million outside: exactly 0", rooms::black_sphere),
    entry("facing-mirrors", "a lamp between two perfect mirrors: long paths must end", rooms::facing_mirrors),
    entry("material-balls", "diffuse, plastic, metal, mirror and glass balls in a row", surfaces::material_balls),
    entry("phong", "Phong balls, from dull to a highlight a tenth of a degree wide", surfaces::phong),
    entry(
        "white-furnace",
        "balls that keep all light, in uniform light: invisible, 1 everywhere",
        surfaces::white_furnace,
    ),
    entry("checkerboard", "a procedural texture up to the horizon", surfaces::checkerboard),
    entry("textures", "every wrap mode with every filter", textures::textures),
    entry("odd-textures", "textures of one texel or row, coordinates of ten million and -1e-9", textures::odd_textures),
    entry("alpha", "cut-out and fading cards and their shadows", textures::alpha),
    entry("glass", "a glass ball, block and thin pane over a checkerboard", surfaces::glass),
    entry("glass-trap", "the camera inside a glass cube that traps light for ever", surfaces::glass_trap),
    entry("nested-glass", "glass inside glass, and glass blocks that share a face", surfaces::nested_glass),
    entry("point-light", "a floor under a point light: closed form", lights::point_light),
    entry("spot", "a floor under a spot light: closed form, with its falloff", lights::spot),
    entry("sun", "a floor and a block in directional light: closed form, with a hard shadow", lights::sun),
    entry("quad-light", "a floor under a square lamp: closed form below its centre", lights::quad_light),
    entry("many-lights", "256 lamps and 16 point lights over a city of blocks", lights::many_lights),
    entry("environment", "a ball under a sky with a small strong sun: importance sampling", lights::environment),
    entry("hot-texel", "a sky with one texel of a million and bright pole rows", lights::hot_texel),
    entry("edge-light", "a lamp whose plane meets the floor, a point light a millionth above it", lights::edge_light),
    entry("grazing", "a kilometre of rough metal seen from a hand's breadth above", geometry::grazing),
    entry("needles", "triangles a million times longer than wide", geometry::needles),
    entry("coincident", "triangles in the same place: the smaller primitive number wins", geometry::coincident),
    entry("odd-normals", "zero, tiny, inverted and mirrored shading normals, zero tangents", geometry::odd_normals),
    entry("empty", "no triangles and no light: black, with warnings", geometry::empty),
];

/// Every built-in scene, the default first.
pub fn list() -> &'static [Builtin] {
    &BUILTINS
}

/// Builds the scene of a name (without `builtin:`).
pub fn build(name: &str) -> Result<Scene, Error> {
    let found = BUILTINS.iter().find(|b| b.name == name);
    let builtin = found.ok_or_else(|| Error::Builtin { name: name.into() })?;
    Ok(Scene { name: name.into(), ..(builtin.make)() })
}
