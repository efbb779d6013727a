//! Wide nodes of a tree of nodes of two, at the least cost that its shape allows.
//!
//! A node stands for several levels of the binary tree: its children are the subtrees below a cut. What a ray pays is
//! the sum of the surfaces of nodes and leaves, since a ray meets them in proportion (MacDonald & Booth 1990), and a visit
//! costs about the same for both. For each subtree, the least cost as a forest of at most one, two, … trees follows from those of its halves
//! (Wald, Benthin & Boulos 2008; Ylitie, Karras & Laine 2017, 3.1).

use super::tree::{Kind, NodeId, Tree};

/// How to cut a binary tree into nodes of up to `WIDTH` children and leaves of up to as many boxes.
pub(in crate::host) struct Cuts<'a, const WIDTH: usize> {
    tree: &'a Tree,
    of: Vec<Cut<WIDTH>>,
}

/// How to cut one subtree. There is one for each node of two, while memory is at its peak: 24 bytes for nodes of four children, 44
/// for those of eight.
#[derive(Clone, Copy)]
struct Cut<const WIDTH: usize> {
    /// The least cost of it as a forest of at most 1, 2, … trees, in surfaces of the whole: what single precision rounds of that
    /// decides between cuts that are as good.
    cost: [f32; WIDTH],
    /// Of so many trees, those that its first half becomes; 0: one tree fewer is as good.
    first: [u8; WIDTH],
    /// The same for the children of its own node.
    below: u8,
    /// As one tree: is it a leaf?
    is_leaf: bool,
    /// Are there no boxes in it?
    is_empty: bool,
}

impl<'a, const WIDTH: usize> Cuts<'a, WIDTH> {
    /// The best ones.
    pub fn new(tree: &'a Tree) -> Self {
        let counts = tree.counts();
        let mut of: Vec<Cut<WIDTH>> = Vec::with_capacity(counts.len());
        // Of a whole without a surface, so have its parts none.
        let whole = tree.bounds().half_area().max(f64::MIN_POSITIVE);
        for (node, count) in tree.nodes().zip(counts) {
            let area = (tree.bounds_of(node).half_area() / whole) as f32;
            let leaf = if count <= WIDTH { area } else { f32::INFINITY };
            of.push(match tree.kind_of(node) {
                Kind::Leaf(_) => Cut::leaf(leaf, count == 0),
                Kind::Inner(pair) => Cut::inner(area, leaf, pair.map(|half| &of[half.index()])),
            });
        }
        Cuts { tree, of }
    }

    /// Is the subtree one leaf? Asked of the root and of what [`Cuts::children`] gives.
    pub fn is_leaf(&self, node: NodeId) -> bool {
        self.of[node.index()].is_leaf
    }

    /// The children of the node over a subtree, those of larger surface first.
    pub fn children(&self, top: NodeId) -> Vec<NodeId> {
        let mut children = Vec::with_capacity(WIDTH);
        match self.tree.kind_of(top) {
            Kind::Inner(pair) if !self.is_leaf(top) => {
                let first = usize::from(self.of[top.index()].below);
                self.forest(pair[0], first, &mut children);
                self.forest(pair[1], WIDTH - first, &mut children);
            }
            _ => children.push(top),
        }
        let area = |child: &NodeId| self.tree.bounds_of(*child).half_area();
        children.retain(|child| !self.of[child.index()].is_empty);
        children.sort_by(|a, b| area(b).total_cmp(&area(a)));
        children
    }

    /// A subtree as the best forest of at most so many trees; the recursion is as deep as the tree, which is bounded.
    fn forest(&self, node: NodeId, most: usize, out: &mut Vec<NodeId>) {
        let cut = &self.of[node.index()];
        let halves =
            (1..most).rev().map(|other| (other + 1, usize::from(cut.first[other]))).find(|(_, first)| *first > 0);
        match (halves, self.tree.kind_of(node)) {
            (Some((trees, first)), Kind::Inner(pair)) => {
                self.forest(pair[0], first, out);
                self.forest(pair[1], trees - first, out);
            }
            _ => out.push(node),
        }
    }
}

