//! Where there is no native walk.

use super::Rays;
use super::tree::WideTree;

/// Nobody.
#[derive(Default)]
pub struct Walkers;

/// Never.
pub(super) fn is_there() -> bool {
    false
}

/// Nothing can be traced.
pub(super) fn trace(_: &WideTree, _: &mut Walkers, _: bool, _: &mut impl Rays) {
    panic!("there is no native walk for this processor");
}
