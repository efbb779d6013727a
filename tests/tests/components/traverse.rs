//! What a ray hits: watertight, the same for every tree, and as [`accept`](jerboa_lib_render::traverse::AcceptFn) says.
//! `JERBOA_RAYS=N` sends N rays to the sphere at each place instead of 3,000, and as many more to the random trees.

use jerboa_ir::lang::{Bool, Fun, Keep, entry};
use jerboa_lib_render::host::bvh::{Bounds, Bvh, BvhNode, ChildRef, Triangle};
use jerboa_lib_render::ray::{Hit, Ray};
use jerboa_lib_render::schema::{NONE, Nodes, Settings, Triangles};
use jerboa_lib_render::traverse::{AcceptFn, make_traverse};

use jerboa_tests::harness::bench::{Bench, Random, number};

/// Kernels `nearest` and `any`; where the scene has cut-outs, only odd primitives count.
fn bench() -> Bench {
    Bench::new(|| {
        let traverse = make_traverse();
        let odd = AcceptFn::lam(|_, (_, hit)| (hit.primitive & 1).eq(1));
        let kind = |any: bool| Fun::<Ray, Hit>::lam(move |b, ray| traverse.call(b, (ray, Keep(Bool::from(any)), odd)));
        entry("nearest", kind(false));
        entry("any", kind(true));
    })
}

/// Put a tree on the bench.
pub fn load(bench: &mut Bench, bvh: &Bvh, triangles: &[Triangle]) {
    bench.rows::<Nodes>(bvh.nodes.len());
    for (row, node) in bvh.nodes.iter().enumerate() {
        for (column, word) in node.words().into_iter().enumerate() {
            bench.set(jerboa_ir::lang::Col::<Nodes, ()>::new(column as u32), row, word);
        }
    }
    bench.rows::<Triangles>(bvh.order.len().max(1));
    for (slot, &number) in bvh.order.iter().enumerate() {
        for (column, x) in triangles[number as usize].concat().into_iter().enumerate() {
            bench.set(jerboa_ir::lang::Col::<Triangles, ()>::new(column as u32), slot, x);
        }
        bench.set(Triangles::PRIMITIVE, slot, number);
    }
}

/// A tree without any structure: a chain in which each node holds one triangle and the box of all the rest. So few
/// triangles that it fits the stack.
fn chain(triangles: &[Triangle]) -> Bvh {
    let mut bvh = Bvh::build(triangles);
    let bounds = |n: &u32| Bounds::of(&triangles[*n as usize]);
    let rest = |i: usize| bvh.order[i..].iter().fold(Bounds::EMPTY, |all, n| all.union(&bounds(n)));
    let node = |i: usize| {
        let inner = if i + 1 < bvh.order.len() { ChildRef::Inner(i as u32 + 1) } else { ChildRef::EMPTY };
        let leaf = ChildRef::Leaf { first: i as u32, count: 1 };
        BvhNode { bounds: [rest(i + 1), bounds(&bvh.order[i])], child: [inner, leaf].map(ChildRef::encode) }
    };
    bvh.nodes = (0..bvh.order.len()).map(node).collect();
    bvh
}

/// A ray without end that skips nothing.
pub fn ray(org: [f32; 3], dir: [f32; 3]) -> [u32; 10] {
    let floats = [org[0], org[1], org[2], dir[0], dir[1], dir[2], f32::INFINITY].map(f32::to_bits);
    std::array::from_fn(|i| floats.get(i).copied().unwrap_or(NONE))
}

fn sub(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|k| a[k] - b[k])
}

/// The unit sphere about 0 by latitude and longitude: closed, corners shared to the bit.
fn sphere(around: usize) -> Vec<Triangle> {
    let at = |i: usize, j: usize| {
        let (theta, phi) = (
            std::f64::consts::PI * i as f64 / (around / 2) as f64,
            std::f64::consts::TAU * (j % around) as f64 / around as f64,
        );
        if i == 0 || 2 * i == around {
            return [0.0, 0.0, if i == 0 { 1.0 } else { -1.0 }];
        }
        [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()].map(|x| x as f32)
    };
    let quads = (0..around / 2).flat_map(|i| (0..around).map(move |j| (i, j)));
    let halves = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    halves.filter(|[a, b, c]| a != b && b != c && c != a).collect()
}

