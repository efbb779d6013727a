//! The core's functions against f64. A function of literals folds to a literal, so no engine is needed.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use jerboa_ir::Lit;
use jerboa_ir::lang::{F32, build};
use jerboa_lib_render::core::fresnel::fresnel_dielectric;
use jerboa_lib_render::core::math::*;
use jerboa_lib_render::core::microfacet::ggx_d;
use jerboa_lib_render::core::onb::onb;
use jerboa_lib_render::core::sampling::*;
use jerboa_lib_render::core::vec::{Vec3, vec2, vec3};

/// f at each pair of arguments.
fn fold(args: &[(f32, f32)], f: impl Fn(F32, F32) -> F32) -> Vec<f32> {
    args.chunks(1000).flat_map(|args| fold_few(args, &f)).collect()
}

fn fold_few(args: &[(f32, f32)], f: impl Fn(F32, F32) -> F32) -> Vec<f32> {
    let mut nodes = vec![];
    let program = build(|| nodes = args.iter().map(|(x, y)| f((*x).into(), (*y).into()).node()).collect());
    let value = |n| match program.as_lit(n) {
        Some(Lit::F32(bits)) => f32::from_bits(bits),
        other => panic!("not a float: {other:?}"),
    };
    nodes.into_iter().map(value).collect()
}

/// f at each argument.
fn fold1(args: &[f32], f: impl Fn(F32) -> F32) -> Vec<f32> {
    let pairs: Vec<(f32, f32)> = args.iter().map(|x| (*x, 0.0)).collect();
    fold(&pairs, |x, _| f(x))
}

/// Distance from the truth in units of the spacing of floats there.
fn ulps(got: f32, truth: f64) -> f64 {
    let t = truth as f32;
    if got.to_bits() == t.to_bits() || (got.is_nan() && t.is_nan()) {
        return 0.0;
    }
    let exponent = (truth.abs().log2().floor() as i32).max(-126);
    (f64::from(got) - truth).abs() / 2f64.powi(exponent - 23)
}

/// n numbers from a to b, evenly spread and off the grid.
fn spread(n: usize, a: f64, b: f64) -> Vec<f32> {
    (0..n).map(|i| (a + (b - a) * ((i as f64 + 0.3819) / n as f64)) as f32).collect()
}

/// Positive floats with evenly spread bit patterns, denormals included.
fn positive_floats(n: u32) -> Vec<f32> {
    let step = f32::INFINITY.to_bits() / n;
    (0..n).map(|i| f32::from_bits(1 + i * step + (i * 7919) % step)).filter(|x| x.is_finite()).collect()
}

/// Largest error of f over the arguments, in ulp, with the argument where it is.
#[track_caller]
fn check(name: &str, args: &[f32], f: impl Fn(F32) -> F32, truth: impl Fn(f64) -> f64, bound: f64) {
    let pairs: Vec<(f32, f32)> = args.iter().map(|x| (*x, 0.0)).collect();
    check2(name, &pairs, |x, _| f(x), |x, _| truth(x), bound);
}

/// As [`check`], with two arguments.
#[track_caller]
fn check2(name: &str, args: &[(f32, f32)], f: impl Fn(F32, F32) -> F32, truth: impl Fn(f64, f64) -> f64, bound: f64) {
    let error = |(got, (x, y)): (f32, &(f32, f32))| (ulps(got, truth((*x).into(), (*y).into())), *x, *y);
    let errors = fold(args, f).into_iter().zip(args).map(error);
    let (worst, x, y) = errors.fold((0.0, 0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a });
    println!("{name}: {worst:.3} ulp at ({x:e}, {y:e})");
    assert!(worst <= bound, "{name}: {worst} ulp at ({x:e}, {y:e})");
}

#[test]
fn sine_and_cosine() {
    let xs = spread(20_000, -2000.0 * std::f64::consts::PI, 2000.0 * std::f64::consts::PI);
    let near = spread(5_000, -7.0, 7.0);
    let worst = |xs: &[f32], got: Vec<f32>, truth: &dyn Fn(f64) -> f64| {
        xs.iter().zip(got).map(|(x, y)| (truth((*x).into()) - f64::from(y)).abs()).fold(0.0, f64::max)
    };
    for xs in [&xs, &near] {
        let sin = worst(xs, fold1(xs, |x| sincos(x).0), &f64::sin);
        let cos = worst(xs, fold1(xs, |x| sincos(x).1), &f64::cos);
        println!("sincos: {sin:e} {cos:e}");
        assert!(sin.max(cos) <= 7.3e-8, "{sin:e} {cos:e}");
    }
    let us = spread(20_000, -1.0, 1.0);
    let tau = std::f64::consts::TAU;
    let sin = worst(&us, fold1(&us, |x| sincos_turns(x).0), &|u| (tau * u).sin());
    let cos = worst(&us, fold1(&us, |x| sincos_turns(x).1), &|u| (tau * u).cos());
    println!("sincos_turns: {sin:e} {cos:e}");
    assert!(sin.max(cos) <= 8.7e-8, "{sin:e} {cos:e}");
    assert_eq!(fold1(&[0.0, 0.25, 0.5, 0.75], |u| sincos_turns(u).0), [0.0, 1.0, 0.0, -1.0]);
    assert_eq!(fold1(&[0.0, 0.25, 0.5, 0.75], |u| sincos_turns(u).1), [1.0, 0.0, -1.0, 0.0]);
    assert!(fold1(&[f32::INFINITY, f32::NAN], |x| sincos(x).0).iter().all(|y| y.is_nan()));
}

