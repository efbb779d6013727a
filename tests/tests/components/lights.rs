//! Lights against closed forms, and their densities against themselves.

use jerboa_ir::lang::{F32, Fun, Row, entry};
use jerboa_lib_render::core::rng::Rng;
use jerboa_lib_render::core::vec::Vec3;
use jerboa_lib_render::host::distribution::{Distribution1D, Distribution2D};
use jerboa_lib_render::host::image_io::Image;
use jerboa_lib_render::light::area::{make_quad_light, make_triangle_light};
use jerboa_lib_render::light::environment::{environment_pdf, environment_radiance, make_environment_light};
use jerboa_lib_render::light::{sample_light, spot::make_spot_light};
use jerboa_lib_render::mis::power_heuristic;
use jerboa_lib_render::schema::*;

use jerboa_tests::harness::bench::{Bench, Random, stream};

/// Kernels: a sample of the lights from a point; rays that leave light 0; the environment.
fn bench(lights: usize) -> Bench {
    let mut bench = Bench::new(|| {
        entry("sample", Fun::lam(|b, (rng, point): (Rng, Vec3)| sample_light(b, rng, point)));
        entry("environment", Fun::lam(|_, dir: Vec3| (environment_radiance(dir), environment_pdf(dir))));
        entry("mis", Fun::lam(|_, (own, other): (F32, F32)| power_heuristic(own, other)));
        let row = Row::<Lights>::at(0u32);
        let emission = |name, light: jerboa_lib_render::light::Light| entry(name, light.sample_emission);
        emission("emit_triangle", make_triangle_light(row));
        emission("emit_quad", make_quad_light(row));
        emission("emit_spot", make_spot_light(row));
        emission("emit_environment", make_environment_light(row));
    });
    bench.rows::<Lights>(lights);
    let shares = Distribution1D::new(&(1..=lights).map(|i| i as f64).collect::<Vec<_>>());
    bench.rows::<LightChoice>(lights + 1);
    for (row, p) in shares.cdf.iter().enumerate() {
        bench.set(LightChoice::CDF, row, *p);
    }
    for row in 0..lights {
        bench.set(Lights::PROBABILITY, row, shares.probability(row));
        bench.set(Lights::PRIMITIVE, row, NONE);
        bench.set(Lights::PRIMITIVE1, row, NONE);
        for column in [Lights::R, Lights::G, Lights::B] {
            bench.set(column, row, 1.0_f32);
        }
    }
    bench.set(Settings::LIGHT_COUNT, 0, lights as u32);
    bench
}

/// Light `row` is a triangle or a parallelogram.
pub fn set_area(bench: &mut Bench, row: usize, kind: u32, corner: [f32; 3], e1: [f32; 3], e2: [f32; 3], area: f32) {
    bench.set(Lights::KIND, row, kind);
    bench.set(Lights::AREA, row, area);
    let columns = [
        Lights::P_X,
        Lights::P_Y,
        Lights::P_Z,
        Lights::E1_X,
        Lights::E1_Y,
        Lights::E1_Z,
        Lights::E2_X,
        Lights::E2_Y,
        Lights::E2_Z,
    ];
    for (column, value) in columns.into_iter().zip([corner, e1, e2].concat()) {
        bench.set(column, row, value);
    }
}

/// A sample, read back.
struct Sample {
    wi: [f64; 3],
    pos: [f32; 3],
    distance: f32,
    intensity: f64,
    pdf: f64,
}

fn sample(bench: &mut Bench, key: u32, point: [f32; 3], both: bool) -> Sample {
    let p = point.map(f32::to_bits);
    let args = [stream(key), p].concat();
    let out = if both { bench.run_both("sample", &args) } else { bench.run("sample", &args) };
    let f = |i: usize| f32::from_bits(out[i]);
    Sample {
        wi: [0, 1, 2].map(|i| f64::from(f(i))),
        pos: [f(3), f(4), f(5)],
        distance: f(6),
        intensity: f64::from(f(7)),
        pdf: f64::from(f(10)),
    }
}

/// Mean and standard error.
fn mean(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (n, sum, squares) = values.fold((0.0, 0.0, 0.0), |(n, s, q), x| (n + 1.0, s + x, q + x * x));
    let mean = sum / n;
    (mean, ((squares / n - mean * mean).max(0.0) / n).sqrt())
}

