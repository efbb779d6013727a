//! Sixteen rays, a lane each: as they come, made ready, and what they hit.

use std::arch::x86_64::*;

use super::super::{Hit, Ray, Rays};
use super::line::{GROWTH, ULP};
use super::vector::{each, floats_16, put_16, put_floats_16, words_16};
use crate::host::bvh::Bounds;
use crate::schema::NONE;

/// Rays, as [`Ray`], and their best hits.
#[repr(align(64))]
pub(super) struct Sixteen {
    pub org: [[f32; 16]; 3],
    pub dir: [[f32; 16]; 3],
    pub tmax: [f32; 16],
    pub skip: [[u32; 16]; 3],
    pub best: Best,
    numbers: [u32; 16],
    /// How many lanes have a ray: the first.
    pub count: usize,
}

/// Hits, as [`Hit`].
#[repr(align(64))]
#[derive(Default)]
pub(super) struct Best {
    pub primitive: [u32; 16],
    pub t: [f32; 16],
    u: [f32; 16],
    v: [f32; 16],
}

impl Default for Sixteen {
    fn default() -> Sixteen {
        let (none, three) = ([0.0; 16], [[0.0; 16]; 3]);
        let best = Best::default();
        Sixteen { org: three, dir: three, tmax: none, skip: [[NONE; 16]; 3], best, numbers: [0; 16], count: 0 }
    }
}

impl Sixteen {
    /// Takes the next rays, fewer than sixteen if there are no more.
    #[inline]
    pub fn take(&mut self, rays: &mut impl Rays) {
        self.count = 0;
        while self.count < 16
            && let Some((number, Ray { org, dir, tmax, skip }, best)) = rays.next()
        {
            let lane = self.count;
            for k in 0..3 {
                self.org[k][lane] = org[k];
                self.dir[k][lane] = dir[k];
                self.skip[k][lane] = skip[k];
            }
            (self.tmax[lane], self.numbers[lane]) = (tmax, number);
            (self.best.primitive[lane], self.best.t[lane]) = (best.primitive, best.t);
            (self.best.u[lane], self.best.v[lane]) = (best.u, best.v);
            self.count += 1;
        }
    }

    /// The ray of a lane: its number, and the best hit so far.
    #[inline]
    pub fn ray(&self, lane: usize) -> (u32, Ray, Hit) {
        let three = |rows: &[[f32; 16]; 3]| [0, 1, 2].map(|k| rows[k][lane]);
        let skip = [0, 1, 2].map(|k| self.skip[k][lane]);
        let ray = Ray { org: three(&self.org), dir: three(&self.dir), tmax: self.tmax[lane], skip };
        (self.numbers[lane], ray, self.hit(lane))
    }

    /// The best hit of a lane.
    #[inline]
    fn hit(&self, lane: usize) -> Hit {
        let Best { primitive, t, u, v } = &self.best;
        Hit { primitive: primitive[lane], t: t[lane], u: u[lane], v: v[lane] }
    }

    /// Hands in what those of some lanes hit.
    #[inline]
    pub fn hand_in(&self, rays: &mut impl Rays, lanes: __mmask16) {
        for lane in (0..self.count.min(16)).filter(|lane| lanes >> lane & 1 == 1) {
            rays.done(self.numbers[lane], self.hit(lane));
        }
    }
}

impl Best {
    /// These lanes have better ones.
    #[inline]
    #[target_feature(enable = "avx512f")]
    pub fn set(&mut self, lanes: __mmask16, primitive: __m512i, [t, u, v]: [__m512; 3]) {
        let numbers = _mm512_mask_mov_epi32(words_16(&self.primitive), lanes, primitive);
        put_16(&mut self.primitive, numbers);
        for (old, new) in [(&mut self.t, t), (&mut self.u, u), (&mut self.v, v)] {
            let floats = _mm512_mask_mov_ps(floats_16(old), lanes, new);
            put_floats_16(old, floats);
        }
    }
}

/// Rays made ready; see [`crate::traverse::line`].
pub(super) struct Lines {
    /// The origin, in cyclic order, the longest axis of the direction last.
    pub org: [__m512; 3],
    /// Which axes those are.
    pub axis: [__m512i; 3],
    /// How far the first two coordinates move per unit of the third, and the scale of the third.
    pub shear: [__m512; 3],
    /// 1/d; this and what follows by axis of the world.
    pub inv: [__m512; 3],
    /// Where the ray goes backward.
    pub is_backward: [__mmask16; 3],
    /// The origin for planes where the ray enters.
    pub org_entry: [__m512; 3],
    /// And for those where it leaves.
    pub org_exit: [__m512; 3],
    /// Which of them are finite and have a direction.
    pub are_usable: __mmask16,
}