#[test]
fn inverse_functions() {
    let xs = spread(20_000, -1.0, 1.0);
    check("asin", &xs, asin, f64::asin, 2.3);
    check("acos", &xs, acos, f64::acos, 1.2);
    assert_eq!(fold1(&[-1.0, 0.0, 1.0], acos), [PI, FRAC_PI_2, 0.0]);
    assert!(fold1(&[1.000_000_1, -2.0, f32::NAN], acos).iter().all(|y| y.is_nan()));
    let mantissa = spread(150, 1.0, 2.0);
    let magnitudes = |i: usize| mantissa[i % 150] * 10f32.powi((i * 7 % 61) as i32 - 30);
    let pairs: Vec<(f32, f32)> = (0..20_000)
        .map(|i| (magnitudes(i) * [1.0, -1.0][i % 2], magnitudes(i / 150 + i * 13) * [1.0, -1.0][i / 2 % 2]))
        .filter(|(y, x)| (y / x).abs() > f32::MIN_POSITIVE)
        .collect();
    check2("atan2", &pairs, atan2, f64::atan2, 2.7);
    let circle: Vec<(f32, f32)> = spread(20_000, -3.2, 3.2).iter().map(|a| (a.sin(), a.cos())).collect();
    check2("atan2 on the circle", &circle, atan2, f64::atan2, 2.7);
    let inf = f32::INFINITY;
    let special =
        [(0.0, 1.0), (-0.0, 1.0), (0.0, -1.0), (-0.0, -0.0), (1.0, 0.0), (inf, inf), (1.0, -inf), (-inf, 1.0)];
    let expected = [0.0, -0.0, PI, -PI, FRAC_PI_2, FRAC_PI_4, PI, -FRAC_PI_2];
    let got = fold(&special, atan2);
    assert_eq!(got.iter().map(|x| x.to_bits()).collect::<Vec<_>>(), expected.map(f32::to_bits), "{got:?}");
}

#[test]
fn exponentials() {
    check("exp", &spread(20_000, -87.0, 88.0), exp, f64::exp, 0.91);
    check("exp near 0", &spread(5_000, -1.0, 1.0), exp, f64::exp, 0.91);
    check("exp, denormal", &spread(2_000, -103.0, -87.4), exp, f64::exp, 1.0);
    check("exp2", &spread(20_000, -126.0, 127.99), exp2, f64::exp2, 1.14);
    let small = spread(10_000, 0.1, 1.0);
    let near: Vec<f32> = small.iter().flat_map(|x| [1e-9, -1e-4, 0.03, -1.0, 1.1, -86.0].map(|k| x * k)).collect();
    check("exp_m1", &near, exp_m1, f64::exp_m1, 2.2);
    let inf = f32::INFINITY;
    assert_eq!(fold1(&[0.0, -104.0, inf, 1e-30], exp_m1), [0.0, -1.0, inf, 1e-30]);
    assert_eq!(fold1(&[0.0, -0.0, inf, -inf, 89.0, -104.0], exp), [1.0, 1.0, inf, 0.0, inf, 0.0]);
    assert_eq!(fold1(&[3.0, -126.0, -149.0, 128.0, -151.0], exp2), [8.0, f32::MIN_POSITIVE, 1e-45, inf, 0.0]);
    assert!(fold1(&[f32::NAN], exp)[0].is_nan() && fold1(&[f32::NAN], exp2)[0].is_nan());
}