#[test]
fn a_quad_light_over_a_point_has_its_closed_form() {
    let mut random = Random::new(0x5eed_0006);
    let mut bench = bench(1);
    for (height, expected) in [(2.0_f32, 0.036738817), (1.0, 0.119728235), (0.5, 0.277063212)] {
        for kind in [LIGHT_QUAD, LIGHT_TRIANGLE] {
            // The light looks down; as a triangle only the half, which by symmetry gives half.
            set_area(
                &mut bench,
                0,
                kind,
                [-0.5, -0.5, height],
                [0.0, 1.0, 0.0],
                [1.0, 0.0, 0.0],
                if kind == LIGHT_QUAD { 1.0 } else { 0.5 },
            );
            let radiance = (0..40_000).map(|i| {
                let s = sample(&mut bench, random.bits() as u32, [0.0; 3], i < 50);
                assert!(s.wi[2] > 0.0 && s.pos[2] < height, "towards it, and a shadow ray ends in front of it");
                0.5 / std::f64::consts::PI * s.intensity * s.wi[2] / s.pdf
            });
            let (mean, error) = mean(radiance);
            let expected = if kind == LIGHT_QUAD { expected } else { expected / 2.0 };
            assert!(
                (mean - expected).abs() < (4.0 * error).max(1e-5) && error < 0.005 * expected,
                "{mean} ± {error}, not {expected}"
            );
        }
    }
    let behind = sample(&mut bench, 1, [0.0, 0.0, 5.0], true);
    assert_eq!((behind.intensity, behind.pdf), (0.0, 0.0), "nothing behind it");
    bench.set(Lights::DOUBLE_SIDED, 0, true);
    assert!(sample(&mut bench, 1, [0.0, 0.0, 5.0], true).intensity > 0.0, "but for two sides");
}

#[test]
fn lights_are_chosen_by_their_share() {
    let mut random = Random::new(0x5eed_0007);
    let mut bench = bench(7);
    for row in 0..7 {
        bench.set(Lights::KIND, row, LIGHT_POINT);
        bench.set(Lights::P_X, row, row as f32 + 1.0);
    }
    let n = 40_000;
    let mut counts = [0.0; 7];
    let mut inverse = 0.0;
    for i in 0..n {
        let s = sample(&mut bench, random.bits() as u32, [0.0; 3], i < 50);
        let light = s.distance as usize - 1;
        assert!((s.pdf - (light + 1) as f64 / 28.0).abs() < 1e-6);
        assert!((s.intensity * f64::from(s.distance).powi(2) - 1.0).abs() < 1e-6);
        counts[light] += 1.0 / f64::from(n);
        inverse += 1.0 / s.pdf / f64::from(n);
    }
    for (light, share) in counts.into_iter().enumerate() {
        assert!((share - (light + 1) as f64 / 28.0).abs() < 0.01, "light {light}: {share}");
    }
    assert!((inverse - 7.0).abs() < 0.2, "the sum of p / p is the number of lights: {inverse}");
}

#[test]
fn point_spot_and_directional_light_follow_the_extension() {
    let mut bench = bench(1);
    bench.set(Lights::KIND, 0, LIGHT_POINT);
    let near = sample(&mut bench, 3, [1e-6, 0.0, 0.0], true);
    assert!((near.intensity / 1e12 - 1.0).abs() < 1e-5, "1 cd at 1e-6 m");
    let at = sample(&mut bench, 3, [0.0; 3], true);
    assert_eq!(at.pdf, 0.0, "no direction from the light itself");

    bench.set(Lights::KIND, 0, LIGHT_SPOT);
    for (column, value) in [(Lights::E1_Z, -1.0), (Lights::COS_OUTER, 0.5_f32), (Lights::COS_INNER, 0.9)] {
        bench.set(column, 0, value);
    }
    for (cos, expected) in [(1.0_f32, 1.0), (0.9, 1.0), (0.7, 0.25), (0.5, 0.0), (0.3, 0.0), (-0.5, 0.0)] {
        let s = sample(&mut bench, 3, [2.0 * (1.0 - cos * cos).sqrt(), 0.0, -2.0 * cos], true);
        assert!((s.intensity * 4.0 - expected).abs() < 2e-6, "cos {cos}: {}", s.intensity);
    }

    bench.set(Lights::KIND, 0, LIGHT_DIRECTIONAL);
    let s = sample(&mut bench, 3, [9.0, 8.0, 7.0], true);
    assert_eq!((s.wi, s.distance, s.intensity), ([0.0, 0.0, 1.0], f32::INFINITY, 1.0));
}

