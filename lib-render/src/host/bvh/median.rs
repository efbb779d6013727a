//! Splits at the median: a plain tree, but one of depth log n on any input.

use super::tree::{NodeId, Tree};
use super::{Bounds, MAX_LEAF};

/// Builds the whole tree over `boxes`; without any it is one empty leaf.
pub(super) fn build(boxes: &[Bounds]) -> Tree {
    let mut tree = Tree::default();
    let mut members = (0..boxes.len() as u32).collect::<Vec<_>>();
    grow(&mut tree, &mut members, boxes);
    tree
}

/// Adds a subtree over `members`, numbers in `boxes`, whose depth is at most log2 of their count.
///
/// Each step halves the members along the axis on which their centres are spread most.
pub(super) fn grow(tree: &mut Tree, members: &mut [u32], boxes: &[Bounds]) -> NodeId {
    if members.len() <= MAX_LEAF {
        return tree.leaf(members, boxes);
    }
    let axis = widest_axis(members, boxes);
    let half = members.len() / 2;
    // Equal centres are told apart by number: coincident boxes split like any others, and always in the same way.
    members.select_nth_unstable_by(half, |&a, &b| {
        let key = |i: u32| boxes[i as usize].doubled_centre()[axis];
        key(a).total_cmp(&key(b)).then(a.cmp(&b))
    });
    let (left, right) = members.split_at_mut(half);
    let children = [grow(tree, left, boxes), grow(tree, right, boxes)];
    tree.inner(children)
}

fn widest_axis(members: &[u32], boxes: &[Bounds]) -> usize {
    let mut lo = [f64::INFINITY; 3];
    let mut hi = [f64::NEG_INFINITY; 3];
    for &i in members {
        for (k, c) in boxes[i as usize].doubled_centre().into_iter().enumerate() {
            lo[k] = lo[k].min(c);
            hi[k] = hi[k].max(c);
        }
    }
    (0..3).fold(0, |best, k| if hi[k] - lo[k] > hi[best] - lo[best] { k } else { best })
}
