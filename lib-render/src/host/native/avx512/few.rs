//! Few triangles need no tree: sixteen rays at once meet one triangle after the other.
//!
//! What a walk takes for a ray, whatever the tree, is enough to test dozens of triangles where nothing is gathered, sorted
//! or branched upon. Corners are looked at once by all rays, though many triangles share them. Then comes the sign test,
//! which leaves about two triangles for a ray; only where it leaves one to any of the sixteen are their hits completed. All
//! is as in [`super::triangle`], operation by operation.

use std::arch::x86_64::*;
use std::collections::HashMap;

use super::super::Rays;
use super::meet;
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
                let Row { primitive, own_box, .. } = &self.rows[row];
                meet::complete(meets[row], &lines, sixteen, self.rows[row].seen(seen), own_box, *primitive);
            }
            sixteen.hand_in(rays, !0);
        }
    }

    /// Looks at all corners.
    #[inline]
    #[target_feature(enable = "avx512f,avx512dq")]
    fn see(&self, lines: &Lines, seen: &mut [Seen]) {
        for (corner, Seen(seen)) in self.corners.iter().zip(seen) {
            let corner = meet::see(lines, *corner);
            seen.iter_mut().zip(corner).for_each(|(row, v)| put_floats_16(row, v));
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
        let limit = ANY.then(|| beyond(floats_16(&rays.tmax)));
        let (mut some, mut meets) = (0, [0; MOST]);
        for (place, (row, meets)) in self.rows.iter().zip(&mut meets).enumerate() {
            let meet = meet::might_meet(rays_there, row.seen(seen), limit);
            *meets = meet::not_skipped(meet, &skip, row.primitive);
            some |= u128::from(*meets != 0) << place;
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

impl Row {
    /// Its corners.
    #[inline]
    #[target_feature(enable = "avx512f")]
    fn seen(&self, seen: &[Seen]) -> [[__m512; 3]; 3] {
        let corner = |c: usize| &seen[self.corners[c] as usize].0;
        each!(|c| each!(|k| floats_16(&corner(c)[k])))
    }
}
