//! Sine, cosine and their inverses.

use std::f32::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, PI, TAU};

use jerboa_ir::lang::{F32, I32};

use super::horner;

/// Sine and cosine of an angle in radians.
///
/// For |x| < 2048 π: at most 8.4e-8 and 8.6e-8 absolute. Beyond, and for infinities and NaN, NaN: not even the quadrant
/// would be right for long. ±0 gives 0 and 1.
pub fn sincos(x: F32) -> (F32, F32) {
    let (r, j) = reduce(x);
    let (sin, cos) = (sin_series(r), cos_series(r));
    quadrant(sin, cos, j)
}

/// Tangent of an angle in radians.
///
/// For |x| < 2048 π: at most 3.6 ulp. Beyond, and for infinities and NaN, NaN. ±0 gives 0.
pub fn tan(x: F32) -> F32 {
    let (r, j) = reduce(x);
    let (sin, cos) = (sin_series(r), cos_series(r));
    let odd = (j & 1).eq(1);
    odd.select(-cos, sin) / odd.select(sin, cos)
}

/// Sine and cosine of 2π u: the reduction is exact, so this is what samplers want.
///
/// For every float: at most 9.3e-8 and 9.3e-8 absolute, and exact at quarters (a zero there has either
/// sign). Infinities and NaN give NaN.
pub fn sincos_turns(u: F32) -> (F32, F32) {
    let turn = u - u.round();
    let quarters = (turn * 4.0).round();
    let r = (turn - quarters * 0.25) * TAU;
    quadrant(sin_series(r), cos_series(r), quarters.to_i32())
}

/// An angle as r + j π/2 with |r| ≤ π/4; r is NaN where |x| is not below 2048 π.
fn reduce(x: F32) -> (F32, I32) {
    /// 2048 π, rounded up.
    const FAR: f32 = 6433.982;
    /// π/2 in four parts (Cody and Waite 1980), cut after 2^-7, 2^-22 and 2^-34: j times one of the first three is exact for
    /// |j| ≤ 4096, and so is x less the first two. What is left out of all four is 8e-20.
    const PARTS: [f32; 4] = [1.570_312_5, 4.837_513e-4, 7.549_533_6e-8, 2.563_344e-12];
    let turns = (x * FRAC_2_PI).round();
    let r = PARTS.iter().fold(x, |r, part| r - turns * *part);
    (x.abs().lt(FAR).select(r, f32::NAN.into()), turns.to_i32())
}

/// Sine for |r| ≤ π/4. Cephes, `sinf.c`: off by 7.9e-9 relative.
fn sin_series(r: F32) -> F32 {
    let z = r * r;
    horner(z, &[-1.951_529_6e-4, 8.332_161e-3, -1.666_665_5e-1]) * z * r + r
}

/// Cosine for |r| ≤ π/4. Cephes, `sinf.c`: off by 1.3e-10.
fn cos_series(r: F32) -> F32 {
    let z = r * r;
    horner(z, &[2.443_315_7e-5, -1.388_731_6e-3, 4.166_664_6e-2]) * z * z - z * 0.5 + 1.0
}

/// Sine and cosine of r + j π/2 from those of r.
fn quadrant(sin: F32, cos: F32, j: I32) -> (F32, F32) {
    let swap = (j & 1).eq(1);
    let (s, c) = (swap.select(cos, sin), swap.select(sin, cos));
    ((j & 2).ne(0).select(-s, s), ((j + 1) & 2).ne(0).select(-c, c))
}

/// The angle of the point (x, y), in [−π, π].
///
/// At most 2.9 ulp. The sign of a zero counts, as in C: atan2(±0, −0) = ±π; an infinite coordinate gives the limit, two
/// give odd multiples of π/4. NaN gives NaN.
pub fn atan2(y: F32, x: F32) -> F32 {
    /// tan(π/8): beyond it the quotient is turned by π/4.
    const TAN_PI_8: f32 = 0.414_213_57;
    let (ax, ay) = (x.abs(), y.abs());
    let (small, large) = (ax.min(ay), ax.max(ay));
    // Neither sum nor quotient shall overflow: ∞/∞ counts as 1/1, 0/0 as 0/1.
    let infinite = large.eq(f32::INFINITY);
    let scale = large.gt(1e38).select(F32::from(0.25), 1.0.into());
    let small = infinite.select(small.eq(f32::INFINITY).select(F32::from(1.0), 0.0.into()), small * scale);
    let large = (infinite | large.eq(0.0)).select(1.0.into(), large * scale);
    let turned = small.gt(large * TAN_PI_8);
    let q = turned.select(small - large, small) / turned.select(small + large, large);
    let z = q * q;
    // For |q| ≤ tan(π/8). Cephes, `atanf.c`: off by 2.2e-8 relative.
    let series = horner(z, &[8.053_744e-2, -1.387_768_6e-1, 1.997_771e-1, -3.333_295e-1]) * z * q + q;
    let octant = turned.select(series + FRAC_PI_4, series);
    let quadrant = ay.gt(ax).select(FRAC_PI_2 - octant, octant);
    let half = (x.bits() >> 31).eq(1u32).select(PI - quadrant, quadrant);
    (x.is_nan() | y.is_nan()).select(f32::NAN.into(), half.copysign(y))
}

/// Arc sine, in [−π/2, π/2].
///
/// On [−1, 1] at most 2.5 ulp; ±0 keeps its sign. Beyond, and for NaN, NaN.
pub fn asin(x: F32) -> F32 {
    let a = x.abs();
    let big = a.gt(0.5);
    let z = big.select((1.0 - a) * 0.5, a * a);
    let s = asin_series(z, big.select(z.sqrt(), a));
    big.select(FRAC_PI_2 - 2.0 * s, s).copysign(x)
}

/// Arc cosine, in [0, π].
///
/// On [−1, 1] at most 1.3 ulp; 1 gives 0. Beyond, and for NaN, NaN.
pub fn acos(x: F32) -> F32 {
    let a = x.abs();
    let big = a.gt(0.5);
    let z = big.select((1.0 - a) * 0.5, a * a);
    let s = asin_series(z, big.select(z.sqrt(), x));
    let near = x.lt(0.0).select(PI - 2.0 * s, 2.0 * s);
    big.select(near, FRAC_PI_2 - s)
}

/// asin(x) for z = x² ≤ 1/4. Cephes, `asinf.c`: off by 5.4e-9 relative.
fn asin_series(z: F32, x: F32) -> F32 {
    horner(z, &[4.216_32e-2, 2.418_131e-2, 4.547_002_6e-2, 7.495_300_3e-2, 1.666_675_2e-1]) * z * x + x
}
