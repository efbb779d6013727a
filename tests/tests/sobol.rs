//! T17: the points of the Sobol sampler fill boxes exactly, are random otherwise, and make errors small.

use std::collections::HashSet;

use jerboa_ir::lang::U32;
use jerboa_lib_render::core::sobol::{in_powers_of_x_plus_1, in_powers_of_x2_plus_x_plus_1, owen, reversed};
use jerboa_tests::harness::bench::{Random, number};
use jerboa_tests::harness::points::{DIMENSIONS, Point, Points, Walk, fraction};
use jerboa_tests::harness::stats::mean;
use jerboa_tests::harness::streams::{joint, judge};
use jerboa_tests::harness::sweep::Sweep;

const SEED: u32 = 20_261;

/// The bit of each column of a matrix is that of Sobol's recursion, of polynomials and first direction numbers as Bratley and
/// Fox have them.
#[test]
fn points_have_sobols_direction_numbers() {
    // x + 1 from 1; x² + x + 1 from 1, 1.
    let second = (0..32).scan(1_u32, |m, _| Some(std::mem::replace(m, *m ^ (*m << 1)))).collect::<Vec<_>>();
    let mut third = vec![1_u32, 1];
    (2..32).for_each(|k| third.push((third[k - 1] << 1) ^ (third[k - 2] << 2) ^ third[k - 2]));
    let columns = |f: fn(U32) -> U32| {
        let mut words = [0; 32];
        Sweep::new(|_, cell, one: U32| reversed(f(one << cell))).fill(&[1], [&[], &[]], &mut words);
        words
    };
    for (f, numbers) in [(in_powers_of_x_plus_1 as fn(U32) -> U32, second), (in_powers_of_x2_plus_x_plus_1, third)] {
        for (k, (word, m)) in columns(f).iter().zip(numbers).enumerate() {
            assert_eq!(*word, m << (31 - k), "column {k}");
        }
    }
}

/// How many of the points have the same first digits: so many in each dimension.
fn fill(points: &[Point], digits: [u32; DIMENSIONS]) -> bool {
    let first = |word: u32, digits: u32| if digits == 0 { 0 } else { word >> (32 - digits) };
    let corner = |p: &Point| -> Point { std::array::from_fn(|d| first(p[d], digits[d])) };
    points.iter().map(corner).collect::<HashSet<_>>().len() == points.len()
}

/// All ways to share `digits` out among `dimensions`.
fn shares(digits: u32, dimensions: &[usize]) -> Vec<[u32; DIMENSIONS]> {
    let [first, rest @ ..] = dimensions else { return if digits == 0 { vec![[0; DIMENSIONS]] } else { vec![] } };
    let with = |own: u32| {
        let mut all = shares(digits - own, rest);
        all.iter_mut().for_each(|share| share[*first] = own);
        all
    };
    (0..=digits).flat_map(with).collect()
}

/// 2^m points from a multiple of 2^m on have each box of volume 2^-m once: in the pairs all boxes, in three dimensions those with
/// an even number of digits in the third, in it alone all.
#[test]
fn boxes_have_their_points() {
    let points = Points::default();
    for m in 0..=12 {
        for key in 0..4 {
            let walk =
                Walk { seed: SEED, pixel: 77 * key, number: key << m, vertex: key, numbers: 1, ..Walk::default() };
            let net = points.of(walk, 1 << m);
            for [u, v, choice] in [[0, 1, 2], [3, 4, 5]] {
                for share in shares(m, &[u, v, choice]).into_iter().filter(|s| s[choice] % 2 == 0 || s[choice] == m) {
                    assert!(fill(&net, share), "2^{m} points, {walk:?}: {share:?}");
                }
            }
        }
    }
}

/// What [`second_half`](jerboa_lib_render::core::sobol::second_half) was searched for: both halves are good together. Of 2^m points
/// boxes of volume 2^(t−m) have 2^t.
#[test]
fn halves_fill_boxes_together() {
    let points = Points::default();
    for m in 1..=10 {
        let net = points.of(Walk { seed: SEED, numbers: 1, ..Walk::default() }, 1 << m);
        let t = |dimensions: &[usize]| {
            let fills = |digits: u32| shares(digits, dimensions).into_iter().all(|share| boxes(&net, share));
            m - (0..=m).rev().find(|digits| fills(*digits)).expect("no digits are filled")
        };
        let pairs = [[0, 3], [0, 4], [1, 3], [1, 4]].map(|pair| t(&pair));
        let four = t(&[0, 1, 3, 4]);
        println!("2^{m} points: t = {pairs:?} of two pairs' dimensions, {four} of all four");
        assert!(pairs.iter().all(|t| *t <= 4) && four <= 4 && (m < 4 || four < m - 1));
    }
}

/// Has each box with so many digits in each dimension as many points as every other?
fn boxes(points: &[Point], digits: [u32; DIMENSIONS]) -> bool {
    let bits: u32 = digits.iter().sum();
    let number = |p: &Point| {
        digits
            .iter()
            .zip(p)
            .fold(0_usize, |n, (d, word)| if *d == 0 { n } else { n << d | (word >> (32 - d)) as usize })
    };
    let mut counts = vec![0; 1 << bits];
    points.iter().for_each(|p| counts[number(p)] += 1);
    counts.iter().all(|count| count << bits == points.len())
}

