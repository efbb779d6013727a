//! Random numbers for the tests of the host modules.

/// SplitMix64 (Steele, Lea & Flood 2014), from a seed that the test prints.
pub(crate) struct Random(pub u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub(crate) fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A point with coordinates uniform in [-1, 1).
    pub(crate) fn point(&mut self) -> [f32; 3] {
        [0; 3].map(|_| (2.0 * self.uniform() - 1.0) as f32)
    }
}
