//! Lights and the choice among them: T5, T26 and T27 by light sampling alone, hard cases, N11.
//!
//! The rows are those of `harness::lights` (lights with extent) and of `harness::analytic` (closed forms). The long form:
//!
//! ```text
//! JERBOA_SAMPLES=1000000 cargo test --release -p jerboa-tests --test components lights -- --nocapture
//! ```

use std::f64::consts::{FRAC_1_PI, PI};

use glam::{DAffine3, DVec3};
use jerboa_example_custom::lamp;
use jerboa_ir::lang::{Buf, F32, Fun, entry};
use jerboa_lib_render::host::ahead::texels;
use jerboa_lib_render::mis::power_heuristic;
use jerboa_lib_render::schema::{LIGHT_POINT, LIGHT_QUAD, LightChoice, Lights, Settings, binding};
use jerboa_scenes::{Environment, Light, LightKind, Material, Model, Scene};
use jerboa_tests::harness::analytic::{ALBEDO, Estimate, bound, direct, light, place, rectangle, sphere};
use jerboa_tests::harness::bench::{Bench, Random, number, stream};
use jerboa_tests::harness::chi2;
use jerboa_tests::harness::lights::{Drawn, LightProbe, Lit, lights};
use jerboa_tests::harness::probe::V;
use jerboa_tests::harness::stats::{FAMILY, chi2_tail, mean, sidak};

/// Samples of a light.
fn samples(quick: usize) -> usize {
    number("JERBOA_SAMPLES", quick)
}

/// So many samples by the keys of a row; the first few by the interpreter too.
fn draw(probe: &mut LightProbe, row: usize, point: V, n: usize) -> Vec<Drawn> {
    (0..n as u32).map(|i| probe.sample((row as u32) << 24 | i, point, i < 10)).collect()
}

/// Each row of the table, sampled by area, and a single lamp by solid angle too.
fn ways(table: &[Lit]) -> impl Iterator<Item = ((usize, &Lit), bool)> {
    let rows = table.iter().enumerate().flat_map(|row| [(row, false), (row, true)]);
    // Without a chart a row takes long, and a sky has no lamp.
    rows.filter(|((_, row), solid_angle)| !solid_angle || row.chart.is_some() && !row.scene.meshes.is_empty())
}

