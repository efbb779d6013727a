//! T6, N25: `sample`, `pdf` and `eval` are one model, and it keeps to its side of the surface.

use jerboa_lib_render::schema::Materials;

use jerboa_tests::harness::bench::{Random, number};
use jerboa_tests::harness::probe::{Probe, V, at_cos, dot, random_direction};
use jerboa_tests::harness::scattering::{fresnel, rows};

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

/// T6: what `sample` says is what `pdf` and `eval` say, and nothing is infinite or negative.
#[test]
fn sample_pdf_and_eval_are_one_model() {
    let mut random = Random::new(0x51);
    let mut probe = Probe::default();
    for row in rows() {
        (row.make)(&mut probe);
        let name = &row.name;
        for consistent in [false, true] {
            probe.consistent(consistent);
            for key in 0..number("JERBOA_PAIRS", 1000) as u32 {
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
                let (f, pdf, only_specular) = probe.eval(random_direction(&mut random), wo);
                assert!(
                    f.iter().all(|x| *x >= 0.0 && x.is_finite()) && pdf >= 0.0 && pdf.is_finite(),
                    "{name}: {f:?} {pdf}"
                );
                assert!(pdf > 0.0 || f == [0.0; 3], "{name}: {f:?} is never sampled");
                assert!(!only_specular || (pdf == 0.0 && (s.is_specular || s.weight == [0.0; 3])), "{name}: {s:?}");
                let black = s.weight == [0.0; 3];
                assert!(black || (dot(s.wi, s.wi) - 1.0).abs() < 2e-6, "{name}: {s:?}");
                if s.is_specular || black {
                    continue;
                }
                assert_eq!(s.pdf, s.pdf_there, "{name}: {s:?}");
                let cos = dot(s.wi, probe.shading_normal()).abs();
                for (w, f) in s.weight.iter().zip(s.f_there) {
                    let scale = cos / f64::from(s.pdf);
                    let expected = f64::from(f) * scale;
                    // The cosine is a rounded scalar product: near grazing it has few digits. So have the smallest floats: four of
                    // their steps are allowed, of f and of the weight.
                    let tolerance = (1e-5 + 3e-7 / cos) * expected + 4.0 * f64::from(f32::from_bits(1)) * (1.0 + scale);
                    assert!((f64::from(*w) - expected).abs() <= tolerance, "{name}: {s:?} expects {expected}");
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
    for row in rows() {
        (row.make)(&mut probe);
        let name = &row.name;
        probe.consistent(true);
        for key in 0..number("JERBOA_PAIRS", 1000) as u32 {
            probe.normal = random_direction(&mut random);
            probe.face = near(&mut random, probe.normal);
            let (wo, wi) = (random_direction(&mut random), random_direction(&mut random));
            let s = probe.sample(wo, key);
            let same = dot(s.wi, probe.face) * dot(wo, probe.face) > 0.0;
            assert!(row.passes || same || s.weight == [0.0; 3], "{name}: {s:?}");
            if name == "metal 0.000" && dot(wo, probe.face).abs() > 1e-6 {
                assert!(same && s.weight == [1.0; 3], "{s:?}");
            }
            let f = probe.eval(wi, wo).0;
            let same = dot(wi, probe.face) * dot(wo, probe.face) > 0.0;
            assert!(row.passes || same || f == [0.0; 3], "{name}: {f:?}");
        }
    }
}
