//! What textures of directions give: anisotropy's, and the normals of a coat and of what it covers.

use std::f64::consts::{FRAC_PI_2, PI};

use jerboa_scenes::{Anisotropy, Clearcoat, Material};
use jerboa_tests::harness::bench::Random;
use jerboa_tests::harness::probe::{V, dot, normalize, random_direction};
use jerboa_tests::harness::scattering::fresnel;

use crate::textured::{TEXTURE, medley, probe, scene};

fn brushed() -> Material {
    Material { anisotropy: Some(Anisotropy::new(0.9)), ..Material::metal("brushed", [1.0; 3], 0.5) }
}

fn turned([x, y, z]: [f64; 3], angle: f64) -> [f64; 3] {
    let (s, c) = angle.sin_cos();
    [c * x - s * y, s * x + c * y, z]
}

/// White metal with microfacets of width `along` in a direction at this angle to x, and of `across`: D G / 4 cos cos in f64, G
/// separable.
fn stretched(wi: V, wo: V, [along, across]: [f64; 2], angle: f64) -> f64 {
    let [i, o] = [wi, wo].map(|w| turned(w.map(f64::from), -angle));
    let h = [0, 1, 2].map(|k| i[k] + o[k]);
    let length2 = h.iter().map(|x| x * x).sum::<f64>();
    let slant = ((h[0] / along).powi(2) + (h[1] / across).powi(2) + h[2] * h[2]) / length2;
    let d = 1.0 / (PI * along * across * slant * slant);
    let seen =
        |w: [f64; 3]| 2.0 / (1.0 + (1.0 + ((along * w[0]).powi(2) + (across * w[1]).powi(2)) / (w[2] * w[2])).sqrt());
    d * seen(i) * seen(o) / (4.0 * i[2] * o[2])
}

/// A direction that is at least so high.
fn above(random: &mut Random, least: f32) -> V {
    loop {
        let w = random_direction(random);
        if w[2] > least {
            return w;
        }
    }
}

/// By the rotation, by the texture's red and green, and by both, counter-clockwise from the tangent; its blue is a factor of the
/// strength.
#[test]
fn anisotropy_has_its_direction() {
    let (mut random, mut probe) = (Random::new(0xa15), probe());
    let mut worst = 0.0_f64;
    for rotation in [0.0, FRAC_PI_2 as f32, 0.7, -2.0] {
        for codes in [None, Some([255u8, 128, 255]), Some([0, 128, 200]), Some([128, 255, 150]), Some([60, 230, 100])] {
            let lobe = Anisotropy { rotation, texture: codes.and(TEXTURE), ..Anisotropy::new(0.9) };
            let [r, g, b] = codes.unwrap_or([255, 0, 255]);
            let mut material = brushed();
            material.anisotropy = Some(lobe);
            probe.load(&scene(material, [r, g, b, 255]));
            let unit = |code: u8| f64::from(code) / 255.0;
            let by_texture = codes.map_or(0.0, |[r, g, _]| (2.0 * unit(g) - 1.0).atan2(2.0 * unit(r) - 1.0));
            let strength = f64::from(0.9f32) * unit(b);
            let across = f64::from(0.5f32).powi(2);
            let widths = [across + (1.0 - across) * strength * strength, across];
            for _ in 0..200 {
                let (wi, wo) = (above(&mut random, 0.05), above(&mut random, 0.05));
                let found = f64::from(probe.eval(wi, wo).0[1]);
                let expected = stretched(wi, wo, widths, f64::from(rotation) + by_texture);
                worst = worst.max((found / expected - 1.0).abs());
                assert!((found / expected - 1.0).abs() < 2e-5, "{rotation}, {codes:?}: {found}, not {expected}");
            }
        }
    }
    println!("largest relative difference {worst:.2e}");
}