#[test]
fn logarithms() {
    let xs = positive_floats(20_000);
    let near = spread(10_000, 0.5, 2.0);
    for (where_, xs) in [("", &xs), (" near 1", &near)] {
        check(&format!("log{where_}"), xs, log, f64::ln, 0.75);
        check(&format!("log2{where_}"), xs, log2, f64::log2, 1.32);
    }
    let small: Vec<f32> = near.iter().flat_map(|x| [1e-9, 1e-4, 1e-2, 0.49, 1e6].map(|k| (x - 0.97) * k)).collect();
    check("log1p", &small, log1p, f64::ln_1p, 2.2);
    let inf = f32::INFINITY;
    assert_eq!(fold1(&[0.0, -0.0, 1.0, inf], log), [-inf, -inf, 0.0, inf]);
    assert_eq!(fold1(&[0.0, 1.0, 8.0, 1e-45, inf], log2), [-inf, 0.0, 3.0, -149.0, inf]);
    assert_eq!(fold1(&[-1.0, 0.0, 1e-20, inf], log1p), [-inf, 0.0, 1e-20, inf]);
    assert!(fold1(&[-1.0, f32::NAN], log).iter().all(|y| y.is_nan()) && fold1(&[-1.5], log1p)[0].is_nan());
}

#[test]
fn powers() {
    let bases = positive_floats(401);
    let pairs: Vec<(f32, f32)> = bases
        .iter()
        .flat_map(|x| spread(50, -125.9, 125.9).into_iter().map(|p| (*x, (f64::from(p) / f64::from(*x).log2()) as f32)))
        .filter(|(x, y)| y.abs() < 1e30 && (f64::from(*y) * f64::from(*x).log2()).abs() < 126.0)
        .collect();
    check2("pow", &pairs, pow, f64::powf, 1.7);
    let near: Vec<(f32, f32)> = spread(300, 0.9, 1.1)
        .into_iter()
        .flat_map(|x| spread(50, -800.0, 800.0).into_iter().map(move |y| (x, y)))
        .collect();
    check2("pow near 1", &near, pow, f64::powf, 1.7);
    let (inf, nan) = (f32::INFINITY, f32::NAN);
    let special = [
        (0.0, 0.0),
        (nan, 0.0),
        (0.0, 2.0),
        (0.0, -2.0),
        (inf, 2.0),
        (inf, -2.0),
        (2.0, inf),
        (2.0, -inf),
        (1.0, 1e38),
    ];
    assert_eq!(fold(&special, pow), [1.0, 1.0, 0.0, inf, inf, 0.0, inf, 0.0, 1.0]);
    assert!(fold(&[(-1.0, 2.0), (nan, 1.0), (2.0, nan)], pow).iter().all(|y| y.is_nan()));
}

/// T12: exact reflectance, f64 by the two polarisations.
#[test]
fn fresnel() {
    let truth = |cos: f64, eta: f64| {
        let sin2 = (1.0 - cos * cos) / (eta * eta);
        if sin2 >= 1.0 {
            return 1.0;
        }
        let t = (1.0 - sin2).sqrt();
        let (s, p) = ((cos - eta * t) / (cos + eta * t), (eta * cos - t) / (eta * cos + t));
        (s * s + p * p) / 2.0
    };
    let mut cosines = spread(5_000, 0.0, 1.0);
    cosines.extend((0..60).map(|i| 10f32.powf(-7.0 + 0.1 * i as f32)));
    for eta in [1.5f32, 1.0 / 1.5, 1.33, 2.4, 0.9, 1.001] {
        let critical = (1.0 - f64::from(eta).powi(2)).max(0.0).sqrt();
        let near = (0..50).map(|i| (critical * (1.0 + 1e-9 * 1.5f64.powi(i))).min(1.0) as f32);
        let cosines: Vec<f32> = cosines.iter().copied().chain(near).collect();
        let pairs: Vec<(f32, f32)> = cosines.iter().map(|c| (*c, eta)).collect();
        for ((cos, _), r) in pairs.iter().zip(fold(&pairs, fresnel_dielectric)) {
            let expected = truth((*cos).into(), eta.into());
            let bound = (1.5e-7 / (f64::from(*cos) - critical).abs().sqrt()).max(5e-7);
            assert!((0.0..=1.0).contains(&r), "eta {eta}, cos {cos}: {r}");
            assert!((f64::from(r) - expected).abs() <= bound, "eta {eta}, cos {cos:e}: {r}, not {expected}");
        }
    }
    assert!(
        fold(&cosines.iter().map(|c| (*c, 1.0)).collect::<Vec<_>>(), fresnel_dielectric).iter().all(|r| *r <= 1e-7)
    );
    let third = 1.0 / 1.5;
    let table = [
        (1.0, 1.5),
        (0.5, 1.5),
        (0.1, 1.5),
        (0.01, 1.5),
        (1e-4, 1.5),
        (1.0, third),
        (0.9, third),
        (0.75, third),
        (0.5, third),
    ];
    let expected = [0.04, 0.089_186_71, 0.571_592_5, 0.943_752_5, 0.999_418_8, 0.04, 0.046_332_65, 0.5, 1.0];
    for (got, expected) in fold(&table, fresnel_dielectric).iter().zip(expected) {
        assert!((got - expected).abs() <= 1e-6, "{got}, not {expected}");
    }
    // Everything is reflected by an index of 0.
    assert_eq!(fold(&[(0.7, 0.0), (1.0, 0.0)], fresnel_dielectric), [1.0, 1.0]);
}

