//! Textures in their hard cases: borders, one texel, coordinates that are huge or no numbers, colour spaces.

use jerboa_ir::lang::{Fun, Row, U32, entry};
use jerboa_lib_render::core::rng::Stream;
use jerboa_lib_render::core::vec::{Vec2, vec2};
use jerboa_lib_render::cutout::is_there;
use jerboa_lib_render::image::Texel;
use jerboa_lib_render::schema::*;
use jerboa_lib_render::texture::look_up;

use jerboa_tests::harness::bench::Bench;

/// Look up texture 0 in an image whose texel i has red = i and alpha = 255 − i, linear.
fn bench(width: u32, height: u32, filter: u32, wrap: u32) -> Bench {
    let mut bench = Bench::new(|| {
        entry("look_up", Fun::<Vec2, Texel>::lam(|b, uv| look_up(b, Row::<Textures>::at(0u32), [uv; 2])));
    });
    bench.rows::<Texels>(256);
    bench.rows::<SrgbCurve>(256);
    reset(&mut bench, width, height, filter, wrap);
    for i in 0..256u32 {
        bench.set(Texels::RGBA, i as usize, i | (255 - i) << 24);
        bench.set(SrgbCurve::LINEAR, i as usize, srgb(i));
    }
    bench
}

fn reset(bench: &mut Bench, width: u32, height: u32, filter: u32, wrap: u32) {
    bench.set(Textures::WIDTH, 0, width);
    bench.set(Textures::HEIGHT, 0, height);
    bench.set(Textures::FILTER, 0, filter);
    bench.set(Textures::WRAP_U, 0, wrap);
    bench.set(Textures::WRAP_V, 0, wrap);
}

/// IEC 61966-2-1.
fn srgb(code: u32) -> f32 {
    let x = f64::from(code) / 255.0;
    (if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }) as f32
}

/// Red · 255 at each point.
fn reds(bench: &mut Bench, uvs: &[(f32, f32)]) -> Vec<f32> {
    uvs.iter().map(|(u, v)| bench.run_floats("look_up", &[*u, *v])[0] * 255.0).collect()
}

/// Points where texture coordinates are hard.
const HARD: [f32; 14] = [
    -1e-9,
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.999_999_94,
    1e7,
    -1e7,
    1e7 + 1.0,
    3e38,
    -3e38,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
];

#[test]
fn nearest_takes_the_texel_that_contains_the_point() {
    let mut bench = bench(1, 1, FILTER_NEAREST, WRAP_REPEAT);
    for (w, h) in [(1, 1), (1, 7), (5, 1), (4, 4), (5, 3)] {
        reset(&mut bench, w, h, FILTER_NEAREST, WRAP_REPEAT);
        let points: Vec<(f32, f32)> =
            (0..200).map(|i| ((i as f32 * 0.377) % 7.0 - 3.5, (i as f32 * 0.713) % 5.0 - 2.5)).collect();
        let texel = |x: f32, n: u32| (f64::from(x) * f64::from(n)).floor().rem_euclid(f64::from(n)) as u32;
        let expected: Vec<f32> = points.iter().map(|(u, v)| (texel(*v, h) * w + texel(*u, w)) as f32).collect();
        let got: Vec<f32> = reds(&mut bench, &points).iter().map(|x| x.round()).collect();
        assert_eq!(got, expected, "{w} x {h}");
    }
}

#[test]
fn no_coordinate_leaves_the_image() {
    let mut bench = bench(1, 1, FILTER_NEAREST, WRAP_REPEAT);
    for (w, h) in [(1, 1), (1, 5), (5, 1), (4, 3)] {
        for filter in [FILTER_NEAREST, FILTER_BILINEAR] {
            for wrap in [WRAP_REPEAT, WRAP_CLAMP, WRAP_MIRROR] {
                reset(&mut bench, w, h, filter, wrap);
                let points: Vec<(f32, f32)> = HARD.iter().flat_map(|u| HARD.map(|v| (*u, v))).collect();
                for (x, at) in reds(&mut bench, &points).iter().zip(&points) {
                    let last = (w * h - 1) as f32;
                    assert!(
                        (-1e-3..=last + 1e-3).contains(x),
                        "{w} x {h}, filter {filter}, wrap {wrap}: {x} at {at:?}"
                    );
                }
            }
        }
    }
    // Just left of the border is the last column with repeat, the first otherwise.
    for (wrap, expected) in [(WRAP_REPEAT, 3.0), (WRAP_CLAMP, 0.0), (WRAP_MIRROR, 0.0)] {
        reset(&mut bench, 4, 1, FILTER_NEAREST, wrap);
        assert_eq!(reds(&mut bench, &[(-1e-9, 0.0)])[0].round(), expected);
    }
}

