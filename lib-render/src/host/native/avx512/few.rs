//! Few triangles need no tree: sixteen rays at once meet one triangle after the other.
//!
//! What a walk takes for a ray, whatever the tree, is enough to test dozens of triangles where nothing is gathered, sorted
//! or branched upon. Corners are looked at once by all rays, though many triangles share them. Then comes the sign test,
//! which leaves about two triangles for a ray; only where it leaves one to any of the sixteen are their hits completed. All
//! is as in [`super::triangle`], operation by operation.

use std::arch::x86_64::*;
use std::collections::HashMap;

use super::super::Rays;
use super::sixteen::{Lines, Sixteen};
use super::vector::{each, floats_16, put_floats_16, words_16};
use crate::host::bvh::{Bounds, Triangle};

/// Most triangles for which it pays (tests/runs/native.txt).
pub(super) const MOST: usize = 128;

/// The triangles.
pub(in crate::host::native) struct Few {
    /// All places where there is a corner, the last coordinate twice.
    corners: Vec<[f32; 4]>,
    rows: Vec<Row>,
    /// The box of the scene.
    pub scene: Bounds,
}

/// A triangle.
struct Row {
    /// Its corners' places in the list.
    corners: [u32; 3],
    primitive: u32,
    own_box: Bounds,
}

/// What is kept between calls.
#[derive(Default)]
pub(super) struct Desk {
    pub rays: Sixteen,
    /// The corners as the rays see them.
    seen: Vec<Seen>,
}

/// A corner as sixteen rays see it, each as if it went along the z axis: x, y, and z in units of its direction.
#[repr(align(64))]
#[derive(Clone, Copy, Default)]
struct Seen([[f32; 16]; 3]);

impl Few {
    /// The triangles of these numbers, at most [`MOST`], in a scene of this box.
    pub fn new(triangles: &[Triangle], numbers: &[u32], scene: Bounds) -> Few {
        let (mut corners, mut places) = (Vec::new(), HashMap::new());
        let mut place = |p: [f32; 3]| {
            *places.entry(p.map(f32::to_bits)).or_insert_with(|| {
                corners.push([p[0], p[1], p[2], p[2]]);
                corners.len() as u32 - 1
            })
        };
        let mut row = |number: &u32| {
            let triangle = &triangles[*number as usize];
            Row { corners: triangle.map(&mut place), primitive: *number, own_box: Bounds::of(triangle) }
        };
        let rows = numbers.iter().map(&mut row).collect();
        Few { corners, rows, scene }
    }

    /// Traces rays. `ANY`: any hit is as good as the nearest.
    #[target_feature(enable = "avx512f,avx512dq")]
    pub(super) fn trace<const ANY: bool>(&self, desk: &mut Desk, rays: &mut impl Rays) {
        let Desk { rays: sixteen, seen } = desk;
        seen.resize(self.corners.len(), Seen::default());
        loop {
            sixteen.take(rays);
            if sixteen.count == 0 {
                return;
            }
            let lines = Lines::new(&self.scene, sixteen);
            self.see(&lines, seen);
            let (mut some, meets) = self.candidates::<ANY>(sixteen, lines.are_usable, seen);
            while some != 0 {
                let row = some.trailing_zeros() as usize % MOST;
                some &= some - 1;
                self.rows[row].complete(meets[row], &lines, sixteen, seen);
            }
            sixteen.hand_in(rays, !0);
        }
    }

    /// Looks at all corners.
    #[inline]
    #[target_feature(enable = "avx512f,avx512dq")]
    fn see(&self, lines: &Lines, seen: &mut [Seen]) {
        for ([x, y, z, w], Seen(seen)) in self.corners.iter().zip(seen) {
            let corner = _mm512_broadcast_f32x4(_mm_setr_ps(*x, *y, *z, *w));
            let [x, y, z] = each!(|k| _mm512_sub_ps(_mm512_permutevar_ps(corner, lines.axis[k]), lines.org[k]));
            let along = |x: __m512, shear: __m512| _mm512_sub_ps(x, _mm512_mul_ps(shear, z));
            put_floats_16(&mut seen[0], along(x, lines.shear[0]));
            put_floats_16(&mut seen[1], along(y, lines.shear[1]));
            put_floats_16(&mut seen[2], _mm512_mul_ps(lines.shear[2], z));
        }
    }