/// Put a map on the bench, as light 0.
fn set_environment(bench: &mut Bench, map: &Image) {
    let distribution = Distribution2D::environment(map);
    bench.set(Lights::KIND, 0, LIGHT_ENVIRONMENT);
    bench.set(Environment::WIDTH, 0, map.width);
    bench.set(Environment::HEIGHT, 0, map.height);
    bench.set(Environment::INTENSITY, 0, 2.0_f32);
    // A right angle about +Y.
    bench.set(Environment::ROTATION_SIN, 0, 1.0_f32);
    bench.rows::<EnvironmentTexels>(map.pixels.len());
    for (row, pixel) in map.pixels.iter().enumerate() {
        for (column, value) in [EnvironmentTexels::R, EnvironmentTexels::G, EnvironmentTexels::B].into_iter().zip(pixel)
        {
            bench.set(column, row, *value);
        }
    }
    bench.rows::<EnvironmentColumns>(distribution.columns.len());
    for (row, p) in distribution.columns.iter().enumerate() {
        bench.set(EnvironmentColumns::CDF, row, *p);
    }
    bench.rows::<EnvironmentRows>(distribution.rows.cdf.len());
    for (row, p) in distribution.rows.cdf.iter().enumerate() {
        bench.set(EnvironmentRows::CDF, row, *p);
    }
}

fn environment(bench: &mut Bench, dir: [f64; 3], both: bool) -> (f64, f64) {
    let args = dir.map(|x| (x as f32).to_bits());
    let out = if both { bench.run_both("environment", &args) } else { bench.run("environment", &args) };
    (f64::from(f32::from_bits(out[0])), f64::from(f32::from_bits(out[3])))
}

#[test]
fn the_environment_is_drawn_by_its_density() {
    let mut random = Random::new(0x5eed_0008);
    let mut bench = bench(1);
    let constant = Image::from_fn(8, 4, |_, _| [1.0; 3]);
    let one_hot = Image::from_fn(16, 8, |x, y| [if (x, y) == (0, 2) { 100.0 } else { 0.0 }; 3]);
    let pole = Image::from_fn(5, 3, |_, y| [if y == 0 { 1.0 } else { 0.25 }; 3]);
    let single = Image::from_fn(1, 1, |_, _| [3.0; 3]);
    for (name, map) in [("constant", constant), ("one hot", one_hot), ("pole", pole), ("single", single)] {
        set_environment(&mut bench, &map);
        // Flux by light sampling against flux by uniform directions; the latter also integrate the density.
        let n = 60_000;
        let mut same = 0;
        let by_light = mean((0..n).map(|i| {
            let s = sample(&mut bench, random.bits() as u32, [0.0; 3], i < 50);
            let (radiance, pdf) = environment(&mut bench, s.wi, false);
            assert!(s.pdf > 0.0 && s.pdf.is_finite() && s.intensity.is_finite(), "{name}");
            assert!(
                (radiance - s.intensity).abs() <= 2e-4 * (1.0 + s.intensity),
                "{name}: {radiance} is {}",
                s.intensity
            );
            // At the edge of a cell rounding may see the neighbour.
            same += u32::from((pdf / s.pdf - 1.0).abs() < 1e-3);
            s.intensity / s.pdf
        }));
        assert!(same > n - n / 1000, "{name}: two densities of a direction");
        let uniform: Vec<(f64, f64)> = (0..n)
            .map(|i| {
                let (z, turn) = (2.0 * random.uniform() - 1.0, random.uniform() * std::f64::consts::TAU);
                let r = (1.0_f64 - z * z).sqrt();
                let (radiance, pdf) = environment(&mut bench, [r * turn.cos(), z, r * turn.sin()], i < 50);
                assert!(radiance == 0.0 || pdf > 0.0, "{name}: light where there is no density");
                (radiance, pdf)
            })
            .collect();
        let sphere = 4.0 * std::f64::consts::PI;
        let flux = mean(uniform.iter().map(|x| x.0 * sphere));
        let whole = mean(uniform.iter().map(|x| x.1 * sphere));
        let close = |a: (f64, f64), b: f64, e: f64| (a.0 - b).abs() <= 4.0 * a.1.hypot(e) + 1e-4 * b;
        assert!(close(by_light, flux.0, flux.1), "{name}: flux {by_light:?} by light, {flux:?} by direction");
        assert!(close(whole, 1.0, 0.0), "{name}: the density integrates to {whole:?}");
    }
    set_environment(&mut bench, &Image::from_fn(4, 2, |_, _| [1.0; 3]));
    for up in [1.0, -1.0] {
        let (radiance, pdf) = environment(&mut bench, [0.0, up, 0.0], true);
        assert!(radiance == 2.0 && pdf > 0.0 && !pdf.is_nan(), "at a pole");
    }
}

