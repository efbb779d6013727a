//! T12, N12: Fresnel's factor and Snell's law against f64.

use jerboa_ir::lang::{F32, Fun, entry};
use jerboa_lib_render::bsdf::conductor::fresnel_conductor;
use jerboa_lib_render::bsdf::dielectric::refract;
use jerboa_lib_render::bsdf::plastic::diffuse_transmittance;
use jerboa_lib_render::core::fresnel::{fresnel_dielectric, fresnel_passed, refracted_cos};
use jerboa_lib_render::core::vec::Vec3;
use jerboa_lib_render::schema::Materials;

use jerboa_tests::harness::bench::{Bench, Random, number};
use jerboa_tests::harness::probe::{Probe, at_cos, dot};
use jerboa_tests::harness::quadrature::gauss;
use jerboa_tests::harness::scattering::{fresnel, fresnel_metal};

fn bench() -> Bench {
    Bench::new(|| {
        entry("fresnel", Fun::lam(|_, (cos, eta): (F32, F32)| fresnel_dielectric(cos, eta)));
        entry("passed", Fun::lam(|_, (c, beyond, eta): (F32, F32, F32)| fresnel_passed(c, beyond, eta)));
        entry("metal", Fun::lam(|_, (cos, eta, k): (F32, F32, F32)| fresnel_conductor(cos, eta, k)));
        entry("diffuse", Fun::lam(|_, ior: F32| diffuse_transmittance(ior)));
        entry("cosine", Fun::lam(|_, (cos, eta): (F32, F32)| refracted_cos(cos, eta)));
        entry("refract", Fun::lam(|_, (wo, n, eta): (Vec3, Vec3, F32)| refract(wo, n, eta)));
    })
}

/// Cosine from which on light gets out of the denser medium.
fn critical(eta: f64) -> f64 {
    (1.0 - (eta * eta).min(1.0)).sqrt()
}

/// Indices on both sides of 1: water, glass, diamond, air at another height, and nothing at all.
const INDICES: [f32; 9] = [1.5, 1.0 / 1.5, 1.33, 0.75, 2.42, 1.0 / 2.42, 1.0003, 0.9997, 1.0];

/// How far reflectance may be off at a cosine: what its rounded input costs next to the critical angle. The bound is that of
/// glass; light polarised in the plane of incidence changes faster by 1/η² into a denser medium yet.
fn allowed(cos: f64, eta: f64) -> f64 {
    let steep = (1.0 / (2.25 * eta * eta)).max(1.0);
    5e-7_f64.max(1.5e-7 * steep / (cos - critical(eta)).abs().sqrt())
}

/// Cosines of all kinds for an index: even, tiny, at Brewster's angle, and around the critical one.
fn cosines(eta: f32, random: &mut Random) -> Vec<f32> {
    let count = number("JERBOA_COSINES", 20_000);
    let edge = critical(f64::from(eta));
    let mut cosines = vec![0.0, f32::MIN_POSITIVE, 1e-30, 1e-7, 1e-4, 0.01, 1.0, (1.0 + eta * eta).sqrt().recip()];
    for off in [0.0, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3] {
        cosines.extend([edge - off, edge + off].map(|c| c.clamp(0.0, 1.0) as f32));
    }
    cosines.extend([(edge as f32).next_up().min(1.0), (edge as f32).next_down().max(0.0)]);
    cosines.extend((0..count).map(|i| match i % 4 {
        0 | 1 => random.uniform() as f32,
        2 => (-20.0 * random.uniform()).exp() as f32,
        _ => (edge + (random.uniform() - 0.5) * (-16.0 * random.uniform()).exp()).clamp(0.0, 1.0) as f32,
    }));
    cosines
}

#[test]
fn reflectance_is_exact_to_its_conditioning() {
    let mut random = Random::new(0x12);
    let mut bench = bench();
    let mut worst = (0.0, 0.0);
    for eta in INDICES {
        for cos in cosines(eta, &mut random) {
            let r = f64::from(bench.run_floats("fresnel", &[cos, eta])[0]);
            let expected = fresnel(f64::from(cos), f64::from(eta));
            let allowed = allowed(f64::from(cos), f64::from(eta));
            assert!((0.0..=1.0).contains(&r), "{cos} {eta}: {r}");
            assert!((r - expected).abs() <= allowed, "{cos} {eta}: {r}, not {expected}");
            let error = ((r - expected).abs() / allowed, (r - expected).abs());
            worst = if error.0 > worst.0 { error } else { worst };
            // The usual form reflects everything at grazing angles of an interface that is none.
            assert!(eta != 1.0 || r <= 1e-7, "{cos}: {r}");
        }
    }
    println!("{:.2} of what is allowed, {:.1e}", worst.0, worst.1);
}

