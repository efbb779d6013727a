//! A ray made ready, and the box test: [`crate::traverse::line`] and [`crate::traverse::bvh`] for eight boxes.

use std::arch::x86_64::*;

use super::super::Ray;
use super::tree::{Node, row};
use super::vector::{each, floats, four_floats, four_words};
use crate::host::bvh::Bounds;

/// See `crate::traverse::line`.
pub(super) const GROWTH: f32 = 1.0 / 1_048_576.0;
/// See `crate::traverse::line`.
pub(super) const ULP: f32 = 1.0 / 8_388_608.0;

/// As [`crate::traverse::line::Line`]: by axis, in cyclic order, the longest of the direction last; the fourth means nothing.
#[derive(Clone, Copy, Default)]
pub(super) struct Line {
    /// The origin.
    pub org: [f32; 4],
    /// 1/d.
    pub inv: [f32; 4],
    /// The origin for planes where the ray enters.
    pub org_entry: [f32; 4],
    /// And for those where it leaves.
    pub org_exit: [f32; 4],
    /// How far the first two coordinates move per unit of the third, and the scale of the third.
    pub shear: [f32; 4],
    /// The axes, 0 to 2.
    pub axis: [u32; 4],
    /// Rows of a node with the planes where the ray enters: twice the axis, and 1 more where it goes backward.
    pub near: [u32; 4],
}

impl Line {
    /// Makes a ray ready, in a scene of this box.
    #[inline]
    #[target_feature(enable = "avx512f,avx512vl,avx512dq")]
    pub fn new(scene: &Bounds, ray: &Ray) -> Line {
        let [x, y, z] = ray.dir.map(f32::abs);
        let x_is_last = (x >= y) & (x >= z);
        let y_is_last = !x_is_last & (y >= z);
        // Cyclic orders that end in z, y, x.
        const CYCLES: [[i32; 4]; 3] = [[0, 1, 2, 2], [2, 0, 1, 1], [1, 2, 0, 0]];
        let [i, j, k, l] = CYCLES[usize::from(y_is_last) + 2 * usize::from(x_is_last)];
        let axis = _mm_setr_epi32(i, j, k, l);
        let four = |v: [f32; 3]| _mm_setr_ps(v[0], v[1], v[2], v[2]);
        let sign = _mm_set1_ps(-0.0);
        let abs = |v: __m128| _mm_andnot_ps(sign, v);

        let place = four(ray.org);
        let reach = _mm_max_ps(abs(_mm_sub_ps(four(scene.lo), place)), abs(_mm_sub_ps(four(scene.hi), place)));
        let reach = _mm_max_ps(reach, _mm_permute_ps::<0b01_00_11_10>(reach));
        let reach = _mm_max_ps(reach, _mm_permute_ps::<0b10_11_00_01>(reach));
        let (org, dir) = (_mm_permutevar_ps(place, axis), _mm_permutevar_ps(four(ray.dir), axis));
        let growth = _mm_mul_ps(reach, _mm_set1_ps(GROWTH));
        let growth = _mm_add_ps(growth, _mm_mul_ps(abs(org), _mm_set1_ps(ULP)));
        let inv = _mm_div_ps(_mm_set1_ps(1.0), dir);
        let forward = _mm_or_ps(abs(growth), _mm_and_ps(sign, inv));
        let shear = _mm_div_ps(dir, _mm_permute_ps::<0b10_10_10_10>(dir));
        let is_backward = _mm_maskz_set1_epi32(_mm_cmp_ps_mask::<_CMP_LT_OQ>(inv, _mm_setzero_ps()), 1);
        Line {
            org: four_floats(org),
            inv: four_floats(inv),
            org_entry: four_floats(_mm_add_ps(org, forward)),
            org_exit: four_floats(_mm_sub_ps(org, forward)),
            shear: four_floats(_mm_blend_ps::<0b0100>(shear, inv)),
            axis: four_words(axis),
            near: four_words(_mm_add_epi32(_mm_add_epi32(axis, axis), is_backward)),
        }
    }

    /// Where it enters and leaves eight boxes, no later than `limit`; as [`crate::traverse::bvh::span`].
    #[inline]
    #[target_feature(enable = "avx512f,avx512vl")]
    pub fn span(&self, near: [__m256; 3], far: [__m256; 3], limit: f32) -> (__m256, __m256) {
        let all = |x: f32| _mm256_set1_ps(x);
        let time = |plane: __m256, org: f32, inv: f32| _mm256_mul_ps(_mm256_sub_ps(plane, all(org)), all(inv));
        let entry = each!(|k| time(near[k], self.org_entry[k], self.inv[k]));
        let exit = each!(|k| time(far[k], self.org_exit[k], self.inv[k]));
        // The accumulator comes second: NaN gives it.
        let first = _mm256_max_ps(entry[1], _mm256_max_ps(entry[0], _mm256_setzero_ps()));
        let last = _mm256_min_ps(exit[1], _mm256_min_ps(exit[0], all(limit)));
        (_mm256_max_ps(entry[2], first), _mm256_min_ps(exit[2], last))
    }

    /// Which boxes of a node it enters, no later than `limit`, and where.
    #[inline]
    #[target_feature(enable = "avx512f,avx512vl")]
    pub fn enters(&self, node: &Node, limit: f32) -> (__mmask8, __m256) {
        // An index below eight, as it is anyway, needs no check.
        let near = each!(|k| floats(row(node, self.near[k] as usize & 7)));
        let far = each!(|k| floats(row(node, (self.near[k] as usize ^ 1) & 7)));
        let (entry, exit) = self.span(near, far, limit);
        (_mm256_cmp_ps_mask::<_CMP_LE_OQ>(entry, exit), entry)
    }
}
