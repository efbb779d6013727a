//! The scene as data with a binding time (Law 2): every table and stream that a kernel may touch.
//!
//! This list is the same for every scene. *Structure* columns hold kinds, flags, counts and presences, and derived facts
//! (emissive or not, lobe present or not); *value* columns hold numbers; *bulk* columns texels, vertices, trees,
//! distributions, and what must never recompile: camera, film, seed. The host half that fills them is `host::tables`.

mod environment;
mod geometry;
mod learned;
mod lights;
mod materials;
mod streams;
mod textures;

use jerboa_ir::lang::{Buf, Spec, declare, spec};
use jerboa_ir::table;

pub use environment::*;
pub use geometry::*;
pub use learned::*;
pub use lights::*;
pub use materials::*;
pub use streams::*;
pub use textures::*;

/// "None" in a column of indices.
pub const NONE: u32 = u32::MAX;

/// [`Settings::CAMERA`]: all rays through one point.
pub const CAMERA_PINHOLE: u32 = 0;
/// [`Settings::CAMERA`]: all through a disk, those of a point of the film through one point in focus.
pub const CAMERA_THIN: u32 = 1;
/// [`Settings::CAMERA`]: all rays parallel.
pub const CAMERA_ORTHOGRAPHIC: u32 = 2;
/// [`Settings::CAMERA`]: angles as the distance from the film's centre.
pub const CAMERA_FISHEYE: u32 = 3;

table! {
    /// The choices of a render, one row: on/off is structure, numbers are value.
    pub classed Settings {
        /// May roulette end paths?
        ROULETTE: Bool, structure;
        /// Does it learn from the first samples what paths are worth?
        LEARNS: Bool, structure;
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
        /// Is there a tree over the lights?
        HAS_LIGHT_TREE: Bool, structure;
        /// Are area lights sampled by solid angle, not by area?
        BY_SOLID_ANGLE: Bool, structure;
        /// Does any material cut holes (mask or blend), or let rays through from behind?
        HAS_CUTOUTS: Bool, structure;
        /// Does any volume absorb?
        HAS_VOLUMES: Bool, structure;
        /// `CAMERA_*`.
        CAMERA: U32, structure;
        /// Do instances share triangles?
        HAS_INSTANCES: Bool, structure;
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
        /// How far ambient occlusion looks, m; infinity for no end.
        OCCLUSION_DISTANCE: F32, value;
        /// Rows of [`Instances`].
        INSTANCE_COUNT: U32, value;
        /// Number of lights in the tree: the first ones.
        TREE_LIGHTS: U32, value;
        /// Number of spheres and disks: the first rows of [`SeenLights`].
        SHAPES: U32, value;
        /// Number of suns: its other rows.
        SUNS: U32, value;
    }
}

table! {
    /// How random numbers are drawn, one row. It is known at every level of knowledge, as [`Models`] is.
    pub classed Sampling {
        /// From scrambled Sobol points, not each by itself?
        IS_SOBOL: Bool, structure;
        /// log2 of how many independent sequences the samples of a pixel belong to.
        LOG_SCRAMBLES: U32, structure;
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
        /// Camera right, world, times half the width of the film: on the plane at distance 1 (pinhole, thin lens), in metres
        /// (orthographic), in radians (fisheye).
        RIGHT_X: F32, bulk;
        /// See [`Frame::RIGHT_X`].
        RIGHT_Y: F32, bulk;
        /// See [`Frame::RIGHT_X`].
        RIGHT_Z: F32, bulk;
        /// Camera up, world, times half the height of the film, likewise.
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
        /// Radius of a thin lens, in [`Frame::LENS_SIZE`], over the length of [`Frame::RIGHT_X`] and so on.
        LENS_RIGHT: F32, bulk;
        /// Radius of a thin lens, likewise, over the length of [`Frame::UP_X`] and so on.
        LENS_UP: F32, bulk;
        /// The largest power of two that is no more than the radius of a thin lens, m.
        LENS_SIZE: F32, bulk;
        /// Depth that a thin lens is in focus at, in the largest power of two that is no more than it or the radius: so squares of either
        /// neither overflow nor vanish, and powers of two round nothing.
        FOCUS: F32, bulk;
        /// [`Frame::LENS_SIZE`] in the unit of [`Frame::FOCUS`].
        LENS_SHARE: F32, bulk;
        /// Absorption coefficient of what the camera is in, 1/m.
        ABSORPTION_R: F32, bulk;
        /// See [`Frame::ABSORPTION_R`].
        ABSORPTION_G: F32, bulk;
        /// See [`Frame::ABSORPTION_R`].
        ABSORPTION_B: F32, bulk;
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
    spec::<Colors>(),
    spec::<Instances>(),
    spec::<Tree>(),
    spec::<Lights>(),
    spec::<LightChoice>(),
    spec::<LightTree>(),
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
    spec::<Models>(),
    spec::<Parameters>(),
    spec::<LightVertices>(),
    spec::<Sampling>(),
    spec::<SeenLights>(),
    spec::<LearnedGrid>(),
    spec::<LearnedLight>(),
    spec::<LearnedPixels>(),
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
