//! Blends of BSDFs with perfectly specular parts, which no material of a file has.

use jerboa_ir::lang::{F32, Fun, U32, entry};
use jerboa_lib_render::bsdf::BsdfSample;
use jerboa_lib_render::bsdf::diffuse::make_diffuse_bsdf;
use jerboa_lib_render::bsdf::mirror::make_mirror_bsdf;
use jerboa_lib_render::bsdf::mix::make_mix_bsdf;
use jerboa_lib_render::core::color::gray;
use jerboa_lib_render::core::rng::Rng;
use jerboa_lib_render::core::vec::Vec3;

use jerboa_tests::harness::bench::Bench;
use jerboa_tests::harness::probe::{at_cos, surface};

/// (1 − k) Lambert + k mirror: the mirror is drawn with probability k and keeps its weight; the rest weighs as if it were
/// alone. (A mirror of density 1, as in Rodent's mix, takes light from the other part.)
#[test]
fn a_mirror_and_a_matt_surface_share_the_samples() {
    const SAMPLES: u32 = 4000;
    let mut bench = Bench::new(|| {
        let sample = |b: &mut _, (wo, albedo, k, key): (Vec3, F32, F32, U32)| -> BsdfSample {
            let up = || Vec3 { x: 0.0.into(), y: 0.0.into(), z: 1.0.into() };
            let surf = surface(up(), up());
            let (matt, mirror) = (make_diffuse_bsdf(surf, gray(albedo)), make_mirror_bsdf(surf, gray(1.0)));
            let rng = Rng::new(0.into(), 0.into(), key);
            make_mix_bsdf(surf, matt, mirror, k).sample.call(b, (rng, wo))
        };
        entry("sample", Fun::lam(sample));
    });
    for (albedo, k) in [(0.8f32, 0.3f32), (0.0, 0.5)] {
        let mut specular = 0;
        for key in 0..SAMPLES {
            let mut args: Vec<u32> = at_cos(0.6).iter().chain(&[albedo, k]).map(|x| x.to_bits()).collect();
            args.push(key);
            let words = bench.run("sample", &args);
            let (weight, is_specular) = (f32::from_bits(words[4]), words[7] != 0);
            specular += u32::from(is_specular);
            let expected = if is_specular { 1.0 } else { albedo };
            assert!((weight - expected).abs() < 1e-5, "albedo {albedo}, k {k}, sample {key}: {weight}, not {expected}");
        }
        let (share, error) = (f64::from(specular) / f64::from(SAMPLES), (0.25 / f64::from(SAMPLES)).sqrt());
        assert!((share - f64::from(k)).abs() < 4.0 * error, "{share} of the samples are specular, not {k}");
    }
}
