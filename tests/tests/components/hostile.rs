//! T29: trees of hostile triangles are shallow and lose nothing, and hostile rays end at once.
//!
//! `JERBOA_TRIANGLES=100000` makes lists of that many instead of 3,000. How long builds take, `robustness builds` measures.

use jerboa_lib_render::host::bvh::{Bvh, Triangle};
use jerboa_lib_render::schema::NONE;
use jerboa_lib_render::traverse::make_traverse;
use jerboa_lib_render::traverse::stack::STACK_SIZE;

use jerboa_tests::harness::bench::{Bench, Random, number};
use jerboa_tests::harness::brute::declare_brute_force;
use jerboa_tests::harness::hostile::{LISTS, soup};
use jerboa_tests::harness::rays::{declare_traversal, load, ray};

fn is_finite(t: &Triangle) -> bool {
    t.as_flattened().iter().all(|x| x.is_finite())
}

#[test]
fn every_list_makes_a_tree() {
    let mut random = Random::new(0x5eed_0029);
    let mut bench = Bench::new(|| {
        declare_traversal(make_traverse());
        declare_brute_force();
    });
    let n = number("JERBOA_TRIANGLES", 3000);
    for list in &LISTS {
        let triangles = (list.make)(&mut random, n);
        let bvh = Bvh::build(&triangles);
        let dropped = bvh.dropped;
        println!("{}: {} triangles, depth {}, {dropped:?}", list.name, triangles.len(), bvh.depth);
        assert!(bvh.depth <= 64 && bvh.waiting <= STACK_SIZE as usize, "{}", list.name);
        assert_eq!(dropped.non_finite, triangles.iter().filter(|t| !is_finite(t)).count(), "{}", list.name);
        assert_eq!(bvh.order.len() + dropped.non_finite + dropped.zero_area, triangles.len(), "{}", list.name);
        load(&mut bench, &bvh, &triangles);
        for _ in 0..20 {
            let args = match bvh.order.len() {
                0 => ray(random.point(), random.point()),
                slots => {
                    let t = triangles[bvh.order[random.below(slots)] as usize];
                    let org = random.point().map(|x| x * t[1][0].abs().max(f32::MIN_POSITIVE));
                    ray(org, [0, 1, 2].map(|k| t[0][k] / 4.0 + t[1][k] / 4.0 + t[2][k] / 2.0 - org[k]))
                }
            };
            let brute = bench.run("brute", &[&args[..], &[bvh.order.len() as u32]].concat());
            // Brute force does not ask whether a ray is usable: of 3e38, some are not.
            let usable = args[..6].iter().map(|w| f32::from_bits(*w).abs()).sum::<f32>() < f32::INFINITY;
            let expected = if usable { brute } else { vec![NONE, brute[1], brute[2], brute[3]] };
            let hit = bench.run("nearest", &args);
            assert_eq!(hit[0], expected[0], "{}: {args:x?}", list.name);
            assert!(!usable || hit == expected, "{}: {args:x?}", list.name);
        }
    }
}

/// Rays with NaN or infinity hit nothing, and take at most two and a half times the steps of ordinary rays: far fewer.
#[test]
fn unusable_rays_end_at_once() {
    let mut random = Random::new(0x5eed_0030);
    let mut bench = Bench::new(|| declare_traversal(make_traverse()));
    let triangles = soup(&mut random, 3000, 0.05);
    load(&mut bench, &Bvh::build(&triangles), &triangles);
    let ordinary: u64 = (0..20).map(|_| bench.steps("nearest", &ray(random.point(), random.point()))).sum();
    for place in 0..6 {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let mut args = ray(random.point(), random.point());
            args[place] = bad.to_bits();
            assert_eq!(bench.run_both("nearest", &args)[0], NONE, "{bad} in place {place}");
            let steps = bench.steps("nearest", &args);
            assert!(
                20 * steps * 2 <= 5 * ordinary,
                "{bad} in place {place}: {steps} steps, ordinary {}",
                ordinary / 20
            );
        }
    }
}
