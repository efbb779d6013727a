//! The walk by AVX-512: many rays on their way, each in the list of what it does next. Few triangles take no walk ([`few`]).

mod bundle;
mod few;
mod line;
mod meet;
mod outside;
mod sixteen;
mod tree;
mod triangle;
mod vector;
mod walker;

use super::{Hit, Ray, Rays, Wanted};
use crate::host::bvh::prefilter::usable;
use crate::host::bvh::{Bounds, Dropped, Triangle};
use crate::schema::NONE;
use few::Few;
use tree::WideTree;
use vector::{prefetch, prefetch_word};
use walker::{Lists, Next};

pub use walker::Walkers;

/// Does this processor have the instructions?
pub(super) fn is_there() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("popcnt")
        && is_x86_feature_detected!("bmi1")
}

/// Triangles, as they are traced.
pub(super) enum Triangles {
    /// One after the other.
    Few(Few),
    /// In a tree.
    Many(WideTree),
}

impl Triangles {
    /// The usable ones of these, and which are not. The rest of the scene lies in a box. Some are few: no more than both that
    /// number and [`few::MOST`].
    pub fn new(triangles: &[Triangle], others: Bounds, few: usize) -> (Triangles, Dropped) {
        let usable = usable(triangles);
        let made = if usable.numbers.len() <= few.min(few::MOST) {
            let scene = usable.bounds.iter().fold(others, |all, own| all.union(own));
            Triangles::Few(Few::new(triangles, &usable.numbers, scene))
        } else {
            Triangles::Many(WideTree::new(triangles, &usable, others))
        };
        (made, usable.dropped)
    }

    /// The box of the scene.
    pub fn bounds(&self) -> Bounds {
        match self {
            Triangles::Few(few) => few.scene,
            Triangles::Many(tree) => tree.bounds,
        }
    }

    /// Hands in the rays that enter none of these boxes, in their scene; see [`outside::outside`].
    ///
    /// # Panics
    /// Where the instructions are not there.
    pub fn outside(&self, boxes: &[Bounds], walkers: &mut Walkers, rays: &mut impl Rays) {
        assert!(is_there(), "the native walk takes AVX-512");
        // SAFETY: the instructions are there.
        unsafe { outside::outside(&self.bounds(), boxes, &mut walkers.desk.rays, rays) }
    }

    /// Traces rays.
    ///
    /// # Panics
    /// Where the instructions are not there.
    pub fn trace(&self, walkers: &mut Walkers, wanted: Wanted, rays: &mut impl Rays) {
        assert!(is_there(), "the native walk takes AVX-512");
        let desk = &mut walkers.desk;
        // SAFETY: the instructions are there.
        unsafe {
            match (self, wanted) {
                (Triangles::Few(few), Wanted::Nearest | Wanted::NearestTogether) => few.trace::<false>(desk, rays),
                (Triangles::Few(few), Wanted::Any) => few.trace::<true>(desk, rays),
                (Triangles::Many(tree), Wanted::Nearest) => Walk::new(tree, walkers, rays).run::<false>(),
                (Triangles::Many(tree), Wanted::Any) => Walk::new(tree, walkers, rays).run::<true>(),
                (Triangles::Many(tree), Wanted::NearestTogether) => {
                    let list = bundle::trace(tree, &mut desk.rays, rays);
                    Walk::new(tree, walkers, &mut Apart { list, rays }).run::<false>();
                }
            }
        }
    }
}

/// Finite, and with a direction; as in [`crate::traverse`].
#[inline]
fn is_usable(ray: &Ray) -> bool {
    let sum = |v: [f32; 3]| v[0].abs() + v[1].abs() + v[2].abs();
    let (place, direction) = (sum(ray.org), sum(ray.dir));
    place < f32::INFINITY && direction > 0.0 && direction < f32::INFINITY
}

/// Rays that were taken from others, to which their hits go.
struct Apart<'a, R> {
    list: Vec<(u32, Ray, Hit)>,
    rays: &'a mut R,
}

impl<R: Rays> Rays for Apart<'_, R> {
    #[inline(always)]
    fn next(&mut self) -> Option<(u32, Ray, Hit)> {
        self.list.pop()
    }

    #[inline(always)]
    fn done(&mut self, number: u32, hit: Hit) {
        self.rays.done(number, hit);
    }

    #[inline(always)]
    fn needs(&self, primitive: u32) -> *const u32 {
        self.rays.needs(primitive)
    }
}

