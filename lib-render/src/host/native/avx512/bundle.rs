//! Rays that go much the same way, as those of a pixel do: sixteen take one walk.
//!
//! A node is tested against intervals: when the first of the rays may enter a box, and when the last may leave it. Rounding is
//! monotone, so the bounds hold for what each ray would find by itself ([`super::line`]), and no ray misses a box that it enters. Triangles are then tested as [`super::meet`] does, for all rays at once; so the hits are those of the other walk.

use std::arch::x86_64::*;

use super::super::{Hit, Ray, Rays};
use super::meet;
use super::sixteen::{Lines, Sixteen};
use super::tree::{CHILDREN, LEAF, Leaf, MAX_WAITING, Node, PRIMITIVES, ROOT, WIDTH, WideTree, row};
use super::vector::{descending, each, floats, floats_16, put, words, words_16};
use crate::host::bvh::Bounds;
use crate::schema::NONE;

/// How far directions of rays that go together may lie apart along each axis, relative to their largest coordinate, and their
/// origins, relative to the scene. Chosen, not tuned: sixteen pixels side by side in a film of some 300 still go together.
/// Without a limit shadow rays took 17 times as long (tests/runs/native.txt).
const WIDEST: f32 = 1.0 / 16.0;

/// Traces rays, sixteen at a time in the order they come; gives those that do not go together.
#[target_feature(enable = "avx512f,avx512vl,avx512dq,popcnt,bmi1")]
pub(super) fn trace(tree: &WideTree, sixteen: &mut Sixteen, rays: &mut impl Rays) -> Vec<(u32, Ray, Hit)> {
    let mut apart = Vec::new();
    let mut stack = Stack::new();
    loop {
        sixteen.take(rays);
        if sixteen.count == 0 {
            return apart;
        }
        let lines = Lines::new(&tree.bounds, sixteen);
        let there = lines.are_usable & ((1_u32 << sixteen.count) - 1) as __mmask16;
        if go_together(&tree.bounds, sixteen, there) {
            Bundle::new(&lines, there).walk(tree, &lines, sixteen, &mut stack);
            sixteen.hand_in(rays, !0);
        } else {
            apart.extend((0..sixteen.count).map(|lane| sixteen.ray(lane)));
        }
    }
}

/// Do those of some lanes? None do not.
#[inline]
#[target_feature(enable = "avx512f,avx512dq")]
fn go_together(scene: &Bounds, rays: &Sixteen, there: __mmask16) -> bool {
    let most = |v: __m512| _mm512_mask_reduce_max_ps(there, v);
    let apart = |v: &[f32; 16]| most(floats_16(v)) - _mm512_mask_reduce_min_ps(there, floats_16(v));
    let widest = |rows: &[[f32; 16]; 3]| rows.iter().map(apart).fold(0.0, f32::max);
    let longest = rays.dir.iter().map(|v| most(_mm512_abs_ps(floats_16(v)))).fold(0.0, f32::max);
    let size = scene.extent().into_iter().fold(0.0, f64::max) as f32;
    there != 0 && widest(&rays.dir) <= WIDEST * longest && widest(&rays.org) <= WIDEST * size
}

/// Where sixteen rays begin, and where they go; by axis.
struct Bundle {
    /// Which lanes have one.
    there: __mmask16,
    ways: [Way; 3],
}

/// Where rays begin along an axis, and which way they go.
enum Way {
    /// All the same, mirrored where that is backward: the largest origin for planes where they enter and the smallest one for
    /// those where they leave, and the least and the most of 1/d.
    Same { is_backward: bool, org_entry: f32, org_exit: f32, inv: [f32; 2] },
    /// Some forward, some backward: origins lie between two numbers, and the steepest of each have this 1/d.
    Both { org: [f32; 2], inv: [f32; 2] },
}