impl<const WIDTH: usize> Cut<WIDTH> {
    fn leaf(cost: f32, is_empty: bool) -> Self {
        Cut { cost: [cost; WIDTH], first: [0; WIDTH], below: 0, is_leaf: true, is_empty }
    }

    fn inner(area: f32, leaf: f32, halves: [&Self; 2]) -> Self {
        let [a, b] = halves.map(|half| half.cost);
        // As so many trees, at least two: the least cost, and how many of them the first half becomes.
        let apart = |trees: usize| {
            let costs = (1..trees).map(|first| (a[first - 1] + b[trees - first - 1], first as u8));
            costs.min_by(|x, y| x.0.total_cmp(&y.0)).expect("two trees or more are in halves")
        };
        let (all, below) = apart(WIDTH);
        let node = area + all;
        let is_empty = halves.iter().all(|half| half.is_empty);
        let mut cut = Cut { cost: [leaf.min(node); WIDTH], first: [0; WIDTH], below, is_leaf: leaf <= node, is_empty };
        for trees in 2..=WIDTH {
            let (cost, first) = if trees == WIDTH { (all, below) } else { apart(trees) };
            cut.cost[trees - 1] = cut.cost[trees - 2];
            if cost < cut.cost[trees - 1] {
                (cut.cost[trees - 1], cut.first[trees - 1]) = (cost, first);
            }
        }
        cut
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::bvh::{Bounds, sah};
    use crate::host::random::Random;

    const WIDTH: usize = 4;

    /// All ways to cut a subtree into at most so many trees.
    fn forests(tree: &Tree, node: NodeId, most: usize) -> Vec<Vec<NodeId>> {
        let mut all = vec![vec![node]];
        if let Kind::Inner([a, b]) = tree.kind_of(node) {
            for trees in 1..most {
                for first in forests(tree, *a, trees) {
                    let rest = forests(tree, *b, most - first.len()).into_iter();
                    all.extend(rest.map(|rest| [first.clone(), rest].concat()));
                }
            }
        }
        all
    }

    /// The least sum of surfaces, by trying all.
    fn least(tree: &Tree, counts: &[usize], node: NodeId) -> f64 {
        let area = tree.bounds_of(node).half_area();
        let below = |forest: &Vec<NodeId>| forest.iter().map(|child| least(tree, counts, *child)).sum::<f64>();
        let inner =
            forests(tree, node, WIDTH).iter().filter(|forest| forest.len() > 1).map(below).fold(f64::MAX, f64::min);
        area + if counts[node.index()] <= WIDTH { 0.0 } else { inner }
    }

    /// The sum of surfaces of the nodes and leaves that are made, and the boxes in the leaves.
    fn made(cuts: &Cuts<WIDTH>, node: NodeId, members: &mut Vec<u32>) -> f64 {
        let area = cuts.tree.bounds_of(node).half_area();
        if cuts.is_leaf(node) {
            let before = members.len();
            cuts.tree.members(node, members);
            assert!(members.len() - before <= WIDTH);
            return area;
        }
        let children = cuts.children(node);
        assert!((2..=WIDTH).contains(&children.len()));
        area + children.into_iter().map(|child| made(cuts, child, members)).sum::<f64>()
    }

    #[test]
    fn no_other_cut_costs_less() {
        const SEED: u64 = 0xc011_a95e;
        println!("seed {SEED:#x}");
        let mut random = Random(SEED);
        for round in 0..200 {
            let boxes: Vec<Bounds> =
                (0..5 + round % 40).map(|_| Bounds::of(&[random.point(), random.point()])).collect();
            let tree = sah::build(&boxes);
            let cuts = Cuts::<WIDTH>::new(&tree);
            let mut members = Vec::new();
            let cost = made(&cuts, tree.root(), &mut members);
            members.sort_unstable();
            assert!(members.into_iter().eq(0..boxes.len() as u32), "round {round}");
            let least = least(&tree, &tree.counts(), tree.root());
            // Up to 64 costs, each rounded to single precision; where two cuts are that close, either will do.
            assert!((cost / least - 1.0).abs() < 4e-6, "round {round}: {cost} where {least} is possible");
        }
    }

    #[test]
    fn there_is_little_of_it_for_each_node() {
        assert_eq!([size_of::<Cut<4>>(), size_of::<Cut<8>>()], [24, 44]);
    }
}
