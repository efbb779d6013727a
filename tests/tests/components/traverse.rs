//! What a ray hits: the same for every tree, and as [`accept`](jerboa_lib_render::traverse::AcceptFn) and its range say.
//! `JERBOA_RAYS=N` sends N rays to the random triangles instead of 3,000.

use jerboa_ir::lang::{Bool, Fun, Keep, entry};
use jerboa_lib_render::host::bvh::{Bvh, Triangle};
use jerboa_lib_render::ray::{Hit, Ray};
use jerboa_lib_render::schema::{NONE, Settings};
use jerboa_lib_render::traverse::{AcceptFn, make_traverse};

use jerboa_tests::harness::bench::{Bench, Random, number};
use jerboa_tests::harness::brute::declare_brute_force;
use jerboa_tests::harness::rays::{TREES, ball, load, ray};

/// Kernels `nearest` and `any`; where the scene has cut-outs, only odd primitives count.
fn bench() -> Bench {
    Bench::new(|| {
        let traverse = make_traverse();
        let odd = AcceptFn::lam(|_, (_, hit)| (hit.primitive & 1).eq(1));
        let kind = |any: bool| Fun::<Ray, Hit>::lam(move |b, ray| traverse.call(b, (ray, Keep(Bool::from(any)), odd)));
        entry("nearest", kind(false));
        entry("any", kind(true));
        declare_brute_force();
    })
}

#[test]
fn every_tree_gives_the_same_hit() {
    let mut random = Random::new(0x5eed_0002);
    let mut bench = bench();
    for round in 0..number("JERBOA_RAYS", 3000) / 75 {
        // Big and small, some of them flat in an axis, some on one slanted plane, some twice, so that there are (near) ties.
        let mut triangles: Vec<Triangle> = (0..24)
            .map(|_| {
                let (at, size) = (random.point(), 4.0_f32.powi(2 - random.below(6) as i32));
                let flat = random.below(6);
                let corner = |random: &mut Random| {
                    let by = random.point();
                    let p = [0, 1, 2].map(|k| if k == flat { 0.25 } else { at[k] + size * by[k] });
                    if flat == 5 { [p[0], p[1], 0.3 * p[0] - 0.7 * p[1]] } else { p }
                };
                [corner(&mut random), corner(&mut random), corner(&mut random)]
            })
            .collect();
        triangles.extend_from_within(..8);
        let scale = 2.0_f32.powi(10 * (round % 5) as i32 - 20);
        let triangles: Vec<Triangle> = triangles.iter().map(|t| t.map(|p| p.map(|x| x * scale))).collect();
        let rays: Vec<_> = (0..250)
            .map(|i| {
                let org = random.point().map(|x| 2.0 * scale * x);
                let t = triangles[random.below(triangles.len())];
                let dir = match i % 4 {
                    0 => random.point(),
                    1 => [0, 1, 2].map(|k| t[0][k] - org[k]),
                    2 => [0, 1, 2].map(|k| 0.5 * (t[0][k] + t[1][k]) - org[k]),
                    _ => std::array::from_fn(|k| if k == i % 3 { -1.0 } else { 0.0 }),
                };
                ray(org, dir)
            })
            .collect();
        let hits = TREES.each_ref().map(|tree| {
            load(&mut bench, &(tree.build)(&mut random, &triangles), &triangles);
            rays.iter().map(|ray| (bench.run("nearest", ray), bench.run("any", ray)[0] != NONE)).collect::<Vec<_>>()
        });
        assert!(hits[0].iter().filter(|hit| hit.1).count() > 50, "the rays hit something");
        let slots = Bvh::build(&triangles).order.len() as u32;
        for (i, ray) in rays.iter().enumerate() {
            let brute = bench.run("brute", &[&ray[..], &[slots]].concat());
            for (tree, hits) in TREES.iter().zip(&hits) {
                assert_eq!(hits[i].0, brute, "round {round}, ray {i}, the tree {}", tree.name);
                assert_eq!(hits[i].1, brute[0] != NONE, "any hit where there is one: round {round}, ray {i}");
            }
        }
    }
}

#[test]
fn of_two_coincident_triangles_the_smaller_number_is_hit() {
    let mut bench = bench();
    let t = [[-1.0, -1.0, 2.0], [1.0, -1.0, 2.0], [0.0, 1.0, 2.0]];
    let triangles = vec![t; 40];
    let bvh = Bvh::build(&triangles);
    load(&mut bench, &bvh, &triangles);
    let mut towards = ray([0.0; 3], [0.0, 0.0, 1.0]);
    assert_eq!(bench.run_both("nearest", &towards)[0..2], [0, 2.0_f32.to_bits()]);
    towards[7..10].copy_from_slice(&[0, 1, 3]);
    assert_eq!(bench.run_both("nearest", &towards)[0], 2, "three are skipped");
    bench.set(Settings::HAS_CUTOUTS, 0, true);
    assert_eq!(bench.run_both("nearest", &towards)[0], 5, "the even ones are holes");
}

#[test]
fn the_range_is_open() {
    let mut bench = bench();
    let triangles = [[[-1.0, -1.0, 2.0], [1.0, -1.0, 2.0], [0.0, 1.0, 2.0]]];
    load(&mut bench, &Bvh::build(&triangles), &triangles);
    let mut hits = |z: f32, tmax: f32| {
        let mut ray = ray([0.0, 0.0, z], [0.0, 0.0, 1.0]);
        ray[6] = tmax.to_bits();
        bench.run_both("nearest", &ray)[0] == 0
    };
    assert!(hits(0.0, 2.000_001));
    assert!(!hits(0.0, 2.0), "the end is not part of it");
    assert!(!hits(2.0, 1.0), "nor is the start");
    assert!(!hits(3.0, 10.0), "behind");
}

#[test]
fn unusable_rays_and_empty_scenes_miss() {
    let mut bench = bench();
    let triangles = ball(8, |_, _| 1.0);
    load(&mut bench, &Bvh::build(&triangles), &triangles);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(bench.run_both("nearest", &ray([0.0, bad, 0.0], [0.0, 0.0, 1.0]))[0], NONE);
        assert_eq!(bench.run_both("nearest", &ray([0.0; 3], [1.0, 0.0, bad]))[0], NONE);
    }
    assert_eq!(bench.run_both("nearest", &ray([0.0; 3], [0.0; 3]))[0], NONE, "no direction");
    load(&mut bench, &Bvh::build(&[]), &[]);
    assert_eq!(bench.run_both("nearest", &ray([0.0; 3], [0.0, 0.0, 1.0]))[0], NONE, "no triangles");
}
