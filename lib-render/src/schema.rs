//! The scene as data with a binding time (Law 2): every table and stream that a kernel may touch.
//!
//! This list is the same for every scene. *Structure* columns hold kinds, flags, counts and presences, and derived facts
//! (emissive or not, lobe present or not); *value* columns hold numbers; *bulk* columns texels, vertices, trees,
//! distributions, and what must never recompile: camera, film, seed. The host half that fills them is `host::tables`.

mod geometry;
mod streams;

use jerboa_ir::lang::{Buf, Spec, declare, spec};
use jerboa_ir::table;

pub use geometry::*;
pub use streams::*;

/// "None" in a column of indices.
pub const NONE: u32 = u32::MAX;

/// [`Materials::ALPHA_MODE`]: every hit counts.
pub const ALPHA_OPAQUE: u32 = 0;
/// [`Materials::ALPHA_MODE`]: a hit counts where alpha ≥ cutoff.
pub const ALPHA_MASK: u32 = 1;
/// [`Materials::ALPHA_MODE`]: a hit counts with probability alpha.
pub const ALPHA_BLEND: u32 = 2;

/// GGX α below which a lobe counts as perfectly smooth (accuracy.md, T6): the [`Materials::SMOOTH`] column and the decision
/// per hit, hence `sample`, `pdf` and `eval`, agree on it.
pub const SMOOTH_ALPHA: f32 = 1e-3;

/// [`Materials::SMOOTH`]: the microfacet lobes have α ≥ [`SMOOTH_ALPHA`] everywhere.
pub const SMOOTH_NEVER: u32 = 0;
/// [`Materials::SMOOTH`]: α < 1e-3 everywhere: perfect reflection and refraction.
pub const SMOOTH_ALWAYS: u32 = 1;
/// [`Materials::SMOOTH`]: a texture decides at each hit.
pub const SMOOTH_PER_HIT: u32 = 2;

/// [`Textures::KIND`]: 8-bit texels.
pub const TEXTURE_IMAGE: u32 = 0;
/// [`Textures::KIND`]: the procedural checkerboard of the paper, section 4.1.
pub const TEXTURE_CHECKERBOARD: u32 = 1;

/// [`Textures::WRAP_U`] and [`Textures::WRAP_V`]: repeat.
pub const WRAP_REPEAT: u32 = 0;
/// Clamp to the edge.
pub const WRAP_CLAMP: u32 = 1;
/// Mirrored repeat.
pub const WRAP_MIRROR: u32 = 2;

/// [`Textures::FILTER`]: the texel that contains the point.
pub const FILTER_NEAREST: u32 = 0;
/// [`Textures::FILTER`]: bilinear between the four texel centres around it.
pub const FILTER_BILINEAR: u32 = 1;

/// [`Lights::KIND`]: a point, intensity in W/sr.
pub const LIGHT_POINT: u32 = 0;
/// [`Lights::KIND`]: a cone with a smooth edge, KHR_lights_punctual.
pub const LIGHT_SPOT: u32 = 1;
/// [`Lights::KIND`]: parallel light, irradiance in W/m² on a facing plane.
pub const LIGHT_DIRECTIONAL: u32 = 2;
/// [`Lights::KIND`]: an emissive triangle.
pub const LIGHT_TRIANGLE: u32 = 3;
/// [`Lights::KIND`]: two emissive triangles that form a parallelogram, sampled as one.
pub const LIGHT_QUAD: u32 = 4;
/// [`Lights::KIND`]: the environment map.
pub const LIGHT_ENVIRONMENT: u32 = 5;

table! {
    /// The choices of a render, one row: on/off is structure, numbers are value.
    pub classed Settings {
        /// May roulette end paths?
        ROULETTE: Bool, structure;
        /// Is the number of path edges limited?
        DEPTH_LIMITED: Bool, structure;
        /// Shading normals: consistent (a closed mesh never leaks) or free.
        CONSISTENT_NORMALS: Bool, structure;
        /// Are rays moved off surfaces by more than rounding asks for?
        HAS_RAY_OFFSET: Bool, structure;
        /// Is there an environment?
        HAS_ENVIRONMENT: Bool, structure;
        /// Is there any light that can be sampled?
        HAS_LIGHTS: Bool, structure;
        /// Is there exactly one?
        HAS_ONE_LIGHT: Bool, structure;
        /// Does any material cut holes (mask or blend)?
        HAS_CUTOUTS: Bool, structure;
        /// Does any volume absorb?
        HAS_VOLUMES: Bool, structure;
        /// Roulette may end a path from this scattering on.
        RR_DEPTH: U32, value;
        /// Largest survival probability.
        RR_CAP: F32, value;
        /// Largest number of path edges.
        MAX_DEPTH: U32, value;
        /// How far rays are moved off surfaces beside the bound on rounding, over 1 m + the largest coordinate.
        RAY_OFFSET: F32, value;
        /// Number of lights.
        LIGHT_COUNT: U32, value;
    }
}

