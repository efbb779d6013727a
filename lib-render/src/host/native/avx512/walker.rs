//! Who is on the way, and what each does next.

use std::arch::x86_64::*;

use super::super::{Hit, Ray};
use super::few::Desk;
use super::line::Line;
use super::tree::{CHILDREN, LEAF, MAX_WAITING, NOTHING, Node, ROOT, WIDTH, row};
use super::vector::{descending, put, words};
use crate::host::bvh::Bounds;
use crate::schema::NONE;

/// Rays on their way at once: so many that memory has answered by the time a ray's turn comes, so few that what they carry
/// stays in the nearest cache.
pub(super) const WALKERS: usize = 64;
/// Entries of a stack: the end of the walk, the children that wait, and those of one node written at once.
const STACK: usize = (1 + MAX_WAITING + WIDTH).next_multiple_of(16);
/// At the bottom of a stack: no child is left.
const DONE: u32 = NOTHING;

/// What a walker does next: the lists in which they wait.
#[derive(Clone, Copy)]
pub(super) enum Next {
    /// Tests the boxes of a node.
    Node,
    /// Tests the triangles of a leaf.
    Leaf,
    /// Hands in its hit, and takes another ray.
    Ray,
    /// Completes the hit on a leaf.
    Hit,
}

impl Next {
    /// What is to be done at a child: without a branch.
    #[inline]
    fn at(child: u32) -> Next {
        let arrived = if child == DONE { Next::Ray } else { Next::Leaf };
        if child < LEAF { Next::Node } else { arrived }
    }
}

/// A ray on its way.
#[derive(Clone)]
#[repr(align(64))]
pub(super) struct Walker {
    pub line: Line,
    pub best: Hit,
    /// The ray's number; `None` before the first.
    pub number: Option<u32>,
    pub tmax: f32,
    pub skip: [u32; 3],
    /// The child that it is at.
    pub child: u32,
    /// Height of the stack.
    top: u32,
    /// Where the children on the stack are entered, rounded down: their lane is in the three lowest bits.
    entries: [u32; STACK],
    /// The children on the stack; the first is [`DONE`].
    children: [u32; STACK],
}

impl Walker {
    fn new() -> Walker {
        Walker {
            line: Line::default(),
            best: Hit { primitive: NONE, t: 0.0, u: 0.0, v: 0.0 },
            number: None,
            tmax: 0.0,
            skip: [NONE; 3],
            child: 0,
            top: 1,
            entries: [0; STACK],
            children: [DONE; STACK],
        }
    }

    /// Sends it to the root with a ray.
    #[inline]
    #[target_feature(enable = "avx512f,avx512vl,avx512dq")]
    pub fn start(&mut self, number: u32, ray: &Ray, best: Hit, scene: &Bounds) {
        self.line = Line::new(scene, ray);
        self.best = best;
        self.number = Some(number);
        self.tmax = ray.tmax;
        self.skip = ray.skip;
        self.child = ROOT;
        self.top = 1;
    }

    /// Puts the children of these lanes on the stack.
    #[inline]
    #[target_feature(enable = "avx512f,avx512vl,popcnt")]
    pub fn push(&mut self, node: &Node, lanes: __mmask8) {
        let children = _mm256_maskz_compress_epi32(lanes, words(row(node, CHILDREN)));
        put(eight(&mut self.children, self.top), children);
        self.top += lanes.count_ones();
    }

    /// Puts the children of these lanes on the stack, the one that is entered first on top.
    #[inline]
    #[target_feature(enable = "avx512f,avx512vl,popcnt")]
    pub fn push_nearest_last(&mut self, node: &Node, lanes: __mmask8, entry: __m256) {
        let lane = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
        let rounded = _mm256_andnot_si256(_mm256_set1_epi32(7), _mm256_castps_si256(entry));
        // Distances are positive, so their bits are in the same order; what is not entered comes behind the others.
        let keys = _mm256_mask_or_epi32(_mm256_set1_epi32(-1), lanes, rounded, lane);
        let keys = descending(keys);
        put(eight(&mut self.entries, self.top), keys);
        put(eight(&mut self.children, self.top), _mm256_permutevar8x32_epi32(words(row(node, CHILDREN)), keys));
        self.top += lanes.count_ones();
    }

