//! What the first samples of a render have taught: how much light is still to be found where, for roulette; see
//! [`crate::tracer::learned`].

use jerboa_ir::table;

/// Cells of [`LearnedGrid`] along each axis.
pub const CELLS: u32 = 32;
/// Sets of directions in a cell: by the largest coordinate, and the signs of all three.
pub const DIRECTIONS: u32 = 24;

table! {
    /// The cells of [`LearnedLight`], one row: a grid whose cells at its faces reach on without end.
    pub LearnedGrid {
        /// Has anything been learned yet?
        IS_LEARNED: Bool, bulk;
        /// Least corner, where all positions are relative to the scene's origin, m.
        X: F32, bulk;
        /// See [`LearnedGrid::X`].
        Y: F32, bulk;
        /// See [`LearnedGrid::X`].
        Z: F32, bulk;
        /// Cells a metre.
        PER_X: F32, bulk;
        /// See [`LearnedGrid::PER_X`].
        PER_Y: F32, bulk;
        /// See [`LearnedGrid::PER_X`].
        PER_Z: F32, bulk;
    }
}

table! {
    /// For each cell, x fastest, and in it for each set of directions: what a path finds that leaves there with throughput 1.
    pub LearnedLight {
        /// Root of the second moment of its luminance, over the number of rays it takes.
        WORTH: F32, bulk;
    }
}

table! {
    /// For each pixel of the film, row by row: what light counts there.
    pub LearnedPixels {
        /// Throughput times [`LearnedLight::WORTH`], over the probability of going on.
        SCALE: F32, bulk;
    }
}