impl Way {
    #[inline]
    #[target_feature(enable = "avx512f,avx512dq")]
    fn new(lines: &Lines, there: __mmask16, k: usize) -> Way {
        let least = |lanes: __mmask16, v: __m512| _mm512_mask_reduce_min_ps(lanes, v);
        let most = |lanes: __mmask16, v: __m512| _mm512_mask_reduce_max_ps(lanes, v);
        let (org_entry, org_exit, inv) = (lines.org_entry[k], lines.org_exit[k], lines.inv[k]);
        let backward = lines.is_backward[k] & there;
        if backward != 0 && backward != there {
            let org =
                [least(there, _mm512_min_ps(org_entry, org_exit)), most(there, _mm512_max_ps(org_entry, org_exit))];
            return Way::Both { org, inv: [most(backward, inv), least(there & !backward, inv)] };
        }
        let is_backward = backward != 0;
        let [org_entry, org_exit, inv] = if is_backward {
            [org_entry, org_exit, inv].map(|v| _mm512_xor_ps(v, _mm512_set1_ps(-0.0)))
        } else {
            [org_entry, org_exit, inv]
        };
        let inv = [least(there, inv), most(there, inv)];
        Way::Same { is_backward, org_entry: most(there, org_entry), org_exit: least(there, org_exit), inv }
    }

    /// The time when the first of the rays may enter between planes, no earlier than `first`, and that when the last leaves, no
    /// later than `last`. NaN, where a ray goes along a plane, gives what was before.
    #[inline]
    #[target_feature(enable = "avx512f,avx512vl,avx512dq")]
    fn span(&self, lo: __m256, hi: __m256, [first, last]: [__m256; 2]) -> [__m256; 2] {
        let all = |x: f32| _mm256_set1_ps(x);
        match *self {
            Way::Same { is_backward, org_entry, org_exit, inv: [least, most] } => {
                let mirrored = |plane: __m256| _mm256_xor_ps(plane, all(-0.0));
                let (near, far) = if is_backward { (mirrored(hi), mirrored(lo)) } else { (lo, hi) };
                // Beyond the origin the steepest ray is last there, behind it first.
                let time = |way: __m256, beyond: f32, behind: f32| {
                    let is_beyond = _mm256_cmp_ps_mask::<_CMP_GE_OQ>(way, _mm256_setzero_ps());
                    _mm256_mul_ps(way, _mm256_mask_blend_ps(is_beyond, all(behind), all(beyond)))
                };
                let entry = time(_mm256_sub_ps(near, all(org_entry)), least, most);
                let exit = time(_mm256_sub_ps(far, all(org_exit)), most, least);
                [_mm256_max_ps(entry, first), _mm256_min_ps(exit, last)]
            }
            // Whoever goes the other way never gets there.
            Way::Both { org: [least, most], inv: [backward, forward] } => {
                let above = _mm256_mul_ps(_mm256_sub_ps(lo, all(most)), all(forward));
                let below = _mm256_mul_ps(_mm256_sub_ps(hi, all(least)), all(backward));
                [_mm256_max_ps(below, _mm256_max_ps(above, first)), last]
            }
        }
    }
}

impl Bundle {
    #[inline]
    #[target_feature(enable = "avx512f,avx512dq")]
    fn new(lines: &Lines, there: __mmask16) -> Bundle {
        Bundle { there, ways: each!(|k| Way::new(lines, there, k)) }
    }

    /// Finds the hits.
    #[inline]
    #[target_feature(enable = "avx512f,avx512vl,avx512dq,popcnt,bmi1")]
    fn walk(&self, tree: &WideTree, lines: &Lines, rays: &mut Sixteen, stack: &mut Stack) {
        let mut limit = self.limit(rays);
        let mut child = ROOT;
        stack.top = 0;
        loop {
            if child & LEAF == 0 {
                let node = tree.node(child);
                let planes = |side: usize| each!(|k| floats(row(node, 2 * k + side)));
                let (entered, entry) = self.enters(planes(0), planes(1), limit);
                stack.push_nearest_last(node, entered, entry);
            } else if self.test(tree.leaf(child), lines, rays, limit) {
                limit = self.limit(rays);
            }
            match stack.pop(limit) {
                Some(next) => child = next,
                None => return,
            }
        }
    }

    /// Behind this no ray needs a hit.
    #[inline]
    #[target_feature(enable = "avx512f")]
    fn limit(&self, rays: &Sixteen) -> f32 {
        _mm512_mask_reduce_max_ps(self.there, floats_16(&rays.best.t))
    }

