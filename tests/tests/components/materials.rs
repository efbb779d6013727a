//! What the shader reads: normal maps, textures of the parameters, emission.

use jerboa_ir::lang::{F32, Fun, Row, entry};
use jerboa_lib_render::core::vec::Vec3;
use jerboa_lib_render::geometry::SurfaceElement;
use jerboa_lib_render::material::{EmissionValue, base_color, gltf_values, make_emission};
use jerboa_lib_render::normal_map::apply_normal_map;
use jerboa_lib_render::schema::*;

use jerboa_tests::harness::bench::Bench;
use jerboa_tests::harness::probe::surface;

/// A surface in the plane z = 0 with a texture of one texel for everything.
fn bench(rgba: [u8; 4]) -> Bench {
    let row = || Row::<Materials>::at(0u32);
    let mut bench = Bench::new(|| {
        let up = || Vec3 { x: 0.0.into(), y: 0.0.into(), z: 1.0.into() };
        let surf = move || -> SurfaceElement { surface(up(), up()) };
        entry("normal", Fun::<F32, Vec3>::lam(move |b, _| apply_normal_map(b, row(), surf()).local.normal));
        entry("emission", Fun::<Vec3, EmissionValue>::lam(move |b, w| make_emission(row(), surf()).call(b, w)));
        entry(
            "values",
            Fun::<F32, _>::lam(move |b, _| {
                let base = base_color(b, row(), surf().uv);
                let values = gltf_values(b, row(), base, surf().uv);
                (base, values.metallic, values.alpha, values.specular, values.transmission)
            }),
        );
    });
    bench.rows::<SrgbCurve>(256);
    for code in 0..256 {
        // Any curve: the host makes the real one.
        bench.set(SrgbCurve::LINEAR, code, code as f32);
    }
    bench.set(Texels::RGBA, 0, u32::from_le_bytes(rgba));
    bench.set(Textures::WIDTH, 0, 1);
    bench.set(Textures::HEIGHT, 0, 1);
    bench
}

#[test]
fn normal_maps_turn_the_normal() {
    let mut bench = bench([255, 0, 255, 255]);
    assert_eq!(bench.run_floats("normal", &[0.0]), [0.0, 0.0, 1.0]);
    bench.set(Materials::NORMAL_TEXTURED, 0, true);
    for scale in [1.0f32, 0.5, 0.0] {
        bench.set(Materials::NORMAL_SCALE, 0, scale);
        let length = (1.0 + 2.0 * scale * scale).sqrt();
        let n = bench.run_floats("normal", &[0.0]);
        // The tangent of this frame is x, the bitangent y.
        for (got, expected) in n.iter().zip([scale / length, -scale / length, 1.0 / length]) {
            assert!((got - expected).abs() < 1e-6, "scale {scale}: {n:?}");
        }
    }
}

#[test]
fn textures_multiply_their_factors() {
    let mut bench = bench([51, 102, 204, 153]);
    let factors =
        [Materials::ROUGHNESS, Materials::METALLIC, Materials::SPECULAR, Materials::TRANSMISSION, Materials::BASE_R];
    for column in factors {
        bench.set(column, 0, 0.5);
    }
    assert_eq!(bench.run_floats("values", &[0.0]), [0.5, 0.0, 0.0, 0.5, 0.25, 0.5, 0.5]);
    bench.set(Materials::METALLIC_ROUGHNESS_TEXTURED, 0, true);
    bench.set(Materials::SPECULAR_TEXTURED, 0, true);
    bench.set(Materials::TRANSMISSION_TEXTURED, 0, true);
    bench.set(Materials::BASE_TEXTURED, 0, true);
    let out = bench.run_floats("values", &[0.0]);
    let expected = [0.1, 0.0, 0.0, 0.4, 0.04, 0.3, 0.1];
    assert!(out.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{out:?}, not {expected:?}");
}

#[test]
fn emission_leaves_the_front_or_both_sides() {
    let mut bench = bench([51, 0, 0, 255]);
    bench.set(Materials::EMISSION_R, 0, 10.0);
    let up = [0.6, 0.0, 0.8];
    let down = [0.6, 0.0, -0.8];
    let density = 0.8 * std::f32::consts::FRAC_1_PI;
    // Radiance, pdf_area (it is no light), pdf_dir.
    assert_eq!(bench.run_floats("emission", &up), [10.0, 0.0, 0.0, 0.0, density]);
    assert_eq!(bench.run_floats("emission", &down), [0.0; 5]);
    bench.set(Materials::DOUBLE_SIDED, 0, true);
    assert_eq!(bench.run_floats("emission", &down), [10.0, 0.0, 0.0, 0.0, density / 2.0]);
    bench.set(Materials::EMISSION_TEXTURED, 0, true);
    bench.set(Textures::SRGB, 0, true);
    assert_eq!(bench.run_floats("emission", &up)[0], 510.0);
}
