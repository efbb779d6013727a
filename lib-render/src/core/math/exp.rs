//! Exponentials and logarithms.

use std::f32::consts::LOG2_E;

use jerboa_ir::lang::{F32, I32};

use super::horner;

/// ln 2 in two parts (Cephes, `expf.c`): n times the first is exact for |n| < 2^15.
const LN2: [f32; 2] = [0.693_359_4, -2.121_944_4e-4];
/// The mantissa of a float.
const MANTISSA: u32 = 0x007f_ffff;
/// The smallest normal float.
const MIN_NORMAL: f32 = f32::MIN_POSITIVE;

/// e^x.
///
/// For every float: at most 1.0 ulp, denormal results included; exact at ±0. Above 88.7228 infinity, below −103.98 zero.
/// NaN gives NaN.
pub fn exp(x: F32) -> F32 {
    let n = (x * LOG2_E).round();
    let r = LN2.iter().fold(x, |r, part| r - n * *part);
    // For |r| ≤ ln 2 / 2. Cephes, `expf.c`: off by 2.7e-9 relative.
    let p = horner(r, &[1.987_569_1e-4, 1.398_199_9e-3, 8.333_452e-3, 4.166_579_6e-2, 1.666_666_5e-1, 0.5]);
    let y = scale(p * r * r + r + 1.0, n.to_i32());
    x.gt(88.722_84).select(f32::INFINITY.into(), x.lt(-103.98).select(0.0.into(), y))
}

/// 2^x.
///
/// For every float: at most 1.3 ulp, denormal results included; exact at integers. From 128 on infinity, below −150
/// zero. NaN gives NaN.
pub fn exp2(x: F32) -> F32 {
    let n = x.round();
    let y = scale(exp2_series(x - n), n.to_i32());
    x.ge(128.0).select(f32::INFINITY.into(), x.lt(-150.0).select(0.0.into(), y))
}

/// 2^r, |r| ≤ 1/2. Cephes, `exp2f.c`: off by 1.6e-8 relative.
fn exp2_series(r: F32) -> F32 {
    let p = [1.535_336_2e-4, 1.339_887_5e-3, 9.618_437e-3, 5.550_332_5e-2, 2.402_264_8e-1, 6.931_472e-1];
    horner(r, &p) * r + 1.0
}

/// y · 2^n in two steps, so that a denormal result is rounded once and 2^128 does not overflow early.
fn scale(y: F32, n: I32) -> F32 {
    let half = n >> 1;
    y * power_of_two(half) * power_of_two(n - half)
}

/// 2^n for n in [-126, 127].
fn power_of_two(n: I32) -> F32 {
    ((n + 127).bits() << 23).float_of_bits()
}

/// The exponent e and m − 1, where x = m · 2^e and m lies in [√½, √2); for positive finite x, denormals included.
fn split(x: F32) -> (F32, F32) {
    let tiny = x.lt(MIN_NORMAL);
    let bits = tiny.select(x * 8_388_608.0, x).bits();
    let m = ((bits & MANTISSA) | 0x3f00_0000u32).float_of_bits();
    let e = (bits >> 23).int_of_bits() - tiny.select(I32::from(126 + 23), 126.into());
    let low = m.lt(std::f32::consts::FRAC_1_SQRT_2);
    (low.select(e - 1, e).to_f32(), low.select(m + m, m) - 1.0)
}

/// What a logarithm gives at 0, below 0, at infinity and at NaN, else y.
fn special(x: F32, y: F32) -> F32 {
    let y = x.eq(f32::INFINITY).select(x, y);
    let y = x.eq(0.0).select(f32::NEG_INFINITY.into(), y);
    (x.lt(0.0) | x.is_nan()).select(f32::NAN.into(), y)
}

/// log(1 + f) − f + f²/2 for √½ ≤ 1 + f < √2. Cephes, `logf.c`: off by 4.0e-9 of the logarithm.
fn log_tail(f: F32) -> F32 {
    let p = [
        7.037_684e-2,
        -1.151_461e-1,
        1.167_699_9e-1,
        -1.242_014_1e-1,
        1.424_932_3e-1,
        -1.666_805_8e-1,
        2.000_071_5e-1,
        -2.499_999_4e-1,
        3.333_333e-1,
    ];
    horner(f, &p) * f * (f * f)
}

/// Natural logarithm.
///
/// For all positive floats, denormals included: at most 0.83 ulp. log 1 = 0, log ±0 = −∞, log ∞ = ∞; negative numbers and
/// NaN give NaN.
pub fn log(x: F32) -> F32 {
    let (e, f) = split(x);
    let y = log_tail(f) + e * LN2[1] - f * f * 0.5;
    special(x, f + y + e * LN2[0])
}