#[test]
fn the_environment_is_turned_about_y() {
    let mut bench = bench(1);
    // Texel columns: 0 is where u is 1/8: seen against +x turned by −90° … the brightest is the last.
    set_environment(&mut bench, &Image::from_fn(4, 1, |x, _| [x as f32; 3]));
    // Unturned: u = 1/2 + atan2(x, −z)/2π. By 90° about +Y: what is seen towards d is the map at (−z, x).
    for (dir, u) in [([0.0, 0.0, -1.0], 0.75), ([1.0, 0.0, 0.0], 0.0), ([0.0, 0.0, 1.0], 0.25), ([-1.0, 0.0, 0.0], 0.5)]
    {
        let x: f64 = u * 4.0 - 0.5;
        let at = |i: f64| i.rem_euclid(4.0);
        let expected = 2.0 * (at(x.floor()) + at(x.floor() + 1.0)) / 2.0;
        let (radiance, _) = environment(&mut bench, dir, true);
        assert!((radiance - expected).abs() < 1e-5, "{dir:?}: {radiance}, not {expected}");
    }
}

/// Flux of light 0 by the rays that leave it: mean of intensity · cos / density, and its standard error.
fn flux(bench: &mut Bench, random: &mut Random, entry: &str) -> (f64, f64) {
    mean((0..20_000).map(|i| {
        let args = stream(random.bits() as u32);
        let out = if i < 50 { bench.run_both(entry, &args) } else { bench.run(entry, &args) };
        let f = |i: usize| f64::from(f32::from_bits(out[i]));
        assert!(((3..6).map(|i| f(i) * f(i)).sum::<f64>() - 1.0).abs() < 1e-5, "a unit direction");
        f(6) * f(9) / (f(10) * f(11))
    }))
}

#[test]
fn the_rays_that_leave_a_light_carry_its_flux() {
    use std::f64::consts::PI;
    let mut random = Random::new(0x5eed_000f);
    let mut bench = bench(1);
    let close = |(flux, error): (f64, f64), expected: f64, what: &str| {
        assert!((flux - expected).abs() <= 4.0 * error + 1e-4 * expected, "{what}: {flux} ± {error}, not {expected}");
    };
    for (both, sides) in [(false, 1.0), (true, 2.0)] {
        bench.set(Lights::DOUBLE_SIDED, 0, both);
        set_area(&mut bench, 0, LIGHT_TRIANGLE, [1.0, 2.0, 3.0], [0.0, 2.0, 0.0], [3.0, 0.0, 0.0], 3.0);
        close(flux(&mut bench, &mut random, "emit_triangle"), sides * 3.0 * PI, "triangle");
        set_area(&mut bench, 0, LIGHT_QUAD, [1.0, 2.0, 3.0], [0.0, 2.0, 0.0], [3.0, 0.0, 0.0], 6.0);
        close(flux(&mut bench, &mut random, "emit_quad"), sides * 6.0 * PI, "quad");
    }
    set_area(&mut bench, 0, LIGHT_SPOT, [0.0; 3], [0.0, 0.6, 0.8], [0.0; 3], 0.0);
    bench.set(Lights::COS_OUTER, 0, 0.5_f32);
    bench.set(Lights::COS_INNER, 0, 0.75_f32);
    // The full intensity above the inner cosine, and the integral of the square of a ramp below.
    close(flux(&mut bench, &mut random, "emit_spot"), 2.0 * PI * (0.25 + 0.25 / 3.0), "spot");
    set_environment(&mut bench, &Image::from_fn(8, 4, |_, _| [1.0; 3]));
    bench.set(Lights::SCENE_RADIUS, 0, 3.0_f32);
    close(flux(&mut bench, &mut random, "emit_environment"), 2.0 * 4.0 * PI * PI * 9.0, "environment");
}

#[test]
fn the_power_heuristic_is_a_weight_for_all_densities() {
    let mut bench = bench(1);
    let mut weight = |own: f32, other: f32| f32::from_bits(bench.run_both("mis", &[own, other].map(f32::to_bits))[0]);
    let all = [0.0, 1e-45, 1e-30, 1e-19, 0.5, 1.0, 2.0, 1e20, f32::MAX, f32::INFINITY];
    for (a, b) in all.iter().flat_map(|a| all.map(|b| (*a, b))) {
        let (x, y) = (weight(a, b), weight(b, a));
        let expected = if a > 0.0 || b > 0.0 { 1.0 } else { 0.0 };
        assert!((x + y - expected).abs() < 1e-6 && (0.0..=1.0).contains(&x), "{a} and {b}: {x} + {y}");
    }
    assert_eq!(weight(1.0, 2.0), 0.2);
}