/// Relatively, even where next to nothing passes: that is what both cosines are for. From both sides the same.
#[test]
fn what_passes_is_exact() {
    let mut random = Random::new(0x14);
    let mut bench = bench();
    let mut worst = 0.0_f64;
    for eta in INDICES {
        for cos in cosines(eta, &mut random) {
            let (c, e) = (f64::from(cos), f64::from(eta));
            let beyond = (e * e - 1.0 + c * c).max(0.0).sqrt() / e;
            let sides = [[cos, beyond as f32, eta], [beyond as f32, cos, 1.0 / eta]];
            for x in sides.map(|args| f64::from(bench.run_floats("passed", &args)[0])) {
                let expected = if beyond == 0.0 && eta != 1.0 { 0.0 } else { 1.0 - fresnel(c, e) };
                let error = (x - expected).abs();
                // 1 − F itself is known to 1e-15; it goes with the square root of the distance from the critical angle.
                let allowed = 1e-6 * expected + 1e-15;
                assert!(error <= allowed, "{cos} {eta}: {x}, not {expected}");
                worst = worst.max(error / allowed);
            }
        }
    }
    println!("{worst:.2} of what is allowed");
}

#[test]
fn spot_values_are_met() {
    let mut bench = bench();
    // f64, from both polarisations; Brewster's angle reflects half of the other polarisation alone.
    let inside = 1.0 / 1.5;
    let table: [(f64, f64, f64); 11] = [
        (1.5, 1.0, 0.04),
        (1.5, 0.5, 0.089_186_713),
        (1.5, 0.1, 0.571_592_52),
        (1.5, 0.01, 0.943_752_543),
        (1.5, 1e-4, 0.999_418_816),
        (inside, 1.0, 0.04),
        (inside, 0.9, 0.046_332_648),
        (inside, 0.75, 0.5),
        (inside, 0.7454, 0.932_140_569),
        (inside, 0.5, 1.0),
        (1.5, 3.25f64.sqrt().recip(), 0.073_964_497),
    ];
    for (eta, cos, expected) in table {
        assert!((fresnel(cos, eta) - expected).abs() < 2e-9, "{eta} {cos}: {}", fresnel(cos, eta));
        let (c, e) = (cos as f32, eta as f32);
        let (r, expected) = (f64::from(bench.run_floats("fresnel", &[c, e])[0]), fresnel(f64::from(c), f64::from(e)));
        assert!((r - expected).abs() <= allowed(cos, eta), "{eta} {cos}: {r}, not {expected}");
    }
}

/// Metals of the list: of silver's index, and of iron's.
#[test]
fn spot_values_of_metals_are_met() {
    let mut bench = bench();
    let cosines = [1.0, 0.5, 0.1, 0.01, 1e-4];
    let table = [
        ((0.2, 3.0), [0.923_371_6, 0.918_411_1, 0.959_083, 0.995_468_7, 0.999_954_5]),
        ((1.5, 7.0), [0.891_402_7, 0.872_570_9, 0.826_719_2, 0.970_182_8, 0.999_691_6]),
    ];
    for ((eta, k), row) in table {
        for (cos, expected) in cosines.into_iter().zip(row) {
            assert!((fresnel_metal(cos, eta, k) - expected).abs() < 1e-7, "{eta} {k} {cos}");
            let r = f64::from(bench.run_floats("metal", &[cos as f32, eta as f32, k as f32])[0]);
            assert!((r - expected).abs() <= 2e-6, "{eta} {k} {cos}: {r}, not {expected}");
        }
    }
}

/// The models, asked through the shader: what a smooth surface reflects, by the weight of its sample or by how often it does, is
/// Fresnel's factor at that cosine.
#[test]
fn smooth_models_reflect_by_fresnels_factor() {
    let mut probe = Probe::default();
    for (eta, k) in [(0.2, 3.0), (1.5, 7.0), (1.5, 0.0), (0.01, 20.0), (20.0, 20.0), (1.0, 0.0)] {
        probe.model("conductor", &[eta, eta, eta, k, k, k]).roughness(0.0);
        for cos in [1.0, 0.5, 0.1, 0.01, -0.5] {
            let s = probe.sample(at_cos(cos), 7);
            let expected = fresnel_metal(cos.abs(), f64::from(eta), f64::from(k));
            assert!(
                s.is_specular && (f64::from(s.weight[1]) - expected).abs() < 2e-6,
                "{eta} {k} {cos}: {s:?}, {expected}"
            );
        }
    }
    for (name, index) in
        [("dielectric", 1.5), ("dielectric", 1.0), ("dielectric", 3.7), ("thin-glass", 1.5), ("thin-glass", 1.0)]
    {
        probe.model(name, &[]).roughness(0.0).number(Materials::IOR, index);
        for cos in [1.0, 0.5, 0.1, 0.01, -0.9, -0.5] {
            let thin = name == "thin-glass";
            let eta = if cos > 0.0 || thin { f64::from(index) } else { 1.0 / f64::from(index) };
            let r = fresnel(f64::abs(cos), eta);
            let share = if thin { 2.0 * r / (1.0 + r) } else { r };
            let n = 2000;
            let reflected = (0..n).filter(|key| f64::from(probe.sample(at_cos(cos), *key).wi[2]) * cos > 0.0).count();
            let found = reflected as f64 / f64::from(n);
            let error = (share * (1.0 - share) / f64::from(n)).sqrt();
            assert!((found - share).abs() <= 4.0 * error + 1e-9, "{name} {index} {cos}: {found}, not {share}");
        }
    }
}