/// Rays on their way.
struct Walk<'a, R> {
    tree: &'a WideTree,
    walkers: &'a mut Walkers,
    lists: Lists,
    rays: &'a mut R,
}

impl<'a, R: Rays> Walk<'a, R> {
    fn new(tree: &'a WideTree, walkers: &'a mut Walkers, rays: &'a mut R) -> Walk<'a, R> {
        Walk { tree, walkers, lists: Lists::new(), rays }
    }

    /// Until no ray is left. `ANY`: any hit is as good as the nearest.
    #[target_feature(enable = "avx512f,avx512vl,avx512dq,popcnt,bmi1")]
    fn run<const ANY: bool>(mut self) {
        while !self.lists.are_empty() {
            self.start_rays();
            self.enter_nodes::<ANY>();
            self.test_leaves();
            self.complete_hits::<ANY>();
        }
    }

    /// Hands in what was hit, and takes new rays. A walker that gets none waits no more.
    #[inline]
    #[target_feature(enable = "avx512f,avx512vl,avx512dq,popcnt,bmi1")]
    fn start_rays(&mut self) {
        for i in 0..self.lists.take(Next::Ray) {
            let id = self.lists.waiting(Next::Ray, i);
            let walker = self.walkers.walker(id);
            if let Some(number) = walker.number.take() {
                self.rays.done(number, walker.best);
            }
            while let Some((number, ray, best)) = self.rays.next() {
                if is_usable(&ray) {
                    walker.start(number, &ray, best, &self.tree.bounds);
                    self.lists.wait(id, Next::Node);
                    break;
                }
                self.rays.done(number, best);
            }
        }
    }

    /// One node each: the children that are entered go on the stack, and the nearest comes off it.
    #[inline]
    #[target_feature(enable = "avx512f,avx512vl,avx512dq,popcnt,bmi1")]
    fn enter_nodes<const ANY: bool>(&mut self) {
        for i in 0..self.lists.take(Next::Node) {
            let id = self.lists.waiting(Next::Node, i);
            let walker = self.walkers.walker(id);
            let node = self.tree.node(walker.child);
            let (entered, entry) = walker.line.enters(node, walker.best.t);
            if ANY {
                walker.push(node, entered);
            } else {
                walker.push_nearest_last(node, entered, entry);
            }
            let next = walker.pop();
            prefetch(self.tree, walker.child);
            self.lists.wait(id, next);
        }
    }

    /// One leaf each. Where the line may meet a triangle, the hit is completed later.
    #[inline]
    #[target_feature(enable = "avx512f,avx512vl,avx512dq,popcnt,bmi1")]
    fn test_leaves(&mut self) {
        for i in 0..self.lists.take(Next::Leaf) {
            let id = self.lists.waiting(Next::Leaf, i);
            let walker = self.walkers.walker(id);
            let leaf = self.tree.leaf(walker.child);
            let next = walker.pop_unless(triangle::might_meet(leaf, &walker.line));
            prefetch(self.tree, walker.child);
            self.lists.wait(id, next);
        }
    }

    /// The best hit after a leaf, and what it leaves to do.
    #[inline]
    #[target_feature(enable = "avx512f,avx512vl,avx512dq,popcnt,bmi1")]
    fn complete_hits<const ANY: bool>(&mut self) {
        for i in 0..self.lists.take(Next::Hit) {
            let id = self.lists.waiting(Next::Hit, i);
            let walker = self.walkers.walker(id);
            let leaf = self.tree.leaf(walker.child);
            let best = triangle::better(leaf, &walker.line, walker.tmax, walker.skip, walker.best);
            let is_better = best != walker.best;
            walker.best = best;
            if ANY && best.primitive != NONE {
                self.lists.wait(id, Next::Ray);
                continue;
            }
            if is_better && !ANY {
                prefetch_word(self.rays.needs(best.primitive));
                walker.forget_farther();
            }
            let next = walker.pop();
            prefetch(self.tree, walker.child);
            self.lists.wait(id, next);
        }
    }
}
