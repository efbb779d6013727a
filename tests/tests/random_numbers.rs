//! T17: the renderer's random numbers. Streams are distinct, neighbours independent, numbers below 1.
//!
//! The long version looks at more numbers for each question; `tests/runs/random-numbers.txt` has what it gave:
//!
//! ```sh
//! JERBOA_NUMBERS=268435456 cargo test --release -p jerboa-tests --test random_numbers -- --nocapture sequences streams twins
//! JERBOA_NUMBERS=16777216 cargo test --release -p jerboa-tests --test random_numbers -- --nocapture neighbours
//! ```

use jerboa_ir::lang::{Fun, U32, entry};
use jerboa_lib_render::core::rng::{Stream, hash, uniform};
use jerboa_lib_render::schema::Frame;
use jerboa_lib_render::tracer::bidirectional::make_light_side_tracer;
use jerboa_lib_render::tracer::light::{LIGHT_STREAM, make_light_tracer};
use jerboa_tests::harness::bench::{Bench, number};
use jerboa_tests::harness::streams::{Battery, Streams, Walk, joint, judge, repeated, twins};
use jerboa_tests::harness::sweep::Sweep;

/// Numbers to look at for each question.
fn numbers() -> usize {
    number("JERBOA_NUMBERS", 1 << 18)
}

/// A generator with a key of one word: what the renderer had once, and what these tests must see through.
fn one_word() -> Streams {
    Streams::new(|seed, pixel, sample, dim: U32| hash(hash(hash(hash(seed) ^ pixel) ^ sample) ^ hash(dim)))
}

/// No two samples of a film have the same stream.
#[test]
fn streams_are_distinct() {
    let (pixels, samples) = (1 << 16, (numbers() >> 18).clamp(64, 256) as u32);
    println!("{pixels} pixels of {samples} samples");
    assert_eq!(repeated(&Streams::default(), pixels, samples), 0);
    // Such keys of two pixels agree in a whole block of samples or not at all.
    let blocks = f64::from(pixels).powi(2) / 2.0 / (2f64.powi(32) / f64::from(samples));
    let found = repeated(&one_word(), pixels, samples) as f64 / f64::from(samples);
    println!("keys of one word: {found} blocks of samples repeat, expected {blocks}");
    assert!((found - blocks).abs() < 4.0 * blocks.sqrt(), "{found} repeated blocks, not {blocks}");
}

/// No path from a light shares its stream with a path from the camera, of whatever pixel and sample.
#[test]
fn paths_from_lights_have_streams_of_their_own() {
    let streams = Streams::default();
    let (pixels, samples) = (1 << 14, (numbers() >> 14).clamp(16, 1024) as u32);
    let both =
        |sample: u32| [0, LIGHT_STREAM].map(|seed| Walk { seed, sample, pixels: 1, log2_dims: 1, ..Walk::default() });
    let words = |walk| streams.words(walk, 2 * pixels);
    let mut seen = std::collections::HashSet::new();
    let mut repeated = 0;
    for walk in (0..samples).flat_map(both) {
        repeated += words(walk).chunks(2).filter(|pair| !seen.insert([pair[0], pair[1]])).count();
    }
    assert_eq!(repeated, 0, "{pixels} pixels of {samples} samples");
}

/// And those are the streams that they ask for.
#[test]
fn paths_from_lights_ask_for_their_own_stream() {
    let mut bench = Bench::new(|| {
        entry("light", Fun::lam(|b, at: (U32, U32, U32)| make_light_tracer().on_emit.call(b, at).1.rng));
        entry("light side", Fun::lam(|b, at: (U32, U32, U32)| make_light_side_tracer().on_emit.call(b, at).1.path.rng));
        entry("stream", Fun::lam(|_, (seed, pixel, sample): (U32, U32, U32)| Stream::of(seed, pixel, sample)));
    });
    let (seed, width) = (7, 100);
    bench.set(Frame::SEED, 0, seed);
    bench.set(Frame::WIDTH, 0, width);
    let expected = bench.run("stream", &[seed ^ LIGHT_STREAM, 2 * width + 3, 5]);
    for tracer in ["light", "light side"] {
        assert_eq!(bench.run_both(tracer, &[3, 2, 5]), expected, "{tracer}");
    }
}

/// A stream of even step is at its start again after 2^31 numbers, or after 2^30, 2^29, … of them.
#[test]
fn streams_do_not_come_round() {
    let words = |dim| Streams::default().words(Walk { dim, pixels: 1, ..Walk::default() }, numbers());
    let (first, half) = (words(0), words(1 << 31));
    assert_eq!(first.iter().zip(&half).filter(|(a, b)| a == b).count(), 0);
}

