//! The walk of the device of streams, by hand for the processor: the kernels `trace` and `shadow` with a wider tree.
//!
//! A ray in a tree is a chain of small steps: test a node, test a leaf, complete a hit. Which one comes next nobody can
//! predict, and what it needs is often in no near cache; so one ray after the other leaves a processor idle for most of the
//! time. Here many rays are on their way at once, and each waits in the list of what it does next (`avx512`): nodes, leaves,
//! hits. A list is worked off in a loop without branches that depend on the ray, each turn independent of the last one, and
//! what a ray needs next is asked of the memory when it enters the list. Nodes have eight children and leaves eight triangles,
//! tested at once.
//!
//! *The hit is that of [`crate::traverse`], to the bit*: a hit is a function of the ray and the triangles, not of the tree or of
//! the order of visits, as long as triangles and boxes are tested by the same formulas. They are the same, operation by
//! operation: nothing is contracted, and minimum and maximum give the second operand if either is NaN.
//!
//! Over few triangles there is no tree, and sixteen rays at once are tested against one triangle after the other. Rays from a
//! camera, sixteen of which go much the same way, take one walk together; where they do not, each takes its own.
//!
//! It is there where the processor has what it takes, for scenes whose instances share no triangles: trees within trees are
//! left to the kernels. Whether a hit on a cut-out counts is for a kernel to say, so triangles
//! that may have holes are in the kernels' tree, the others in this one; the better of two hits is the hit on all.

#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(not(target_arch = "x86_64"))]
#[path = "none.rs"]
mod avx512;
pub(super) mod streams;

use super::bvh::{Bounds, Dropped, Triangle};
use crate::schema::NONE;
use avx512::Triangles;

pub use avx512::Walkers;

/// A ray, as [`crate::ray::Ray`].
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Origin, m.
    pub org: [f32; 3],
    /// Direction.
    pub dir: [f32; 3],
    /// End of the range, in units of `dir`.
    pub tmax: f32,
    /// Primitives that it does not hit, or `NONE`.
    pub skip: [u32; 3],
}

/// What it hits, as [`crate::ray::Hit`].
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Hit {
    /// The primitive, or `NONE`.
    pub primitive: u32,
    /// Distance in units of the direction.
    pub t: f32,
    /// Barycentric weight of the second corner.
    pub u: f32,
    /// Barycentric weight of the third corner.
    pub v: f32,
}

impl Hit {
    /// Nothing hit within `tmax`.
    pub fn miss(tmax: f32) -> Hit {
        Hit { primitive: NONE, t: tmax, u: 0.0, v: 0.0 }
    }
}

/// Rays to trace, and where hits go. To be inlined always: on its way over the stack a ray would wait for its own words.
pub trait Rays {
    /// The number of the next ray, the ray, and the best hit so far.
    fn next(&mut self) -> Option<(u32, Ray, Hit)>;
    /// What the ray of this number hits.
    fn done(&mut self, number: u32, hit: Hit);
    /// What will be read of a primitive when a hit on it is handed in, if anything: memory is asked for it in time.
    fn needs(&self, primitive: u32) -> *const u32 {
        _ = primitive;
        std::ptr::null()
    }
}

/// What is asked of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// The nearest hits.
    Nearest,
    /// The nearest hits of rays most of which go the way of those before and behind them, as those from a camera do.
    NearestTogether,
    /// Any hit is as good as the nearest: nothing but whether there is one has a meaning.
    Any,
}

/// A scene's triangles for the native walk.
pub struct Native {
    triangles: Triangles,
    /// Where the rest of the scene lies.
    others: Vec<Bounds>,
}

impl Native {
    /// Has this processor what it takes?
    pub fn is_there() -> bool {
        avx512::is_there()
    }

    /// Triangles made ready, and which of them are left out. The rest of the scene, if there is any, lies in boxes.
    ///
    /// # Panics
    /// On processors that never have what it takes.
    pub fn new(triangles: &[Triangle], others: &[Bounds]) -> (Native, Dropped) {
        Native::of(triangles, others, usize::MAX)
    }

    /// As [`Native::new`], with a tree even over few triangles.
    ///
    /// # Panics
    /// As [`Native::new`].
    pub fn with_tree(triangles: &[Triangle], others: &[Bounds]) -> (Native, Dropped) {
        Native::of(triangles, others, 0)
    }

    fn of(triangles: &[Triangle], others: &[Bounds], few: usize) -> (Native, Dropped) {
        let around = others.iter().fold(Bounds::EMPTY, |all, part| all.union(part));
        let (triangles, dropped) = Triangles::new(triangles, around, few);
        (Native { triangles, others: others.to_vec() }, dropped)
    }

    /// Are all triangles of the scene there?
    pub fn is_all(&self) -> bool {
        self.others.is_empty()
    }

    /// The box of the scene.
    pub fn bounds(&self) -> Bounds {
        self.triangles.bounds()
    }

    /// Hands in, with the best hits so far, the rays that hit nothing in the rest of the scene for certain.
    ///
    /// # Panics
    /// Unless [`Native::is_there`].
    pub fn outside(&self, walkers: &mut Walkers, rays: &mut impl Rays) {
        self.triangles.outside(&self.others, walkers, rays);
    }

    /// Traces rays.
    ///
    /// # Panics
    /// Unless [`Native::is_there`].
    pub fn trace(&self, walkers: &mut Walkers, wanted: Wanted, rays: &mut impl Rays) {
        self.triangles.trace(walkers, wanted, rays);
    }
}