table! {
    /// What never recompiles, one row: camera, film, seed, range of samples.
    pub Frame {
        /// Film width in pixels.
        WIDTH: U32, bulk;
        /// Film height in pixels.
        HEIGHT: U32, bulk;
        /// First column of the crop window.
        CROP_X: U32, bulk;
        /// First row of the crop window.
        CROP_Y: U32, bulk;
        /// Columns of the crop window.
        CROP_WIDTH: U32, bulk;
        /// First sample of this pass.
        SAMPLE: U32, bulk;
        /// Samples per pixel in this pass.
        SAMPLES: U32, bulk;
        /// Seed of the render.
        SEED: U32, bulk;
        /// Camera position, world.
        EYE_X: F32, bulk;
        /// Camera position, world.
        EYE_Y: F32, bulk;
        /// Camera position, world.
        EYE_Z: F32, bulk;
        /// Camera right, world, times tan(yfov/2) · aspect.
        RIGHT_X: F32, bulk;
        /// See [`Frame::RIGHT_X`].
        RIGHT_Y: F32, bulk;
        /// See [`Frame::RIGHT_X`].
        RIGHT_Z: F32, bulk;
        /// Camera up, world, times tan(yfov/2).
        UP_X: F32, bulk;
        /// See [`Frame::UP_X`].
        UP_Y: F32, bulk;
        /// See [`Frame::UP_X`].
        UP_Z: F32, bulk;
        /// Viewing direction, world, unit.
        FORWARD_X: F32, bulk;
        /// See [`Frame::FORWARD_X`].
        FORWARD_Y: F32, bulk;
        /// See [`Frame::FORWARD_X`].
        FORWARD_Z: F32, bulk;
    }
}

table! {
    /// Textures as materials refer to them: image, sampling, colour space, set of coordinates, transform.
    pub classed Textures {
        /// What it is: `TEXTURE_*`.
        KIND: U32, structure;
        /// `FILTER_*`.
        FILTER: U32, structure;
        /// `WRAP_*` of the first coordinate.
        WRAP_U: U32, structure;
        /// `WRAP_*` of the second coordinate.
        WRAP_V: U32, structure;
        /// Are red, green and blue stored by the sRGB curve?
        SRGB: Bool, structure;
        /// Which set of coordinates, 0 or 1.
        UV_SET: U32, structure;
        /// Is there a KHR_texture_transform?
        TRANSFORMED: Bool, structure;
        /// Width in texels.
        WIDTH: U32, value;
        /// Height in texels.
        HEIGHT: U32, value;
        /// First texel in [`Texels`].
        OFFSET: U32, value;
        /// Transform, row by row: u' = M00 u + M01 v + M02.
        M00: F32, value;
        /// See [`Textures::M00`].
        M01: F32, value;
        /// See [`Textures::M00`].
        M02: F32, value;
        /// v' = M10 u + M11 v + M12.
        M10: F32, value;
        /// See [`Textures::M10`].
        M11: F32, value;
        /// See [`Textures::M10`].
        M12: F32, value;
        /// Checkerboard: colour of the square at the origin, linear.
        EVEN_R: F32, value;
        /// See [`Textures::EVEN_R`].
        EVEN_G: F32, value;
        /// See [`Textures::EVEN_R`].
        EVEN_B: F32, value;
        /// Checkerboard: colour of its neighbours, linear.
        ODD_R: F32, value;
        /// See [`Textures::ODD_R`].
        ODD_G: F32, value;
        /// See [`Textures::ODD_R`].
        ODD_B: F32, value;
    }
}

table! {
    /// Texels of all images, row by row from the top: red in the low byte, alpha in the high byte.
    pub Texels {
        /// RGBA, 8 bits each.
        RGBA: U32, bulk;
    }
}

table! {
    /// The sRGB curve (IEC 61966-2-1) at the 256 codes.
    pub SrgbCurve {
        /// Linear value in [0, 1].
        LINEAR: F32, bulk;
    }
}