impl Lines {
    /// Makes rays ready, in a scene of this box.
    #[inline]
    #[target_feature(enable = "avx512f,avx512dq")]
    pub fn new(scene: &Bounds, rays: &Sixteen) -> Lines {
        let all = |x: f32| _mm512_set1_ps(x);
        let (place, dir) = (each!(|k| floats_16(&rays.org[k])), each!(|k| floats_16(&rays.dir[k])));
        let (distance, length) = (each!(|k| _mm512_abs_ps(place[k])), each!(|k| _mm512_abs_ps(dir[k])));
        let at_least = |p: __m512, q: __m512| _mm512_cmp_ps_mask::<_CMP_GE_OQ>(p, q);
        let [x, y, z] = length;
        let x_is_last = at_least(x, y) & at_least(x, z);
        let y_is_last = !x_is_last & at_least(y, z);
        let in_order = |v: [__m512; 3]| {
            each!(|k| {
                let by_y = _mm512_mask_blend_ps(y_is_last, v[k], v[(k + 2) % 3]);
                _mm512_mask_blend_ps(x_is_last, by_y, v[(k + 1) % 3])
            })
        };
        let axis = each!(|k| {
            let by_y = _mm512_mask_set1_epi32(_mm512_set1_epi32(k as i32), y_is_last, (k as i32 + 2) % 3);
            _mm512_mask_set1_epi32(by_y, x_is_last, (k as i32 + 1) % 3)
        });

        // How much boxes grow.
        let reach = each!(|k| {
            let to = |plane: f32| _mm512_abs_ps(_mm512_sub_ps(all(plane), place[k]));
            _mm512_max_ps(to(scene.lo[k]), to(scene.hi[k]))
        });
        let reach = _mm512_max_ps(_mm512_max_ps(reach[0], reach[1]), reach[2]);
        let reach = _mm512_mul_ps(reach, all(GROWTH));
        let inv = each!(|k| _mm512_div_ps(all(1.0), dir[k]));
        let forward = each!(|k| {
            let growth = _mm512_add_ps(reach, _mm512_mul_ps(distance[k], all(ULP)));
            _mm512_or_ps(growth, _mm512_and_ps(all(-0.0), inv[k]))
        });

        let ordered = in_order(dir);
        let sum = |v: [__m512; 3]| _mm512_add_ps(_mm512_add_ps(v[0], v[1]), v[2]);
        let is_finite = |v: __m512| _mm512_cmp_ps_mask::<_CMP_LT_OQ>(v, all(f32::INFINITY));
        let has_length = _mm512_cmp_ps_mask::<_CMP_GT_OQ>(sum(length), _mm512_setzero_ps());
        Lines {
            org: in_order(place),
            axis,
            shear: [_mm512_div_ps(ordered[0], ordered[2]), _mm512_div_ps(ordered[1], ordered[2]), in_order(inv)[2]],
            inv,
            is_backward: each!(|k| _mm512_cmp_ps_mask::<_CMP_LT_OQ>(inv[k], _mm512_setzero_ps())),
            org_entry: each!(|k| _mm512_add_ps(place[k], forward[k])),
            org_exit: each!(|k| _mm512_sub_ps(place[k], forward[k])),
            are_usable: is_finite(sum(distance)) & is_finite(sum(length)) & has_length,
        }
    }

    /// Where they enter a box, and which of them do; as [`crate::traverse::bvh::span`], whatever the order of axes: the
    /// largest entry and the smallest exit are the same, and NaN gives what was before.
    #[inline]
    #[target_feature(enable = "avx512f")]
    pub fn enters(&self, lo: [f32; 3], hi: [f32; 3]) -> (__m512, __mmask16) {
        let (mut entry, mut exit) = (_mm512_setzero_ps(), _mm512_set1_ps(f32::INFINITY));
        for k in 0..3 {
            let (lo, hi) = (_mm512_set1_ps(lo[k]), _mm512_set1_ps(hi[k]));
            let near = _mm512_mask_blend_ps(self.is_backward[k], lo, hi);
            let far = _mm512_mask_blend_ps(self.is_backward[k], hi, lo);
            let time = |plane: __m512, org: __m512| _mm512_mul_ps(_mm512_sub_ps(plane, org), self.inv[k]);
            entry = _mm512_max_ps(time(near, self.org_entry[k]), entry);
            exit = _mm512_min_ps(time(far, self.org_exit[k]), exit);
        }
        (entry, _mm512_cmp_ps_mask::<_CMP_LE_OQ>(entry, exit))
    }
}
