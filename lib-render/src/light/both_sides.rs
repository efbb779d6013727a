//! Lamps that shine on both sides, as double-sided materials do.

use jerboa_ir::lang::{Bool, F32};

use crate::core::sampling::cosine_hemisphere_pdf;

/// Does the back shine in a direction of this cosine to the front? Not where it is NaN.
pub fn shines_behind(cos: F32) -> Bool {
    cos.lt(0.0)
}

/// Does a uniform number draw the back? It is as likely as the front.
pub fn draws_back(u: F32) -> Bool {
    u.lt(0.5)
}

/// Density of a direction under emission sampling, per steradian, of a lamp that shines on both sides or in front.
pub fn emission_pdf(both: Bool, cos: F32) -> F32 {
    let front = cosine_hemisphere_pdf(cos);
    both.select(cosine_hemisphere_pdf(cos.abs()) * 0.5, front)
}
