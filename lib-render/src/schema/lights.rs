//! Lights, and how one is chosen.

use jerboa_ir::table;

use super::{Materials, Parameters};

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
/// [`Lights::KIND`]: a ball that shines, without a surface.
pub const LIGHT_SPHERE: u32 = 6;
/// [`Lights::KIND`]: a disk that shines like a spot, without a surface.
pub const LIGHT_DISK: u32 = 7;
/// [`Lights::KIND`]: a disk in the sky.
pub const LIGHT_SUN: u32 = 8;
/// [`Lights::KIND`]: the first light of a user's crate; the others follow.
pub const LIGHT_OWN: u32 = 64;

table! {
    /// Lights, one row each; the environment is one of them.
    pub classed Lights {
        /// `LIGHT_*`.
        KIND: U32, structure;
        /// Area lights: does emission leave both sides?
        DOUBLE_SIDED: Bool, structure;
        /// Area lights: is emission textured, or the coat over it?
        TEXTURED: Bool, structure;
        /// Area lights: the material.
        MATERIAL: ref Materials, structure;
        /// The first of the numbers that a light of a user's crate takes.
        NUMBERS: ref Parameters, structure;
        /// Probability of choosing this light.
        PROBABILITY: F32, value;
        /// The way to it in the [`LightTree`]: bit k says to which child to go from level k.
        TRAIL: U32, value;
        /// Area lights: the (first) primitive.
        PRIMITIVE: U32, value;
        /// Area lights: the second primitive of a quad, or `NONE`. Its corners are P0+E1+E2, P0+E2, P0+E1 in some order.
        PRIMITIVE1: U32, value;
        /// Position, middle of a sphere or a disk, or corner P0 of an area light, world.
        P_X: F32, value;
        /// See [`Lights::P_X`].
        P_Y: F32, value;
        /// See [`Lights::P_X`].
        P_Z: F32, value;
        /// Edge P1 − P0 of an area light, m; direction in which a spot, a disk, a directional light or a
        /// sun's middle shines, unit.
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
        /// Radiance (area, sphere, sun; disk along its axis), intensity W/sr (point, spot), irradiance W/m² (directional).
        R: F32, value;
        /// See [`Lights::R`].
        G: F32, value;
        /// See [`Lights::R`].
        B: F32, value;
        /// Area, m².
        AREA: F32, value;
        /// Spot and disk: cosine of the outer angle.
        COS_OUTER: F32, value;
        /// Spot and disk: cosine of the inner angle.
        COS_INNER: F32, value;
        /// Radius of the scene's bounding sphere, m (emission sampling of infinite lights; rounding at disks).
        SCENE_RADIUS: F32, value;
        /// Absorption coefficient of what the light lies in, 1/m.
        ABSORPTION_R: F32, value;
        /// See [`Lights::ABSORPTION_R`].
        ABSORPTION_G: F32, value;
        /// See [`Lights::ABSORPTION_R`].
        ABSORPTION_B: F32, value;
        /// Textured quads: how many corners the first primitive begins before P0.
        TURN: U32, value;
        /// Textured quads: how many corners the second primitive begins before P0+E1+E2.
        TURN1: U32, value;
        /// Sphere and disk: radius, m.
        RADIUS: F32, value;
        /// Sun: 1 − cosine of half the angle across.
        OPENING: F32, value;
    }
}

table! {
    /// Lights that are seen though they have no surface: spheres and disks, then suns.
    pub SeenLights {
        /// The light, a row of [`Lights`].
        LIGHT: U32, bulk;
    }
}

table! {
    /// Cumulative probabilities of the lights: one more than there are lights, from 0 to 1.
    pub LightChoice {
        /// Probability of the lights before this one.
        CDF: F32, bulk;
    }
}

/// Set in [`LightTree::LINK`] of a leaf.
pub const TREE_LEAF: u32 = 1 << 31;

table! {
    /// A tree over the lights that have a place; the root is row 0, the first child of a node the row after it. A zero row where
    /// there is no tree.
    pub LightTree {
        /// Middle of a ball around all its lights, world.
        X: F32, bulk;
        /// See [`LightTree::X`].
        Y: F32, bulk;
        /// See [`LightTree::X`].
        Z: F32, bulk;
        /// Its radius, m.
        RADIUS: F32, bulk;
        /// Axis of a cone around all normals, unit, world.
        AXIS_X: F32, bulk;
        /// See [`LightTree::AXIS_X`].
        AXIS_Y: F32, bulk;
        /// See [`LightTree::AXIS_X`].
        AXIS_Z: F32, bulk;
        /// Share of the power of all lights in the tree.
        POWER: F32, bulk;
        /// Cosine of the cone's half angle, which is in [0, π].
        COS_NORMALS: F32, bulk;
        /// Its sine.
        SIN_NORMALS: F32, bulk;
        /// Cosine of the largest angle between light and its normal.
        COS_LIGHT: F32, bulk;
        /// The second child, or [`TREE_LEAF`] and a row of [`Lights`].
        LINK: U32, bulk;
    }
}