/// Two numbers that share k first digits: scrambled they share k, differ in the next, and what follows is random, each by itself.
#[test]
fn scrambling_is_random_below_the_first_digit_that_differs() {
    let n = number("JERBOA_NUMBERS", 1 << 16);
    let scrambled = Sweep::new(|_, cell, (x, seed): (U32, U32)| {
        let key = jerboa_lib_render::core::rng::hash(cell ^ seed);
        reversed(owen(x, key))
    });
    let words = |x: u32| {
        let mut words = vec![0; n];
        scrambled.fill(&[x, SEED], [&[], &[]], &mut words);
        words
    };
    let mut family = vec![];
    for k in 0..10 {
        let x = 0x0123_4567_u32.rotate_left(3 * k);
        let (us, vs) = (words(x), words(x ^ (1 << k)));
        assert!(us.iter().zip(&vs).all(|(u, v)| (u ^ v).leading_zeros() == k), "{k} digits are shared");
        let below = |words: &[u32]| words.iter().map(|w| w << (k + 1)).collect::<Vec<_>>();
        let (p, z) = joint(&below(&us), &below(&vs));
        println!("after {k} digits: correlation {z:.2}/sqrt(n)");
        assert!(z.abs() <= 4.0, "after {k} digits: correlation {z}/sqrt(n)");
        family.push((format!("after {k} digits"), p));
        let next: Vec<u32> = us.iter().map(|w| w << 5).collect();
        family.push((format!("the first ten digits, {k}"), joint(&us, &next).0));
    }
    judge(&family);
}

/// First points of adjacent pixels, of other seeds and vertices, and dimensions of one point have nothing to do with each other.
#[test]
fn neighbours_are_independent() {
    let n = number("JERBOA_NUMBERS", 1 << 16);
    let points = Points::default();
    let base = Walk { seed: SEED, pixels: 2, ..Walk::default() };
    let here = points.of(base, n);
    let column = |points: &[Point], d: usize| points.iter().map(|p| p[d]).collect::<Vec<_>>();
    let mut family = vec![];
    let mut compare = |name: String, us: &[u32], vs: &[u32]| {
        let (p, z) = joint(us, vs);
        assert!(z.abs() <= 4.0, "{name}: correlation {z}/sqrt(n)");
        family.push((name, p));
    };
    let others = [
        ("pixels in x", Walk { pixel: 1, ..base }),
        ("pixels in y", Walk { pixel: 1921, ..base }),
        ("seeds", Walk { seed: SEED + 1, ..base }),
        ("vertices", Walk { vertex: 1, ..base }),
    ];
    for (name, walk) in others {
        let there = points.of(walk, n);
        (0..DIMENSIONS).for_each(|d| compare(format!("{name}, dimension {d}"), &column(&here, d), &column(&there, d)));
    }
    for (d, e) in (0..DIMENSIONS).flat_map(|d| (0..d).map(move |e| (d, e))) {
        compare(format!("dimensions {d} and {e}"), &column(&here, d), &column(&here, e));
    }
    judge(&family);
}

/// A lamp of 1 x 1 straight above a pixel's footprint of 0.1 x 0.1, which is not in its middle; in its way half a plane at half
/// the height, whose edge runs at `slope` to the lamp's.
fn light(p: [f64; 4], slope: Option<f64>) -> f64 {
    let [x, y] = [0.1 * (p[0] - 0.5) + 0.3, 0.1 * (p[1] - 0.5) + 0.1];
    let [u, v] = [p[2] - 0.5, p[3] - 0.5];
    let blocked = slope.is_some_and(|slope| (u + x) / 2.0 + slope * (v + y) / 2.0 > 0.15);
    if blocked { 0.0 } else { ((u - x).powi(2) + (v - y).powi(2) + 1.0).powi(-2) }
}

/// How much smaller the variance of the mean of n samples is than with independent numbers, and that it is the same mean.
#[test]
fn direct_light_has_less_variance() {
    let renders = number("JERBOA_RENDERS", 4000);
    let points = Points::default();
    let mut random = Random::new(SEED.into());
    println!("{renders} renders, seed {SEED}");
    let cases = [
        ("no occluder", None, [(16, 50.0), (64, 200.0)]),
        ("an edge along the lamp", Some(0.0), [(16, 5.0), (64, 8.0)]),
        ("an oblique edge", Some(0.75), [(16, 2.5), (64, 4.0)]),
    ];
    for (name, slope, sizes) in cases {
        for (n, least) in sizes {
            let of = |draw: &mut dyn FnMut(u32) -> f64| mean((0..renders as u32).map(draw));
            let (truth, error) =
                of(&mut |_| (0..n).map(|_| light([0; 4].map(|_| random.uniform()), slope)).sum::<f64>() / f64::from(n));
            let (found, less) = of(&mut |render| {
                let net = points.of(Walk { seed: SEED, pixel: render, numbers: 1, ..Walk::default() }, n as usize);
                let place = |p: &Point| [p[0], p[1], p[3], p[4]].map(fraction);
                net.iter().map(|p| light(place(p), slope)).sum::<f64>() / f64::from(n)
            });
            let gain = (error / less).powi(2);
            println!("{name}, {n} samples: {gain:.1} times less variance; means {truth:.6}, {found:.6} ± {less:.1e}");
            assert!((truth - found).abs() <= 4.0 * error.hypot(less), "{name}, {n} samples: another mean");
            assert!(gain >= least, "{name}, {n} samples: {gain}");
        }
    }
}

/// Interpreter and machine code give the same words.
#[test]
fn engines_agree() {
    let sampler = Points::default();
    for seed in [0, u32::MAX] {
        let walk = Walk { seed, pixel: u32::MAX - 5, number: u32::MAX - 3, vertex: 7, pixels: 1, numbers: 1 };
        sampler.check_engines(walk, 20);
    }
}
