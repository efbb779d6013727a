//! The list of built-in scenes, with what is hard about them.

use super::{Builtin, Hard, Reference, Source, geometry, glass, lights, rooms, surfaces, textures};
use crate::Scene;

/// A scene that is not hard.
const fn plain(name: &'static str, purpose: &'static str, make: fn() -> Scene) -> Builtin {
    Builtin { name, purpose, hard: None, make }
}

/// A scene of the gallery.
const fn hard(
    name: &'static str,
    purpose: &'static str,
    naive: &'static str,
    reference: Reference,
    make: fn() -> Scene,
) -> Builtin {
    Builtin { name, purpose, hard: Some(Hard { naive, reference }), make }
}

/// A mean that is known.
const fn exactly(mean: f64) -> Reference {
    Reference { mean, standard_error: 0.0, source: Source::ClosedForm }
}

/// A mean that was rendered.
const fn rendered(mean: f64, standard_error: f64, spp: u32) -> Reference {
    Reference { mean, standard_error, source: Source::Rendered { spp } }
}

/// The Cornell box, wherever it stands and however large it is.
const CORNELL_BOX: Reference = rendered(0.13575, 1.0e-4, 1024);

/// A floor of squares under a sky.
const CHECKERBOARD: Reference = rendered(0.610787, 3.9e-5, 512);