/// No two pixels see the same streams in another order.
#[test]
fn pixels_are_no_twins() {
    let (pixels, samples) = ((numbers() >> 10).max(1 << 16) as u32, (numbers() >> 18).max(64) as u32);
    assert_eq!(twins(&Streams::default(), pixels, samples), 0);
    let found = twins(&one_word(), pixels, samples) as f64;
    let expected = f64::from(pixels).powi(2) / 2.0 / (2f64.powi(32) / f64::from(samples));
    println!("{pixels} pixels of {samples} samples, keys of one word: {found} twins, expected {expected:.1}");
    assert!((found - expected).abs() < 5.0 * expected.sqrt(), "{found} twins, not {expected}");
}

/// Adjacent pixels, samples, dimensions and seeds: joint distribution and correlation, in the first 8 dimensions.
#[test]
fn neighbours_are_independent() {
    let streams = Streams::default();
    // A film of 1920 columns; every other pixel, so that the pairs are independent.
    let (columns, per_pixel) = (1920, 512);
    let collect = |walk: Walk| -> Vec<u32> {
        let pixels = numbers().div_ceil(per_pixel) as u32;
        let pixel = |i: u32| walk.pixel + 2 * columns * (i / 900) + 2 * (i % 900);
        (0..pixels).flat_map(|i| streams.words(Walk { pixel: pixel(i), ..walk }, per_pixel)).collect()
    };
    let mut family = vec![];
    for dim in 0..8 {
        let base = Walk { dim, samples: 2, ..Walk::default() };
        let here = collect(base);
        let neighbours = [
            ("pixels in x", Walk { pixel: 1, ..base }),
            ("pixels in y", Walk { pixel: columns, ..base }),
            ("samples", Walk { sample: 1, ..base }),
            ("dimensions", Walk { dim: dim + 1, ..base }),
            ("seeds", Walk { seed: 1, ..base }),
            ("paths from lights", Walk { seed: LIGHT_STREAM, ..base }),
        ];
        for (name, walk) in neighbours {
            let (p, z) = joint(&here, &collect(walk));
            println!("{name}, dimension {dim}: correlation {z:.2}/sqrt(n)");
            assert!(z.abs() <= 4.0, "{name}, dimension {dim}: correlation {z}/sqrt(n)");
            family.push((format!("{name}, dimension {dim}"), p));
        }
    }
    judge(&family);
}

/// One long sequence along dimensions, along samples, along pixels and along seeds.
#[test]
fn sequences_are_random() {
    const BLOCK: usize = 3 << 17;
    let streams = Streams::default();
    let walks = [
        ("dimensions", Walk { samples: 1, log2_dims: 5, ..Walk::default() }),
        ("samples", Walk { samples: 1, ..Walk::default() }),
        ("pixels", Walk { pixels: 1, ..Walk::default() }),
        ("the diagonal", Walk { pixels: 1, samples: 1, dim: 4, seed: 7, ..Walk::default() }),
    ];
    let mut family = vec![];
    for (name, walk) in walks {
        let mut battery = Battery::default();
        for block in 0..numbers().div_ceil(BLOCK) {
            let on = ((block * BLOCK) >> walk.log2_dims) as u32;
            let Walk { pixel, sample, pixels, samples, .. } = walk;
            battery
                .add(&streams.words(Walk { pixel: pixel + on * pixels, sample: sample + on * samples, ..walk }, BLOCK));
        }
        family.extend(battery.results().into_iter().map(|(what, p)| (format!("along {name}: {what}"), p)));
    }
    judge(&family);
}

/// All 2^24 numbers that a word can give: exact multiples of 2^-24 below 1.
#[test]
fn numbers_are_below_one() {
    let sweep = Sweep::new(|_, cell, low: U32| uniform((cell << 8) | low).bits());
    let mut words = vec![0; 1 << 24];
    for low in [0, 0xff] {
        sweep.fill(&[low], [&[], &[]], &mut words);
        let wrong = (0..1u32 << 24).find(|k| f32::from_bits(words[*k as usize]) != *k as f32 / 16_777_216.0);
        assert_eq!(wrong, None);
    }
    assert!(words.iter().all(|w| f32::from_bits(*w) < 1.0));
}

/// Interpreter and machine code give the same words.
#[test]
fn engines_agree() {
    for seed in [0, 1, u32::MAX] {
        let walk = Walk { seed, pixel: u32::MAX - 5, sample: u32::MAX - 3, pixels: 1, samples: 1, ..Walk::default() };
        Streams::default().check_engines(Walk { log2_dims: 3, ..walk }, 100);
    }
}
