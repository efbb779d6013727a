//! Where there is no native walk.

use super::Rays;
use crate::host::bvh::{Bounds, Dropped, Triangle};

/// Nobody.
#[derive(Default)]
pub struct Walkers;

/// No tree.
pub(super) struct WideTree {
    pub bounds: Bounds,
}

impl WideTree {
    /// None can be made.
    pub fn new(_: &[Triangle], _: Bounds) -> (WideTree, Dropped) {
        panic!("there is no native walk for this processor");
    }
}

/// Never.
pub(super) fn is_there() -> bool {
    false
}

/// There is no tree to trace anything in.
pub(super) fn trace(_: &WideTree, _: &mut Walkers, _: bool, _: &mut impl Rays) {
    panic!("there is no native walk for this processor");
}
