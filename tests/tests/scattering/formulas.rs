//! N4, N6, N7: formulas that keep their digits where the usual ones lose them.

use std::f64::consts::{PI, TAU};

use jerboa_ir::lang::{F32, Fun, entry};
use jerboa_lib_render::bsdf::frame::frame_along;
use jerboa_lib_render::core::microfacet::{Widths, ggx_d};
use jerboa_lib_render::core::onb::onb;
use jerboa_lib_render::core::vec::Vec3;
use jerboa_lib_render::schema::Materials;

use jerboa_tests::harness::bench::{Bench, Random, number};
use jerboa_tests::harness::probe::{Probe, V, at_cos, dot, normalize, random_direction};

/// N4: the distribution of normals for every width. (By the cosine alone: off by 0.1 % at α = 0.01, by 12 % at 0.001.)
#[test]
fn narrow_distributions_keep_their_digits() {
    let mut random = Random::new(0x4);
    let mut bench = Bench::new(|| entry("d", Fun::lam(|_, (h, alpha): (Vec3, F32)| ggx_d(h, Widths::round(alpha)))));
    let mut worst = 0.0_f64;
    for alpha in [1e-5f32, 1e-4, 1e-3, 1e-2, 0.05, 0.1, 0.5, 1.0] {
        for _ in 0..number("JERBOA_PAIRS", 1000) {
            // A normal as likely as this width makes it.
            let (u, phi) = (random.uniform(), TAU * random.uniform());
            let tan = f64::from(alpha) * (u / (1.0 - u)).sqrt();
            let h = normalize([tan * phi.cos(), tan * phi.sin(), 1.0]);
            let [x, y, z] = h.map(f64::from);
            let (a2, sin2, cos2) = (f64::from(alpha).powi(2), x * x + y * y, z * z / dot(h, h));
            let expected = 1.0 / (PI * a2 * (cos2 * (1.0 + sin2 / (z * z) / a2)).powi(2));
            let d = f64::from(bench.run_floats("d", &[h[0], h[1], h[2], alpha])[0]);
            worst = worst.max((d / expected - 1.0).abs());
        }
    }
    println!("largest error {worst:.2e}");
    assert!(worst < 1e-6, "{worst}");
}

/// N6: the lobe is exact for large exponents.
#[test]
fn phong_is_exact_for_large_exponents() {
    let mut probe = Probe::default();
    for ns in [10.0f32, 100.0, 1e4, 1e6] {
        probe.phong(ns).number(Materials::BASE_R, 0.0).number(Materials::BASE_G, 0.0).number(Materials::BASE_B, 0.0);
        let wo = at_cos(0.6);
        let axis = [-wo[0], -wo[1], wo[2]].map(f64::from);
        for k in [0.1, 0.5, 1.0, 2.0] {
            let tilt = k / f64::from(ns).sqrt();
            let wi = normalize([axis[0], axis[1], axis[2] + tilt]);
            let f = f64::from(probe.eval(wi, wo).0[0]);
            let w = wi.map(f64::from);
            let d2: f64 = (0..3).map(|i| (w[i] - axis[i]).powi(2)).sum();
            let expected = (f64::from(ns) + 2.0) / TAU * (f64::from(ns) * (-d2 / 2.0).ln_1p()).exp();
            assert!((f / expected - 1.0).abs() < 1e-5, "ns {ns}, {k}: {f}, not {expected}");
        }
    }
}

/// How far three directions are from orthonormal, where the last one is taken for unit.
fn defect(t: V, b: V, n: V) -> f64 {
    let faults = [dot(t, t) - 1.0, dot(b, b) - 1.0, dot(t, b), dot(t, n), dot(b, n)];
    faults.iter().fold(0.0, |m: f64, x| m.max(x.abs()))
}

/// N7: a frame around every direction. (Frisvad's breaks near −z, where 1/(1 + z) overflows.)
#[test]
fn frames_are_orthonormal_around_every_direction() {
    let mut random = Random::new(0x7);
    let mut bench = Bench::new(|| entry("onb", Fun::lam(|_, n: Vec3| onb(n))));
    let near_poles = (0..60).flat_map(|k| {
        let off = 0.5f64.powi(k);
        [1.0, -1.0].into_iter().flat_map(move |z| [[off, 0.0, z], [0.0, -off, z], [off, off, z]]).map(normalize)
    });
    let axes =
        [0, 1, 2].into_iter().flat_map(|i| [1.0, -1.0].map(|x| std::array::from_fn(|j| if i == j { x } else { 0.0 })));
    let others: Vec<V> = (0..number("JERBOA_PAIRS", 1000)).map(|_| random_direction(&mut random)).collect();
    let mut worst = 0.0_f64;
    for n in near_poles.chain(axes).chain([[0.0, 0.0, -1.0], [-0.0, -0.0, -1.0]]).chain(others) {
        let f = bench.run_floats("onb", &n);
        let (t, b) = ([f[0], f[1], f[2]], [f[3], f[4], f[5]]);
        let largest = defect(t, b, n);
        assert!(largest < 4e-7, "{n:?}: {t:?} {b:?}");
        worst = worst.max(largest);
        // Right-handed: t × b = n.
        let turn = f64::from(t[0]) * f64::from(b[1]) - f64::from(t[1]) * f64::from(b[0]);
        assert!((turn - f64::from(n[2])).abs() < 4e-7, "{n:?}");
    }
    println!("largest error {worst:.2e}");
}

/// A frame along a direction that is nearly the normal: what is across the normal is short, and what rounding left along it large
/// beside it. (Taken away once, the tangent is 2e-6 off at an angle of 0.04, and 0.1 at 1e-6.)
#[test]
fn frames_along_a_direction_are_orthonormal_however_near_it_is_to_the_normal() {
    let mut random = Random::new(0x71);
    let mut bench = Bench::new(|| entry("frame", Fun::lam(|_, (n, along): (Vec3, Vec3)| frame_along(n, along))));
    let mut worst = 0.0_f64;
    for angle in (0..24).map(|k| 0.5_f64.powi(k)) {
        for _ in 0..number("JERBOA_PAIRS", 1000) / 10 {
            let (n, aside) = (random_direction(&mut random), random_direction(&mut random));
            let along = normalize([0, 1, 2].map(|i| f64::from(n[i]) + angle * f64::from(aside[i])));
            let f = bench.run_floats("frame", &[n, along].concat());
            let (t, b) = ([f[0], f[1], f[2]], [f[3], f[4], f[5]]);
            let largest = defect(t, b, n);
            assert!(largest < 5e-7, "{angle}: {n:?} {along:?}: {t:?} {b:?}");
            worst = worst.max(largest);
            // The direction lies in the plane of tangent and normal; 1e-6 is where there is none across any more.
            assert!(dot(b, along).abs() < 1.2e-6, "{angle}: {n:?} {along:?}: {t:?} {b:?}");
        }
    }
    println!("largest error {worst:.2e}");
}
