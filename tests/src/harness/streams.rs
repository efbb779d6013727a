//! Random numbers asked for in bulk, and what is counted in them.
//!
//! [`Streams`] fills memory with the words of the renderer's generator, by machine code, in the order of a [`Walk`]. Then
//! [`joint`] compares two sequences, and a [`Battery`] looks at one long sequence. Each gives probabilities p: of a
//! statistic at least as large, were the words uniform and independent. [`judge`] takes a whole family of them.

use jerboa_ir::lang::U32;
use jerboa_lib_render::core::rng::Rng;

use super::stats::{FAMILY, chi2_tail, normal_upper, sidak};
use super::sweep::Sweep;

/// Which words, in which order: all dimensions of a sample, then on to another sample or pixel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Walk {
    /// Seed of the render.
    pub seed: u32,
    /// Pixel of the first word.
    pub pixel: u32,
    /// Sample of the first word.
    pub sample: u32,
    /// First dimension of each sample.
    pub dim: u32,
    /// How far the pixel goes on from one sample to the next.
    pub pixels: u32,
    /// How far the sample goes on.
    pub samples: u32,
    /// log2 of the number of dimensions of each sample.
    pub log2_dims: u32,
}

/// A generator of words, compiled.
pub struct Streams(Sweep);

impl Default for Streams {
    /// The renderer's.
    fn default() -> Streams {
        Streams::new(|seed, pixel, sample, dim| Rng { dim, ..Rng::new(seed, pixel, sample) }.word())
    }
}

impl Streams {
    /// `word` gives a word from (seed, pixel, sample, dimension).
    pub fn new(word: impl FnOnce(U32, U32, U32, U32) -> U32) -> Streams {
        type Shared = ((U32, U32, U32, U32), (U32, U32, U32));
        Streams(Sweep::new(|_, cell, ((seed, pixel, sample, dim), (pixels, samples, log2_dims)): Shared| {
            let outer = cell >> log2_dims;
            let inner = cell - (outer << log2_dims);
            word(seed, pixel + outer * pixels, sample + outer * samples, dim + inner)
        }))
    }

    /// The first `n` words of a walk.
    pub fn words(&self, walk: Walk, n: usize) -> Vec<u32> {
        let mut words = vec![0; n];
        let Walk { seed, pixel, sample, dim, pixels, samples, log2_dims } = walk;
        self.0.fill(&[seed, pixel, sample, dim, pixels, samples, log2_dims], [&[], &[]], &mut words);
        words
    }

    /// Interpreter and machine code agree on the first `n` words of a walk.
    pub fn check_engines(&self, walk: Walk, n: usize) {
        let Walk { seed, pixel, sample, dim, pixels, samples, log2_dims } = walk;
        let shared = [seed, pixel, sample, dim, pixels, samples, log2_dims];
        assert_eq!(self.0.interpret(&shared, [&[], &[]], n), self.words(walk, n), "{walk:?}");
    }
}

/// How many streams of `pixels` pixels, `samples` of each, repeat another one: equal in their first two words.
pub fn repeated(streams: &Streams, pixels: u32, samples: u32) -> usize {
    let of = |sample| streams.words(Walk { sample, pixels: 1, log2_dims: 1, ..Walk::default() }, 2 * pixels as usize);
    let pair = |w: &[u32]| u64::from(w[0]) << 32 | u64::from(w[1]);
    let mut seen: Vec<u64> = (0..samples).flat_map(|s| of(s).chunks(2).map(pair).collect::<Vec<_>>()).collect();
    duplicates(&mut seen)
}

/// How many of `pixels` pixels see the same `samples` streams as another one, in any order: equal sums over the samples
/// of hashed first words.
pub fn twins(streams: &Streams, pixels: u32, samples: u32) -> usize {
    let of = |pixel| streams.words(Walk { pixel, samples: 1, ..Walk::default() }, samples as usize);
    let sum =
        |words: Vec<u32>| words.iter().map(|w| super::bench::Random(u64::from(*w)).bits()).fold(0, u64::wrapping_add);
    let mut sums: Vec<u64> = (0..pixels).map(|p| sum(of(p))).collect();
    duplicates(&mut sums)
}

/// How many values repeat a smaller or equal one, once sorted.
fn duplicates(values: &mut [u64]) -> usize {
    values.sort_unstable();
    values.windows(2).filter(|w| w[0] == w[1]).count()
}

/// χ² of the joint distribution of two sequences in 32 x 32 cells, as a probability, and their correlation in units of
/// its standard deviation 1/√n.
pub fn joint(us: &[u32], vs: &[u32]) -> (f64, f64) {
    let mut cells = vec![0u32; 1024];
    let (mut sum, mut n) = (0.0, 0.0);
    for (u, v) in us.iter().zip(vs) {
        cells[(u >> 27 << 5 | v >> 27) as usize] += 1;
        // Of known mean and variance 1/12.
        let centred = |x: u32| (f64::from(x) + 0.5) / 4_294_967_296.0 - 0.5;
        sum += 12.0 * centred(*u) * centred(*v);
        n += 1.0;
    }
    (uniform_chi2(&cells), sum / f64::sqrt(n))
}