/// N7: orthonormal for every normal, −z and its neighbours included.
#[test]
fn frames() {
    let mut normals: Vec<[f32; 3]> = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [-0.0, 0.0, -1.0]];
    for (i, z) in spread(500, -1.0, 1.0).into_iter().enumerate() {
        let (s, phi) = ((1.0 - z * z).max(0.0).sqrt(), i as f32 * 2.4);
        normals.push([s * phi.cos(), s * phi.sin(), z]);
        let t = 1e-4 * z;
        normals.push([t * phi.cos(), t * phi.sin(), -(1.0 - t * t).sqrt()]);
    }
    for [x, y, z] in normals {
        let part = |pick: fn(Vec3, Vec3) -> F32| {
            f64::from(
                fold1(&[0.0], |_| {
                    let (s, t) = onb(vec3(x, y, z));
                    pick(s, t)
                })[0],
            )
        };
        let s = [part(|s, _| s.x), part(|s, _| s.y), part(|s, _| s.z)];
        let t = [part(|_, t| t.x), part(|_, t| t.y), part(|_, t| t.z)];
        let n = [x, y, z].map(f64::from);
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let length = dot(n, n);
        let worst = [dot(s, t), dot(s, n), dot(t, n), dot(s, s) - length, dot(t, t) - length].map(f64::abs);
        assert!(worst.iter().all(|e| *e < 4e-7), "[{x}, {y}, {z}]: {worst:?}");
        let handed = dot([s[1] * t[2] - s[2] * t[1], s[2] * t[0] - s[0] * t[2], s[0] * t[1] - s[1] * t[0]], n);
        assert!((handed - 1.0).abs() < 1e-6);
    }
}

/// N4: the distribution of normals down to the smallest rough α.
#[test]
fn ggx() {
    for alpha in [1e-3f32, 0.01, 0.1, 0.5, 1.0] {
        for tan in [0.0f32, 0.1, 0.7, 1.0, 3.0, 30.0] {
            let t = f64::from(tan * alpha);
            let (x, z) = ((t / (1.0 + t * t).sqrt()) as f32, (1.0 / (1.0 + t * t).sqrt()) as f32);
            let got = fold1(&[x], |x| ggx_d(vec3(x * 0.6, x * 0.8, z), alpha.into()))[0];
            let (a2, x2, z2) = (f64::from(alpha).powi(2), f64::from(x).powi(2), f64::from(z).powi(2));
            let expected = 1.0 / (std::f64::consts::PI * a2 * (x2 / a2 + z2).powi(2));
            assert!((f64::from(got) / expected - 1.0).abs() < 1e-6, "α {alpha}, tan {tan} α: {got}, not {expected}");
        }
    }
}

/// Warps stay in their shapes and are centred.
#[test]
fn warps() {
    let us: Vec<(f32, f32)> = (0..4096).map(|i| ((i % 64) as f32 / 64.0, (i / 64) as f32 / 64.0)).collect();
    let inside = |f: fn(F32, F32) -> F32, lo: f32, hi: f32, mean: f32| {
        let values = fold(&us, f);
        assert!(values.iter().all(|x| (lo..=hi).contains(x)));
        let got = values.iter().sum::<f32>() / values.len() as f32;
        assert!((got - mean).abs() < 0.02, "{got}, not {mean}");
    };
    inside(
        |u, v| {
            let d = concentric_disk(vec2(u, v));
            d.x * d.x + d.y * d.y
        },
        0.0,
        1.000_001,
        0.5,
    );
    inside(|u, v| cosine_hemisphere(vec2(u, v)).z, 0.0, 1.0, 2.0 / 3.0);
    inside(|u, v| uniform_triangle(vec2(u, v)).x, 0.0, 1.0, 1.0 / 3.0);
    inside(
        |u, v| {
            let w = uniform_triangle(vec2(u, v));
            w.x + w.y
        },
        0.0,
        1.0,
        2.0 / 3.0,
    );
    inside(|u, v| uniform_sphere(vec2(u, v)).z, -1.0, 1.0, 0.0);
    inside(|u, v| uniform_sphere(vec2(u, v)).length2(), 0.999_999, 1.000_001, 1.0);
    inside(|u, v| 1.0 - uniform_cone(vec2(u, v), 0.1.into()).z, 0.0, 0.100_001, 0.05);
}
