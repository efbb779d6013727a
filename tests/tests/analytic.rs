//! Whole renders against closed forms: T4 (closed enclosures), T16 (roulette), T27 (direct light), and that seeds and
//! estimators agree.
//!
//! The scenes are the tables of `jerboa_tests::harness::analytic`; a row there is a row of every test here. Each mean is of
//! independent samples with a fixed seed and must lie within 4 standard errors of the truth: a correct renderer fails a
//! comparison with probability 6.3e-5 for another seed (some of the 250 here: 1 in 64). The long form has a million paths for each
//! comparison, as the list asks:
//!
//! ```text
//! JERBOA_PATHS=1000000 cargo test --release -p jerboa-tests --test analytic -- --nocapture --test-threads 1
//! ```

use glam::{DAffine3, Vec3};
use jerboa_lib_render::host::device::DeviceKind;
use jerboa_lib_render::host::film::{Film, Window};
use jerboa_lib_render::host::generate::generic;
use jerboa_lib_render::host::renderer::{Handle, Options, Render, Renderer};
use jerboa_lib_render::host::replay::interpret;
use jerboa_lib_render::host::tables::{Choices, Pass};
use jerboa_scenes::{AlphaMode, Instance, Material, Mesh, Scene};
use jerboa_tests::harness::analytic::{
    Closed, Estimate, Look, SEED, bodies, bound, direct, enclosures, estimate, estimate_green, glowing_box, plates,
    renderer, seen,
};
use jerboa_tests::harness::bench::number;

/// Paths of a comparison.
fn paths(quick: usize) -> usize {
    number("JERBOA_PATHS", quick)
}

/// Each grey scene of a table, rendered at every look of it.
fn all_agree(table: &[Closed], quick: usize, most: f64) {
    all_agree_by(estimate, table, quick, most);
}

