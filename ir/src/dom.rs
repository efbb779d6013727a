//! The dominator tree of a function's blocks: which block lies on every path to which.
//!
//! Built with the algorithm of Cooper, Harvey and Kennedy (*A Simple, Fast Dominance Algorithm*, 2001), which takes one
//! pass on reducible graphs. Ancestors are found by jump pointers (Myers, *An Applicative Random-Access Stack*, 1983) in
//! O(log depth), because residuals have chains of 10⁵ blocks and one walk of the chain per node would be quadratic.

/// A dominator tree over blocks numbered in reverse postorder; block 0 is the root.
#[derive(Clone, Debug, Default)]
pub struct DomTree {
    /// Immediate dominator of each block; the root's is itself.
    idom: Vec<u32>,
    /// Distance from the root.
    depth: Vec<u32>,
    /// An ancestor further up: equal depths have jumps of equal length.
    jump: Vec<u32>,
    /// Number of each block in a preorder of the tree, children in reverse postorder.
    enter: Vec<u32>,
    /// One past the largest preorder number below each block.
    leave: Vec<u32>,
    /// The blocks in that preorder.
    order: Vec<u32>,
}

impl DomTree {
    /// The tree of blocks with these predecessors. Blocks are in reverse postorder and all reachable from block 0.
    pub fn new(preds: &[Vec<u32>]) -> DomTree {
        let idom = immediate_dominators(preds);
        let mut tree = DomTree { idom, ..DomTree::default() };
        tree.measure();
        tree.number();
        tree
    }

    /// The immediate dominator; none for the root.
    pub fn idom(&self, block: u32) -> Option<u32> {
        (block != 0).then(|| self.idom[block as usize])
    }

    /// Distance from the root.
    pub fn depth(&self, block: u32) -> u32 {
        self.depth[block as usize]
    }

    /// Is `above` on every path from the root to `below`? Every block dominates itself.
    pub fn dominates(&self, above: u32, below: u32) -> bool {
        let at = self.enter[below as usize];
        self.enter[above as usize] <= at && at < self.leave[above as usize]
    }

    /// The deepest block that dominates both, in O(log depth).
    pub fn common(&self, a: u32, b: u32) -> u32 {
        let mut at = a;
        while !self.dominates(at, b) {
            let far = self.jump[at as usize];
            at = if self.dominates(far, b) { self.idom[at as usize] } else { far };
        }
        at
    }

    /// The child of `above` whose subtree holds `below`, which `above` dominates strictly; in O(log depth).
    pub fn child_towards(&self, above: u32, below: u32) -> u32 {
        let wanted = self.depth(above) + 1;
        let mut at = below;
        while self.depth(at) > wanted {
            let far = self.jump[at as usize];
            at = if self.depth(far) < wanted { self.idom[at as usize] } else { far };
        }
        at
    }

    /// The blocks, each after its dominators and followed by all that it dominates.
    pub fn preorder(&self) -> &[u32] {
        &self.order
    }

    /// Number of a block in [`Self::preorder`].
    pub fn preorder_number(&self, block: u32) -> u32 {
        self.enter[block as usize]
    }

    /// Depths and jump pointers.
    fn measure(&mut self) {
        let n = self.idom.len();
        self.depth = vec![0; n];
        self.jump = vec![0; n];
        for b in 1..n {
            let up = self.idom[b] as usize;
            self.depth[b] = self.depth[up] + 1;
            let (near, far) = (self.jump[up] as usize, self.jump[self.jump[up] as usize] as usize);
            let equal = self.depth[up] - self.depth[near] == self.depth[near] - self.depth[far];
            self.jump[b] = if equal { far as u32 } else { up as u32 };
        }
    }

    /// Preorder numbers, from the sizes of the subtrees.
    fn number(&mut self) {
        let n = self.idom.len();
        let mut size = vec![1u32; n];
        for b in (1..n).rev() {
            size[self.idom[b] as usize] += size[b];
        }
        let mut next: Vec<u32> = vec![1; n];
        self.enter = vec![0; n];
        self.order = vec![0; n];
        for b in 1..n {
            let up = self.idom[b] as usize;
            self.enter[b] = next[up];
            next[up] += size[b];
            next[b] = self.enter[b] + 1;
            self.order[self.enter[b] as usize] = b as u32;
        }
        self.leave = (0..n).map(|b| self.enter[b] + size[b]).collect();
    }
}

