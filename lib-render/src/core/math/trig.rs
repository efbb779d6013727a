//! Sine, cosine and their inverses.

use std::f32::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, PI, TAU};

use jerboa_ir::lang::{F32, I32};

use super::horner;

/// Sine and cosine of an angle in radians.
///
/// Measured for |x| ≤ 2000 π: at most 7.3e-8 absolute. Infinities and NaN give NaN; beyond 2^31 π/2 the result is
/// meaningless.
pub fn sincos(x: F32) -> (F32, F32) {
    // π/2 in three parts: j times the first two is exact for |j| < 4096 (Cody and Waite 1980).
    const PARTS: [f32; 3] = [1.570_312_5, 4.837_513e-4, 7.549_79e-8];
    let turns = (x * FRAC_2_PI).round();
    let r = PARTS.iter().fold(x, |r, part| r - turns * *part);
    quadrant(r, turns.to_i32())
}

/// Sine and cosine of 2π u: the reduction is exact, so this is what samplers want.
///
/// Measured for u in [-1, 1]: at most 8.7e-8 absolute; u = 0, 1/4, 1/2, 3/4 give exact results. Infinities and NaN give NaN.
pub fn sincos_turns(u: F32) -> (F32, F32) {
    let quarters = (u * 4.0).round();
    quadrant((u - quarters * 0.25) * TAU, quarters.to_i32())
}

/// Sine and cosine of r + j π/2, |r| ≤ π/4.
fn quadrant(r: F32, j: I32) -> (F32, F32) {
    let z = r * r;
    let sin = horner(z, &[-1.951_529_6e-4, 8.332_161e-3, -1.666_665_5e-1]) * z * r + r;
    let cos = horner(z, &[2.443_315_7e-5, -1.388_731_6e-3, 4.166_664_6e-2]) * z * z - z * 0.5 + 1.0;
    let swap = (j & 1).eq(1);
    let (s, c) = (swap.select(cos, sin), swap.select(sin, cos));
    ((j & 2).ne(0).select(-s, s), ((j + 1) & 2).ne(0).select(-c, c))
}

/// The angle of the point (x, y), in [−π, π].
///
/// Measured for magnitudes from 1e-30 to 1e30: at most 2.7 ulp. The sign of a zero counts, as in C:
/// atan2(±0, −0) = ±π; an infinite coordinate gives the limit, two give odd multiples of π/4. NaN gives NaN. Where the sum of magnitudes overflows, and
/// where the quotient is denormal, the error may be larger.
pub fn atan2(y: F32, x: F32) -> F32 {
    /// tan(π/8): beyond it the quotient is turned by π/4.
    const TAN_PI_8: f32 = 0.414_213_57;
    let (ax, ay) = (x.abs(), y.abs());
    let (small, large) = (ax.min(ay), ax.max(ay));
    // ∞/∞ counts as 1/1, 0/0 as 0/1.
    let infinite = large.eq(f32::INFINITY);
    let small = infinite.select(small.eq(f32::INFINITY).select(F32::from(1.0), 0.0.into()), small);
    let large = (infinite | large.eq(0.0)).select(1.0.into(), large);
    let turned = small.gt(large * TAN_PI_8);
    let q = turned.select(small - large, small) / turned.select(small + large, large);
    let z = q * q;
    let series = horner(z, &[8.053_744e-2, -1.387_768_6e-1, 1.997_771e-1, -3.333_295e-1]) * z * q + q;
    let octant = turned.select(series + FRAC_PI_4, series);
    let quadrant = ay.gt(ax).select(FRAC_PI_2 - octant, octant);
    let half = (x.bits() >> 31).eq(1u32).select(PI - quadrant, quadrant);
    (x.is_nan() | y.is_nan()).select(f32::NAN.into(), half.copysign(y))
}

/// Arc sine, in [−π/2, π/2]. Measured on [-1, 1]: at most 2.3 ulp. Beyond, NaN.
pub fn asin(x: F32) -> F32 {
    let a = x.abs();
    let big = a.gt(0.5);
    let z = big.select((1.0 - a) * 0.5, a * a);
    let s = asin_series(z, big.select(z.sqrt(), a));
    big.select(FRAC_PI_2 - 2.0 * s, s).copysign(x)
}

/// Arc cosine, in [0, π]. Measured on [-1, 1]: at most 1.2 ulp. Beyond, NaN.
pub fn acos(x: F32) -> F32 {
    let a = x.abs();
    let big = a.gt(0.5);
    let z = big.select((1.0 - a) * 0.5, a * a);
    let s = asin_series(z, big.select(z.sqrt(), x));
    let near = x.lt(0.0).select(PI - 2.0 * s, 2.0 * s);
    big.select(near, FRAC_PI_2 - s)
}

/// asin(x) for z = x² ≤ 1/4.
fn asin_series(z: F32, x: F32) -> F32 {
    horner(z, &[4.216_32e-2, 2.418_131e-2, 4.547_002_6e-2, 7.495_300_3e-2, 1.666_675_2e-1]) * z * x + x
}
