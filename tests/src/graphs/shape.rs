//! The shape of a control flow graph: which block goes on in which.
//!
//! Every reducible graph is forward edges, along which block numbers rise, and edges back to blocks that dominate their
//! source (Hecht and Ullman, *Characterizations of Reducible Flow Graphs*, J. ACM 1974). An edge to a dominator changes no
//! dominator; so the forward edges are drawn first, then the dominators are known, then the edges back are drawn.

use crate::choices::Choices;

/// Blocks of a graph at most.
const BLOCKS: u32 = 24;

/// A reducible graph over blocks that are numbered in a topological order of its forward edges. Block 0 is the entry.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Where each block goes on, in the order of its arms. An arm may repeat; none is a return.
    pub succs: Vec<Vec<usize>>,
    /// The immediate dominator of each block; the entry's is itself.
    pub idom: Vec<usize>,
    /// How often each block stands in `succs`.
    pub entered: Vec<u32>,
    /// Is the block the header of a loop?
    pub header: Vec<bool>,
}

impl Shape {
    /// A random shape of `most` blocks at most.
    pub fn random(c: &mut Choices, most: u32) -> Shape {
        let n = 1 + c.below(most.clamp(1, BLOCKS)) as usize;
        // How far forward edges go, and how many more there are than a tree has: short ones make chains and nests, long
        // ones exits past many joins.
        let reach = c.pick(&[3, 6, n]);
        let extra = c.below(1 + n as u32);
        let mut succs: Vec<Vec<usize>> = vec![vec![]; n];
        for block in 1..n {
            let from = block - 1 - c.below(reach.min(block) as u32) as usize;
            succs[from].push(block);
        }
        for _ in 0..extra {
            let from = c.below(n as u32) as usize;
            let far = reach.min(n - 1 - from) as u32;
            if far > 0 {
                succs[from].push(from + 1 + c.below(far) as usize);
            }
        }
        let idom = dominators(&succs);
        let mut header = vec![false; n];
        for _ in 0..c.below(1 + n as u32) {
            let from = c.below(n as u32) as usize;
            let mut to = from;
            while to != 0 && idom[to] != 0 && c.below(2) == 0 {
                to = idom[to];
            }
            // The entry is a function: nobody goes back to it.
            if to != 0 {
                let at = c.below(succs[from].len() as u32 + 1) as usize;
                succs[from].insert(at, to);
                header[to] = true;
            }
        }
        let mut entered = vec![0; n];
        succs.iter().flatten().for_each(|to| entered[*to] += 1);
        Shape { succs, idom, entered, header }
    }
}

/// Immediate dominators, where all edges go forward: each is where the ways up from all predecessors meet.
fn dominators(succs: &[Vec<usize>]) -> Vec<usize> {
    let mut idom: Vec<Option<usize>> = vec![None; succs.len()];
    let known = |idom: &[Option<usize>], block: usize| idom[block].unwrap_or(0);
    for (from, succs) in succs.iter().enumerate() {
        for to in succs {
            let (mut a, mut b) = (idom[*to].unwrap_or(from), from);
            while a != b {
                if a > b { a = known(&idom, a) } else { b = known(&idom, b) }
            }
            idom[*to] = Some(a);
        }
    }
    (0..succs.len()).map(|block| known(&idom, block)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dominators_are_where_all_ways_meet() {
        // 0 → 1, 2; 1 → 3; 2 → 3, 4; 3 → 4.
        assert_eq!(dominators(&[vec![1, 2], vec![3], vec![3, 4], vec![4], vec![]]), [0, 0, 0, 0, 0]);
        assert_eq!(dominators(&[vec![1], vec![2, 3], vec![4], vec![4], vec![5], vec![]]), [0, 0, 1, 1, 1, 4]);
    }
}
