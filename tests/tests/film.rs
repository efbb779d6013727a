//! T20: the film's sums are exact, and no order of arrival, tile, thread or merge changes a bit of them.
//!
//! `JERBOA_SAMPLES` samples, 2^20 otherwise; the long version is
//!
//! ```sh
//! JERBOA_SAMPLES=67108864 cargo test --release -p jerboa-tests --test film -- --nocapture
//! ```

use jerboa_lib_render::host::film::{Film, RANGE, Window};
use jerboa_tests::harness::bench::{Random, number};

const ONE: Window = Window { x: 0, y: 0, width: 1, height: 1 };

/// The mean of samples of one channel, each added by itself; the exact mean as f64 has it; and a mean summed in f32.
fn means(samples: impl Iterator<Item = f32>) -> [f64; 3] {
    let (mut film, mut n) = (Film::new(ONE), 0.0f64);
    // Kahan 1965: a sum in f64 with its error.
    let (mut sum, mut error, mut naive) = (0.0f64, 0.0f64, 0.0f32);
    for x in samples {
        film.add([0, 0], [x, 0.0, -x]);
        let next = f64::from(x) - error;
        let total = sum + next;
        (error, sum) = ((total - sum) - next, total);
        naive += x;
        n += 1.0;
    }
    let [mean, zero, negative] = film.mean().pixels[0];
    assert_eq!((zero, negative), (0.0, -mean));
    assert_eq!((film.count([0, 0]), film.dropped()), (n as u32, 0));
    [mean.into(), sum / n, f64::from(naive) / n]
}

#[test]
fn the_mean_of_equal_samples_is_that_sample() {
    let n = number("JERBOA_SAMPLES", 1 << 20);
    let [mean, _, naive] = means(std::iter::repeat_n(0.1, n));
    println!("{n} samples of 0.1: {mean}; a sum in f32 is off by {:.2e}", naive / f64::from(0.1f32) - 1.0);
    assert_eq!(mean as f32, 0.1);
    assert!((naive / f64::from(0.1f32) - 1.0).abs() > 1e-3, "the test sees what a sum in f32 does");
}

#[test]
fn the_mean_of_exponential_samples_is_exact() {
    let n = number("JERBOA_SAMPLES", 1 << 20);
    let mut random = Random::new(0x5eed_0020);
    let [mean, exact, naive] = means((0..n).map(|_| -(1.0 - random.uniform()).ln() as f32));
    println!("{n} samples: {mean}, exactly {exact}; a sum in f32 is off by {:.2e}", naive / exact - 1.0);
    // Rounded once.
    assert_eq!(mean as f32, exact as f32);
    assert!((mean / exact - 1.0).abs() <= 1e-6);
    assert!((exact - 1.0).abs() < 5.0 / (n as f64).sqrt(), "and they are exponential");
}

/// Samples that follow from a number: of all magnitudes and both signs, one in 64 unusable.
fn sample(i: u64) -> ([u32; 2], [f32; 3]) {
    let mut random = Random(i);
    let pixel = [random.below(WINDOW.width as usize), random.below(WINDOW.height as usize)];
    let channel = |random: &mut Random| ((random.uniform() - 0.3) * 2f64.powi(random.below(60) as i32 - 30)) as f32;
    let mut sample = std::array::from_fn(|_| channel(&mut random));
    if random.below(64) == 0 {
        let unusable = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, RANGE * 1.000_001, -RANGE * 1.000_001, f32::MAX];
        sample[random.below(3)] = unusable[random.below(6)];
    }
    ([WINDOW.x + pixel[0] as u32, WINDOW.y + pixel[1] as u32], sample)
}

const WINDOW: Window = Window { x: 3, y: 5, width: 7, height: 6 };

/// `parts` in an order that follows from the seed.
fn shuffled<T>(mut parts: Vec<T>, random: &mut Random) -> Vec<T> {
    for i in (1..parts.len()).rev() {
        parts.swap(i, random.below(i + 1));
    }
    parts
}

fn filled(window: Window, samples: impl IntoIterator<Item = u64>) -> Film {
    let mut film = Film::new(window);
    for (pixel, x) in samples.into_iter().map(sample) {
        if window.index(pixel).is_some() {
            film.add(pixel, x);
        }
    }
    film
}

#[test]
fn neither_order_nor_tiles_nor_threads_change_a_bit() {
    let n = number("JERBOA_SAMPLES", 1 << 20) as u64 / 64;
    let mut random = Random::new(0x5eed_0021);
    let whole = filled(WINDOW, 0..n);
    assert!(whole.dropped() > n / 128 && whole.dropped() < n / 32, "{} of {n} dropped", whole.dropped());
    let counted: u64 = (0..WINDOW.height)
        .flat_map(|y| (0..WINDOW.width).map(move |x| [WINDOW.x + x, WINDOW.y + y]))
        .map(|pixel| u64::from(whole.count(pixel)))
        .sum();
    assert_eq!(counted + whole.dropped(), n, "each sample is in the film or counted as dropped");
    assert!(whole == filled(WINDOW, shuffled((0..n).collect(), &mut random)), "another order");
    for _ in 0..4 {
        // Every pixel in one tile, the tiles cut at random; every tile's samples dealt to three threads' films.
        let (x, y) = (1 + random.below(6) as u32, 1 + random.below(5) as u32);
        let tiles = [(0, 0, x, y), (x, 0, 7 - x, y), (0, y, x, 6 - y), (x, y, 7 - x, 6 - y)];
        let tiles = tiles.map(|(x, y, width, height)| Window { x: WINDOW.x + x, y: WINDOW.y + y, width, height });
        let parts: Vec<Film> = std::thread::scope(|scope| {
            let deals = tiles.iter().flat_map(|tile| (0..3).map(move |thread| (*tile, thread)));
            let part =
                |(tile, thread): (Window, usize)| scope.spawn(move || filled(tile, (thread as u64..n).step_by(3)));
            let threads: Vec<_> = deals.map(part).collect();
            threads.into_iter().map(|t| t.join().expect("it ends")).collect()
        });
        let mut merged = Film::new(WINDOW);
        // A film of the same window takes what another has merged.
        let mut other = Film::new(WINDOW);
        for (i, part) in shuffled(parts, &mut random).iter().enumerate() {
            let into = if i % 2 == 0 { &mut merged } else { &mut other };
            into.merge(part).expect("it lies within");
        }
        merged.merge(&other).expect("the same window");
        assert!(whole == merged, "cut at ({x}, {y})");
    }
}