/// Probability of so uneven counts.
fn uniform_chi2(counts: &[u32]) -> f64 {
    let n: f64 = counts.iter().map(|c| f64::from(*c)).sum();
    let expected = n / counts.len() as f64;
    let chi2: f64 = counts.iter().map(|c| (f64::from(*c) - expected).powi(2) / expected).sum();
    chi2_tail(chi2, counts.len() - 1)
}

/// Counts of one long sequence of words.
pub struct Battery {
    /// Words.
    n: u64,
    /// Bits that are set.
    ones: u64,
    /// Bits that differ from the one before, within a word.
    changes: u64,
    /// Words by their number of ones.
    weights: [u32; 33],
    /// Pairs by the first 8 bits of each.
    pairs: Vec<u32>,
    /// Triples by the first 5 bits of each.
    triples: Vec<u32>,
    /// Blocks whose birthdays were compared, and spacings in them that repeat another.
    birthdays: (u32, usize),
}

/// Birthdays in a block: with 2^46 days the number of repeated spacings is Poisson of mean m³ / 4 / 2^46 = 1 (Marsaglia &
/// Tsang 2002; the approximation is good to 1/m).
const BIRTHDAYS: usize = 1 << 16;

impl Default for Battery {
    fn default() -> Battery {
        let (pairs, triples) = (vec![0; 1 << 16], vec![0; 1 << 15]);
        Battery { n: 0, ones: 0, changes: 0, weights: [0; 33], pairs, triples, birthdays: (0, 0) }
    }
}

impl Battery {
    /// Goes on with these words.
    pub fn add(&mut self, words: &[u32]) {
        self.n += words.len() as u64;
        for w in words {
            self.ones += u64::from(w.count_ones());
            self.changes += u64::from(((w ^ (w >> 1)) & 0x7fff_ffff).count_ones());
            self.weights[w.count_ones() as usize] += 1;
        }
        for w in words.chunks_exact(2) {
            self.pairs[(w[0] >> 24 << 8 | w[1] >> 24) as usize] += 1;
        }
        for w in words.chunks_exact(3) {
            self.triples[(w[0] >> 27 << 10 | w[1] >> 27 << 5 | w[2] >> 27) as usize] += 1;
        }
        for block in words.chunks_exact(2 * BIRTHDAYS) {
            let day = |w: &[u32]| u64::from(w[0] >> 9) << 23 | u64::from(w[1] >> 9);
            let mut days: Vec<u64> = block.chunks_exact(2).map(day).collect();
            days.sort_unstable();
            let mut spacings: Vec<u64> = days.windows(2).map(|d| d[1] - d[0]).collect();
            self.birthdays.0 += 1;
            self.birthdays.1 += duplicates(&mut spacings);
        }
    }

    /// Name and probability of each statistic.
    pub fn results(&self) -> Vec<(&'static str, f64)> {
        let n = self.n as f64;
        let normal = |count: u64, trials: f64| normal_upper((count as f64 - trials / 2.0) / (trials.sqrt() / 2.0));
        let mut results = vec![
            ("ones", normal(self.ones, 32.0 * n)),
            ("changes of bits", normal(self.changes, 31.0 * n)),
            ("Hamming weights", self.weights()),
            ("pairs, 256 x 256", uniform_chi2(&self.pairs)),
            ("triples, 32 x 32 x 32", uniform_chi2(&self.triples)),
        ];
        if self.birthdays.0 > 0 {
            // At least so many of a Poisson number of this mean; half of the probability of the number itself, so that
            // p is centred.
            let (mean, k) = (f64::from(self.birthdays.0), self.birthdays.1);
            let at_least = |k: usize| if k == 0 { 1.0 } else { 1.0 - chi2_tail(2.0 * mean, 2 * k) };
            results.push(("birthday spacings", (at_least(k) + at_least(k + 1)) / 2.0));
        }
        results
    }

    /// χ² of the weights against the binomial numbers, rare ones together.
    fn weights(&self) -> f64 {
        let (mut chi2, mut classes, mut binomial) = (0.0, 0, 2f64.powi(-32));
        let mut rare = (0.0, 0.0);
        for (k, count) in self.weights.iter().enumerate() {
            let expected = self.n as f64 * binomial;
            binomial *= (32 - k) as f64 / (k + 1) as f64;
            if expected < 10.0 {
                rare = (rare.0 + expected, rare.1 + f64::from(*count));
            } else {
                chi2 += (f64::from(*count) - expected).powi(2) / expected;
                classes += 1;
            }
        }
        chi2 += (rare.1 - rare.0).powi(2) / rare.0;
        chi2_tail(chi2, classes)
    }
}

/// Prints a family of probabilities and demands that none is too close to 0 or to 1: a sound generator fails at 1 % of
/// the seeds.
#[track_caller]
pub fn judge(family: &[(String, f64)]) {
    let limit = sidak(FAMILY, family.len()) / 2.0;
    for (name, p) in family {
        println!("{name}: p = {p:.6}");
    }
    let out: Vec<_> = family.iter().filter(|(_, p)| !(limit..=1.0 - limit).contains(p)).collect();
    assert!(out.is_empty(), "p within {limit:e} of 0 or 1: {out:?}");
}