    /// Which rays might hit each triangle, and a bit for each that any might.
    #[inline]
    #[target_feature(enable = "avx512f")]
    fn candidates<const ANY: bool>(
        &self,
        rays: &Sixteen,
        are_usable: __mmask16,
        seen: &[Seen],
    ) -> (u128, [__mmask16; MOST]) {
        const { assert!(MOST <= u128::BITS as usize) };
        let rays_there = are_usable & ((1_u32 << rays.count) - 1) as __mmask16;
        let skip = each!(|k| words_16(&rays.skip[k]));
        let limit = beyond(floats_16(&rays.tmax));
        let zero = _mm512_setzero_ps();
        let (mut some, mut meets) = (0, [0; MOST]);
        for (place, (row, meets)) in self.rows.iter().zip(&mut meets).enumerate() {
            let [a, b, c] = row.seen(seen);
            let [w, u, v] = weights([a, b, c]);
            let least = _mm512_min_ps(_mm512_min_ps(w, u), v);
            let largest = _mm512_max_ps(_mm512_max_ps(w, u), v);
            let meet = _mm512_mask_cmp_ps_mask::<_CMP_GE_OQ>(rays_there, least, zero)
                | _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(rays_there, largest, zero);
            // A mean of what is behind is behind.
            let farthest = _mm512_max_ps(_mm512_max_ps(a[2], b[2]), c[2]);
            let mut meet = _mm512_mask_cmp_ps_mask::<_CMP_GT_OQ>(meet, farthest, zero);
            if ANY {
                let nearest = _mm512_min_ps(_mm512_min_ps(a[2], b[2]), c[2]);
                meet = _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(meet, nearest, limit);
            }
            let primitive = _mm512_set1_epi32(row.primitive as i32);
            for skip in skip {
                meet = _mm512_mask_cmpneq_epi32_mask(meet, skip, primitive);
            }
            *meets = meet;
            some |= u128::from(meet != 0) << place;
        }
        (some, meets)
    }
}

/// A distance such that a triangle whose corners all lie there is not hit before `tmax`: a mean of three distances, as it is
/// rounded, is less than the smallest of them by 8 · 2^-24 of it at most, if that is no tiny number. This leaves four times as
/// much.
#[inline]
#[target_feature(enable = "avx512f")]
fn beyond(tmax: __m512) -> __m512 {
    let all = |x: f32| _mm512_set1_ps(x);
    _mm512_max_ps(_mm512_mul_ps(tmax, all(1.0 + 1.0 / 524_288.0)), all(1e-30))
}

/// The edge functions of corners that were looked at.
#[inline]
#[target_feature(enable = "avx512f")]
fn weights([a, b, c]: [[__m512; 3]; 3]) -> [__m512; 3] {
    let product = |p: __m512, q: __m512| _mm512_mul_ps(p, q);
    let edge = |p: [__m512; 3], q: [__m512; 3]| _mm512_sub_ps(product(p[0], q[1]), product(p[1], q[0]));
    [edge(c, b), edge(a, c), edge(b, a)]
}

impl Row {
    /// Its corners.
    #[inline]
    #[target_feature(enable = "avx512f")]
    fn seen(&self, seen: &[Seen]) -> [[__m512; 3]; 3] {
        let corner = |c: usize| &seen[self.corners[c] as usize].0;
        each!(|c| each!(|k| floats_16(&corner(c)[k])))
    }

    /// The best hits after this triangle, which these rays might hit.
    #[inline]
    #[target_feature(enable = "avx512f")]
    fn complete(&self, might: __mmask16, lines: &Lines, rays: &mut Sixteen, seen: &[Seen]) {
        let corners = self.seen(seen);
        let weights = weights(corners);
        let sum = _mm512_add_ps(_mm512_add_ps(weights[0], weights[1]), weights[2]);
        let [w, u, v] = each!(|k| _mm512_div_ps(weights[k], sum));
        let [a, b, c] = each!(|c| corners[c][2]);
        let t = _mm512_add_ps(_mm512_mul_ps(w, a), _mm512_mul_ps(u, b));
        let t = _mm512_add_ps(t, _mm512_mul_ps(v, c));
        let (entry, in_box) = lines.enters(self.own_box.lo, self.own_box.hi);
        let hit = might & in_box;
        let hit = _mm512_mask_cmp_ps_mask::<_CMP_NEQ_OQ>(hit, sum, _mm512_setzero_ps());
        let hit = _mm512_mask_cmp_ps_mask::<_CMP_GT_OQ>(hit, t, _mm512_setzero_ps());
        let hit = _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(hit, t, _mm512_set1_ps(f32::INFINITY));
        let t = _mm512_max_ps(entry, t);
        let hit = _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(hit, t, floats_16(&rays.tmax));
        let (best, primitive) = (floats_16(&rays.best.t), _mm512_set1_epi32(self.primitive as i32));
        let nearer = _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(hit, t, best);
        let as_near = _mm512_mask_cmp_ps_mask::<_CMP_EQ_OQ>(hit, t, best);
        let first = _mm512_mask_cmplt_epu32_mask(as_near, primitive, words_16(&rays.best.primitive));
        rays.best.set(nearer | first, primitive, [t, u, v]);
    }
}
