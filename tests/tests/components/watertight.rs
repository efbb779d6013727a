//! T9: rays from inside closed shapes, aimed at what is hardest to hit, always hit, and the tree changes no bit of it.
//! Each remedy is shown against what it replaces: the same rays find holes there.
//!
//! `JERBOA_RAYS=N` sends N rays per shape, place and aim instead of 12; every tenth is compared with brute force and two
//! other trees.

use jerboa_lib_render::host::bvh::{Bvh, Triangle};
use jerboa_lib_render::schema::NONE;
use jerboa_lib_render::traverse::make_traverse;

use jerboa_tests::harness::bench::{Bench, Random, number};
use jerboa_tests::harness::brute::declare_brute_force;
use jerboa_tests::harness::naive::{self, BoxTest, TriangleTest};
use jerboa_tests::harness::probe::V;
use jerboa_tests::harness::rays::{AIMS, PLACES, Place, SHAPES, TREES, ball, declare_traversal, load, ray, unit};

/// Calls back with each shape at each place.
fn everywhere(mut f: impl FnMut(&str, Place, &[Triangle])) {
    for (shape, place) in SHAPES.iter().flat_map(|s| PLACES.map(|p| (s, p))) {
        let triangles: Vec<Triangle> = (shape.triangles)().iter().map(|t| t.map(|p| place.world(p))).collect();
        f(shape.name, place, &triangles);
    }
}

/// Every other direction is unit, the others end on what they aim at.
fn args(i: usize, (org, dir): (V, V)) -> [u32; 10] {
    ray(org, if i.is_multiple_of(2) { dir } else { unit(dir) })
}

#[test]
fn closed_shapes_have_no_holes() {
    let mut random = Random::new(0x5eed_0001);
    let mut bench = Bench::new(|| {
        declare_traversal(make_traverse());
        declare_brute_force();
    });
    let n = number("JERBOA_RAYS", 12);
    let (mut sent, mut compared) = (0_u64, 0_u64);
    everywhere(|name, place, triangles| {
        let bvh = Bvh::build(triangles);
        load(&mut bench, &bvh, triangles);
        let mut samples = Vec::new();
        for aim in &AIMS {
            for i in 0..n {
                let args = args(i, (aim.ray)(&mut random, place, triangles));
                let hit = if i == 0 { bench.run_both("nearest", &args) } else { bench.run("nearest", &args) };
                assert_ne!(hit[0], NONE, "{name}, {place:?}, {}: {args:x?}", aim.name);
                assert_ne!(bench.run("any", &args)[0], NONE, "{name}, {place:?}, {}: {args:x?}", aim.name);
                if i % 10 == 0 {
                    let slots = bvh.order.len() as u32;
                    let brute = bench.run("brute", &[&args[..], &[slots]].concat());
                    assert_eq!(hit, brute, "{name}, {place:?}, {}: {args:x?} by brute force", aim.name);
                    samples.push((args, hit));
                }
                sent += 1;
            }
        }
        for tree in &TREES[1..] {
            load(&mut bench, &(tree.build)(&mut random, triangles), triangles);
            for (args, hit) in &samples {
                assert_eq!(&bench.run("nearest", args), hit, "{name}, {place:?}: {args:x?} in the tree {}", tree.name);
                compared += 1;
            }
        }
    });
    println!("{sent} rays hit; {compared} in other trees, and half as many by brute force, with the same bits");
}

/// How many of the rays of one aim find a hole in a sphere, in a traversal made of these parts.
fn holes(boxes: BoxTest, triangle: TriangleTest, place: Place, aim: &str) -> f64 {
    let mut random = Random::new(0x5eed_0002);
    let mut bench = Bench::new(|| declare_traversal(naive::make_traverse(boxes, triangle)));
    let aim = AIMS.iter().find(|a| a.name == aim).expect("it is in the table");
    let n = number("JERBOA_RAYS", 4000);
    let mut missed = 0;
    for shape in &SHAPES {
        let triangles: Vec<Triangle> = (shape.triangles)().iter().map(|t| t.map(|p| place.world(p))).collect();
        load(&mut bench, &Bvh::build(&triangles), &triangles);
        for i in 0..n {
            let args = args(i, (aim.ray)(&mut random, place, &triangles));
            missed += usize::from(bench.run("nearest", &args)[0] == NONE);
        }
    }
    let share = missed as f64 / (SHAPES.len() * n) as f64;
    println!("{boxes:?} boxes, {triangle:?}, {place:?}, {}: {:.4} % miss", aim.name, 100.0 * share);
    share
}

