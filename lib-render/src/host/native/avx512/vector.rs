//! Eight lanes: loads, and order.

use std::arch::x86_64::*;

use super::tree::{Leaf, Line, WideTree};

/// Three values, by index.
macro_rules! each {
    (|$k:ident| $value:expr) => {
        [
            {
                let $k = 0_usize;
                $value
            },
            {
                let $k = 1_usize;
                $value
            },
            {
                let $k = 2_usize;
                $value
            },
        ]
    };
}
pub(super) use each;

/// Eight floats.
#[inline]
#[target_feature(enable = "avx512f,avx512vl")]
pub(super) fn floats(row: &[u32; 8]) -> __m256 {
    // SAFETY: eight words can be read there, at any alignment.
    unsafe { _mm256_loadu_ps(row.as_ptr().cast()) }
}

/// Eight words.
#[inline]
#[target_feature(enable = "avx512f,avx512vl")]
pub(super) fn words(row: &[u32; 8]) -> __m256i {
    // SAFETY: eight words can be read there, at any alignment.
    unsafe { _mm256_loadu_si256(row.as_ptr().cast()) }
}

/// Writes eight words.
#[inline]
#[target_feature(enable = "avx512f,avx512vl")]
pub(super) fn put(row: &mut [u32; 8], v: __m256i) {
    // SAFETY: eight words can be written there, at any alignment.
    unsafe { _mm256_storeu_si256(row.as_mut_ptr().cast(), v) }
}

/// Sixteen floats.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn floats_16(row: &[f32; 16]) -> __m512 {
    // SAFETY: sixteen floats can be read there, at any alignment.
    unsafe { _mm512_loadu_ps(row.as_ptr()) }
}

/// Sixteen words.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn words_16(row: &[u32; 16]) -> __m512i {
    // SAFETY: sixteen words can be read there, at any alignment.
    unsafe { _mm512_loadu_si512(row.as_ptr().cast()) }
}

/// Writes sixteen floats.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn put_floats_16(row: &mut [f32; 16], v: __m512) {
    // SAFETY: sixteen floats can be written there, at any alignment.
    unsafe { _mm512_storeu_ps(row.as_mut_ptr(), v) }
}

/// Writes sixteen words.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn put_16(row: &mut [u32; 16], v: __m512i) {
    // SAFETY: sixteen words can be written there, at any alignment.
    unsafe { _mm512_storeu_si512(row.as_mut_ptr().cast(), v) }
}

/// The lanes.
#[inline]
#[target_feature(enable = "avx512f,avx512vl")]
pub(super) fn lanes(v: __m256) -> [f32; 8] {
    let mut row = [0; 8];
    put(&mut row, _mm256_castps_si256(v));
    row.map(f32::from_bits)
}

/// The lanes of a short one.
#[inline]
#[target_feature(enable = "avx512f,avx512vl")]
pub(super) fn four_words(v: __m128i) -> [u32; 4] {
    let mut row = [0; 4];
    // SAFETY: four words can be written there, at any alignment.
    unsafe { _mm_storeu_si128(row.as_mut_ptr().cast(), v) };
    row
}

/// The lanes of a short one.
#[inline]
#[target_feature(enable = "avx512f,avx512vl")]
pub(super) fn four_floats(v: __m128) -> [f32; 4] {
    four_words(_mm_castps_si128(v)).map(f32::from_bits)
}

/// The lanes as signed numbers in descending order, by a bitonic network (Batcher 1968).
#[inline]
#[target_feature(enable = "avx512f,avx512vl")]
pub(super) fn descending(v: __m256i) -> __m256i {
    // Each lane with its partner; the smaller one goes to the lanes of the mask.
    macro_rules! exchange {
        ($v:ident, $partner:expr, $smaller:literal) => {{
            let other = $partner;
            _mm256_blend_epi32::<$smaller>(_mm256_max_epi32($v, other), _mm256_min_epi32($v, other))
        }};
    }
    let v = exchange!(v, _mm256_shuffle_epi32::<0b10_11_00_01>(v), 0b1010_1010);
    let v = exchange!(v, _mm256_shuffle_epi32::<0b00_01_10_11>(v), 0b1100_1100);
    let v = exchange!(v, _mm256_shuffle_epi32::<0b10_11_00_01>(v), 0b1010_1010);
    let backward = _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0);
    let v = exchange!(v, _mm256_permutevar8x32_epi32(v, backward), 0b1111_0000);
    let v = exchange!(v, _mm256_shuffle_epi32::<0b01_00_11_10>(v), 0b1100_1100);
    exchange!(v, _mm256_shuffle_epi32::<0b10_11_00_01>(v), 0b1010_1010)
}

/// Asks the memory for a word.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn prefetch_word(at: *const u32) {
    _mm_prefetch::<_MM_HINT_T0>(at.cast());
}

/// Asks the memory for a child, which will soon be needed. Without a branch.
#[inline]
#[target_feature(enable = "avx512f,avx512vl")]
pub(super) fn prefetch(tree: &WideTree, child: u32) {
    let at = tree.address(child);
    for line in 0..size_of::<Leaf>() / size_of::<Line>() {
        _mm_prefetch::<_MM_HINT_T0>(at.wrapping_add(line).cast());
    }
}