/// T5. What is drawn and not blocked follows the density that a ray into its direction is told of.
#[test]
fn lights_are_drawn_by_their_density() {
    let mut probe = LightProbe::default();
    let (table, n) = (lights(), samples(4_000));
    println!("{n} samples, keys from row << 24 on");
    let level = sidak(FAMILY, 2 * table.len());
    let mut faults = Vec::new();
    for ((i, row), solid_angle) in ways(&table) {
        probe.solid_angle = solid_angle;
        probe.load(&row.scene);
        let found = |s: Drawn| (s.pdf > 0.0 && !s.is_delta && !s.is_blocked).then_some(s.wi);
        // Where there is no chart every edge of a light costs thousands of rays.
        let few = if row.chart.is_some() { n } else { n.min(500) };
        let directions: Vec<Option<V>> = draw(&mut probe, i, row.point, few).into_iter().map(found).collect();
        let pdf = |dir| f64::from(probe.see(row.point, dir).pdf);
        let report = match &row.chart {
            Some(chart) => chart.test(row.point, &directions, solid_angle, pdf),
            None => chi2::sphere(&directions, pdf),
        };
        println!(
            "{}, by solid angle {solid_angle}: ∫ {:.6}, lost {:.4}, p {:.3}",
            row.name, report.integral, report.lost, report.p
        );
        faults.extend(report.fault(level).map(|f| format!("{}: {f}", row.name)));
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

/// T26. Radiance, distance and density of a sample are those of the ray into its direction; the cosine of a light seen edge-on
/// is known to a rounding of 1.
#[test]
fn a_sample_is_what_a_ray_sees() {
    let mut probe = LightProbe::default();
    for ((i, row), solid_angle) in ways(&lights()) {
        probe.solid_angle = solid_angle;
        probe.load(&row.scene);
        let (mut compared, mut apart) = (0, 0);
        // Between two texels a rounding of the direction is worth a share of the brighter one.
        let texels = row.scene.environment.iter().flat_map(|e| e.radiance.iter().flatten());
        let brightest = row.scene.materials.iter().flat_map(|m| &m.emissive).chain(texels).fold(0.0, |a, b| b.max(a));
        for s in draw(&mut probe, i, row.point, samples(1_000)) {
            let valid = |x: f32| x >= 0.0 && x.is_finite();
            assert!(valid(s.pdf) && valid(s.radiance) && (s.pdf > 0.0 || s.radiance == 0.0), "{}: {s:?}", row.name);
            if s.pdf > 0.0 && !s.is_delta && !s.is_blocked {
                let seen = probe.see(row.point, s.wi);
                let near = |a: f32, b: f32, share| a == b || (a / b - 1.0).abs() <= (1e-5 + 1e-6 / seen.cos) * share;
                // The density of a sky is looked up like its radiance.
                let share = if seen.distance.is_finite() { 1.0 } else { brightest / s.radiance };
                let same = near(s.distance, seen.distance, 1.0) && near(s.pdf, seen.pdf, share);
                compared += 1;
                // The direction of a point at the rim of a texel or a lamp may round to the other side.
                let brightest = f32::max(brightest, s.radiance);
                apart += u32::from(!(same && (s.radiance - seen.radiance).abs() <= 1e-5 * brightest));
            }
        }
        println!("{}: {compared} compared, {apart} apart", row.name);
        assert!(f64::from(apart) <= 1e-3 * f64::from(compared), "{}: {apart} of {compared} apart", row.name);
    }
}

/// T27 by light sampling alone, with twice the bound, since it has more variance; `analytic.rs` has it with both kinds of sampling, and by BSDF sampling alone.
#[test]
fn light_sampling_alone_has_the_closed_form() {
    let mut probe = LightProbe::default();
    let n = samples(2_000);
    println!("{n} samples, keys from row << 24 on");
    let mut faults = Vec::new();
    // By solid angle no lamp is too near.
    let table = direct();
    let ways = table.iter().enumerate().flat_map(|row| [(row, false), (row, true)]);
    for ((i, closed), solid_angle) in
        ways.filter(|((_, c), by_angle)| if *by_angle { c.name.starts_with("lamp") } else { !c.is_near })
    {
        probe.solid_angle = solid_angle;
        let mut scene = closed.scene.clone();
        // The floor: it faces away from itself, and its rounding would stand in the way.
        scene.instances.remove(0);
        probe.load(&scene);
        for (look, truth) in closed.looks.iter().filter(|(look, _)| look.window.area() == 1) {
            let point = look.on_floor(0.5, 0.5).as_vec3().to_array();
            let reflected = |s: Drawn| {
                let arrives = s.pdf > 0.0 && !s.is_blocked && s.wi[1] > 0.0;
                let [cos, radiance, pdf] = [s.wi[1], s.radiance, s.pdf].map(f64::from);
                if arrives { f64::from(ALBEDO) * FRAC_1_PI * cos * radiance / pdf } else { 0.0 }
            };
            let drawn = draw(&mut probe, i, [point[0], 0.0, point[2]], n * closed.effort);
            let found = Estimate::of(&drawn.into_iter().map(reflected).collect::<Vec<_>>());
            println!(
                "{}, by solid angle {solid_angle}: {:.6e} ± {:.1e}, truth {truth:.6e}",
                closed.name, found.mean, found.error
            );
            faults.extend(found.fault(*truth, closed.facets, bound(4e-3, n)).map(|f| format!("{}: {f}", closed.name)));
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

/// And by rays that find lights by chance, without any light sampling: what both are weighted with can only divide the same
/// light between them.
#[test]
fn seeing_alone_has_the_closed_form() {
    let mut probe = LightProbe::default();
    let mut random = Random::new(0x5eed_0061);
    let n = samples(20_000);
    println!("{n} rays, seed 0x5eed0061");
    let mut faults = Vec::new();
    let of_light = |name: &str| ["ball of light", "disk of light", "sun of"].iter().any(|kind| name.starts_with(kind));
    for closed in direct().iter().filter(|c| of_light(&c.name)) {
        let mut scene = closed.scene.clone();
        scene.instances.remove(0);
        probe.load(&scene);
        let (look, truth) = &closed.looks[0];
        let point = look.on_floor(0.5, 0.5).as_vec3();
        let reflected = |_| {
            let (sin, turn) = (random.uniform().sqrt(), 2.0 * PI * random.uniform());
            let dir = [sin * turn.cos(), (1.0 - sin * sin).sqrt(), sin * turn.sin()].map(|c| c as f32);
            f64::from(ALBEDO) * f64::from(probe.see([point.x, 0.0, point.z], dir).radiance)
        };
        let found = Estimate::of(&(0..n).map(reflected).collect::<Vec<_>>());
        println!("{}: {:.6e} ± {:.1e}, truth {truth:.6e}", closed.name, found.mean, found.error);
        // What is met by less than a hundred rays says nothing.
        let met = found.error < 0.1 * truth && found.error > 0.0;
        if met && (found.mean - truth).abs() > 4.0 * found.error {
            faults.push(format!("{}: {found:?}, truth {truth}", closed.name));
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

/// Many lights of every kind, some without power: those that may be drawn, and the scene.
fn many(count: usize, sky: bool, power: impl Fn(usize) -> f32) -> Scene {
    let mut scene = Scene::default();
    let at = |i: usize| DVec3::new((i % 32) as f64, 1.0 + (i % 3) as f64, (i / 32) as f64);
    for i in 0..count - usize::from(sky) {
        let (inner, outer, radius) = (0.1, 0.5, 0.2);
        let kinds = [
            [LightKind::Point, LightKind::Spot { inner, outer }, LightKind::Directional],
            [LightKind::Sphere { radius }, LightKind::Disk { inner, outer, radius }, LightKind::Sun { angle: 0.1 }],
        ];
        let kind = kinds[i % 2][i % 3];
        if i % 5 < 3 {
            let to_world = DAffine3::from_translation(at(i)) * light(kind, 1.0, 0.0).to_world;
            scene.lights.push(Light { to_world, ..light(kind, power(i), 0.0) });
        } else {
            let lamp = rectangle(glam::Vec3::ZERO, glam::Vec3::X * 0.1, glam::Vec3::Z * 0.1);
            let material = Material { double_sided: i % 2 == 0, ..Material::emitter("lamp", [power(i); 3]) };
            place(&mut scene, lamp, material, 1.0, at(i));
        }
    }
    // And some that give nothing.
    scene.lights.insert(0, light(LightKind::Point, 0.0, 1.0));
    scene.lights.push(light(LightKind::Directional, 0.0, 1.0));
    place(&mut scene, sphere(0), Material::diffuse("dark", [0.5; 3]), 0.1, DVec3::Y * 9.0);
    if sky {
        let radiance = vec![[1.0; 3]; 8];
        scene.environment = Some(Environment { width: 4, height: 2, radiance, intensity: 1.0, rotation_deg: 0.0 });
    }
    scene
}

/// T26. The choice inverts an ascending table, so its two ends say everything about a light: it is drawn by the numbers from
/// the one to the other, which are exactly the share of all 2^24 numbers that its row and the weights are told.
#[test]
fn lights_are_chosen_with_the_probability_that_is_told() {
    let mut probe = LightProbe::default();
    let spread = |i: usize| (0.3 * ((i * 7919 % 101) as f32 / 10.0 - 5.0)).exp();
    let scenes = [
        ("1", many(1, false, |_| 1.0), 1),
        ("1, the sky", many(1, true, |_| 1.0), 1),
        ("33", many(33, true, spread), 33),
        ("1000", many(1000, false, spread), 1000),
        ("1000 of all magnitudes", many(1000, false, |i| 10_f32.powi((i % 61) as i32 - 30)), 1000),
    ];
    for (name, scene, count) in scenes {
        let tables = probe.load(&scene);
        let cdf = tables.memory[binding::<LightChoice>()].words.iter().map(|w| f32::from_bits(*w)).collect::<Vec<_>>();
        assert_eq!((cdf.len(), cdf[0], cdf[count]), (count + 1, 0.0, 1.0), "{name}: lights without power are none");
        assert_eq!(tables.memory[binding::<Lights>()].rows as usize, count);
        const STEP: f32 = 1.0 / 16_777_216.0;
        for i in 0..count {
            assert!(cdf[i] < cdf[i + 1] && (cdf[i] / STEP).fract() == 0.0, "{name}, light {i}: it is drawn");
            // The difference of multiples of 2^-24 is exact.
            let share = cdf[i + 1] - cdf[i];
            assert_eq!([probe.choose(cdf[i]), probe.choose(cdf[i + 1] - STEP)], [(i, share); 2], "{name}, light {i}");
        }
    }
}

/// T26, as drawn: a light of probability p counts 1 / p, and the mean is the number of lights. A sample states p, alone for
/// a light without extent.
#[test]
fn one_over_the_probability_counts_the_lights() {
    let mut probe = LightProbe::default();
    let n = samples(160_000);
    println!("{n} samples, keys 0 to {n}");
    for count in [1, 33, 1000] {
        // Powers from 1 to 4.
        let lights = (0..count).map(|i| light(LightKind::Point, 1.0 + (i % 4) as f32, i as f64 / 100.0));
        probe.load(&Scene { lights: lights.collect(), ..Scene::default() });
        let inverse = |key| 1.0 / (f64::from(probe.sample(key, [100.0, 0.0, 0.0], key < 10).pdf) * count as f64);
        let (mean, error) = mean((0..n as u32).map(inverse));
        println!("{count} lights: {mean} ± {error}");
        let off = (mean - 1.0).abs();
        assert!(off <= 4.0 * error + 1e-6 && off <= 0.01 && 4.0 * error <= 0.03, "{count}: {mean} ± {error}");
    }
}

/// T26, with a tree. The probability that a drawn light is told is to the bit the one that a ray to it asks for; lights are
/// drawn by these probabilities (χ²), which add to 1 less what is lost where a node may give light and no child does; and
/// every light that is turned to the point may be drawn.
#[test]
fn a_tree_draws_lights_by_the_probability_that_is_told() {
    let mut probe = LightProbe::default();
    let n = samples(4_000);
    println!("{n} samples, keys 0 to {n}");
    let points = [[3.1, 2.5, 0.2], [16.0, -3.0, 9.0], [1e3, 1.0, 0.0]];
    let level = sidak(FAMILY, 3 * points.len());
    let mut faults = Vec::new();
    for (count, sky) in [(33, true), (80, false), (1000, true)] {
        let tables = probe.load(&many(count, sky, |i| (0.3 * ((i * 7919 % 101) as f32 / 10.0 - 5.0)).exp()));
        let in_tree = tables.memory[binding::<Settings>()].words[Settings::TREE_LIGHTS.0 as usize] as usize;
        let rows: Vec<&[u32]> = tables.memory[binding::<Lights>()].words.chunks(Lights::COLUMNS.len()).collect();
        assert!(in_tree >= 16 && rows.len() == count && in_tree < count, "{in_tree} of {count}");
        for point in points {
            let mut told = Vec::new();
            for (i, row) in rows.iter().enumerate() {
                let word = |column: u32| row[column as usize];
                let p = f32::from_bits(word(Lights::PROBABILITY.0));
                told.push(if i < in_tree { probe.probability(i, point) } else { p });
                let is_lamp = word(Lights::KIND.0) == LIGHT_QUAD;
                // Lamps face down.
                let faces = word(Lights::DOUBLE_SIDED.0) != 0
                    || f64::from(f32::from_bits(word(Lights::P_Y.0))) + tables.origin.y > f64::from(point[1]) + 1e-3;
                let shines = word(Lights::KIND.0) == LIGHT_POINT || is_lamp && faces;
                assert!(told[i] > 0.0 || !shines, "{count} lights, {point:?}: light {i} is never drawn");
            }
            let mut drawn = vec![0.0; count + 1];
            for key in 0..n as u32 {
                let (light, p) = probe.choose_by_tree(key, point);
                assert!(p == 0.0 || p == told[light], "{count} lights, {point:?}: light {light}, {p}");
                drawn[if p > 0.0 { light } else { count }] += 1.0;
            }
            let sum: f64 = told.iter().map(|p| f64::from(*p)).sum();
            let lost = (1.0 - sum).max(0.0);
            let expected: Vec<f64> = told.iter().map(|p| f64::from(*p)).chain([lost]).map(|p| p * n as f64).collect();
            let (chi2, freedom) = chi2::pearson(&drawn, &expected);
            let p = if freedom == 0 { 1.0 } else { chi2_tail(chi2, freedom) };
            println!("{count} lights from {point:?}: probabilities add to {sum:.6}, p {p:.3}");
            if p < level || sum > 1.0 + 1e-5 {
                faults.push(format!("{count} lights from {point:?}: sum {sum}, p {p}"));
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn lights_without_extent_follow_the_extension() {
    let mut probe = LightProbe::default();
    let mut with = |kind, point: V| {
        probe.load(&Scene { lights: vec![light(kind, 1.0, 0.0)], ..Scene::default() });
        probe.sample(3, point, true)
    };
    for distance in [1e-6_f32, 1e-3, 1.0, 1e15] {
        let s = with(LightKind::Point, [distance, 0.0, 0.0]);
        let expected = f64::from(distance).powi(-2);
        assert!((f64::from(s.radiance) / expected - 1.0).abs() < 1e-6 && s.pdf == 1.0 && s.is_delta, "{s:?}");
        assert_eq!((s.wi, s.distance), ([-1.0, 0.0, 0.0], distance));
    }
    assert_eq!(with(LightKind::Point, [0.0; 3]).pdf, 0.0, "no direction from the light itself");
    let spot = LightKind::Spot { inner: 0.9_f32.acos(), outer: 0.5_f32.acos() };
    for (cos, expected) in [(1.0_f32, 1.0), (0.9, 1.0), (0.7, 0.25), (0.5, 0.0), (0.3, 0.0), (-0.5, 0.0)] {
        let s = with(spot, [2.0 * (1.0 - cos * cos).sqrt(), -2.0 * cos, 0.0]);
        assert!((s.radiance * 4.0 - expected).abs() < 2e-6, "cos {cos}: {}", s.radiance);
    }
    // A size that is none, or whose radiance no number holds.
    for radius in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-20] {
        assert!(with(LightKind::Sphere { radius }, [2.0, 0.0, 0.0]).is_delta, "radius {radius}");
        let (inner, outer) = (0.1, 0.5);
        assert!(with(LightKind::Disk { inner, outer, radius }, [0.0, -2.0, 0.0]).is_delta, "radius {radius}");
    }
    for angle in [0.0, 1e-7, -1.0, 4.0, f32::NAN] {
        assert!(with(LightKind::Sun { angle }, [0.0; 3]).is_delta, "angle {angle}");
    }
    assert!(!with(LightKind::Sun { angle: 1e-6 }, [0.0; 3]).is_delta);
    let s = with(LightKind::Directional, [9.0, 8.0, 7.0]);
    assert!((s.wi[1] - 1.0).abs() < 1e-7 && (s.distance, s.radiance) == (f32::INFINITY, 1.0), "{s:?}");
}

/// That of a user's crate, of exponent 2: the square of the cosine to its axis.
fn own_lamp() -> Scene {
    let own = vec![Model::named(lamp::NAME).with("exponent", &[2.0])];
    Scene { lights: vec![light(LightKind::Own(0), 1.0, 0.0)], own, ..Scene::default() }
}

#[test]
fn a_lamp_of_a_users_crate_shines_by_its_cosine() {
    let mut probe = LightProbe::default();
    probe.load(&own_lamp());
    for (cos, expected) in [(1.0_f32, 1.0), (0.8, 0.64), (0.1, 0.01), (0.0, 0.0), (-0.5, 0.0)] {
        let s = probe.sample(3, [2.0 * (1.0 - cos * cos).sqrt(), -2.0 * cos, 0.0], true);
        assert!((s.radiance * 4.0 - expected).abs() < 2e-6 && s.is_delta && s.pdf == 1.0, "cos {cos}: {s:?}");
    }
}

/// A lamp is not hidden by itself: neither where its halves meet, nor a needle whose every point is near the seam, nor from
/// a grazing angle; and from its own plane there is nothing to draw.
#[test]
fn a_lamp_does_not_hide_itself() {
    let mut probe = LightProbe::default();
    let (x, z) = (glam::Vec3::X, glam::Vec3::Z);
    for width in [1.0, 1e-3, 1e-6] {
        for (point, lit) in [
            ([0.3, 0.0, 0.2], true),
            ([0.0, 0.999_999, 0.0], true),
            ([1e3, 0.9, 0.0], true),
            ([2.0, 1.0, 0.3], false),
            ([0.1, 1.0, 0.0], false),
            ([0.3, 2.0, 0.2], false),
        ] {
            let mut scene = Scene::default();
            let lamp = rectangle(glam::vec3(-0.5, 1.0, -0.5 * width), x, z * width);
            place(&mut scene, lamp, Material::emitter("lamp", [1.0; 3]), 1.0, DVec3::ZERO);
            probe.solid_angle = false;
            probe.load(&scene);
            let by_area = draw(&mut probe, 0, point, samples(1_000));
            probe.solid_angle = true;
            probe.load(&scene);
            for s in draw(&mut probe, 0, point, samples(1_000)).into_iter().chain(by_area) {
                assert_eq!(s.pdf > 0.0 && s.pdf.is_finite(), lit, "width {width}, from {point:?}: {s:?}");
                assert!(!lit || !s.is_blocked, "width {width}, from {point:?}: {s:?}");
                assert!(lit || s.radiance == 0.0, "width {width}, from {point:?}: {s:?}");
            }
        }
    }
}

/// Unturned, u = 1/2 + atan2(x, −z)/2π. By 90 degrees about +Y, what is seen towards d is the map at (−z, x).
#[test]
fn the_environment_is_turned_about_y() {
    let mut probe = LightProbe::default();
    let radiance = (0..4).map(|x| [x as f32; 3]).collect();
    let map = Environment { width: 4, height: 1, radiance, intensity: 2.0, rotation_deg: 90.0 };
    probe.load(&Scene { environment: Some(map), ..Scene::default() });
    for (dir, u) in [([0.0, 0.0, -1.0], 0.75), ([1.0, 0.0, 0.0], 0.0), ([0.0, 0.0, 1.0], 0.25), ([-1.0, 0.0, 0.0], 0.5)]
    {
        let x: f64 = u * 4.0 - 0.5;
        let at = |i: f64| i.rem_euclid(4.0);
        let expected = at(x.floor()) + at(x.floor() + 1.0);
        let seen = probe.see([0.0; 3], dir);
        assert!((f64::from(seen.radiance) - expected).abs() < 1e-5, "{dir:?}: {seen:?}, not {expected}");
    }
}

/// Wherever a map shines, bilinearly, light sampling may draw; and the poles are no exception.
#[test]
fn where_a_sky_shines_there_is_density() {
    let mut probe = LightProbe::default();
    let mut random = Random::new(0x5eed_0008);
    for row in lights().iter().filter(|row| row.scene.environment.is_some()) {
        probe.load(&row.scene);
        for i in 0..samples(4_000) {
            // A third of them close to a pole.
            let z = 2.0 * random.uniform() - 1.0;
            let up = if i % 3 == 0 { z.signum() * (1.0 - 1e-4 * z.abs()) } else { z };
            let (sin, turn) = ((1.0 - up * up).sqrt(), 2.0 * PI * random.uniform());
            let dir = [sin * turn.cos(), up, sin * turn.sin()].map(|c| c as f32);
            let seen = probe.see([0.0, -50.0, 0.0], dir);
            let sky = seen.distance == f32::INFINITY;
            assert!(!sky || seen.radiance == 0.0 || seen.pdf > 0.0, "{}: {dir:?}, {seen:?}", row.name);
            assert!(seen.radiance.is_finite() && !seen.pdf.is_nan(), "{}: {dir:?}, {seen:?}", row.name);
        }
        for up in [1.0, -1.0] {
            let seen = probe.see([0.0, -50.0 * up, 0.0], [0.0, up, 0.0]);
            assert!(seen.radiance.is_finite() && !seen.pdf.is_nan(), "{}: {seen:?}", row.name);
        }
    }
}

/// What the device of streams asks the memory for is what light sampling reads: what it finds lies between those four texels.
#[test]
fn the_texels_that_are_asked_for_are_those_that_are_read() {
    let mut probe = LightProbe::default();
    let mut random = Random::new(0x5eed_0041);
    for (width, height) in [(1, 1), (7, 3), (64, 32)] {
        let radiance: Vec<_> = (0..width * height).map(|_| [random.uniform() as f32; 3]).collect();
        let map = Environment { width, height, radiance: radiance.clone(), intensity: 1.0, rotation_deg: 30.0 };
        let tables = probe.load(&Scene { environment: Some(map), ..Scene::default() });
        for key in 0..samples(1_000) as u32 {
            let found = probe.sample(key, [0.0; 3], false).radiance;
            let [start, step, _, dim, _] = stream(key);
            let asked = texels(&tables, [start, step, dim]).expect("there is an environment").map(|i| radiance[i][1]);
            let (least, most) = asked.into_iter().fold((f32::MAX, 0.0_f32), |(lo, hi), x| (lo.min(x), hi.max(x)));
            let rounding = 4.0 * f32::EPSILON;
            assert!(
                (least - rounding..=most + rounding).contains(&found),
                "{width}x{height}, {key}: {found}, {asked:?}"
            );
        }
    }
}

/// T10. No ray that leaves a lamp meets it, also where the lamp's points have no error to be moved by: on a plane through 0.
#[test]
fn no_ray_that_leaves_a_lamp_meets_it() {
    let mut probe = LightProbe::default();
    let n = samples(1_000);
    println!("{n} samples, keys 0 to {n}");
    for (height, lean) in [(0.0, 0.0), (1e-3, 0.0), (1.0, 0.0), (0.3, 0.7)] {
        for triangles in [2, 1] {
            let mut scene = Scene::default();
            let lamp = rectangle(glam::vec3(-1.0, height, -1.0), glam::Vec3::Z * 0.8, glam::vec3(2.0, lean, 0.0));
            place(
                &mut scene,
                lamp,
                Material { double_sided: true, ..Material::emitter("lamp", [1.0; 3]) },
                1.0,
                DVec3::ZERO,
            );
            scene.meshes[0].triangles.truncate(triangles);
            probe.load(&scene);
            let met = (0..n as u32).filter(|key| probe.emit(*key, 0, false).is_blocked).count();
            assert_eq!(met, 0, "at height {height}, leaning by {lean}, {triangles} triangles");
        }
    }
}

/// Rays that leave a light carry its flux.
#[test]
fn the_rays_that_leave_a_light_carry_its_flux() {
    let mut probe = LightProbe::default();
    let n = samples(10_000);
    println!("{n} samples, keys 0 to {n}");
    let mut check = |scene: &Scene, expected: f64, what: &str| {
        probe.load(scene);
        let fluxes = (0..n as u32).map(|key| {
            let e = probe.emit(key, 0, key < 20);
            let length = e.dir.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>();
            assert!((length - 1.0).abs() < 1e-5, "{what}: a unit direction");
            e.flux
        });
        let (flux, error) = mean(fluxes);
        assert!((flux - expected).abs() <= 4.0 * error + 1e-4 * expected, "{what}: {flux} ± {error}, not {expected}");
    };
    for (double_sided, sides) in [(false, 1.0), (true, 2.0)] {
        let mut scene = Scene::default();
        let lamp = rectangle(glam::vec3(1.0, 2.0, 3.0), glam::Vec3::Y * 2.0, glam::Vec3::X * 3.0);
        let material = Material { double_sided, ..Material::emitter("lamp", [1.0; 3]) };
        place(&mut scene, lamp, material, 1.0, DVec3::ZERO);
        check(&scene, sides * 6.0 * PI, "quad");
        scene.meshes[0].triangles.truncate(1);
        check(&scene, sides * 3.0 * PI, "triangle");
    }
    // The full intensity above the inner cosine, and the integral of the square of a ramp below.
    let spot = LightKind::Spot { inner: 0.75_f32.acos(), outer: 0.5_f32.acos() };
    let of = |kind| Scene { lights: vec![light(kind, 1.0, 0.0)], ..Scene::default() };
    check(&of(spot), 2.0 * PI * (0.25 + 0.25 / 3.0), "spot");
    check(&of(LightKind::Point), 4.0 * PI, "point");
    check(&own_lamp(), 2.0 * PI / 3.0, "a user's lamp");
    check(&of(LightKind::Sphere { radius: 0.5 }), 4.0 * PI, "sphere");
    let disk = LightKind::Disk { inner: 0.75_f32.acos(), outer: 0.5_f32.acos(), radius: 0.5 };
    check(&of(disk), 2.0 * PI * (0.25 + 0.25 / 3.0), "disk");
    // From all sides onto the disk of the bounding sphere, whose radius is 3.
    let mut sky = Scene::default();
    place(
        &mut sky,
        rectangle(glam::vec3(-2.0, -1.0, -2.0), glam::Vec3::X * 4.0, glam::vec3(0.0, 2.0, 4.0)),
        Material::default(),
        1.0,
        DVec3::ZERO,
    );
    let uniform = Environment { width: 8, height: 4, radiance: vec![[2.0; 3]; 32], intensity: 1.0, rotation_deg: 0.0 };
    sky.environment = Some(uniform);
    check(&sky, 2.0 * 4.0 * PI * PI * 9.0, "environment");
    // Onto the same disk, faced from each direction: 1 lux is radiance 1 / (π sin² 0.5), times 2π (1 − cos 0.5) steradians.
    let sun = Scene { environment: None, lights: vec![light(LightKind::Sun { angle: 1.0 }, 1.0, 0.0)], ..sky };
    check(&sun, 2.0 * PI * 9.0 * (1.0 - 0.5_f64.cos()) / 0.5_f64.sin().powi(2), "sun");
}

/// Emission under a clear coat: 1 − c F of it, with the exact Fresnel factor F of index 1.5 (KHR_materials_clearcoat). What light
/// sampling gives is compared with what a ray sees, here, by the rows of coated lamps.
#[test]
fn a_coat_dims_emission() {
    let table = lights();
    let row = table.iter().find(|row| row.name == "coated lamp").expect("it is in the table");
    let mut probe = LightProbe::default();
    probe.load(&row.scene);
    for cos in [1.0_f64, 0.8, 0.5, 0.1] {
        let inner = (1.0 - (1.0 - cos * cos) / 2.25).sqrt();
        let [s, p] = [(cos - 1.5 * inner) / (cos + 1.5 * inner), (1.5 * cos - inner) / (1.5 * cos + inner)];
        let expected = 2.0 * (1.0 - 0.8 * (s * s + p * p) / 2.0);
        // The lamp is at height 0.3; a ray that ends at its middle.
        let dir = [(1.0 - cos * cos).sqrt(), cos, 0.0];
        let from = [-dir[0] / cos * 0.1, 0.2, 0.0].map(|x| x as f32);
        let seen = probe.see(from, dir.map(|x| x as f32));
        assert!((f64::from(seen.radiance) / expected - 1.0).abs() < 1e-5, "cos {cos}: {seen:?}, not {expected}");
    }
}

/// N11. Two weights add to 1 for all densities, also where squares overflow or vanish; where no sampler draws, 0.
#[test]
fn the_power_heuristic_is_a_weight_for_all_densities() {
    let mut bench = Bench::new(|| entry("mis", Fun::lam(|_, (own, other): (F32, F32)| power_heuristic(own, other))));
    let mut weight = |own: f32, other: f32| f32::from_bits(bench.run_both("mis", &[own, other].map(f32::to_bits))[0]);
    let all = [0.0, 1e-45, 1e-30, 1e-19, 0.5, 1.0, 2.0, 1e20, f32::MAX, f32::INFINITY];
    for (a, b) in all.iter().flat_map(|a| all.map(|b| (*a, b))) {
        let (x, y) = (weight(a, b), weight(b, a));
        let expected = if a > 0.0 || b > 0.0 { 1.0 } else { 0.0 };
        assert!((x + y - expected).abs() < 1e-6 && (0.0..=1.0).contains(&x), "{a} and {b}: {x} + {y}");
    }
    assert_eq!(weight(1.0, 2.0), 0.2);
}