#[test]
fn a_closed_sphere_has_no_holes() {
    let mut random = Random::new(0x5eed_0001);
    let mut bench = bench();
    let places = [
        ([0.0; 3], 1.0),
        ([0.0; 3], 1e-15),
        ([0.0; 3], 1e15),
        ([1.37, -2.21, 0.5], 1.0),
        ([148376.0, 1234.0, -223423.0], 1.0),
        ([1e6; 3], 1.0),
        ([1.0; 3], 1e-3),
    ];
    for (centre, scale) in places {
        let place = |p: [f32; 3]| [0, 1, 2].map(|k| p[k] * scale + centre[k]);
        let triangles: Vec<Triangle> = sphere(24).into_iter().map(|t| t.map(place)).collect();
        let bvh = Bvh::build(&triangles);
        load(&mut bench, &bvh, &triangles);
        for i in 0..number("JERBOA_RAYS", 3000) {
            let t = triangles[bvh.order[random.below(bvh.order.len())] as usize];
            let weight = random.uniform() as f32;
            let aim = match i % 3 {
                0 => t[0],
                1 => [0, 1, 2].map(|k| t[0][k] + weight * (t[1][k] - t[0][k])),
                _ => [0, 1, 2].map(|k| (t[0][k] + t[1][k] + t[2][k]) / 3.0),
            };
            let org = place(random.point().map(|x| 0.4 * x));
            let dir = sub(aim, org);
            let length = dir.iter().map(|x| x * x).sum::<f32>().sqrt();
            let dir = if i % 2 == 0 || length == 0.0 { dir } else { dir.map(|x| x / length) };
            let args = ray(org, dir);
            let hit = if i < 30 { bench.run_both("nearest", &args) } else { bench.run("nearest", &args) };
            assert_ne!(hit[0], NONE, "centre {centre:?}, scale {scale}: {org:?} to {aim:?}");
            assert_ne!(bench.run("any", &args)[0], NONE);
        }
    }
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
        let built = Bvh::build(&triangles);
        let chain = chain(&triangles);
        let rays: Vec<_> = (0..250)
            .map(|i| {
                let org = random.point().map(|x| 2.0 * scale * x);
                let t = triangles[random.below(triangles.len())];
                let dir = match i % 4 {
                    0 => random.point(),
                    1 => sub(t[0], org),
                    2 => sub([0, 1, 2].map(|k| 0.5 * (t[0][k] + t[1][k])), org),
                    _ => std::array::from_fn(|k| if k == i % 3 { -1.0 } else { 0.0 }),
                };
                ray(org, dir)
            })
            .collect();
        let trees = [built, chain];
        let hits = trees.map(|bvh| {
            load(&mut bench, &bvh, &triangles);
            rays.iter().map(|ray| (bench.run("nearest", ray), bench.run("any", ray)[0] != NONE)).collect::<Vec<_>>()
        });
        assert!(hits[0].iter().filter(|hit| hit.1).count() > 50, "the rays hit something");
        for (i, (a, b)) in hits[0].iter().zip(&hits[1]).enumerate() {
            assert_eq!(a, b, "round {round}, ray {i}");
            assert_eq!(a.0[0] != NONE, a.1, "any hit where there is a nearest one: round {round}, ray {i}");
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
    let triangles = sphere(8);
    load(&mut bench, &Bvh::build(&triangles), &triangles);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(bench.run_both("nearest", &ray([0.0, bad, 0.0], [0.0, 0.0, 1.0]))[0], NONE);
        assert_eq!(bench.run_both("nearest", &ray([0.0; 3], [1.0, 0.0, bad]))[0], NONE);
    }
    assert_eq!(bench.run_both("nearest", &ray([0.0; 3], [0.0; 3]))[0], NONE, "no direction");
    load(&mut bench, &Bvh::build(&[]), &[]);
    assert_eq!(bench.run_both("nearest", &ray([0.0; 3], [0.0, 0.0, 1.0]))[0], NONE, "no triangles");
}

#[test]
fn hits_scale_with_the_scene_to_the_bit() {
    let mut random = Random::new(0x5eed_000d);
    let mut bench = bench();
    let unit: Vec<Triangle> = sphere(12);
    let rays: Vec<_> = (0..300).map(|_| (random.point(), random.point())).collect();
    let mut hits = |scale: f32| -> Vec<_> {
        let triangles: Vec<Triangle> = unit.iter().map(|t| t.map(|p| p.map(|x| x * scale))).collect();
        load(&mut bench, &Bvh::build(&triangles), &triangles);
        let hit = |(org, dir): &([f32; 3], [f32; 3])| bench.run("nearest", &ray(org.map(|x| x * scale), *dir));
        let unscale = |hit: Vec<u32>| (hit[0], f32::from_bits(hit[1]) / scale, hit[2], hit[3]);
        rays.iter().map(hit).map(unscale).collect()
    };
    let expected = hits(1.0);
    for k in [-40, -13, 20, 40] {
        assert_eq!(hits(2.0_f32.powi(k)), expected, "scaled by 2^{k}");
    }
}