table! {
    /// Materials, as glTF describes them, with the lobes that can be present at all as structure.
    pub classed Materials {
        /// A hit adds the base colour as emission and ends the path.
        UNLIT: Bool, structure;
        /// Does it emit?
        EMISSIVE: Bool, structure;
        /// Does emission leave both sides? (It never affects intersection.)
        DOUBLE_SIDED: Bool, structure;
        /// `ALPHA_*`.
        ALPHA_MODE: U32, structure;
        /// Diffuse lobe: not all metal, not all transmission.
        HAS_DIFFUSE: Bool, structure;
        /// Dielectric reflection layer: specular above 0 and not all metal.
        HAS_SPECULAR: Bool, structure;
        /// Metal lobe: metallic may be above 0.
        HAS_METAL: Bool, structure;
        /// Transmission lobe.
        HAS_TRANSMISSION: Bool, structure;
        /// Transmission without a volume: light passes straight, the surface has no inside.
        THIN: Bool, structure;
        /// Does the volume absorb?
        HAS_ABSORPTION: Bool, structure;
        /// `SMOOTH_*`.
        SMOOTH: U32, structure;
        /// Physically corrected Phong instead (diffuse `BASE`, specular `SPECULAR_*`, exponent `PHONG_NS`).
        PHONG: Bool, structure;
        /// Base colour has a texture.
        BASE_TEXTURED: Bool, structure;
        /// Metallic and roughness have a texture.
        METALLIC_ROUGHNESS_TEXTURED: Bool, structure;
        /// There is a normal map.
        NORMAL_TEXTURED: Bool, structure;
        /// Emission has a texture.
        EMISSION_TEXTURED: Bool, structure;
        /// Specular strength has a texture (alpha channel).
        SPECULAR_TEXTURED: Bool, structure;
        /// Specular colour has a texture.
        SPECULAR_COLOR_TEXTURED: Bool, structure;
        /// Transmission has a texture (red channel).
        TRANSMISSION_TEXTURED: Bool, structure;
        /// Base colour texture; row 0 where there is none.
        BASE_TEXTURE: ref Textures, structure;
        /// Metallic (blue) and roughness (green).
        METALLIC_ROUGHNESS_TEXTURE: ref Textures, structure;
        /// Normal map.
        NORMAL_TEXTURE: ref Textures, structure;
        /// Emission.
        EMISSION_TEXTURE: ref Textures, structure;
        /// Specular strength.
        SPECULAR_TEXTURE: ref Textures, structure;
        /// Specular colour.
        SPECULAR_COLOR_TEXTURE: ref Textures, structure;
        /// Transmission.
        TRANSMISSION_TEXTURE: ref Textures, structure;
        /// Base colour factor, linear.
        BASE_R: F32, value;
        /// See [`Materials::BASE_R`].
        BASE_G: F32, value;
        /// See [`Materials::BASE_R`].
        BASE_B: F32, value;
        /// Alpha factor.
        BASE_A: F32, value;
        /// Smallest alpha of a hit, mode mask.
        ALPHA_CUTOFF: F32, value;
        /// Metallic factor in [0, 1].
        METALLIC: F32, value;
        /// Roughness factor in [0, 1]; α is its square.
        ROUGHNESS: F32, value;
        /// Scale of the normal map's x and y.
        NORMAL_SCALE: F32, value;
        /// Emitted radiance, W/(m² sr), strength included.
        EMISSION_R: F32, value;
        /// See [`Materials::EMISSION_R`].
        EMISSION_G: F32, value;
        /// See [`Materials::EMISSION_R`].
        EMISSION_B: F32, value;
        /// Index of refraction inside, relative to outside.
        IOR: F32, value;
        /// Specular strength in [0, 1].
        SPECULAR: F32, value;
        /// Specular colour factor; Phong's reflectance.
        SPECULAR_R: F32, value;
        /// See [`Materials::SPECULAR_R`].
        SPECULAR_G: F32, value;
        /// See [`Materials::SPECULAR_R`].
        SPECULAR_B: F32, value;
        /// Transmission factor in [0, 1].
        TRANSMISSION: F32, value;
        /// Absorption coefficient of the volume, 1/m.
        ABSORPTION_R: F32, value;
        /// See [`Materials::ABSORPTION_R`].
        ABSORPTION_G: F32, value;
        /// See [`Materials::ABSORPTION_R`].
        ABSORPTION_B: F32, value;
        /// Phong exponent.
        PHONG_NS: F32, value;
    }
}