/// A quarter of a turn is tangent and bitangent in each other's place, of all that GGX does.
#[test]
fn a_quarter_of_a_turn_swaps_the_axes() {
    let (mut random, mut probe) = (Random::new(0x90), probe());
    let pairs: Vec<[V; 2]> = (0..200).map(|_| [above(&mut random, 0.05), random_direction(&mut random)]).collect();
    let mut seen = |rotation: f32, turn: fn(V) -> V| -> Vec<V> {
        let lobe = Anisotropy { rotation, ..Anisotropy::new(0.6) };
        probe.load(&scene(Material { anisotropy: Some(lobe), ..medley() }, [255; 4]));
        pairs.iter().map(|[wi, wo]| probe.eval(turn(*wi), turn(*wo)).0).collect()
    };
    let (quarter, none) = (seen(FRAC_PI_2 as f32, |w| w), seen(0.0, |[x, y, z]| [y, -x, z]));
    for (found, expected) in quarter.iter().zip(&none) {
        // The sine of what f32 has for a right angle is 4e-8 off, and lobes are as steep as 1 / α² of that.
        let near = (0..3).all(|c| (found[c] - expected[c]).abs() <= 5e-5 * expected[c]);
        assert!(near, "{found:?}, not {expected:?}");
    }
    assert!(quarter != seen(0.0, |w| w), "nobody would see it");
}

/// What a normal map of this texel and scale makes of the normal z.
fn mapped([r, g, b]: [u8; 3], scale: f64) -> V {
    let [x, y, z] = [r, g, b].map(|code| f64::from(code) / 127.5 - 1.0);
    normalize([x * scale, y * scale, z])
}

/// A coat's normal map moves its lobe and what passes it; the material's own moves what is under it. f is relative to the normal of
/// what is covered: its coat, by the coat's own normal, plus what is under it, twice through the coat.
#[test]
fn a_coat_and_what_it_covers_have_normals_of_their_own() {
    let (mut random, mut probe) = (Random::new(0xc0a7), probe());
    let (codes, scale, up) = ([190, 90, 220], 0.8f32, [0.0, 0.0, 1.0]);
    let slope = mapped(codes, scale.into());
    let coat = Clearcoat::new(0.7, 0.5);
    let black = scene(Material { clearcoat: Some(coat), ..Material::diffuse("black", [0.0; 3]) }, [255; 4]);
    let (texel, albedo) = ([codes[0], codes[1], codes[2], 255], [0.8, 0.5, 0.2]);
    let on_coat = Clearcoat { normal_texture: TEXTURE, normal_scale: scale, ..coat };
    let coated = |clearcoat| Material { clearcoat: Some(clearcoat), ..Material::diffuse("paint", albedo) };
    let own = Material { normal_texture: TEXTURE, normal_scale: scale, ..coated(coat) };
    let cases = [
        ("of the coat", coated(on_coat), slope, up),
        ("of the material", own.clone(), up, slope),
        ("of both", Material { clearcoat: Some(on_coat), ..own }, slope, slope),
    ];
    let mut worst = 0.0_f64;
    for (what, material, of_coat, of_base) in cases {
        let paint = scene(material, texel);
        for _ in 0..300 {
            let (wi, wo) = (random_direction(&mut random), random_direction(&mut random));
            let heights = [wi, wo].map(|w| [of_coat, of_base].map(|n| dot(w, n)));
            if heights.iter().flatten().any(|cos| cos.abs() < 0.05) {
                continue;
            }
            let [[coat_i, base_i], [coat_o, base_o]] = heights;
            probe.load(&black).normal = of_coat;
            let lobe = f64::from(probe.eval(wi, wo).0[0]) * (coat_i / base_i).abs();
            let passed = |cos: f64| 1.0 - f64::from(0.7f32) * fresnel(cos.abs(), 1.5);
            let under = if base_i * base_o > 0.0 { passed(coat_i) * passed(coat_o) / PI } else { 0.0 };
            let found = probe.load(&paint).eval(wi, wo).0;
            for (found, albedo) in found.iter().zip(albedo) {
                let expected = lobe + f64::from(albedo) * under;
                let off = if expected == 0.0 { f64::from(*found) } else { (f64::from(*found) / expected - 1.0).abs() };
                worst = worst.max(off);
                assert!(off < 1e-5, "{what}: {wi:?} {wo:?}: {found}, not {expected}");
            }
        }
    }
    println!("largest relative difference {worst:.2e}");
}
