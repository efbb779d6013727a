//! What a device that sums by itself leaves for a pixel.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, U32};

use crate::core::color::Color;
use crate::core::exact::Exact;
use crate::schema::Pixels;

/// A row of [`Pixels`].
#[derive(Clone, Copy)]
pub struct PixelSum {
    /// Red, green and blue.
    pub sums: [Exact; 3],
    /// Samples in the sums.
    pub count: U32,
    /// Samples that were dropped.
    pub dropped: U32,
    /// Closest-hit rays.
    pub closest: U32,
    /// Shadow rays.
    pub shadow: U32,
}
impl_staged!(PixelSum { sums, count, dropped, closest, shadow });

impl PixelSum {
    /// No sample.
    pub fn zero() -> PixelSum {
        let zero = U32::from(0);
        PixelSum { sums: [Exact::zero(); 3], count: zero, dropped: zero, closest: zero, shadow: zero }
    }

    /// Add a sample with its numbers of rays. As on the host's film, one with a channel that is not finite or too large is
    /// dropped whole.
    #[must_use]
    pub fn with(self, radiance: Color, closest: U32, shadow: U32) -> PixelSum {
        let Color { r, g, b } = radiance;
        let is_taken = Exact::takes(r) & Exact::takes(g) & Exact::takes(b);
        let channels = [r, g, b];
        let more = std::array::from_fn(|c| self.sums[c].with(channels[c]));
        PixelSum {
            sums: is_taken.select(more, self.sums),
            count: self.count + is_taken.bits(),
            dropped: self.dropped + Bool::bits(!is_taken),
            closest: self.closest + closest,
            shadow: self.shadow + shadow,
        }
    }

    /// Add light that is no sample of the pixel: from a path that belongs to another one. What cannot be added is dropped.
    #[must_use]
    pub fn with_light(self, light: Color) -> PixelSum {
        let zero = U32::from(0);
        PixelSum { count: self.count, ..self.with(light, zero, zero) }
    }

    /// The row of this number.
    pub fn load(b: &mut Block, row: U32) -> PixelSum {
        b.load_record(Pixels::R0, row)
    }

    /// Store it there.
    pub fn store(self, b: &mut Block, row: U32) {
        b.store_record(Pixels::R0, row, self);
    }
}
