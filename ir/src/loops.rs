//! The loops of a function: the header, nesting and depth of each block.
//!
//! A loop is a back edge's target, the *header*, which dominates the source, and all blocks that reach that source
//! without the header. Loops are found innermost first; a finished loop counts as one block (Tarjan, *Testing Flow Graph
//! Reducibility*, 1974), so that the work is nearly linear.

use crate::dom::DomTree;

/// Loops of blocks numbered in reverse postorder.
#[derive(Clone, Debug, Default)]
pub struct Loops {
    /// Is the block a header?
    is_header: Vec<bool>,
    /// The header of the innermost loop around a block; around a header, the one of the next loop out.
    around: Vec<Option<u32>>,
    /// Number of loops around a block, its own included for a header.
    depth: Vec<u32>,
    /// An edge that goes back without going to a dominator: the graph is not reducible.
    irreducible: Option<(u32, u32)>,
}

impl Loops {
    /// The loops of the blocks with these predecessors and dominators.
    pub fn new(preds: &[Vec<u32>], dom: &DomTree) -> Loops {
        let n = preds.len();
        let mut loops = Loops { is_header: vec![false; n], around: vec![None; n], ..Loops::default() };
        let mut merged = Merged((0..n as u32).collect());
        for header in (0..n as u32).rev() {
            loops.collect(header, preds, dom, &mut merged);
        }
        for b in 0..n {
            let outer = loops.around[b].map_or(0, |h| loops.depth[h as usize]);
            loops.depth.push(outer + loops.is_header[b] as u32);
        }
        loops
    }

    /// The header of the innermost loop that a block belongs to: itself for a header.
    pub fn header(&self, block: u32) -> Option<u32> {
        if self.is_header[block as usize] { Some(block) } else { self.around[block as usize] }
    }

    /// The header of the loop around the loop of this header.
    pub fn outer(&self, header: u32) -> Option<u32> {
        self.around[header as usize]
    }

    /// Is a block the header of a loop?
    pub fn is_header(&self, block: u32) -> bool {
        self.is_header[block as usize]
    }

    /// Number of loops that a block belongs to.
    pub fn depth(&self, block: u32) -> u32 {
        self.depth[block as usize]
    }

    /// An edge (from, to) into the middle of a loop, if there is one: then the graph is not reducible.
    pub fn irreducible(&self) -> Option<(u32, u32)> {
        self.irreducible
    }

    /// The blocks of the loop of one header that are in no loop yet.
    fn collect(&mut self, header: u32, preds: &[Vec<u32>], dom: &DomTree, merged: &mut Merged) {
        let mut work = Vec::new();
        for &p in preds[header as usize].iter().filter(|p| **p >= header) {
            if dom.dominates(header, p) {
                self.is_header[header as usize] = true;
                work.push(merged.find(p));
            } else {
                self.irreducible = Some((p, header));
            }
        }
        while let Some(block) = work.pop() {
            if block == header || self.around[block as usize].is_some() {
                continue;
            }
            self.around[block as usize] = Some(header);
            merged.0[block as usize] = header;
            for &p in &preds[block as usize] {
                let p = merged.find(p);
                if p != header && dom.dominates(header, p) {
                    work.push(p);
                }
            }
        }
    }
}

/// Union-find: a block of a finished loop stands for its header.
struct Merged(Vec<u32>);

impl Merged {
    fn find(&mut self, mut block: u32) -> u32 {
        while self.0[block as usize] != block {
            let up = self.0[block as usize];
            self.0[block as usize] = self.0[up as usize];
            block = up;
        }
        block
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn loops(succs: &[&[u32]]) -> Loops {
        let mut preds = vec![Vec::new(); succs.len()];
        for (b, list) in succs.iter().enumerate() {
            list.iter().for_each(|s| preds[*s as usize].push(b as u32));
        }
        Loops::new(&preds, &DomTree::new(&preds))
    }

    #[test]
    fn nested_loops_have_depths() {
        // 0 → 1 (outer) → 2 (inner) → 3 → 2 | 4 → 1 | 5
        let l = loops(&[&[1], &[2], &[3], &[2, 4], &[1, 5], &[]]);
        assert_eq!((0..6).map(|b| l.depth(b)).collect::<Vec<_>>(), [0, 1, 2, 2, 1, 0]);
        assert_eq!(
            (l.header(3), l.header(2), l.outer(2), l.header(4), l.header(5)),
            (Some(2), Some(2), Some(1), Some(1), None)
        );
        assert_eq!(l.irreducible(), None);
    }

    #[test]
    fn two_entries_are_reported() {
        let l = loops(&[&[1, 2], &[2, 3], &[1], &[]]);
        assert!(l.irreducible().is_some());
    }
}
