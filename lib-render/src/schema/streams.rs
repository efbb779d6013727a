//! Streams: what kernels leave for each other and for the host, one row for each path in flight.

use jerboa_ir::stream;

stream! {
    /// What a kernel leaves for each sample of each pixel of a pass.
    pub Samples {
        /// Red radiance.
        R: F32;
        /// Green.
        G: F32;
        /// Blue.
        B: F32;
        /// Closest-hit rays traced.
        CLOSEST: U32;
        /// Shadow rays traced.
        SHADOW: U32;
    }
}

/// The columns of a stream of paths; there are two, and a wave goes from one to the other.
macro_rules! paths {
    ($(#[$doc:meta])* $name:ident) => {
        stream! {
            $(#[$doc])*
            pub rows $name {
                /// The record `Ray`.
                ORG_X: F32;
                /// See `ORG_X`.
                ORG_Y: F32;
                /// See `ORG_X`.
                ORG_Z: F32;
                /// See `ORG_X`.
                DIR_X: F32;
                /// See `ORG_X`.
                DIR_Y: F32;
                /// See `ORG_X`.
                DIR_Z: F32;
                /// See `ORG_X`.
                TMAX: F32;
                /// See `ORG_X`.
                SKIP: U32;
                /// See `ORG_X`.
                SKIP1: U32;
                /// See `ORG_X`.
                SKIP2: U32;
                /// The record `RayState`.
                RNG_START: U32;
                /// See `RNG_START`.
                RNG_STEP: U32;
                /// See `RNG_START`.
                RNG_INDEX: U32;
                /// See `RNG_START`.
                VERTEX: U32;
                /// See `RNG_START`.
                THROUGHPUT_R: F32;
                /// See `RNG_START`.
                THROUGHPUT_G: F32;
                /// See `RNG_START`.
                THROUGHPUT_B: F32;
                /// See `RNG_START`.
                RADIANCE_SCALE: F32;
                /// See `RNG_START`.
                PDF_DIR: F32;
                /// See `RNG_START`.
                IS_SPECULAR: Bool;
                /// See `RNG_START`.
                ABSORPTION_R: F32;
                /// See `RNG_START`.
                ABSORPTION_G: F32;
                /// See `RNG_START`.
                ABSORPTION_B: F32;
                /// Nothing: what follows is stored apart, and is two times four words.
                PADDING: U32;
                /// Radiance so far.
                R: F32;
                /// Green.
                G: F32;
                /// Blue.
                B: F32;
                /// Closest-hit rays so far.
                CLOSEST: U32;
                /// Shadow rays so far.
                SHADOW: U32;
                /// The host's number of the sample.
                ITEM: U32;
                /// Is there a ray to trace?
                ALIVE: Bool;
                /// Is there a shadow ray, in the row of [`Shadows`] of the same number?
                ASKED: Bool;
            }
        }
    };
}

paths! {
    /// The paths of a wave.
    Paths
}

paths! {
    /// The same paths one vertex further, in the order of shading.
    Next
}

stream! {
    /// Where the rays of [`Paths`] end, row by row.
    pub rows Hits {
        /// The record `Hit`.
        PRIMITIVE: U32;
        /// See [`Hits::PRIMITIVE`].
        T: F32;
        /// See [`Hits::PRIMITIVE`].
        U: F32;
        /// See [`Hits::PRIMITIVE`].
        V: F32;
        /// Class of the primitive's row of `Geometries`: its shader; `NONE` for a miss.
        CLASS: U32;
    }
}

stream! {
    /// Rows of [`Paths`] by shader: row i of [`Next`] comes from row `PATH` of it.
    pub Order {
        /// A row of [`Paths`].
        PATH: U32;
    }
}

stream! {
    /// Shadow rays, for the rows of [`Next`].
    pub rows Shadows {
        /// The record `Ray`.
        ORG_X: F32;
        /// See [`Shadows::ORG_X`].
        ORG_Y: F32;
        /// See [`Shadows::ORG_X`].
        ORG_Z: F32;
        /// See [`Shadows::ORG_X`].
        DIR_X: F32;
        /// See [`Shadows::ORG_X`].
        DIR_Y: F32;
        /// See [`Shadows::ORG_X`].
        DIR_Z: F32;
        /// See [`Shadows::ORG_X`].
        TMAX: F32;
        /// See [`Shadows::ORG_X`].
        SKIP: U32;
        /// See [`Shadows::ORG_X`].
        SKIP1: U32;
        /// See [`Shadows::ORG_X`].
        SKIP2: U32;
        /// What it carries if nothing blocks it.
        R: F32;
        /// Green.
        G: F32;
        /// Blue.
        B: F32;
    }
}

stream! {
    /// What a device leaves for each pixel of a piece of a pass: exact sums of the samples, see [`crate::core::exact`].
    pub rows Pixels {
        /// The record `PixelSum`: red, from the least significant word.
        R0: U32;
        /// See [`Pixels::R0`].
        R1: U32;
        /// See [`Pixels::R0`].
        R2: U32;
        /// See [`Pixels::R0`].
        R3: U32;
        /// Green.
        G0: U32;
        /// See [`Pixels::G0`].
        G1: U32;
        /// See [`Pixels::G0`].
        G2: U32;
        /// See [`Pixels::G0`].
        G3: U32;
        /// Blue.
        B0: U32;
        /// See [`Pixels::B0`].
        B1: U32;
        /// See [`Pixels::B0`].
        B2: U32;
        /// See [`Pixels::B0`].
        B3: U32;
        /// Samples in the sums.
        COUNT: U32;
        /// Samples that were dropped.
        DROPPED: U32;
        /// Closest-hit rays traced.
        CLOSEST: U32;
        /// Shadow rays traced.
        SHADOW: U32;
    }
}

stream! {
    /// Ranges of rows on a device that counts by itself, and grids to dispatch over them; see [`crate::device::wavefront`].
    pub rows Ranges {
        /// The first row.
        FIRST: U32;
        /// The row after the last.
        END: U32;
        /// Groups of invocations, one invocation a row.
        GROUPS_X: U32;
        /// 1.
        GROUPS_Y: U32;
        /// 1.
        GROUPS_Z: U32;
    }
}

stream! {
    /// For each class of shaders, and in it for each block of rows of [`Paths`]: how many are of the class; then, how many in
    /// the blocks before; then, in all rows before.
    pub Counts {
        /// How many.
        COUNT: U32;
    }
}

/// Rows of [`LightVertices`]. A path from a light that has as many vertices ends there, though roulette ends all but
/// one in 4000 before, in a room that absorbs nothing too.
pub const LIGHT_VERTICES: u32 = 4096;

stream! {
    /// Vertices of a path from a light, to be connected with, from the first on; see [`crate::device::both`].
    pub rows LightVertices {
        /// The record `LightVertex`: where it is; `NONE` behind the last one.
        PRIMITIVE: U32;
        /// See [`LightVertices::PRIMITIVE`].
        T: F32;
        /// See [`LightVertices::PRIMITIVE`].
        U: F32;
        /// See [`LightVertices::PRIMITIVE`].
        V: F32;
        /// Where the light comes from.
        FROM_X: F32;
        /// See [`LightVertices::FROM_X`].
        FROM_Y: F32;
        /// See [`LightVertices::FROM_X`].
        FROM_Z: F32;
        /// The light.
        R: F32;
        /// Green.
        G: F32;
        /// Blue.
        B: F32;
        /// Sums of densities.
        D_NEXT: F32;
        /// See [`LightVertices::D_NEXT`].
        D_PAST: F32;
        /// Number of the vertex.
        VERTEX: U32;
    }
}