    /// Which of eight boxes some ray may enter, no later than `limit`, and where the first.
    #[inline]
    #[target_feature(enable = "avx512f,avx512vl,avx512dq")]
    fn enters(&self, lo: [__m256; 3], hi: [__m256; 3], limit: f32) -> (__mmask8, __m256) {
        let mut span = [_mm256_setzero_ps(), _mm256_set1_ps(limit)];
        for k in 0..3 {
            span = self.ways[k].span(lo[k], hi[k], span);
        }
        let [first, last] = span;
        (_mm256_cmp_ps_mask::<_CMP_LE_OQ>(first, last), first)
    }

    /// Tests the triangles of a leaf whose boxes some ray may enter. Might a hit be better than one before?
    #[inline]
    #[target_feature(enable = "avx512f,avx512vl,avx512dq,popcnt,bmi1")]
    fn test(&self, leaf: &Leaf, lines: &Lines, rays: &mut Sixteen, limit: f32) -> bool {
        let [p, q, r] = each!(|c| each!(|k| floats(row(leaf, 3 * c + k))));
        let lo = each!(|k| _mm256_min_ps(_mm256_min_ps(p[k], q[k]), r[k]));
        let hi = each!(|k| _mm256_max_ps(_mm256_max_ps(p[k], q[k]), r[k]));
        let is_there = _mm256_cmpneq_epi32_mask(words(row(leaf, PRIMITIVES)), _mm256_set1_epi32(NONE as i32));
        let mut entered = self.enters(lo, hi, limit).0 & is_there;
        let mut is_met = false;
        while entered != 0 {
            let lane = entered.trailing_zeros() as usize & 7;
            entered &= entered - 1;
            let corner = |c: usize| [0, 1, 2].map(|k| f32::from_bits(row(leaf, 3 * c + k)[lane]));
            let seen = each!(|c| {
                let [x, y, z] = corner(c);
                meet::see(lines, [x, y, z, z])
            });
            let primitive = row(leaf, PRIMITIVES)[lane];
            let might = meet::might_meet(self.there, seen, None);
            let might = meet::not_skipped(might, &each!(|k| words_16(&rays.skip[k])), primitive);
            if might != 0 {
                is_met = true;
                let own_box = Bounds::of(&[corner(0), corner(1), corner(2)]);
                meet::complete(might, lines, rays, seen, &own_box, primitive);
            }
        }
        is_met
    }
}

/// Children that wait, with where they are entered.
struct Stack {
    /// As bits, rounded down: their lane is in the three lowest.
    entries: [u32; SIZE],
    children: [u32; SIZE],
    top: usize,
}

/// Children that wait, and those of one node written at once.
const SIZE: usize = MAX_WAITING + 2 * WIDTH;

impl Stack {
    fn new() -> Stack {
        Stack { entries: [0; SIZE], children: [0; SIZE], top: 0 }
    }

    /// Puts the children of these lanes on the stack, the one that is entered first on top; see
    /// [`super::walker::Walker::push_nearest_last`].
    #[inline]
    #[target_feature(enable = "avx512f,avx512vl,popcnt")]
    fn push_nearest_last(&mut self, node: &Node, lanes: __mmask8, entry: __m256) {
        let lane = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
        let rounded = _mm256_andnot_si256(_mm256_set1_epi32(7), _mm256_castps_si256(entry));
        let keys = descending(_mm256_mask_or_epi32(_mm256_set1_epi32(-1), lanes, rounded, lane));
        let eight = |stack: &mut [u32; SIZE], at: usize, v: __m256i| {
            put(stack[at..].first_chunk_mut().expect("no walk leaves so many children"), v);
        };
        eight(&mut self.entries, self.top, keys);
        eight(&mut self.children, self.top, _mm256_permutevar8x32_epi32(words(row(node, CHILDREN)), keys));
        self.top += lanes.count_ones() as usize;
    }

    /// The child on top that is not entered behind a limit.
    #[inline]
    fn pop(&mut self, limit: f32) -> Option<u32> {
        while self.top > 0 {
            self.top -= 1;
            if self.entries[self.top] <= limit.to_bits() | 7 {
                return Some(self.children[self.top]);
            }
        }
        None
    }
}