/// Cooper, Harvey and Kennedy, figure 3.
fn immediate_dominators(preds: &[Vec<u32>]) -> Vec<u32> {
    const NONE: u32 = u32::MAX;
    let mut idom = vec![NONE; preds.len()];
    idom[0] = 0;
    let mut changed = true;
    while changed {
        changed = false;
        for b in 1..preds.len() {
            let known = preds[b].iter().copied().filter(|p| idom[*p as usize] != NONE);
            let new = known.reduce(|a, b| meet(&idom, a, b)).expect("reverse postorder: a predecessor came before");
            changed |= std::mem::replace(&mut idom[b], new) != new;
        }
    }
    idom
}

/// The first common ancestor; ancestors have smaller numbers.
fn meet(idom: &[u32], mut a: u32, mut b: u32) -> u32 {
    while a != b {
        while a > b {
            a = idom[a as usize];
        }
        while b > a {
            b = idom[b as usize];
        }
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Predecessors, edges given as successors.
    fn preds(succs: &[&[u32]]) -> Vec<Vec<u32>> {
        let mut preds = vec![Vec::new(); succs.len()];
        for (b, list) in succs.iter().enumerate() {
            list.iter().for_each(|s| preds[*s as usize].push(b as u32));
        }
        preds
    }

    #[test]
    fn a_diamond_joins_at_its_top() {
        let tree = DomTree::new(&preds(&[&[1, 2], &[3], &[3], &[]]));
        assert_eq!((tree.idom(3), tree.idom(0)), (Some(0), None));
        assert_eq!((tree.common(1, 2), tree.common(1, 3), tree.common(3, 3)), (0, 0, 3));
        assert!(tree.dominates(0, 3) && !tree.dominates(1, 3) && tree.dominates(2, 2));
    }

    #[test]
    fn agrees_with_removing_a_block() {
        // Block a dominates b iff b cannot be reached once a is removed.
        let mut seed = 0x2545_f491_4f6c_dd1d_u64;
        let mut random = |n: u32| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((seed >> 33) as u32) % n
        };
        for n in 2..40u32 {
            // A tree of forward edges keeps all reachable; the rest go back to any smaller block or forward.
            let mut succs: Vec<Vec<u32>> = vec![Vec::new(); n as usize];
            for b in 1..n {
                succs[random(b) as usize].push(b);
                succs[b as usize].push(random(b) + 1);
            }
            let lists: Vec<&[u32]> = succs.iter().map(Vec::as_slice).collect();
            let preds = preds(&lists);
            let tree = DomTree::new(&preds);
            for a in 0..n {
                let mut seen = vec![false; n as usize];
                let mut stack = vec![0];
                while let Some(b) = stack.pop() {
                    if b != a && !std::mem::replace(&mut seen[b as usize], true) {
                        stack.extend(&succs[b as usize]);
                    }
                }
                for b in 0..n {
                    assert_eq!(tree.dominates(a, b), a == b || !seen[b as usize], "{succs:?}: {a} over {b}");
                    let c = tree.common(a, b);
                    assert!(tree.dominates(c, a) && tree.dominates(c, b));
                    assert!((0..n).all(|d| !tree.dominates(d, a) || !tree.dominates(d, b) || tree.dominates(d, c)));
                    if a != b && tree.dominates(a, b) {
                        let child = tree.child_towards(a, b);
                        assert!(tree.idom(child) == Some(a) && tree.dominates(child, b));
                    }
                }
            }
        }
    }

    #[test]
    fn a_long_chain_is_no_problem() {
        let n = 100_000u32;
        let preds: Vec<Vec<u32>> = (0..n).map(|b| if b == 0 { vec![] } else { vec![b - 1] }).collect();
        let tree = DomTree::new(&preds);
        assert_eq!(tree.depth(n - 1), n - 1);
        assert!((0..n).all(|b| tree.common(n - 1, b) == b && (b + 1 == n || tree.child_towards(b, n - 1) == b + 1)));
    }
}