#[test]
fn bilinear_interpolates_between_centres() {
    let mut bench = bench(4, 1, FILTER_BILINEAR, WRAP_REPEAT);
    let mut row = |wrap, points: &[f32]| {
        reset(&mut bench, 4, 1, FILTER_BILINEAR, wrap);
        let points: Vec<(f32, f32)> = points.iter().map(|u| (*u, 0.5)).collect();
        reds(&mut bench, &points)
    };
    let close = |got: Vec<f32>, expected: &[f32]| {
        let near = got.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-4);
        assert!(near, "{got:?} is not {expected:?}");
    };
    // Centres at 1/8, 3/8, …; at 0 half of each end with repeat, the first alone otherwise.
    let points = [0.125, 0.25, 0.3125, 0.875, 0.0, 1.0, -0.0625, 1.0625, -1e-9];
    close(row(WRAP_REPEAT, &points), &[0.0, 0.5, 0.75, 3.0, 1.5, 1.5, 2.25, 0.75, 1.5]);
    close(row(WRAP_CLAMP, &points), &[0.0, 0.5, 0.75, 3.0, 0.0, 3.0, 0.0, 3.0, 0.0]);
    close(row(WRAP_MIRROR, &[0.25, -0.25, 1.75, 1.0, 0.0, 2.25]), &[0.5, 0.5, 0.5, 3.0, 0.0, 0.5]);
}

#[test]
fn colours_are_decoded_before_they_are_filtered() {
    let mut bench = bench(256, 1, FILTER_BILINEAR, WRAP_REPEAT);
    bench.set(Textures::SRGB, 0, true);
    let out = bench.run_floats("look_up", &[101.0 / 256.0, 0.5]);
    let expected = (srgb(100) + srgb(101)) / 2.0;
    assert!((out[0] - expected).abs() < 1e-6 && out[1] == 0.0, "{out:?}, not {expected}");
    // Alpha is linear, whatever the colours are.
    assert!((out[3] - (255.0 - 100.5) / 255.0).abs() < 1e-6, "{out:?}");
}

#[test]
fn transforms_and_checkerboards() {
    let mut bench = bench(4, 1, FILTER_NEAREST, WRAP_REPEAT);
    bench.set(Textures::TRANSFORMED, 0, true);
    bench.set(Textures::M01, 0, 1.0);
    bench.set(Textures::M02, 0, 0.5);
    // u' = v + 1/2
    assert_eq!(reds(&mut bench, &[(0.3, 0.0), (0.3, 0.25)]).iter().map(|x| x.round()).collect::<Vec<_>>(), [2.0, 3.0]);
    bench.set(Textures::TRANSFORMED, 0, false);
    bench.set(Textures::KIND, 0, TEXTURE_CHECKERBOARD);
    bench.set(Textures::EVEN_R, 0, 1.0);
    let points = [(0.5, 0.5), (1.5, 0.5), (1.5, -0.5), (-0.5, 0.5), (f32::NAN, 0.5)];
    assert_eq!(reds(&mut bench, &points), [255.0, 0.0, 255.0, 0.0, 255.0]);
}

#[test]
fn alpha_decides_whether_a_surface_is_there() {
    let mut bench = Bench::new(|| {
        entry(
            "is_there",
            Fun::<U32, _>::lam(|b, key| {
                let stream = Stream::keyed(0.into(), 0.into(), key);
                let at = ([vec2(0.0, 0.0); 2], 1.0.into());
                is_there(b, Row::<Materials>::at(0u32), at, stream, 1u32.into(), 7u32.into())
            }),
        );
    });
    let mut there = |mode: u32, alpha: f32| {
        bench.set(Materials::ALPHA_MODE, 0, mode);
        bench.set(Materials::BASE_A, 0, alpha);
        bench.set(Materials::ALPHA_CUTOFF, 0, 0.5);
        (0..1000).map(|key| bench.run("is_there", &[key])[0]).sum::<u32>()
    };
    assert_eq!(there(ALPHA_OPAQUE, 0.0), 1000);
    assert_eq!([there(ALPHA_MASK, 0.5), there(ALPHA_MASK, 0.499)], [1000, 0]);
    assert_eq!([there(ALPHA_BLEND, 1.0), there(ALPHA_BLEND, 0.0)], [1000, 0]);
    // Four standard deviations.
    let share = there(ALPHA_BLEND, 0.3);
    assert!(share.abs_diff(300) < 58, "{share}");
}
