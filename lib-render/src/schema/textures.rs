//! Textures: how materials refer to images, and the texels.

use jerboa_ir::table;

use super::Parameters;

/// [`Textures::KIND`]: 8-bit texels.
pub const TEXTURE_IMAGE: u32 = 0;
/// [`Textures::KIND`]: the procedural checkerboard of the paper, section 4.1.
pub const TEXTURE_CHECKERBOARD: u32 = 1;
/// [`Textures::KIND`]: smooth noise.
pub const TEXTURE_NOISE: u32 = 2;
/// [`Textures::KIND`]: the first texture of a user's crate; the others follow.
pub const TEXTURE_OWN: u32 = 64;

/// [`Textures::WRAP_U`] and [`Textures::WRAP_V`]: repeat.
pub const WRAP_REPEAT: u32 = 0;
/// Clamp to the edge.
pub const WRAP_CLAMP: u32 = 1;
/// Mirrored repeat.
pub const WRAP_MIRROR: u32 = 2;
/// A border of one colour; it is that of both coordinates.
pub const WRAP_BORDER: u32 = 3;

/// [`Textures::FILTER`]: the texel that contains the point.
pub const FILTER_NEAREST: u32 = 0;
/// [`Textures::FILTER`]: bilinear between the four texel centres around it.
pub const FILTER_BILINEAR: u32 = 1;
/// [`Textures::FILTER`]: cubic B-splines over the sixteen texel centres around it.
pub const FILTER_BICUBIC: u32 = 2;

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
        /// The first of the numbers that a texture of a user's crate takes.
        NUMBERS: ref Parameters, structure;
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
        /// Checkerboard: colour of the square at the origin, linear. Noise: that of the lowest value.
        EVEN_R: F32, value;
        /// See [`Textures::EVEN_R`].
        EVEN_G: F32, value;
        /// See [`Textures::EVEN_R`].
        EVEN_B: F32, value;
        /// Checkerboard: colour of its neighbours, linear. Noise: that of the highest value.
        ODD_R: F32, value;
        /// See [`Textures::ODD_R`].
        ODD_G: F32, value;
        /// See [`Textures::ODD_R`].
        ODD_B: F32, value;
        /// The border, linear.
        BORDER_R: F32, value;
        /// See [`Textures::BORDER_R`].
        BORDER_G: F32, value;
        /// See [`Textures::BORDER_R`].
        BORDER_B: F32, value;
        /// See [`Textures::BORDER_R`].
        BORDER_A: F32, value;
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
