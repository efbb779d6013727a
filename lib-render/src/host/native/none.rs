//! Where there is no native walk.

use super::{Rays, Wanted};
use crate::host::bvh::{Bounds, Dropped, Triangle};

/// Nobody.
#[derive(Default)]
pub struct Walkers;

/// None.
pub(super) struct Triangles;

impl Triangles {
    /// None can be made.
    pub fn new(_: &[Triangle], _: Bounds, _: usize) -> (Triangles, Dropped) {
        panic!("there is no native walk for this processor");
    }

    /// Of nothing.
    pub fn bounds(&self) -> Bounds {
        Bounds::EMPTY
    }

    /// There is nothing to pass by.
    pub fn outside(&self, _: &[Bounds], _: &mut Walkers, _: &mut impl Rays) {
        panic!("there is no native walk for this processor");
    }

    /// There is nothing to trace rays in.
    pub fn trace(&self, _: &mut Walkers, _: Wanted, _: &mut impl Rays) {
        panic!("there is no native walk for this processor");
    }
}

/// Never.
pub(super) fn is_there() -> bool {
    false
}
