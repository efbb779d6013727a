//! The native walk finds what the kernel finds, to the bit: the nearest hit of every ray, and whether there is any.
//!
//! `JERBOA_RAYS=N` sends N times 25 rays to each list of triangles instead of 16 times.

use jerboa_lib_render::host::bvh::{Bvh, Triangle};
use jerboa_lib_render::schema::NONE;
use jerboa_lib_render::traverse::make_traverse;

use jerboa_tests::harness::bench::{Bench, Random, number};
use jerboa_tests::harness::hostile::{LISTS, soup};
use jerboa_tests::harness::native::{Words, hits, outside};
use jerboa_tests::harness::rays::{AIMS, PLACES, SHAPES, ball, declare_traversal, load, ray};

/// Asks both; gives how many rays hit.
fn compare(bench: &mut Bench, what: &str, triangles: &[Triangle], rays: &[Words]) -> usize {
    let Some(nearest) = hits(triangles, false, rays) else { return rays.len() };
    let any = hits(triangles, true, rays).expect("it is there");
    load(bench, &Bvh::build(triangles), triangles);
    for ((args, nearest), any) in rays.iter().zip(&nearest).zip(&any) {
        assert_eq!(nearest[..], bench.run("nearest", args), "{what}: {args:x?}");
        assert_eq!(any[0] == NONE, nearest[0] == NONE, "{what}, any hit: {args:x?}");
    }
    nearest.iter().filter(|hit| hit[0] != NONE).count()
}

fn bench() -> Bench {
    Bench::new(|| declare_traversal(make_traverse()))
}

/// Some rays end, some skip what others would hit.
fn limited(random: &mut Random, mut args: Words, triangles: usize) -> Words {
    if random.below(4) == 0 {
        args[6] = (4.0 * random.uniform() as f32).to_bits();
    }
    for skip in &mut args[7..] {
        if triangles > 0 && random.below(3) == 0 {
            *skip = random.below(triangles) as u32;
        }
    }
    args
}

/// As many rays as wait, fewer, more: some counts around the number of walkers and that of lanes.
const COUNTS: [usize; 8] = [0, 1, 15, 16, 17, 63, 65, 1000];

/// So many triangles take a tree, and so few none.
const SIZES: [usize; 2] = [2000, 120];

#[test]
fn closed_shapes_are_hit_as_by_the_kernel() {
    let (mut random, mut bench) = (Random::new(0x5eed_0041), bench());
    let n = number("JERBOA_RAYS", 16);
    for (shape, place) in SHAPES.iter().flat_map(|shape| PLACES.map(|place| (shape, place))) {
        let triangles: Vec<Triangle> = (shape.triangles)().iter().map(|t| t.map(|p| place.world(p))).collect();
        let aims = AIMS.iter().cycle().take(n * AIMS.len());
        let rays: Vec<Words> = aims
            .map(|aim| {
                let (org, dir) = (aim.ray)(&mut random, place, &triangles);
                ray(org, dir)
            })
            .collect();
        let found = compare(&mut bench, &format!("{}, {place:?}", shape.name), &triangles, &rays);
        assert_eq!(found, rays.len(), "{}, {place:?}: no holes", shape.name);
    }
}

#[test]
fn hostile_triangles_are_hit_as_by_the_kernel() {
    let (mut random, mut bench) = (Random::new(0x5eed_0042), bench());
    let n = number("JERBOA_RAYS", 16);
    for (list, size) in LISTS.iter().flat_map(|list| SIZES.map(|size| (list, size))) {
        let triangles = (list.make)(&mut random, size);
        let rays: Vec<Words> = (0..25 * n)
            .map(|i| {
                let t = triangles.get(random.below(triangles.len().max(1))).copied().unwrap_or_default();
                let size = t[1][0].abs();
                let org = random.point().map(|x| x * if size > 0.0 && size.is_finite() { size } else { 1.0 });
                let to = match i % 3 {
                    0 => t[0],
                    1 => [0, 1, 2].map(|k| 0.5 * (t[0][k] + t[1][k])),
                    _ => [0, 1, 2].map(|k| t[0][k] / 4.0 + t[1][k] / 4.0 + t[2][k] / 2.0),
                };
                limited(&mut random, ray(org, [0, 1, 2].map(|k| to[k] - org[k])), triangles.len())
            })
            .collect();
        let found = compare(&mut bench, list.name, &triangles, &rays);
        println!("{}, {}: {found} of {} rays hit", list.name, triangles.len(), rays.len());
    }
}

#[test]
fn ties_go_to_the_smallest_number_natively_too() {
    let (mut random, mut bench) = (Random::new(0x5eed_0043), bench());
    // Each triangle seven times: more than a leaf holds lie in one place.
    let lists = [60, 17].map(|n| soup(&mut random, n, 0.6).repeat(7));
    for (triangles, count) in lists.iter().flat_map(|list| COUNTS.map(|count| (list, count))) {
        let rays: Vec<Words> = (0..count)
            .map(|_| {
                let args = ray(random.point().map(|x| 2.0 * x), random.point());
                limited(&mut random, args, triangles.len())
            })
            .collect();
        let found = compare(&mut bench, "repeated", triangles, &rays);
        assert!(count < 100 || found * 16 >= count, "{found} of {count} rays hit");
    }
}

#[test]
fn rays_that_pass_by_hit_nothing() {
    let (mut random, mut bench) = (Random::new(0x5eed_0044), bench());
    let mut passing = 0;
    for (list, size) in LISTS.iter().flat_map(|list| [500, 5].map(|size| (list, size))) {
        let triangles = (list.make)(&mut random, size);
        let rays: Vec<Words> = (0..25 * number("JERBOA_RAYS", 16))
            .map(|i| {
                let t = triangles.get(random.below(triangles.len().max(1))).copied().unwrap_or_default();
                let org = random.point().map(|x| 2.0 * x * t[1][0].abs().clamp(1e-42, 1e38));
                let to = if i.is_multiple_of(2) { t[i % 3] } else { random.point() };
                limited(&mut random, ray(org, [0, 1, 2].map(|k| to[k] - org[k])), triangles.len())
            })
            .collect();
        let Some(outside) = outside(&triangles, &rays) else { return };
        load(&mut bench, &Bvh::build(&triangles), &triangles);
        for number in &outside {
            assert_eq!(bench.run("nearest", &rays[*number])[0], NONE, "{}: {:x?}", list.name, rays[*number]);
        }
        assert!(!triangles.is_empty() || outside.len() == rays.len(), "there is nothing to come near to");
        passing += usize::from((1..rays.len()).contains(&outside.len()));
    }
    assert!(passing > LISTS.len(), "some rays pass by in {passing} lists only");
}

#[test]
fn unusable_rays_and_empty_scenes_miss_natively_too() {
    let mut bench = bench();
    let good = ray([0.0; 3], [0.3, -0.2, 1.0]);
    let mut rays = vec![good];
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3e38, -0.0] {
        for place in 0..7 {
            let mut args = good;
            args[place] = bad.to_bits();
            rays.push(args);
        }
    }
    rays.push(ray([0.0; 3], [0.0; 3]));
    rays.push(good);
    let found = compare(&mut bench, "a ball", &ball(8, |_, _| 1.0), &rays);
    assert!((2..rays.len()).contains(&found) || hits(&[], false, &[]).is_none(), "{found} rays hit");
    if let Some(hits) = hits(&[], false, &rays) {
        assert!(hits.iter().all(|hit| hit[0] == NONE), "there is nothing to hit");
    }
}