fn all_agree_by(estimate: fn(&Renderer, &Look, usize, u32) -> Estimate, table: &[Closed], quick: usize, most: f64) {
    let paths = paths(quick);
    println!("{paths} paths, seeds from {SEED} on");
    let mut faults = Vec::new();
    for closed in table {
        let r = closed.renderer();
        for ((look, truth), seed) in closed.looks.iter().zip(SEED..) {
            let found = estimate(&r, look, paths * closed.effort, seed);
            println!("{}: {:.6e} ± {:.1e}, truth {truth:.6e}", closed.name, found.mean, found.error);
            let fault = found.fault(*truth, closed.facets, bound(most, paths));
            faults.extend(fault.map(|f| format!("{}, seed {seed}: {f}", closed.name)));
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn enclosures_have_their_radiance() {
    all_agree(&enclosures(), 1 << 12, 5e-3);
}

/// Each lobe, model and instance that keeps a known share of the light, in a uniform sky or in a room that glows.
#[test]
fn bodies_have_their_radiance() {
    all_agree(&bodies(), 1 << 12, 5e-3);
}

/// Each lobe and model that loses light, and materials of a Wavefront file, at three slants.
#[test]
fn plates_return_what_quadrature_says() {
    all_agree_by(estimate_green, &plates(), 1 << 12, 5e-3);
}

/// Each camera.
#[test]
fn cameras_see_what_they_should() {
    all_agree(&seen(), 1 << 12, 5e-3);
}

#[test]
fn direct_light_has_its_closed_form() {
    all_agree(&direct(), 1 << 12, 2e-3);
}

/// Roulette at the first scattering already changes no mean, though a floor of metal in white paint mirrors a part of the
/// sky and mixes the rest: which paths survive must not depend on the lobe that sent them.
#[test]
fn roulette_changes_no_mean() {
    let paths = paths(1 << 14);
    println!("{paths} paths, seeds {SEED} and {}", SEED + 1);
    for closed in direct().iter().filter(|c| c.scene.environment.is_some()) {
        let mut scene = closed.scene.clone();
        scene.materials.iter_mut().for_each(|m| (m.metallic, m.roughness) = (0.5, 0.3));
        let mean = |rr_depth: Option<u32>, seed: u32| {
            let choices = Choices { rr_depth, ..closed.choices };
            estimate(&renderer(&scene, choices), &closed.looks[0].0, paths, seed)
        };
        let (with, without) = (mean(Some(1), SEED), mean(None, SEED + 1));
        let error = with.error.hypot(without.error);
        println!("{}: {with:?}, {without:?}", closed.name);
        assert!((with.mean - without.mean).abs() <= 4.0 * error, "{}", closed.name);
    }
}

/// The same by paths that find emitters only by chance: what light sampling and its weights must add up to.
#[test]
fn without_light_sampling_it_is_the_same() {
    let paths = paths(1 << 14);
    println!("{paths} paths, seed {SEED}");
    for closed in direct().iter().filter(|c| c.scene.materials.iter().any(Material::is_emissive)) {
        let r = closed.by_bsdf_only();
        for (look, truth) in &closed.looks {
            let found = estimate(&r, look, paths, SEED);
            println!("{}: {:.6e} ± {:.1e}, truth {truth:.6e}", closed.name, found.mean, found.error);
            let off = (found.mean - truth).abs() - closed.facets * truth;
            // A lamp that no path meets has an error of 0.
            let met = found.error > 0.0;
            assert!(!met || off <= (4.0 * found.error).max(1e-4 * truth), "{}: {found:?}, truth {truth}", closed.name);
        }
    }
}

/// Machine code, the interpreted residual and the interpreted generic program give the same bits.
#[test]
fn every_engine_sees_the_same() {
    let rooms = enclosures();
    // Albedo is a number and changes no program.
    let rooms = rooms.iter().filter(|c| c.name.ends_with("0.5"));
    for closed in rooms.chain(&direct()).chain(&bodies()).chain(&plates()).chain(&seen()) {
        let options = Options { choices: closed.choices, device: DeviceKind::CpuScalar, ..Options::default() };
        let r = Renderer::new(&closed.scene, options).unwrap_or_else(|e| panic!("{}: {e}", closed.name));
        let look = &closed.looks[0].0;
        let window = Window { width: 1, height: 1, ..look.window };
        let pass = Pass { size: look.size, window, sample: 0, samples: 2, seed: SEED };
        let compiled = r.samples(&look.camera, &pass).unwrap_or_else(|e| panic!("{e}"));
        for (engine, program) in [("residual", &r.kernels()[0].residual.program), ("generic", generic().program())] {
            let words = interpret(program, "path", r.tables(), &look.camera, &pass, &mut ());
            assert_eq!(words.unwrap_or_else(|e| panic!("{e}")), compiled, "{}, {engine}", closed.name);
        }
    }
}

/// T16. Without light sampling and from scattering s on with survival rho^s, then rho: the part before is certain, after
/// that a geometric number of vertices follows, with probability rho^s at all. So the relative variance is
/// rho^s (1 + rho − rho^s): .09 .57 .82 .92 .99 for s = 4, which is what the list has.
#[test]
fn roulette_costs_what_the_theory_says() {
    println!("seed {SEED}");
    for (albedo, quick) in [(0.5, 1 << 14), (0.8, 1 << 14), (0.9, 1 << 13), (0.95, 1 << 13), (0.99, 1 << 13)] {
        let closed = glowing_box(albedo as f32);
        for start in [3, 4] {
            let r = renderer(&closed.scene, Choices { rr_depth: Some(start), ..Choices::default() });
            let found = estimate(&r, &closed.looks[0].0, paths(quick), SEED);
            let power = f64::powi(albedo, start as i32);
            let (variance, theory) = (found.relative_variance(), power * (1.0 + albedo - power));
            let Estimate { mean, error, .. } = found;
            println!(
                "albedo {albedo}, from {start}: {mean:.5} ± {error:.5}, variance {variance:.3}, theory {theory:.3}"
            );
            assert_eq!(found.fault(1.0, 0.0, bound(5e-3, paths(quick))), None);
            assert!(variance <= 1.2 * theory, "albedo {albedo} from {start}: variance {variance}, theory {theory}");
        }
    }
}

/// Paths of at most k edges bring 1 − ρ^k.
#[test]
fn limited_depth_is_a_geometric_sum() {
    for depth in [1, 2, 3, 6] {
        let choices = Choices { max_depth: Some(depth), ..Choices::default() };
        let closed = Closed { choices, ..glowing_box(0.5) };
        let found = estimate(&closed.renderer(), &closed.looks[0].0, paths(1 << 14), SEED);
        let truth = 1.0 - 0.5_f64.powi(depth as i32);
        assert_eq!(found.fault(truth, 0.0, bound(5e-3, paths(1 << 14))), None, "{depth} edges");
    }
}

fn load(name: &str) -> Scene {
    Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{e}"))
}

/// Balls that keep all light, smooth and rough, in a sky of radiance 1.
#[test]
fn what_absorbs_nothing_is_invisible() {
    let scene = load("white-furnace");
    let look = Look::whole(scene.camera_or_default());
    let found = estimate(&renderer(&scene, Choices::default()), &look, paths(1 << 15), SEED);
    assert_eq!(found.fault(1.0, 0.0, bound(5e-3, paths(1 << 15))), None);
}

#[test]
fn nothing_leaks_into_a_black_room() {
    for name in ["black-box", "black-sphere"] {
        let scene = load(name);
        let look = Look::whole(scene.camera_or_default());
        let lit = |s: &[f64; 3]| s.iter().any(|c| *c != 0.0);
        let r = renderer(&scene, Choices::default());
        assert_eq!(look.samples(&r, paths(1 << 15), SEED).filter(lit).count(), 0, "{name}");
    }
}

/// A black card that is there with probability 1/4, crossed by the camera's ray and again, the same triangle, by the shadow
/// ray: each decides for itself, so 9/16 of the light comes through.
#[test]
fn a_blended_card_is_crossed_twice() {
    let table = direct();
    let sun = table.iter().find(|c| c.name == "sun").expect("it is in the table");
    let mut scene = sun.scene.clone();
    let black = Material { alpha_mode: AlphaMode::Blend, ..Material::diffuse("card", [0.0; 3]) };
    scene.materials.push(Material { base_color: [0.0, 0.0, 0.0, 0.25], ..black });
    scene.meshes.push(Mesh {
        positions: [[-100.0, 0.01, -100.0], [0.0, 0.01, 200.0], [100.0, 0.01, -100.0]].map(Vec3::from).to_vec(),
        triangles: vec![[0, 1, 2]],
        material: scene.materials.len() - 1,
        ..Mesh::default()
    });
    scene.instances.push(Instance { mesh: scene.meshes.len() - 1, to_world: DAffine3::IDENTITY });
    let (look, uncovered) = &sun.looks[0];
    let found = estimate(&renderer(&scene, Choices::default()), look, paths(1 << 16), SEED);
    assert_eq!(found.fault(0.75 * 0.75 * uncovered, 0.0, bound(5e-3, paths(1 << 16))), None);
}

/// Emitters without area are no lights: no sample changes by a bit. The corners of the last ones lie on one line, exactly,
/// but so far apart that edges rounded to single precision have an area.
#[test]
fn emitters_without_area_change_nothing() {
    let table = direct();
    let lamp = table.iter().find(|c| c.name == "lamp at height 1").expect("it is in the table");
    let (look, _) = &lamp.looks[0];
    let mut scene = lamp.scene.clone();
    // Few enough digits that twice and three times a number is exact too.
    let on_a_line = |x: f32| Vec3::new(1.0, 2.0, 3.0) * f32::from_bits(x.to_bits() & !0xff);
    let flat = [
        [Vec3::splat(0.1); 3],
        [Vec3::new(0.0, 0.5, 0.0), Vec3::new(1.0, 0.5, 1.0), Vec3::splat(0.5)],
        [0.1, 1e-9, 0.7].map(on_a_line),
        [1e-7, 0.3, 0.7].map(on_a_line),
        [3e-8, 0.9, 0.2].map(on_a_line),
    ];
    for positions in flat {
        let mesh = Mesh { positions: positions.to_vec(), triangles: vec![[0, 1, 2]], ..Mesh::default() };
        scene.meshes.push(Mesh { material: scene.meshes[1].material, ..mesh });
        scene.instances.push(Instance { mesh: scene.meshes.len() - 1, to_world: DAffine3::IDENTITY });
    }
    let samples = |scene: &Scene| -> Vec<[f64; 3]> {
        look.samples(&renderer(scene, Choices { max_depth: Some(2), ..Choices::default() }), 1 << 10, SEED).collect()
    };
    assert_eq!(samples(&scene), samples(&lamp.scene));
}

/// Two triangles that form a parallelogram are one light. Apart they are chosen one by one, which for area sampling is
/// the same density: so neither way may have more variance than the other.
#[test]
fn a_seam_costs_nothing() {
    let table = direct();
    let variance = |name: &str| {
        let closed = table.iter().find(|c| c.name == name).expect("it is in the table");
        let found = estimate(&closed.renderer(), &closed.looks[0].0, paths(1 << 15), SEED);
        println!("{name}: {:.6} ± {:.6}, variance {:.4}", found.mean, found.error, found.relative_variance());
        found.relative_variance()
    };
    for height in ["1", "0.01"] {
        let ratio =
            variance(&format!("lamp at height {height}")) / variance(&format!("lamp in two halves at height {height}"));
        assert!((0.9..1.1).contains(&ratio), "height {height}: whole over halves {ratio}");
    }
}

/// The films of eight seeds, merged, hold to the bit what their samples one by one add up to; and their mean is that of
/// one run of eight times the samples, within 4 standard errors of the difference.
#[test]
fn seeds_add_up() {
    let closed = glowing_box(0.8);
    let (look, spp) = (&closed.looks[0].0, 16);
    let r = closed.renderer();
    let film_of = |spp: u32, seed: u32| {
        let mut film = Film::of_size(look.size);
        let job = Render { sample: 0, spp, seed };
        r.render_with(&look.camera, &mut film, job, &Handle::default()).unwrap_or_else(|e| panic!("{e}"));
        film
    };
    let (mut merged, mut one_by_one) = (Film::of_size(look.size), Film::of_size(look.size));
    let mut values = Vec::new();
    for seed in (SEED..).take(8) {
        merged.merge(&film_of(spp, seed)).expect("the same window");
        let samples = look.samples(&r, look.window.area() * spp as usize, seed);
        for (i, s) in samples.enumerate() {
            let pixel = i as u32 / spp;
            one_by_one.add([pixel % look.size[0], pixel / look.size[0]], s.map(|c| c as f32));
            values.push(s[1]);
        }
    }
    assert_eq!(merged.mean().pixels, one_by_one.mean().pixels);
    let long: Vec<f64> = look.samples(&r, look.window.area() * 8 * spp as usize, SEED + 8).map(|s| s[1]).collect();
    let (a, b) = (Estimate::of(&values), Estimate::of(&long));
    println!("seeds {SEED} to {}: {a:?}, {b:?}", SEED + 8);
    assert!((a.mean - b.mean).abs() <= 4.0 * a.error.hypot(b.error));
    let pixels = film_of(8 * spp, SEED + 8).mean().pixels;
    let mean = pixels.iter().map(|p| f64::from(p[1])).sum::<f64>() / pixels.len() as f64;
    assert!((mean / b.mean - 1.0).abs() < 1e-6, "the film holds what the samples are");
}