/// The formulas that N2 and N3 replace, with the rays of the test above: it would be red with each of them.
#[test]
fn other_formulas_have_holes() {
    let near = Place { centre: [1.37, -2.21, 0.5], scale: 1.0 };
    let tiny = Place { centre: [0.0; 3], scale: 1e-18 };
    use {BoxTest as B, TriangleTest as T};
    assert_eq!(holes(B::Padded, T::Watertight, near, "edges"), 0.0, "the copy of the walk is a copy");
    assert!(holes(B::Padded, T::MoellerTrumbore, near, "edges") > 0.01);
    assert!(holes(B::Padded, T::Contracted, near, "edges") > 1e-4);
    assert!(holes(B::Padded, T::LateDivision, tiny, "random") > 0.99);
    assert_eq!(holes(B::Padded, T::Watertight, tiny, "random"), 0.0);
    assert!(holes(B::Plain, T::Woop, near, "vertices") > 1e-4);
    assert!(holes(B::Precomputed, T::Woop, near, "vertices") > 1e-4);
    assert!(holes(B::Unordered, T::Woop, near, "within a plane") > 1e-4);
}

/// N15: u, v, t and the point of a hit against f64, on triangles whose altitudes are a quarter of their longest side or
/// more, from no farther than their size and at 14 degrees or more: errors grow with the reciprocals of both.
#[test]
fn hits_are_accurate() {
    let mut random = Random::new(0x5eed_000e);
    let mut bench = Bench::new(|| declare_traversal(make_traverse()));
    let mut worst = [0.0_f64; 4];
    let mut sent = 0;
    while sent < number("JERBOA_RAYS", 3000) {
        let scale = 10.0_f32.powf(20.0 * random.uniform() as f32 - 10.0);
        let t: Triangle = [0; 3].map(|_| random.point().map(|x| x * scale));
        let org = random.point().map(|x| x * scale);
        let (a, b) = (random.uniform() as f32, random.uniform() as f32);
        let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
        let dir = [0, 1, 2].map(|k| t[0][k] + a * (t[1][k] - t[0][k]) + b * (t[2][k] - t[0][k]) - org[k]);
        let Some([u, v, distance]) = exact(org, dir, t) else { continue };
        load(&mut bench, &Bvh::build(&[t]), &[t]);
        let hit = bench.run("nearest", &ray(org, dir));
        if hit[0] == NONE {
            continue;
        }
        sent += 1;
        let [t32, u32, v32] = [1, 2, 3].map(|i| f64::from(f32::from_bits(hit[i])));
        let epsilon = f64::from(f32::EPSILON);
        let at = |u: f64, v: f64, k: usize| {
            let [p, q, r] = t.map(|p| f64::from(p[k]));
            (1.0 - u - v) * p + u * q + v * r
        };
        let off = (0..3).map(|k| (at(u, v, k) - at(u32, v32, k)).abs()).fold(0.0, f64::max) / f64::from(scale);
        let errors = [(u - u32).abs(), (v - v32).abs(), (distance / t32 - 1.0).abs(), off].map(|e| e / epsilon);
        (0..4).for_each(|i| worst[i] = worst[i].max(errors[i]));
    }
    println!("largest errors in u, v (of 1), t (of t), point (of the size), units in the last place: {worst:.2?}");
    assert!(worst.iter().all(|e| *e <= 16.0));
}

/// u, v, t in f64 of a ray on a triangle that is neither thin nor seen from the side.
fn exact(org: V, dir: V, t: Triangle) -> Option<[f64; 3]> {
    let [o, d] = [org, dir].map(|v| v.map(f64::from));
    let t = t.map(|p| p.map(f64::from));
    let sub = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| a[k] - b[k]);
    let cross =
        |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
    let length = |a: [f64; 3]| dot(a, a).sqrt();
    let (e1, e2, e3) = (sub(t[1], t[0]), sub(t[2], t[0]), sub(t[2], t[1]));
    let normal = cross(e1, e2);
    let longest = length(e1).max(length(e2)).max(length(e3));
    if length(normal) < 0.25 * longest * longest || dot(normal, d).abs() < 0.25 * length(normal) * length(d) {
        return None;
    }
    let (p, s) = (cross(d, e2), sub(o, t[0]));
    let det = dot(e1, p);
    let q = cross(s, e1);
    Some([dot(s, p) / det, dot(d, q) / det, dot(e2, q) / det])
}

/// The whole of a ray's arithmetic scales with the scene.
#[test]
fn hits_scale_with_the_scene_to_the_bit() {
    let mut random = Random::new(0x5eed_000d);
    let mut bench = Bench::new(|| declare_traversal(make_traverse()));
    let shape = ball(12, |_, _| 1.0);
    let rays: Vec<_> = (0..300).map(|_| (random.point(), random.point())).collect();
    let mut hits = |scale: f32| -> Vec<_> {
        let triangles: Vec<Triangle> = shape.iter().map(|t| t.map(|p| p.map(|x| x * scale))).collect();
        load(&mut bench, &Bvh::build(&triangles), &triangles);
        let hit = |(org, dir): &(V, V)| bench.run("nearest", &ray(org.map(|x| x * scale), *dir));
        let unscale = |hit: Vec<u32>| (hit[0], f32::from_bits(hit[1]) / scale, hit[2], hit[3]);
        rays.iter().map(hit).map(unscale).collect()
    };
    let expected = hits(1.0);
    for k in [-40, -13, 20, 40] {
        assert_eq!(hits(2.0_f32.powi(k)), expected, "scaled by 2^{k}");
    }
}