pub(super) static BUILTINS: &[Builtin] = &[
    hard(
        "cornell-box",
        "two boxes in a box with a red and a green wall: the default scene",
        "gets this one right: it is what the next four must look like",
        CORNELL_BOX,
        rooms::cornell_box,
    ),
    hard(
        "far-away",
        "the Cornell box a million metres from the origin: the same picture",
        "adds positions up in single precision, which steps by 1/16 there: walls come apart",
        CORNELL_BOX,
        rooms::far_away,
    ),
    hard(
        "huge",
        "the Cornell box two thousand kilometres wide: the same picture, to the bit",
        "starts rays 0.001 off a surface, less than a rounding there: half of them hit where they start",
        CORNELL_BOX,
        rooms::huge,
    ),
    hard(
        "tiny",
        "the Cornell box a quarter of a millimetre wide: the same picture, to the bit",
        "starts rays 0.001 off a surface, beyond the opposite wall: black",
        CORNELL_BOX,
        rooms::tiny,
    ),
    hard(
        "crumbs",
        "the Cornell box with triangles of no area, glowing ones too: the same picture",
        "divides by an area of 0: normals and densities that are not numbers",
        CORNELL_BOX,
        rooms::crumbs,
    ),
    hard(
        "furnace-sphere",
        "inside a glowing sphere of albedo 1/2: radiance 1 everywhere",
        "scatters about the sphere's normal and weighs by the facet's: darker at the edges of facets",
        exactly(1.0),
        rooms::furnace_sphere,
    ),
    hard(
        "closed-box-50",
        "inside a glowing box of albedo .5: radiance 1 everywhere",
        "counts emission twice, by light sampling and where a path happens to meet it: 1.5",
        exactly(1.0),
        rooms::closed_box::<50>,
    ),
    hard(
        "closed-box-80",
        "inside a glowing box of albedo .8: radiance 1 everywhere",
        "ends paths after 8 edges: 0.83",
        exactly(1.0),
        rooms::closed_box::<80>,
    ),
    hard(
        "closed-box-90",
        "inside a glowing box of albedo .9: radiance 1 everywhere",
        "goes on with a fixed probability of .75: the variance is infinite, images never settle",
        exactly(1.0),
        rooms::closed_box::<90>,
    ),
    hard(
        "closed-box-95",
        "inside a glowing box of albedo .95: radiance 1 everywhere",
        "goes on with a fixed probability of .75 and at most 64 edges: dark, with fireflies",
        exactly(1.0),
        rooms::closed_box::<95>,
    ),
    hard(
        "closed-box-99",
        "inside a glowing box of albedo .99: radiance 1 everywhere",
        "goes on with a probability of at most .95: the variance is infinite",
        exactly(1.0),
        rooms::closed_box::<99>,
    ),
    hard(
        "white-box",
        "inside a box that absorbs nothing, with a lamp: long paths must end",
        "follows some paths for thousands of edges, or cuts them off and is too dark",
        rendered(0.5699, 2.1e-3, 64),
        rooms::white_box,
    ),
    hard(
        "black-box",
        "inside a black box, a million outside: exactly 0, no leak at edges",
        "misses both triangles at an edge they share: sparks of a million",
        exactly(0.0),
        rooms::black_box,
    ),
    hard(
        "black-sphere",
        "inside a coarse smooth black sphere, a million outside: exactly 0",
        "takes the side of the surface from the smooth normal: light comes in through the wall",
        exactly(0.0),
        rooms::black_sphere,
    ),
    hard(
        "facing-mirrors",
        "a lamp between two perfect mirrors: long paths must end",
        "recurses for each reflection: the stack overflows, or a fixed depth shows as a black hole",
        rendered(0.014016, 1.2e-5, 1024),
        rooms::facing_mirrors,
    ),
    plain("material-balls", "diffuse, plastic, metal, mirror and glass balls in a row", surfaces::material_balls),
    plain("models", "a ball for each model that is not glTF's, and a window", surfaces::models),
    plain("layered", "lacquered, cloth, brushed, translucent and iridescent balls in a row", surfaces::layered),
    hard(
        "phong",
        "Phong balls, from dull to a highlight a tenth of a degree wide",
        "raises a cosine near 1 to the millionth by a fast power: the highlight is a third too dark",
        rendered(0.520021, 6.8e-5, 512),
        surfaces::phong,
    ),
    hard(
        "near-smooth",
        "metal balls a little smoother and a little rougher than what counts as a mirror",
        "takes 1 - cos² of a cosine near 1: the density of normals is 12 % off, then infinite",
        rendered(0.61648, 1.8e-4, 1024),
        surfaces::near_smooth,
    ),
    hard(
        "white-furnace",
        "balls that keep all light, in uniform light: invisible, 1 everywhere",
        "loses light at grazing angles: grey rims",
        exactly(1.0),
        surfaces::white_furnace,
    ),
    hard(
        "checkerboard",
        "a procedural texture up to the horizon",
        "gets this one right: it is what air-glass must look like",
        CHECKERBOARD,
        surfaces::checkerboard,
    ),
    plain("textures", "every wrap mode, nearest and bilinear", textures::textures),
    plain("fine-textures", "cards with borders, cards with bicubic filters, and noise", textures::fine_textures),
    hard(
        "odd-textures",
        "textures of one texel or row, coordinates of ten million and -1e-9",
        "takes u - floor(u) = 1 for a fraction and reads texel w of w: garbage or a crash",
        rendered(0.491049, 6.4e-5, 256),
        textures::odd_textures,
    ),
    hard(
        "alpha",
        "cut-out and fading cards and their shadows",
        "stops shadow rays at every card: whole rectangles of shadow",
        rendered(0.503493, 4.2e-5, 512),
        textures::alpha,
    ),
    hard(
        "mirrored-maps",
        "a card with a normal map and its mirror image: a symmetric picture",
        "builds the tangent frame of the mirrored one with the wrong hand: bumps become dents",
        rendered(0.291347, 4.0e-5, 512),
        textures::mirrored_maps,
    ),
    plain("glass", "a glass ball, block and thin pane over a checkerboard", glass::glass),
    plain(
        "caustic",
        "a glass ball under a small lamp: light that paths from the camera find by chance",
        glass::caustic,
    ),
    hard(
        "glass-trap",
        "the camera inside a glass cube that traps light for ever",
        "takes the camera to be outside, or follows totally reflected light for ever",
        exactly(1.038_747_0),
        glass::glass_trap,
    ),
    hard(
        "nested-glass",
        "glass inside glass, a ball that is there twice, blocks a hair apart",
        "enters the doubled ball twice and leaves it once, or steps over the gap: dark and bright glass",
        rendered(0.575064, 6.8e-5, 512),
        glass::nested_glass,
    ),
    hard(
        "air-glass",
        "glass of index 1 over a checkerboard: invisible",
        "divides 0 by 0 in Fresnel's equations at grazing angles: a bright rim where nothing is",
        CHECKERBOARD,
        glass::air_glass,
    ),
    hard(
        "tinted-slab",
        "tinted air before uniform light: the longer the path, the darker",
        "absorbs by thickness whatever the direction, or nothing where nothing refracts: too bright",
        exactly(0.507275),
        glass::tinted_slab,
    ),
    hard(
        "grazing-glass",
        "a kilometre of glass from a hand's breadth above, in uniform light: 1 everywhere",
        "makes reflected and refracted shares that do not add up to 1 near the horizon",
        exactly(1.0),
        glass::grazing_glass,
    ),
    plain("point-light", "a floor under a point light: closed form", lights::point_light),
    plain("spot", "a floor under a spot light: closed form, with its falloff", lights::spot),
    plain("sun", "a floor and a block in directional light: closed form, with a hard shadow", lights::sun),
    plain("round-lights", "a ball and a disk of light, and a sun: seen, mirrored and refracted", lights::round_lights),
    plain("sunlit", "balls and a block under a clear sky and its sun", lights::sunlit),
    plain("quad-light", "a floor under a square lamp: closed form below its centre", lights::quad_light),
    hard(
        "far-lamp",
        "a floor under a square lamp of 1e-8 steradians: closed form",
        "takes a solid angle for the excess of a sum of angles: 0 or negative, black",
        exactly(0.999_999_93),
        lights::far_lamp,
    ),
    hard(
        "pinpoint-lamp",
        "a floor under a square lamp of side 1e-10: closed form",
        "squares densities of 1e20: infinity over infinity, and every pixel is not a number",
        exactly(0.153_949_39),
        lights::pinpoint_lamp,
    ),
    plain("many-lights", "256 lamps and 16 point lights over a city of blocks", lights::many_lights),
    plain("environment", "a ball under a sky with a small strong sun: importance sampling", lights::environment),
    hard(
        "hot-texel",
        "a sky with one texel of a million and bright pole rows",
        "gives no samples to what filtering brings into dark neighbours: fireflies of a million",
        rendered(732.13, 2.2e-1, 1024),
        lights::hot_texel,
    ),
    hard(
        "edge-light",
        "a lamp whose plane meets the floor, a point light a millionth above it",
        "divides by a cosine or a distance of 0: pixels that are not numbers",
        rendered(0.154035, 2.5e-5, 1024),
        lights::edge_light,
    ),
    hard(
        "grazing",
        "a kilometre of rough metal seen from a hand's breadth above",
        "draws normals that nobody sees from there: weights without bound, sparks",
        rendered(0.182427, 4.3e-5, 1024),
        geometry::grazing,
    ),
    hard(
        "needles",
        "triangles a million times longer than wide",
        "loses triangles whose edge functions cancel: holes and stripes",
        rendered(0.00785008, 8.9e-7, 1024),
        geometry::needles,
    ),
    hard(
        "coincident",
        "triangles in the same place: the smaller primitive number wins",
        "shows whichever the tree offers first: red and blue specks",
        rendered(0.837205, 3.5e-5, 256),
        geometry::coincident,
    ),
    hard(
        "odd-normals",
        "zero, tiny, inverted and mirrored shading normals, zero tangents",
        "normalises a zero: black balls, or pixels that are not numbers",
        rendered(0.469902, 5.0e-5, 256),
        geometry::odd_normals,
    ),
    plain("pebbles", "512 pebbles that share the triangles of one mesh", geometry::pebbles),
    hard(
        "empty",
        "no triangles and no light: black, with warnings",
        "builds a tree over nothing: a panic, or a read before the first node",
        exactly(0.0),
        geometry::empty,
    ),
];
