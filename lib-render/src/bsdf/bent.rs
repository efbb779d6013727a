//! Shading normals bent for reflections, where they are consistent: what a mirror or a microfacet reflects leaves the surface.

use jerboa_ir::lang::F32;

use crate::bsdf::frame::{Side, is_consistent, reflect};
use crate::core::vec::Vec3;

impl Side {
    /// The normal for mirrors and microfacets: the shading normal, bent just enough that the mirror image of wo leaves the
    /// surface instead of entering it. The cosine between it and wo is then positive.
    ///
    /// Source: Keller et al. 2017, "The Iray light transport simulation and rendering system", section A.3: lift the mirror
    /// direction to the surface and take the half vector.
    pub fn bent_normal(self, wo: Vec3) -> Vec3 {
        /// The lowest a lifted direction leaves the surface (its sine), unless wo itself is lower. Large against rounding.
        const LIFT: f32 = 0.01;
        let (n, g) = (self.normal, self.judge);
        let mirrored = reflect(wo, n);
        let height = mirrored.dot(g);
        let least = (wo.dot(g) * 0.9).min(LIFT);
        let lifted = (mirrored + g * (least - height)).normalize();
        let bent = (wo + lifted).normalize();
        is_consistent().select(height.lt(least).select(bent, n), n)
    }
}

/// What f is multiplied with where it was found with a bent normal, whose cosine with wi is `bent_cos`: the renderer
/// multiplies it with [`shading_cos`](crate::bsdf::frame::shading_cos), here `cos`.
pub fn bend_ratio(bent_cos: F32, cos: F32) -> F32 {
    let ratio = cos.gt(0.0).select(bent_cos.abs() / cos, 0.0.into());
    is_consistent().select(ratio, 1.0.into())
}
