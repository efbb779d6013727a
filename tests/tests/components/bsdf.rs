//! Scattering: values, energy, reciprocity, and that `sample`, `pdf` and `eval` are one model (T5 to T8, T12, N25).
//! `JERBOA_PAIRS=N` asks each material N times instead of 1,500 in T6 and N25.

use std::f64::consts::{PI, TAU};

use jerboa_lib_render::schema::Materials;

use jerboa_tests::harness::bench::{Random, number};
use jerboa_tests::harness::probe::{Probe, V, at_cos, dot, normalize, random_direction};

/// A material by name.
type Named = (&'static str, fn(&mut Probe) -> &mut Probe);

/// One of each kind.
const ZOO: [Named; 15] = [
    ("lambert", |p| p.lambert()),
    ("mirror", |p| p.metal(0.0)),
    ("metal .04", |p| p.metal(0.04)),
    ("metal .5", |p| p.metal(0.5)),
    ("plastic .3", |p| p.plastic(0.3)),
    ("plastic 0", |p| p.plastic(0.0)),
    ("glass 0", |p| p.glass(0.0, false)),
    ("glass .4", |p| p.glass(0.4, false)),
    ("thin 0", |p| p.glass(0.0, true)),
    ("thin .4", |p| p.glass(0.4, true)),
    ("medley .5", |p| p.medley(0.5)),
    ("medley 0", |p| p.medley(0.0)),
    ("phong 20", |p| p.phong(20.0)),
    ("phong 1e4", |p| p.phong(1e4)),
    ("phong 2e6", |p| p.phong(2e6)),
];

#[test]
fn lambert_is_exact_and_two_sided() {
    let mut probe = Probe::default();
    probe.lambert();
    let f = [0.8f32, 0.5, 0.2].map(|a| a * std::f32::consts::FRAC_1_PI);
    let (up, down) = (at_cos(0.6), at_cos(-0.3));
    for consistent in [false, true] {
        probe.consistent(consistent);
        assert_eq!(probe.eval(up, up), (f, 0.6 * std::f32::consts::FRAC_1_PI, false));
        assert_eq!(probe.eval(down, down).0, f);
        assert_eq!(probe.eval(up, down).0, [0.0; 3]);
        for key in 0..100 {
            assert_eq!(probe.sample(down, key).weight, [0.8, 0.5, 0.2]);
        }
    }
}

#[test]
fn mirrors_and_glass_follow_the_semantics() {
    let mut probe = Probe::default();
    for consistent in [false, true] {
        let mirror = probe.metal(0.0);
        let s = mirror.consistent(consistent).sample(at_cos(0.3), 1);
        assert_eq!((s.weight, s.is_specular, s.scale), ([1.0; 3], true, 1.0));
        let expected = at_cos(0.3);
        assert!((s.wi[0] + expected[0]).abs() < 1e-7 && (s.wi[2] - expected[2]).abs() < 1e-7, "{s:?}");
        assert!(mirror.eval(at_cos(0.3), at_cos(0.3)).2);
        let glass = probe.glass(0.0, false);
        glass.consistent(consistent);
        for (cos, eta) in [(0.9, 1.5), (0.1, 1.5), (-0.9, 1.0 / 1.5), (-0.75, 1.0 / 1.5), (-0.5, 1.0 / 1.5)] {
            let wo = at_cos(cos);
            let mut reflected = 0;
            for key in 0..4000 {
                let s = glass.sample(wo, key);
                if f64::from(s.wi[2]) * cos > 0.0 {
                    reflected += 1;
                    assert!((s.weight[0] - 1.0).abs() < 1e-6, "{s:?}");
                } else {
                    let sin = |w: V| f64::from(w[0]).hypot(f64::from(w[1]));
                    assert!((sin(s.wi) * eta - sin(wo)).abs() < 1e-6, "Snell: {s:?}");
                    assert!(
                        (f64::from(s.scale) * eta * eta - 1.0).abs() < 1e-6
                            && (s.weight[0] / s.scale - 1.0).abs() < 1e-6
                    );
                }
            }
            let r = fresnel(cos.abs(), eta);
            let share = f64::from(reflected) / 4000.0;
            assert!((share - r).abs() <= 4.0 * (r * (1.0 - r) / 4000.0).sqrt() + 1e-9, "{cos}: {share} is not {r}");
        }
    }
    // An index of 1 is invisible.
    let nothing = probe.glass(0.0, false).number(Materials::IOR, 1.0);
    for wo in [at_cos(1e-3), at_cos(-0.5)] {
        let s = nothing.sample(wo, 3);
        assert!((dot(s.wi, wo) + 1.0).abs() < 1e-6 && s.weight == [1.0; 3], "{s:?}");
    }
}

/// Exact reflectance by its two polarisations, f64.
fn fresnel(cos: f64, eta: f64) -> f64 {
    let sin_t = (1.0 - cos * cos).sqrt() / eta;
    if sin_t >= 1.0 {
        return 1.0;
    }
    let t = (1.0 - sin_t * sin_t).sqrt();
    let (s, p) = ((cos - eta * t) / (cos + eta * t), (eta * cos - t) / (eta * cos + t));
    (s * s + p * p) / 2.0
}

/// T6: what `sample` says is what `pdf` and `eval` say, and nothing is infinite or negative.
#[test]
fn sample_pdf_and_eval_are_one_model() {
    let mut random = Random::new(0x51);
    let mut probe = Probe::default();
    for (name, make) in ZOO {
        make(&mut probe);
        for consistent in [false, true] {
            probe.consistent(consistent);
            for key in 0..number("JERBOA_PAIRS", 1500) as u32 {
                probe.normal = random_direction(&mut random);
                probe.face = if key % 2 == 0 { probe.normal } else { near(&mut random, probe.normal) };
                let wo = random_direction(&mut random);
                if key < 3 {
                    probe.check_engines(wo);
                }
                let s = probe.sample(wo, key);
                let all = [s.wi, s.weight, s.f_there, [s.pdf, s.scale, s.pdf_there]].concat();
                assert!(all.iter().all(|x| x.is_finite()), "{name}: {s:?}");
                assert!(s.weight.iter().chain(&s.f_there).all(|x| *x >= 0.0) && s.pdf_there >= 0.0, "{name}: {s:?}");
                let black = s.weight == [0.0; 3];
                assert!(black || (dot(s.wi, s.wi) - 1.0).abs() < 2e-6, "{name}: {s:?}");
                if s.is_specular || black {
                    continue;
                }
                assert_eq!(s.pdf, s.pdf_there, "{name}: {s:?}");
                let cos = dot(s.wi, probe.normal).abs();
                for (w, f) in s.weight.iter().zip(s.f_there) {
                    let expected = f64::from(f) * cos / f64::from(s.pdf);
                    // The cosine is a rounded scalar product: near grazing it has few digits.
                    let tolerance = 1e-5 + 3e-7 / cos;
                    assert!(
                        (f64::from(*w) - expected).abs() <= tolerance * expected,
                        "{name}: {s:?} expects {expected}"
                    );
                }
            }
        }
    }
}

/// A unit vector up to 80 degrees away.
fn near(random: &mut Random, n: V) -> V {
    loop {
        let d = random_direction(random);
        if dot(d, n) > 0.17 {
            return d;
        }
    }
}

/// N25: with consistent normals nothing opaque lets light through, and mirrors lose nothing.
#[test]
fn consistent_normals_do_not_leak() {
    let mut random = Random::new(0x25);
    let mut probe = Probe::default();
    for (name, make) in ZOO {
        make(&mut probe);
        let passes = ["glass", "thin", "medley"].iter().any(|p| name.starts_with(p));
        probe.consistent(true);
        for key in 0..number("JERBOA_PAIRS", 1500) as u32 {
            probe.normal = random_direction(&mut random);
            probe.face = near(&mut random, probe.normal);
            let (wo, wi) = (random_direction(&mut random), random_direction(&mut random));
            let s = probe.sample(wo, key);
            let same = dot(s.wi, probe.face) * dot(wo, probe.face) > 0.0;
            assert!(passes || same || s.weight == [0.0; 3], "{name}: {s:?}");
            if name == "mirror" && dot(wo, probe.face).abs() > 1e-6 {
                assert!(same && s.weight == [1.0; 3], "{s:?}");
            }
            let f = probe.eval(wi, wo).0;
            let same = dot(wi, probe.face) * dot(wo, probe.face) > 0.0;
            assert!(passes || same || f == [0.0; 3], "{name}: {f:?}");
        }
    }
}

/// T8: f(a, b) = f(b, a); across an interface, divided by the square of the index there.
#[test]
fn scattering_is_reciprocal() {
    let mut random = Random::new(0x8);
    let mut probe = Probe::default();
    for (name, make) in ZOO {
        make(&mut probe);
        for _ in 0..1000 {
            let (a, b) = (random_direction(&mut random), random_direction(&mut random));
            let (fab, fba) = (probe.eval(a, b).0, probe.eval(b, a).0);
            let solid = name.starts_with("glass") || name.starts_with("medley");
            let index = |w: V| if solid && w[2] < 0.0 { 1.5f64 * 1.5 } else { 1.0 };
            for (x, y) in fab.iter().zip(fba) {
                let (x, y) = (f64::from(*x) * index(b).recip(), f64::from(y) * index(a).recip());
                // Where nearly all is reflected, 1 − F has few digits (N12).
                let digits = if (a[2] > 0.0) == (b[2] > 0.0) { 1e-9 } else { 1e-6 };
                assert!((x - y).abs() <= 2e-5 * x.max(y) + digits, "{name}: {a:?} {b:?}: {x} {y}");
            }
        }
    }
}

/// Directional albedo of GGX with separable Smith masking and F = 1, by f64 quadrature over normals.
fn ggx_albedo(alpha: f64, mu: f64) -> f64 {
    let g1 = |c: f64| 2.0 * c / (c + (alpha * alpha + (1.0 - alpha * alpha) * c * c).sqrt());
    let (n, sin) = (600, (1.0 - mu * mu).sqrt());
    let cell = |i: i32, j: i32| {
        let (u, phi) = ((f64::from(i) + 0.5) / f64::from(n), PI * (f64::from(j) + 0.5) / f64::from(n));
        let tan2 = alpha * alpha * u / (1.0 - u);
        let hz = (1.0 / (1.0 + tan2)).sqrt();
        let oh = sin * (1.0 - hz * hz).sqrt() * phi.cos() + mu * hz;
        let iz = 2.0 * oh * hz - mu;
        if oh > 0.0 && iz > 0.0 { g1(mu) * g1(iz) * oh / (mu * hz) } else { 0.0 }
    };
    (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).map(|(i, j)| cell(i, j)).sum::<f64>() / f64::from(n * n)
}

/// T7.
#[test]
fn metal_reflects_as_much_as_quadrature_says() {
    // α = 1 at normal incidence is 1 − ln 2 for height-correlated and for separable masking: G1(wo) = 1 there.
    assert!((ggx_albedo(1.0, 1.0) - (1.0 - 2f64.ln())).abs() < 1e-4);
    let mut probe = Probe::default();
    for roughness in [0.3f32, 0.7, 1.0] {
        let metal = probe.metal(roughness);
        for mu in [1.0, 0.7, 0.3, 0.05] {
            let expected = ggx_albedo(f64::from(roughness * roughness), mu);
            let (mean, error) = metal.albedo(at_cos(mu), 10_000);
            assert!(
                (mean - expected).abs() <= 4.0 * error + 2e-4,
                "{roughness} {mu}: {mean} ± {error}, not {expected}"
            );
        }
    }
}

/// T7: nothing gains energy, and a smooth white interface loses none.
#[test]
fn no_material_gains_energy() {
    let mut probe = Probe::default();
    for (name, make) in ZOO {
        make(&mut probe);
        for mu in [1.0, 0.5, 0.1, 0.01, -0.2, -0.9] {
            let (mean, error) = probe.albedo(at_cos(mu), 4000);
            assert!(mean <= 1.0 + 4.0 * error + 1e-6, "{name} at {mu}: {mean} ± {error}");
            if ["mirror", "glass 0", "thin 0"].contains(&name) {
                assert!((mean - 1.0).abs() < 1e-6, "{name} at {mu}: {mean}");
            }
        }
    }
}

/// T5: samples fall as the density says, by χ² over cells of (cos θ, φ); and the density integrates to at most 1.
#[test]
fn samples_follow_the_density() {
    const ROWS: usize = 16;
    const COLUMNS: usize = 16;
    const SAMPLES: u32 = 10_000;
    let cases: [Named; 6] = [
        ("plastic .5", |p| p.plastic(0.5)),
        ("metal .6", |p| p.metal(0.6)),
        ("glass .6", |p| p.glass(0.6, false)),
        ("thin .6", |p| p.glass(0.6, true)),
        ("medley .6", |p| p.medley(0.6)),
        ("phong 10", |p| p.phong(10.0)),
    ];
    let mut probe = Probe::default();
    for (name, make) in cases {
        make(&mut probe);
        for mu in [0.9, 0.2, -0.7] {
            let wo = at_cos(mu);
            let mut seen = vec![0.0; ROWS * COLUMNS];
            for key in 0..SAMPLES {
                let s = probe.sample(wo, key);
                // A failed sample lies in no cell.
                if s.pdf > 0.0 {
                    let row = ((f64::from(s.wi[2]) + 1.0) / 2.0 * ROWS as f64) as usize;
                    let turn = f64::from(s.wi[1]).atan2(f64::from(s.wi[0])).rem_euclid(TAU) / TAU;
                    seen[row.min(ROWS - 1) * COLUMNS + ((turn * COLUMNS as f64) as usize).min(COLUMNS - 1)] += 1.0;
                }
            }
            let sub = 6;
            let mut expected = vec![0.0; ROWS * COLUMNS];
            for i in 0..ROWS * sub {
                for j in 0..COLUMNS * sub {
                    let z = (i as f64 + 0.5) / (ROWS * sub) as f64 * 2.0 - 1.0;
                    let phi = (j as f64 + 0.5) / (COLUMNS * sub) as f64 * TAU;
                    let s = (1.0 - z * z).sqrt();
                    let pdf = f64::from(probe.eval(normalize([s * phi.cos(), s * phi.sin(), z]), wo).1);
                    expected[i / sub * COLUMNS + j / sub] += pdf * 2.0 * TAU / (ROWS * COLUMNS * sub * sub) as f64;
                }
            }
            let total: f64 = expected.iter().sum();
            assert!(total < 1.003, "{name} at {mu}: the density integrates to {total}");
            let (mut chi2, mut cells) = (0.0, 0);
            let (mut rest_seen, mut rest) = (0.0, 0.0);
            for (seen, share) in seen.iter().zip(&expected) {
                let count = share * f64::from(SAMPLES);
                if count < 20.0 {
                    rest_seen += seen;
                    rest += count;
                } else {
                    chi2 += (seen - count) * (seen - count) / count;
                    cells += 1;
                }
            }
            chi2 += (rest_seen - rest) * (rest_seen - rest) / rest.max(20.0);
            // Normal approximation of χ²; 5 deviations leave room for the error of the cells' integrals.
            let limit = f64::from(cells) + 5.0 * (2.0 * f64::from(cells)).sqrt();
            assert!(chi2 < limit, "{name} at {mu}: χ² {chi2} of {cells} cells, total {total}");
        }
    }
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