/// Logarithm to base 2.
///
/// For all positive floats, denormals included: at most 1.46 ulp; exact at powers of two. Special values as [`log`].
pub fn log2(x: F32) -> F32 {
    /// log2 e − 1: f itself is added last.
    const REST: f32 = 0.442_695_05;
    let (e, f) = split(x);
    let y = log_tail(f) - f * f * 0.5;
    special(x, y * LOG2_E + f * REST + f + e)
}

/// log(1 + x), accurate near 0: the rounding of 1 + x is divided out again (Kahan 1979, HP-15C).
///
/// For x > −1: at most 2.5 ulp. ±0 keeps its sign; −1 gives −∞, below and NaN give NaN; ∞ gives ∞.
pub fn log1p(x: F32) -> F32 {
    let u = 1.0 + x;
    let d = u - 1.0;
    // 1 + x = 1, or nothing left to repair.
    let plain = u.eq(1.0);
    let y = log(u);
    plain.select(x, (u.eq(0.0) | u.eq(f32::INFINITY)).select(y, y * (x / d)))
}

/// e^x − 1, accurate near 0: the rounding of e^x is divided out again (Kahan).
///
/// For every float: at most 2.5 ulp. ±0 keeps its sign; −1 where e^x vanishes; ∞ gives ∞, NaN gives NaN.
pub fn exp_m1(x: F32) -> F32 {
    let u = exp(x);
    let d = u - 1.0;
    let repaired = d * (x / log(u));
    // Nothing left to repair: e^x = 1, or so far from 1 that the difference is exact enough.
    u.eq(1.0).select(x, x.abs().gt(1.0).select(d, repaired))
}

/// x^y for x ≥ 0: exp2(y log2 x) with the logarithm and the product in two floats each.
///
/// At most 1.4 ulp, denormal results included. x^0 = 1^y = 1 for every x and y; 0^y = 0 or ∞ by the sign of y; other NaN,
/// and negative x, give NaN. There are no integer powers of negative numbers: no component asks for them.
pub fn pow(x: F32, y: F32) -> F32 {
    let (hi, lo) = log2_two(x);
    let (p, error) = product(y, hi);
    let rest = error + y * lo;
    let n = p.max(-200.0).min(200.0).round();
    let value = scale(exp2_series((p - n) + rest), n.to_i32());
    let value = p.gt(128.5).select(f32::INFINITY.into(), p.lt(-151.0).select(0.0.into(), value));
    // 0, infinities and numbers where the two-float product would overflow.
    let edge = y * log2(x);
    let extreme = x.eq(0.0) | x.eq(f32::INFINITY) | y.abs().gt(1e30);
    let value = extreme.select(exp2(edge), value);
    let value = (x.lt(0.0) | x.is_nan() | y.is_nan()).select(f32::NAN.into(), value);
    (y.eq(0.0) | x.eq(1.0)).select(1.0.into(), value)
}

/// log2 x as a sum of two floats, about 2^-40 relative: with s = f / (2 + f), log2 m = 2 log2 e · artanh s, and the terms in s
/// and in s³ are products of two floats each.
fn log2_two(x: F32) -> (F32, F32) {
    /// 2 log2 e in two parts.
    const K: [f32; 2] = [2.885_39, 3.851_926e-8];
    /// A third of it.
    const K_3: [f32; 2] = [0.961_796_7, -7.028_462e-9];
    let (e, f) = split(x);
    let t = f + 2.0;
    let t_lo = f - (t - 2.0);
    let s = f / t;
    let (st, st_lo) = product(s, t);
    let s_lo = (f - st - st_lo - s * t_lo) / t;
    let (z, z_lo) = product(s, s);
    let (cube, cube_lo) = product(z, s);
    let (head, head_lo) = product(s, K[0].into());
    let (next, next_lo) = product(cube, K_3[0].into());
    // Fitted to (2 log2 e · artanh s − head − next) / s⁵ for |s| ≤ (√2 − 1)/(√2 + 1): off by 2e-11 of the logarithm at most.
    let tail = horner(z, &[0.337_858_65, 0.411_848_07, 0.577_080_2]) * z * cube;
    // Of two summands the first is 0 or the larger, so each sum's error is exact (Dekker 1971).
    let sum = |a: F32, b: F32| (a + b, b - ((a + b) - a));
    let (hi, hi_lo) = sum(e, head);
    let (hi, next_off) = sum(hi, next);
    let small = head_lo
        + s * K[1]
        + s_lo * K[0]
        + next_lo
        + cube * K_3[1]
        + (z_lo * s + 3.0 * z * s_lo) * K_3[0]
        + cube_lo * K_3[0];
    sum(hi, hi_lo + next_off + (tail + small))
}

/// a · b as rounded product and its exact error, without a fused operation (Dekker 1971).
fn product(a: F32, b: F32) -> (F32, F32) {
    let halves = |x: F32| {
        let hi = (x.bits() & 0xffff_f000u32).float_of_bits();
        (hi, x - hi)
    };
    let ((ah, al), (bh, bl), p) = (halves(a), halves(b), a * b);
    (p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
}
