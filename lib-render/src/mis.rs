//! Multiple importance sampling (Veach and Guibas 1995; Veach 1997, section 9.2.4).

use jerboa_ir::lang::F32;

/// Weight of a sample that was drawn with density `own` and could have been drawn with density `other` too, both per
/// steradian: the power heuristic with exponent 2, as 1 / (1 + (other / own)²).
///
/// The ratio form neither overflows where squares do nor gives NaN at the ends (N11): other = 0 gives 1, other = ∞ gives 0,
/// own = ∞ gives 1. Two infinite densities share equally, 1/2 each; two zeros, of a direction that neither draws, get 0.
pub fn power_heuristic(own: F32, other: F32) -> F32 {
    let ratio = other / own;
    // ∞ / ∞ and 0 / 0 are NaN.
    let tie = own.gt(0.0).select(F32::from(0.5), F32::from(0.0));
    ratio.is_nan().select(tie, 1.0 / (1.0 + ratio * ratio))
}
