//! The tree between building and laying out: children before parents, the root last.

use super::{Bounds, MAX_LEAF};

/// A node's index in its tree.
#[derive(Clone, Copy, Debug)]
pub(in crate::host) struct NodeId(u32);

impl NodeId {
    /// Its place in what has an entry for each node.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// What a node stands for.
pub(in crate::host) enum Kind {
    /// Two children.
    Inner([NodeId; 2]),
    /// A range of `order`.
    Leaf(std::ops::Range<usize>),
}

struct Node {
    bounds: Bounds,
    kind: Kind,
}

/// A binary tree over boxes, which it numbers as the slice it was built from does.
#[derive(Default)]
pub(in crate::host) struct Tree {
    nodes: Vec<Node>,
    /// Box numbers, leaf by leaf.
    pub order: Vec<u32>,
    /// Boxes from this number on have a leaf each, and count as if they filled it.
    apart: Option<u32>,
}

impl Tree {
    /// Adds a leaf over `members`, numbers in `boxes`.
    pub fn leaf(&mut self, members: &[u32], boxes: &[Bounds]) -> NodeId {
        let first = self.order.len();
        self.order.extend_from_slice(members);
        let bounds = members.iter().fold(Bounds::EMPTY, |all, &i| all.union(&boxes[i as usize]));
        self.push(bounds, Kind::Leaf(first..self.order.len()))
    }

    /// Adds a node above two others.
    pub fn inner(&mut self, children: [NodeId; 2]) -> NodeId {
        let [a, b] = children.map(|child| self.bounds_of(child));
        self.push(a.union(&b), Kind::Inner(children))
    }

    fn push(&mut self, bounds: Bounds, kind: Kind) -> NodeId {
        self.nodes.push(Node { bounds, kind });
        NodeId(self.nodes.len() as u32 - 1)
    }

    /// All nodes, children before parents.
    pub fn nodes(&self) -> impl Iterator<Item = NodeId> {
        (0..self.nodes.len() as u32).map(NodeId)
    }

    /// The node that was added last.
    pub fn root(&self) -> NodeId {
        NodeId(self.nodes.len() as u32 - 1)
    }

    pub fn bounds_of(&self, node: NodeId) -> Bounds {
        self.nodes[node.0 as usize].bounds
    }

    pub fn kind_of(&self, node: NodeId) -> &Kind {
        &self.nodes[node.0 as usize].kind
    }

    /// The same tree, but that boxes from this number on have a leaf each.
    pub fn set_apart(&self, first: u32, boxes: &[Bounds]) -> Tree {
        let mut tree = Tree { apart: Some(first), ..Tree::default() };
        let mut new: Vec<NodeId> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            new.push(match &node.kind {
                Kind::Inner(children) => tree.inner(children.map(|child| new[child.0 as usize])),
                Kind::Leaf(range) => {
                    let (apart, together): (Vec<u32>, Vec<u32>) =
                        self.order[range.clone()].iter().partition(|member| **member >= first);
                    let rest = (apart.is_empty() || !together.is_empty()).then(|| tree.leaf(&together, boxes));
                    let each = apart.iter().map(|member| tree.leaf(&[*member], boxes));
                    let leaves: Vec<NodeId> = rest.into_iter().chain(each).collect();
                    leaves.into_iter().reduce(|a, b| tree.inner([a, b])).expect("there is a leaf")
                }
            });
        }
        tree
    }

    /// For each node, the number of boxes below it.
    pub fn counts(&self) -> Vec<usize> {
        let mut counts: Vec<usize> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            counts.push(match &node.kind {
                Kind::Leaf(range) => match self.apart {
                    Some(first) if self.order[range.start..].first().is_some_and(|one| *one >= first) => MAX_LEAF,
                    _ => range.len(),
                },
                Kind::Inner(children) => children.iter().map(|child| counts[child.0 as usize]).sum(),
            });
        }
        counts
    }

    /// Appends the numbers of all boxes below a node, which are few.
    pub fn members(&self, node: NodeId, out: &mut Vec<u32>) {
        match self.kind_of(node) {
            Kind::Leaf(range) => out.extend_from_slice(&self.order[range.clone()]),
            Kind::Inner(children) => children.iter().for_each(|child| self.members(*child, out)),
        }
    }

    /// Bounds of the whole.
    pub fn bounds(&self) -> Bounds {
        self.bounds_of(self.root())
    }
}
