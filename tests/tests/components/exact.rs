//! The exact sum in IR against that of the film.

use jerboa_ir::lang::{Fun, U32, entry};
use jerboa_lib_render::core::color::Color;
use jerboa_lib_render::device::pixel::PixelSum;
use jerboa_lib_render::host::film::{Film, Window};
use jerboa_tests::harness::bench::{Bench, Random, number};

/// Where rounding, words and ranges change.
const HOSTILE: [f32; 12] = [
    0.0,
    1.0,
    0.1,
    2_147_483_648.0,
    2_147_483_904.0,
    f32::MAX,
    f32::INFINITY,
    f32::NAN,
    f32::MIN_POSITIVE,
    1e-45,
    1e-19,
    3e9,
];

/// A bench whose kernel adds a sample to a row of `Pixels`, word by word.
fn bench() -> Bench {
    Bench::new(|| {
        entry(
            "add",
            Fun::<(PixelSum, Color, U32), PixelSum>::lam(|_, (sum, radiance, rays)| {
                sum.with(radiance, rays, rays + 1u32)
            }),
        );
    })
}

/// A film of one pixel with these sums.
fn film(sum: &[u32]) -> Film {
    let wide = |words: &[u32]| words.iter().rev().fold(0, |sum, word| sum << 32 | u128::from(*word)) as i128;
    let mut film = one();
    film.add_sum([0, 0], 0, std::array::from_fn(|c| wide(&sum[4 * c..][..4])), sum[12], sum[13]);
    film
}

fn one() -> Film {
    Film::new(Window { x: 0, y: 0, width: 1, height: 1 })
}

/// Adds these samples one after the other on both.
fn agree(bench: &mut Bench, samples: &[[f32; 3]]) {
    let (mut sum, mut right) = (vec![0; 16], one());
    for (rays, sample) in (0..).zip(samples) {
        let args: Vec<u32> = sum.iter().copied().chain(sample.map(f32::to_bits)).chain([rays]).collect();
        let before = sum;
        sum = bench.run_both("add", &args);
        right.add([0, 0], *sample);
        assert_eq!(film(&sum), right, "{sample:?} to {before:x?}");
        assert_eq!([sum[14], sum[15]], [before[14] + rays, before[15] + rays + 1]);
    }
}

#[test]
fn hostile_samples_are_rounded_and_dropped_as_on_the_film() {
    let mut bench = bench();
    let mut values: Vec<f32> = HOSTILE.to_vec();
    // Each power of two that is rounded, halves and their neighbours above and below, odd and even.
    for exponent in -70..32 {
        let power = 2_f32.powi(exponent);
        values.extend([power, power.next_up(), power.next_down(), 1.5 * power, (1.5 * power).next_up(), 1.75 * power]);
    }
    for x in values {
        agree(&mut bench, &[[x, -x, 0.5], [-1.0, x, 1e-3], [-x, x, -x]]);
    }
}

#[test]
fn random_samples_are_summed_as_on_the_film() {
    let mut bench = bench();
    let mut random = Random::new(0xe4ac7);
    for _ in 0..number("JERBOA_EXACT", 40) {
        let mut word = || {
            let bits = random.bits();
            // Any bits; or, of any sign, a magnitude in or near the range of the film.
            let near = f32::from_bits(((bits as u32) & 0x807f_ffff) | (((bits >> 32) % 104 + 56) as u32) << 23);
            if bits >> 60 == 0 { f32::from_bits((bits >> 16) as u32) } else { near }
        };
        let samples: Vec<[f32; 3]> = (0..40).map(|_| [word(), word(), word()]).collect();
        agree(&mut bench, &samples);
    }
}