table! {
    /// Lights, one row each; the environment is one of them.
    pub classed Lights {
        /// `LIGHT_*`.
        KIND: U32, structure;
        /// Area lights: does emission leave both sides?
        DOUBLE_SIDED: Bool, structure;
        /// Area lights: is emission textured?
        TEXTURED: Bool, structure;
        /// Area lights: the material.
        MATERIAL: ref Materials, structure;
        /// Probability of choosing this light.
        PROBABILITY: F32, value;
        /// Area lights: the (first) primitive.
        PRIMITIVE: U32, value;
        /// Area lights: the second primitive of a quad, or `NONE`. Its corners are P0+E1+E2, P0+E2, P0+E1 in some order.
        PRIMITIVE1: U32, value;
        /// Position, or corner P0 of an area light, world.
        P_X: F32, value;
        /// See [`Lights::P_X`].
        P_Y: F32, value;
        /// See [`Lights::P_X`].
        P_Z: F32, value;
        /// Edge P1 − P0 of an area light, m; direction in which a spot or a directional light shines, unit.
        E1_X: F32, value;
        /// See [`Lights::E1_X`].
        E1_Y: F32, value;
        /// See [`Lights::E1_X`].
        E1_Z: F32, value;
        /// Edge P2 − P0 of an area light, m.
        E2_X: F32, value;
        /// See [`Lights::E2_X`].
        E2_Y: F32, value;
        /// See [`Lights::E2_X`].
        E2_Z: F32, value;
        /// Radiance (area), intensity W/sr (point, spot), irradiance W/m² (directional).
        R: F32, value;
        /// See [`Lights::R`].
        G: F32, value;
        /// See [`Lights::R`].
        B: F32, value;
        /// Area, m².
        AREA: F32, value;
        /// Spot: cosine of the outer angle.
        COS_OUTER: F32, value;
        /// Spot: cosine of the inner angle.
        COS_INNER: F32, value;
        /// Radius of the scene's bounding sphere, m (emission sampling of infinite lights).
        SCENE_RADIUS: F32, value;
    }
}

table! {
    /// Cumulative probabilities of the lights: one more than there are lights, from 0 to 1.
    pub LightChoice {
        /// Probability of the lights before this one.
        CDF: F32, bulk;
    }
}

table! {
    /// The environment, one row.
    pub classed Environment {
        /// Width in texels.
        WIDTH: U32, value;
        /// Height in texels.
        HEIGHT: U32, value;
        /// Slots of [`EnvironmentColumns`] for each row, as a power of two.
        LOG_COLUMN_SLOTS: U32, value;
        /// Slots of [`EnvironmentRows`], likewise.
        LOG_ROW_SLOTS: U32, value;
        /// Factor on radiance.
        INTENSITY: F32, value;
        /// Cosine of the rotation about +Y.
        ROTATION_COS: F32, value;
        /// Sine of the rotation about +Y.
        ROTATION_SIN: F32, value;
    }
}

table! {
    /// Environment texels, row by row from +Y.
    pub EnvironmentTexels {
        /// Red radiance.
        R: F32, bulk;
        /// Green.
        G: F32, bulk;
        /// Blue.
        B: F32, bulk;
        /// Density with which light sampling finds the middle of the texel, per steradian, times sin(theta).
        DENSITY: F32, bulk;
    }
}

table! {
    /// Slots of alias tables (`host::alias`) that draw a texel of a row of the environment: 2^`LOG_COLUMN_SLOTS` of them a row.
    pub EnvironmentColumns {
        /// A slot.
        SLOT: U32, bulk;
    }
}

table! {
    /// Slots of the alias table that draws a row of the environment: 2^`LOG_ROW_SLOTS` of them.
    pub EnvironmentRows {
        /// A slot.
        SLOT: U32, bulk;
    }
}

/// Every buffer; the order is the binding number.
pub const BUFFERS: &[Spec] = &[
    spec::<Settings>(),
    spec::<Frame>(),
    spec::<Textures>(),
    spec::<Texels>(),
    spec::<SrgbCurve>(),
    spec::<Materials>(),
    spec::<Geometries>(),
    spec::<Primitives>(),
    spec::<Vertices>(),
    spec::<Normals>(),
    spec::<Uvs>(),
    spec::<Tangents>(),
    spec::<Tree>(),
    spec::<Lights>(),
    spec::<LightChoice>(),
    spec::<Environment>(),
    spec::<EnvironmentTexels>(),
    spec::<EnvironmentColumns>(),
    spec::<EnvironmentRows>(),
    spec::<Samples>(),
    spec::<Paths>(),
    spec::<Next>(),
    spec::<Hits>(),
    spec::<Order>(),
    spec::<Shadows>(),
    spec::<Pixels>(),
    spec::<Ranges>(),
    spec::<Counts>(),
];

/// Declare every buffer in the program that is being built.
pub fn declare_all() {
    declare(BUFFERS);
}

/// Binding number of a buffer.
///
/// # Panics
/// When it is not in [`BUFFERS`].
pub fn binding<B: Buf>() -> usize {
    BUFFERS.iter().position(|s| s.0 == B::NAME).expect("every buffer of the schema is listed")
}
