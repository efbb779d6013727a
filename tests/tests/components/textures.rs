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
    // What a scene asks for of textures stands at the end of a longer list.
    bench.rows::<Models>(1);
    bench.set(Models::USED, 0, true);
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

const FILTERS: [u32; 3] = [FILTER_NEAREST, FILTER_BILINEAR, FILTER_BICUBIC];

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
        for filter in FILTERS {
            for wrap in [WRAP_REPEAT, WRAP_CLAMP, WRAP_MIRROR, WRAP_BORDER] {
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

/// What lies at any index along an axis of `size` texels: a texel, or nothing.
fn along(i: i64, size: i64, wrap: u32) -> Option<i64> {
    match wrap {
        WRAP_REPEAT => Some(i.rem_euclid(size)),
        WRAP_CLAMP => Some(i.clamp(0, size - 1)),
        WRAP_MIRROR => {
            let i = i.rem_euclid(2 * size);
            Some(i.min(2 * size - 1 - i))
        }
        _ => (0..size).contains(&i).then_some(i),
    }
}

/// Weights of texels by their distance from the point, along one axis, in double precision.
fn weight(filter: u32, distance: f64) -> f64 {
    let x = distance.abs();
    match filter {
        FILTER_NEAREST => f64::from(x < 0.5),
        FILTER_BILINEAR => (1.0 - x).max(0.0),
        // The cubic B-spline: the box filter four times over.
        _ if x < 1.0 => (4.0 - 6.0 * x * x + 3.0 * x * x * x) / 6.0,
        _ => (2.0 - x).max(0.0).powi(3) / 6.0,
    }
}

/// Red and alpha, by definition: over all texels of the infinite plane that are near enough, and a border of red 0.2, alpha 0.6.
fn expected([u, v]: [f64; 2], [w, h]: [i64; 2], filter: u32, wrap: u32) -> [f64; 2] {
    let (x, y) = (u * w as f64 - 0.5, v * h as f64 - 0.5);
    let near = |x: f64| x.floor() as i64 - 2..=x.floor() as i64 + 3;
    let mut sum = [0.0; 2];
    for (i, j) in near(x).flat_map(|i| near(y).map(move |j| (i, j))) {
        let k = weight(filter, x - i as f64) * weight(filter, y - j as f64);
        let texel = match (along(i, w, wrap), along(j, h, wrap)) {
            (Some(i), Some(j)) => [(j * w + i) as f64 / 255.0, 1.0 - (j * w + i) as f64 / 255.0],
            _ => [0.2, 0.6],
        };
        (0..2).for_each(|c| sum[c] += k * texel[c]);
    }
    sum
}

#[test]
fn every_filter_and_border_is_what_its_definition_says() {
    let mut bench = bench(1, 1, FILTER_NEAREST, WRAP_REPEAT);
    bench.set(Textures::BORDER_R, 0, 0.2f32);
    bench.set(Textures::BORDER_A, 0, 0.6f32);
    // On no edge of a texel of any size, where the nearest texel is two.
    let points: Vec<[f32; 2]> =
        (0..150).map(|i| [(i as f32 * 0.377) % 5.0 - 2.4317, (i as f32 * 0.713) % 5.0 - 2.4317]).collect();
    for (w, h) in [(1, 1), (1, 2), (2, 1), (3, 1), (1, 7), (4, 4), (7, 5)] {
        for filter in FILTERS {
            for wrap in [WRAP_REPEAT, WRAP_CLAMP, WRAP_MIRROR, WRAP_BORDER] {
                reset(&mut bench, w, h, filter, wrap);
                for at in &points {
                    let expected = expected(at.map(f64::from), [w.into(), h.into()], filter, wrap);
                    let found = bench.run_floats("look_up", at);
                    let off = (f64::from(found[0]) - expected[0]).abs().max((f64::from(found[3]) - expected[1]).abs());
                    assert!(off < 1e-5, "{w} x {h}, filter {filter}, wrap {wrap}, {at:?}: {found:?}, not {expected:?}");
                }
            }
        }
    }
}

/// The weights of sixteen texels add up to 1, and no rounding takes what they give beyond the texels.
#[test]
fn a_white_image_stays_white() {
    let mut bench = bench(1, 1, FILTER_NEAREST, WRAP_REPEAT);
    (0..256).for_each(|i| bench.set(Texels::RGBA, i, u32::MAX));
    for filter in FILTERS {
        reset(&mut bench, 16, 16, filter, WRAP_REPEAT);
        for i in 0..4000 {
            let at = [i as f32 * 0.618_034, i as f32 * 0.754_877_7];
            let [r, alpha] = [0, 3].map(|c| bench.run_floats("look_up", &at)[c]);
            assert!(r <= 1.0 && alpha <= 1.0 && r.min(alpha) > 1.0 - 4e-7, "filter {filter}, {at:?}: {r}, {alpha}");
        }
    }
}

/// Nothing of the image reaches far beyond its border, wherever that is asked for.
#[test]
fn beyond_a_border_is_its_colour() {
    let mut bench = bench(1, 1, FILTER_NEAREST, WRAP_BORDER);
    let border = [0.25, 0.5, 0.75, 0.125f32];
    let columns = [Textures::BORDER_R, Textures::BORDER_G, Textures::BORDER_B, Textures::BORDER_A];
    columns.iter().zip(border).for_each(|(column, x)| bench.set(*column, 0, x));
    for (w, h) in [(1, 1), (1, 5), (5, 1), (4, 3)] {
        for filter in FILTERS {
            reset(&mut bench, w, h, filter, WRAP_BORDER);
            for far in [-2.5, 3.5, 1e7, -1e7, 3e38, -3e38, f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
                for at in [[far, 0.5], [0.5, far], [far, far]] {
                    let found = bench.run_floats("look_up", &at);
                    let near = found.iter().zip(border).all(|(a, b)| (a - b).abs() <= 1e-7);
                    assert!(near, "{w} x {h}, filter {filter}, {at:?}: {found:?}");
                }
            }
        }
    }
    // Where coordinates are huge the last bit of the image is long gone, but that of one texel beside it is not.
    reset(&mut bench, 4, 1, FILTER_NEAREST, WRAP_BORDER);
    for (u, is_there) in [(0.0, true), (-1e-9, false), (0.999_999_94, true), (1.0, false)] {
        assert_eq!(bench.run_floats("look_up", &[u, 0.5])[3] != border[3], is_there, "{u}");
    }
}

/// Noise in plain Rust, in double precision but for what hashing takes.
fn noise(u: f32, v: f32) -> f64 {
    let hash = |x: u32| {
        let x = (x ^ x >> 17).wrapping_mul(0xed5a_d4bb);
        let x = (x ^ x >> 11).wrapping_mul(0xac4c_1b51);
        let x = (x ^ x >> 15).wrapping_mul(0x3184_8bab);
        x ^ x >> 14
    };
    let octave = |n: u32| {
        let [x, y] = [u, v].map(|x| f64::from(x) * f64::from(1 << n));
        let number = |i: i32, j: i32| {
            let [i, j] = [(x, i), (y, j)].map(|(x, n)| (x.floor() as i32).wrapping_add(n) as u32);
            f64::from(hash(hash(i ^ hash(n)) ^ j) >> 8) / 16_777_216.0
        };
        let smooth = |x: f64| {
            let t = x - x.floor();
            t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
        };
        let mix = |a: f64, b: f64, k: f64| a + (b - a) * k;
        mix(mix(number(0, 0), number(1, 0), smooth(x)), mix(number(0, 1), number(1, 1), smooth(x)), smooth(y))
    };
    (0..4).map(|n| octave(n) * 0.5f64.powi(n as i32)).sum::<f64>() / 1.875
}

#[test]
fn noise_is_what_its_definition_says() {
    let mut bench = bench(1, 1, FILTER_NEAREST, WRAP_REPEAT);
    bench.set(Textures::KIND, 0, TEXTURE_NOISE);
    bench.set(Textures::ODD_R, 0, 1.0f32);
    let count = 4000;
    let points: Vec<(f32, f32)> = (0..count).map(|i| (i as f32 * 0.618 - 900.0, i as f32 * 0.755 - 1300.0)).collect();
    let mut mean = 0.0;
    for (u, v) in points {
        let found = f64::from(bench.run_floats("look_up", &[u, v])[0]);
        assert!((found - noise(u, v)).abs() < 1e-6, "{u}, {v}: {found}, not {}", noise(u, v));
        mean += found / f64::from(count);
    }
    // A number in [0, 1) has a variance of 1/12, a mean of four octaves 85/225 of it at most; 4 standard errors.
    let error = (85.0 / 225.0 / 12.0 / f64::from(count)).sqrt();
    assert!((mean - 0.5).abs() < 4.0 * error, "{mean}");
    for (u, v) in HARD.into_iter().flat_map(|u| HARD.map(|v| (u, v))) {
        let found = bench.run_floats("look_up", &[u, v]);
        assert!((0.0..=1.0).contains(&found[0]) && found[3] == 1.0, "{u}, {v}: {found:?}");
    }
    // Between equal colours there is nothing but that colour.
    bench.set(Textures::EVEN_R, 0, 1.0f32);
    assert!((0..1000).all(|i| (1.0 - 3e-7..=1.0).contains(&bench.run_floats("look_up", &[i as f32 * 0.377, 0.3])[0])));
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
