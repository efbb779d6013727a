//! The environment: its texels, and the tables that draw one.

use jerboa_ir::table;

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