/// Averages over a diffuse illumination: Walsh's closed form (1926), and what follows from it for the other side.
#[test]
fn cosine_averages_are_met() {
    let mut bench = bench();
    for (eta, expected) in [(1.5f32, 0.091_777_96), (1.0 / 1.5, 0.596_345_76)] {
        let n = number("JERBOA_COSINES", 20_000) as u32;
        let mut sum = 0.0;
        for i in 0..n {
            // Even in the square of the cosine, which is what the cosine weighs.
            let cos = ((f64::from(i) + 0.5) / f64::from(n)).sqrt();
            sum += f64::from(bench.run_floats("fresnel", &[cos as f32, eta])[0]);
        }
        let mean = sum / f64::from(n);
        assert!((mean - expected).abs() < 1e-5, "{eta}: {mean}, not {expected}");
    }
}

/// Metals, good and bad ones, and dielectrics as metals without extinction.
#[test]
fn metals_reflect_as_complex_numbers_say() {
    let mut random = Random::new(0x15);
    let mut bench = bench();
    let mut worst = 0.0_f64;
    for _ in 0..number("JERBOA_COSINES", 20_000) {
        let between = |random: &mut Random, lo: f64, hi: f64| (lo * (hi / lo).powf(random.uniform())) as f32;
        let eta = between(&mut random, 0.01, 20.0);
        let k = if random.below(8) == 0 { 0.0 } else { between(&mut random, 0.01, 20.0) };
        let cos = if random.below(4) == 0 { between(&mut random, 1e-6, 1.0) } else { random.uniform() as f32 };
        // Without extinction the formula is next to total reflection as badly conditioned as that of dielectrics.
        let e = f64::from(eta);
        let edge = if k < 0.05 {
            1.5e-7 * (1.0 / (e * e)).max(1.0) / (f64::from(cos) - critical(e)).abs().sqrt()
        } else {
            0.0
        };
        let r = f64::from(bench.run_floats("metal", &[cos, eta, k])[0]);
        let error = (r - fresnel_metal(f64::from(cos), e, k.into())).abs();
        assert!(error <= 1e-6_f64.max(edge), "{cos} {eta} {k}: {r}, off by {error:.1e}");
        worst = if edge == 0.0 { worst.max(error) } else { worst };
    }
    println!("largest error {worst:.1e}");
}

/// The polynomial for what passes of diffuse light.
#[test]
fn diffuse_light_passes_as_quadrature_says() {
    let mut bench = bench();
    let mut worst = 0.0_f64;
    for i in 0..=200 {
        let ior = 1.0 + 0.01 * i as f32;
        let passed = f64::from(bench.run_floats("diffuse", &[ior])[0]);
        let e = f64::from(ior);
        worst = worst.max((passed - gauss::<64>(0.0, 1.0, |c| (1.0 - fresnel(c, e)) * 2.0 * c)).abs());
    }
    println!("largest error {worst:.1e}");
    assert!(worst < 2e-5, "{worst}");
}

#[test]
fn refraction_follows_snell() {
    let mut random = Random::new(0x13);
    let mut bench = bench();
    let normal = [0.0, 0.0, 1.0];
    for eta in INDICES {
        for cos in cosines(eta, &mut random).into_iter().step_by(10) {
            let wo = at_cos(f64::from(cos));
            let edge = critical(f64::from(eta));
            let bent = f64::from(bench.run_floats("cosine", &[cos, eta])[0]);
            let sin2 = (1.0 - f64::from(cos).powi(2)) / f64::from(eta).powi(2);
            // A square root of what is left of 1: conditioned like Fresnel's factor.
            let allowed = allowed(f64::from(cos), f64::from(eta));
            assert!((bent - (1.0 - sin2).max(0.0).sqrt()).abs() <= allowed, "{cos} {eta}: {bent}");
            if f64::from(cos) <= edge {
                continue;
            }
            let args = [wo[0], wo[1], wo[2], 0.0, 0.0, 1.0, eta];
            let f = bench.run_floats("refract", &args);
            let wi = [f[0], f[1], f[2]];
            assert!((dot(wi, wi) - 1.0).abs() < 4e-7 && dot(wi, normal) <= 0.0, "{cos} {eta}: {wi:?}");
            for i in 0..2 {
                // Opposite sides, sines as the indices.
                let expected = -f64::from(wo[i]) / f64::from(eta);
                assert!((f64::from(wi[i]) - expected).abs() < 4e-7 + allowed, "{cos} {eta}: {wi:?}");
            }
        }
    }
}
