//! Sixteen rays and one triangle: [`super::triangle`], operation by operation, with the roles of lanes exchanged.

use std::arch::x86_64::*;

use super::sixteen::{Lines, Sixteen};
use super::vector::{each, floats_16, words_16};
use crate::host::bvh::Bounds;

/// A corner as sixteen rays see it, each as if it went along the z axis: x, y, and z in units of its direction.
pub(super) type Seen = [__m512; 3];

/// Looks at a corner, its last coordinate given twice.
#[inline]
#[target_feature(enable = "avx512f,avx512dq")]
pub(super) fn see(lines: &Lines, [x, y, z, w]: [f32; 4]) -> Seen {
    let corner = _mm512_broadcast_f32x4(_mm_setr_ps(x, y, z, w));
    let [x, y, z] = each!(|k| _mm512_sub_ps(_mm512_permutevar_ps(corner, lines.axis[k]), lines.org[k]));
    let along = |x: __m512, shear: __m512| _mm512_sub_ps(x, _mm512_mul_ps(shear, z));
    [along(x, lines.shear[0]), along(y, lines.shear[1]), _mm512_mul_ps(lines.shear[2], z)]
}

/// The edge functions of a triangle's corners.
#[inline]
#[target_feature(enable = "avx512f")]
fn weights([a, b, c]: [Seen; 3]) -> [__m512; 3] {
    let product = |p: __m512, q: __m512| _mm512_mul_ps(p, q);
    let edge = |p: Seen, q: Seen| _mm512_sub_ps(product(p[0], q[1]), product(p[1], q[0]));
    [edge(c, b), edge(a, c), edge(b, a)]
}

/// Which of these rays, all of which end at `limit` if any hit will do, might hit the triangle: it is not behind them, and the
/// edge functions have one sign.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn might_meet(there: __mmask16, corners: [Seen; 3], limit: Option<__m512>) -> __mmask16 {
    let zero = _mm512_setzero_ps();
    let [w, u, v] = weights(corners);
    let least = _mm512_min_ps(_mm512_min_ps(w, u), v);
    let largest = _mm512_max_ps(_mm512_max_ps(w, u), v);
    let meet = _mm512_mask_cmp_ps_mask::<_CMP_GE_OQ>(there, least, zero)
        | _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(there, largest, zero);
    let [a, b, c] = corners;
    // A mean of what is behind is behind.
    let farthest = _mm512_max_ps(_mm512_max_ps(a[2], b[2]), c[2]);
    let meet = _mm512_mask_cmp_ps_mask::<_CMP_GT_OQ>(meet, farthest, zero);
    let Some(limit) = limit else { return meet };
    let nearest = _mm512_min_ps(_mm512_min_ps(a[2], b[2]), c[2]);
    _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(meet, nearest, limit)
}

/// Those of some rays that may hit a primitive.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn not_skipped(rays: __mmask16, skip: &[__m512i; 3], primitive: u32) -> __mmask16 {
    let primitive = _mm512_set1_epi32(primitive as i32);
    skip.iter().fold(rays, |rays, skip| _mm512_mask_cmpneq_epi32_mask(rays, *skip, primitive))
}

/// The best hits after a triangle, which these rays might hit.
#[inline]
#[target_feature(enable = "avx512f")]
pub(super) fn complete(
    might: __mmask16,
    lines: &Lines,
    rays: &mut Sixteen,
    corners: [Seen; 3],
    own_box: &Bounds,
    primitive: u32,
) {
    let weights = weights(corners);
    let sum = _mm512_add_ps(_mm512_add_ps(weights[0], weights[1]), weights[2]);
    let [w, u, v] = each!(|k| _mm512_div_ps(weights[k], sum));
    let [a, b, c] = each!(|c| corners[c][2]);
    let t = _mm512_add_ps(_mm512_mul_ps(w, a), _mm512_mul_ps(u, b));
    let t = _mm512_add_ps(t, _mm512_mul_ps(v, c));
    let (entry, in_box) = lines.enters(own_box.lo, own_box.hi);
    let hit = might & in_box;
    let hit = _mm512_mask_cmp_ps_mask::<_CMP_NEQ_OQ>(hit, sum, _mm512_setzero_ps());
    let hit = _mm512_mask_cmp_ps_mask::<_CMP_GT_OQ>(hit, t, _mm512_setzero_ps());
    let hit = _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(hit, t, _mm512_set1_ps(f32::INFINITY));
    let t = _mm512_max_ps(entry, t);
    let hit = _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(hit, t, floats_16(&rays.tmax));
    let (best, number) = (floats_16(&rays.best.t), _mm512_set1_epi32(primitive as i32));
    let nearer = _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(hit, t, best);
    let as_near = _mm512_mask_cmp_ps_mask::<_CMP_EQ_OQ>(hit, t, best);
    let first = _mm512_mask_cmplt_epu32_mask(as_near, number, words_16(&rays.best.primitive));
    rays.best.set(nearer | first, number, [t, u, v]);
}