    /// Goes to the child on top of the stack.
    #[inline]
    pub fn pop(&mut self) -> Next {
        self.top -= 1;
        self.child = self.children[self.top as usize];
        Next::at(self.child)
    }

    /// Goes to the child on top of the stack, or stays for a hit: without a branch.
    #[inline]
    pub fn pop_unless(&mut self, stays: bool) -> Next {
        let top = self.top - 1;
        let child = self.children[top as usize];
        self.top = std::hint::select_unpredictable(stays, self.top, top);
        self.child = std::hint::select_unpredictable(stays, self.child, child);
        std::hint::select_unpredictable(stays, Next::Hit, Next::at(child))
    }

    /// Takes off the stack what is entered behind the best hit. The end of the walk is entered at 0.
    #[inline]
    #[target_feature(enable = "avx512f,avx512vl,popcnt")]
    pub fn forget_farther(&mut self) {
        let limit = _mm256_set1_epi32((self.best.t.to_bits() | 7) as i32);
        let (mut from, mut to) = (0, 0);
        while from < self.top {
            let entries = words(eight(&mut self.entries, from));
            let children = words(eight(&mut self.children, from));
            let are_there = ((1_u32 << (self.top - from).min(8)) - 1) as u8;
            let stay = _mm256_cmple_epi32_mask(entries, limit) & are_there;
            put(eight(&mut self.entries, to), _mm256_maskz_compress_epi32(stay, entries));
            put(eight(&mut self.children, to), _mm256_maskz_compress_epi32(stay, children));
            to += stay.count_ones();
            from += 8;
        }
        self.top = to;
    }
}

/// Eight entries of a stack.
#[inline]
fn eight(stack: &mut [u32; STACK], at: u32) -> &mut [u32; 8] {
    stack[at as usize..].first_chunk_mut().expect("no walk leaves so many children")
}

/// All who may be on their way. To be kept between calls: it is some memory.
pub struct Walkers {
    all: Box<[Walker; WALKERS]>,
    /// Where there are few triangles, nobody walks.
    pub(super) desk: Desk,
}

impl Default for Walkers {
    fn default() -> Walkers {
        let walkers: Box<[Walker]> = vec![Walker::new(); WALKERS].into();
        let all = walkers.try_into().unwrap_or_else(|_| unreachable!("it has their number"));
        Walkers { all, desk: Desk::default() }
    }
}

impl Walkers {
    #[inline]
    pub(super) fn walker(&mut self, id: u8) -> &mut Walker {
        &mut self.all[usize::from(id) % WALKERS]
    }
}

/// Who does what next.
pub(super) struct Lists {
    ids: [[u8; WALKERS]; 4],
    lengths: [usize; 4],
}

impl Lists {
    /// All take a ray first.
    pub fn new() -> Lists {
        let mut lists = Lists { ids: [[0; WALKERS]; 4], lengths: [0; 4] };
        (0..WALKERS as u8).for_each(|id| lists.wait(id, Next::Ray));
        lists
    }

    /// Puts a walker, who is in no list, in one.
    #[inline]
    pub fn wait(&mut self, id: u8, next: Next) {
        let length = &mut self.lengths[next as usize];
        self.ids[next as usize][*length % WALKERS] = id;
        *length += 1;
    }

    /// Empties a list and says how many were in it: [`Lists::waiting`] gives them, in order. Who waits again in the list
    /// meanwhile takes the place of somebody who was given already.
    #[inline]
    pub fn take(&mut self, next: Next) -> usize {
        std::mem::take(&mut self.lengths[next as usize])
    }

    /// Number i of a list that was taken.
    #[inline]
    pub fn waiting(&self, next: Next, i: usize) -> u8 {
        self.ids[next as usize][i % WALKERS]
    }

    /// Is nobody on the way?
    #[inline]
    pub fn are_empty(&self) -> bool {
        self.lengths == [0; 4]
    }
}
