//! The triangle test: [`crate::traverse::triangle`] for eight triangles.

use std::arch::x86_64::*;

use super::super::Hit;
use super::line::Line;
use super::tree::{Leaf, PRIMITIVES, row};
use super::vector::{each, floats, lanes, words};

/// Corners as the ray sees them that goes along the z axis, z not yet scaled, and their edge functions.
struct Edges {
    corners: [[__m256; 3]; 3],
    sheared: [[__m256; 3]; 3],
    weights: [__m256; 3],
}

impl Edges {
    #[inline]
    #[target_feature(enable = "avx512f,avx512vl")]
    fn new(leaf: &Leaf, line: &Line) -> Edges {
        let all = |x: f32| _mm256_set1_ps(x);
        // An index below three, as it is anyway, needs no check.
        let corners = each!(|c| each!(|k| floats(row(leaf, 3 * c + (line.axis[k] as usize & 3)))));
        let sheared = each!(|c| {
            let [x, y, z] = each!(|k| _mm256_sub_ps(corners[c][k], all(line.org[k])));
            let along = |x: __m256, shear: f32| _mm256_sub_ps(x, _mm256_mul_ps(all(shear), z));
            [along(x, line.shear[0]), along(y, line.shear[1]), z]
        });
        let product = |p: __m256, q: __m256| _mm256_mul_ps(p, q);
        let edge = |p: [__m256; 3], q: [__m256; 3]| _mm256_sub_ps(product(p[0], q[1]), product(p[1], q[0]));
        let [a, b, c] = sheared;
        Edges { corners, sheared, weights: [edge(c, b), edge(a, c), edge(b, a)] }
    }

    /// Where is none of the weights negative or none positive?
    #[inline]
    #[target_feature(enable = "avx512f,avx512vl")]
    fn have_one_sign(&self) -> __mmask8 {
        let ([x, y, z], zero) = (self.weights, _mm256_setzero_ps());
        let least = _mm256_min_ps(_mm256_min_ps(x, y), z);
        let largest = _mm256_max_ps(_mm256_max_ps(x, y), z);
        _mm256_cmp_ps_mask::<_CMP_GE_OQ>(least, zero) | _mm256_cmp_ps_mask::<_CMP_LE_OQ>(largest, zero)
    }

    /// The entry of each triangle's own box, and whether the ray passes it.
    #[inline]
    #[target_feature(enable = "avx512f,avx512vl")]
    fn own_box(&self, line: &Line) -> (__m256, __mmask8) {
        let [p, q, r] = self.corners;
        let lo = each!(|k| _mm256_min_ps(_mm256_min_ps(p[k], q[k]), r[k]));
        let hi = each!(|k| _mm256_max_ps(_mm256_max_ps(p[k], q[k]), r[k]));
        let backward = each!(|k| 0_u8.wrapping_sub(line.near[k] as u8 & 1));
        let near = each!(|k| _mm256_mask_blend_ps(backward[k], lo[k], hi[k]));
        let far = each!(|k| _mm256_mask_blend_ps(backward[k], hi[k], lo[k]));
        let (entry, exit) = line.span(near, far, f32::INFINITY);
        (entry, _mm256_cmp_ps_mask::<_CMP_LE_OQ>(entry, exit))
    }
}

/// Might the line meet one of the triangles?
#[inline]
#[target_feature(enable = "avx512f,avx512vl")]
pub(super) fn might_meet(leaf: &Leaf, line: &Line) -> bool {
    Edges::new(leaf, line).have_one_sign() != 0
}

/// The best hit after the triangles of a leaf.
#[inline]
#[target_feature(enable = "avx512f,avx512vl")]
pub(super) fn better(leaf: &Leaf, line: &Line, tmax: f32, skip: [u32; 3], best: Hit) -> Hit {
    let all = |x: f32| _mm256_set1_ps(x);
    let edges = Edges::new(leaf, line);
    let weights = edges.weights;
    let sum = _mm256_add_ps(_mm256_add_ps(weights[0], weights[1]), weights[2]);
    let [w, u, v] = each!(|k| _mm256_div_ps(weights[k], sum));
    let [az, bz, cz] = each!(|c| _mm256_mul_ps(all(line.shear[2]), edges.sheared[c][2]));
    let t = _mm256_add_ps(_mm256_mul_ps(w, az), _mm256_mul_ps(u, bz));
    let t = _mm256_add_ps(t, _mm256_mul_ps(v, cz));
    let (entry, is_in_box) = edges.own_box(line);
    let is_whole = _mm256_cmp_ps_mask::<_CMP_NEQ_OQ>(sum, _mm256_setzero_ps());
    let is_ahead = _mm256_cmp_ps_mask::<_CMP_GT_OQ>(t, _mm256_setzero_ps())
        & _mm256_cmp_ps_mask::<_CMP_LT_OQ>(t, all(f32::INFINITY));
    let t = _mm256_max_ps(entry, t);

    let primitives = words(row(leaf, PRIMITIVES));
    let is_not = |number: u32| _mm256_cmpneq_epi32_mask(primitives, _mm256_set1_epi32(number as i32));
    let in_range = _mm256_cmp_ps_mask::<_CMP_LE_OQ>(t, all(best.t)) & _mm256_cmp_ps_mask::<_CMP_LT_OQ>(t, all(tmax));
    let mut wins = edges.have_one_sign() & is_whole & is_ahead & is_in_box & in_range;
    wins &= is_not(skip[0]) & is_not(skip[1]) & is_not(skip[2]);
    if wins == 0 {
        return best;
    }
    let (t, u, v) = (lanes(t), lanes(u), lanes(v));
    let mut best = best;
    while wins != 0 {
        let lane = wins.trailing_zeros() as usize & 7;
        wins &= wins - 1;
        let hit = Hit { primitive: row(leaf, PRIMITIVES)[lane], t: t[lane], u: u[lane], v: v[lane] };
        if hit.t < best.t || (hit.t == best.t && hit.primitive < best.primitive) {
            best = hit;
        }
    }
    best
}
