//! Law: of equal pieces of program, one is enough.
//!
//! Two continuations are equal if their bodies are, with the parameters of one for those of the other, and whatever they
//! lead to is the same or equal in the same sense. So the arms of a dispatch whose classes differ in nothing that matters
//! become one arm, and functions specialised twice to the same end become one.
//!
//! Candidates are found by hashes that are refined along the edges (Hopcroft's idea), then compared exactly.

use std::hash::{Hash, Hasher};

use jerboa_ir::dom::DomTree;
use jerboa_ir::*;
use rustc_hash::{FxHashMap, FxHashSet, FxHasher};

use super::draft::{Draft, Subst};

/// How far along the edges hashes look, at least and at most: between them, as far as [`HASHES`] lasts.
const ROUNDS: [usize; 2] = [8, 64];
/// Hashes that all rounds may make together, so that a chain of 10^5 nearly equal pieces stays cheap.
const HASHES: usize = 1 << 20;
/// With how many of equal hash a continuation is compared, for the same reason.
const CANDIDATES: usize = 4;
/// Nodes that all comparisons may look at together, for each node of the program.
const STEPS: usize = 4;

pub(crate) fn run(draft: &mut Draft) -> u64 {
    let order = draft.order();
    let hashes = refine(draft, &order);
    let mut groups: FxHashMap<u64, Vec<ContId>> = FxHashMap::default();
    let mut steps = STEPS * (draft.p().nodes.len() + draft.p().conts.len());
    let mut subst = Subst::default();
    let dom = Dominance::new(draft);
    for c in &order {
        let group = groups.entry(hashes[c.index()]).or_default();
        match group
            .iter()
            .rev()
            .take(CANDIDATES)
            .find(|first| steps > 0 && *c != draft.entry && Compare::new(draft, &dom, &mut steps).equal(*c, **first))
        {
            Some(first) => {
                let (from, to) = (draft.world.cont_value(*c), draft.world.cont_value(*first));
                subst.insert(from, to);
            }
            None => group.push(*c),
        }
    }
    draft.apply(&order, &subst);
    subst.len() as u64
}

fn hash_of(x: impl Hash) -> u64 {
    let mut hasher = FxHasher::default();
    x.hash(&mut hasher);
    hasher.finish()
}

/// Likewise of something and of the words after it.
fn hash_words(first: impl Hash, words: impl Iterator<Item = u64>) -> u64 {
    let mut hasher = FxHasher::default();
    first.hash(&mut hasher);
    words.for_each(|x| hasher.write_u64(x));
    hasher.finish()
}

/// A hash of each continuation that equal ones share.
fn refine(draft: &Draft, order: &[ContId]) -> Vec<u64> {
    let p = draft.p();
    let mut nodes: Vec<u64> = Vec::with_capacity(p.nodes.len());
    for node in &p.nodes {
        let get = |x: &NodeId| nodes[x.index()];
        nodes.push(match node {
            Node::Lit(lit) => hash_of(lit),
            Node::Param { index, .. } => hash_of(index),
            Node::Prim { op, args } => hash_words(op, args[..op.arity()].iter().map(get)),
            Node::Pack(lanes) => hash_words(lanes.len(), lanes.iter().map(get)),
            Node::Lane { vector, lane } => hash_of((get(vector), lane)),
            Node::Read { column, index } => hash_of((column, get(index))),
            _ => 0,
        });
    }
    let mut hashes = vec![0; p.conts.len()];
    for c in order {
        let mut hasher = FxHasher::default();
        (p.cont(*c).params.len(), kind(draft.body(*c))).hash(&mut hasher);
        draft.body(*c).operands(&mut |x| hasher.write_u64(nodes[x.index()]));
        hashes[c.index()] = hasher.finish();
    }
    // Once a round tells no more of them apart, none will (Moore, *Gedanken-experiments on sequential machines*, 1956).
    let mut told_apart = 0;
    for _ in 0..(HASHES / order.len().max(1)).clamp(ROUNDS[0], ROUNDS[1]) {
        let distinct = order.iter().map(|c| hashes[c.index()]).collect::<FxHashSet<u64>>().len();
        if distinct == told_apart {
            break;
        }
        told_apart = distinct;
        let mut next = hashes.clone();
        for c in order {
            let mut hasher = FxHasher::default();
            hasher.write_u64(hashes[c.index()]);
            draft.body(*c).operands(&mut |x| {
                if let Some(to) = draft.cont_of(x) {
                    hasher.write_u64(hashes[to.index()]);
                }
            });
            next[c.index()] = hasher.finish();
        }
        hashes = next;
    }
    hashes
}

/// What a body does, without its operands.
fn kind(body: &Body) -> u64 {
    let mem = |m: &Mem| match m {
        Mem::Stream(column) => hash_of((0, column)),
        Mem::Unchecked(column) => hash_of((1, column)),
        Mem::Local(_) => 2,
    };
    match body {
        Body::Switch { arms, .. } => hash_of((1, arms.iter().map(|(n, _)| *n).collect::<Vec<_>>())),
        Body::Load { mem: m, .. } => hash_of((2, mem(m))),
        Body::Store { mem: m, .. } => hash_of((3, mem(m))),
        Body::Vectorize { width, .. } => hash_of((5, width)),
        Body::Local { scalar, len, .. } => hash_of((4, scalar, len)),
        body => hash_of(std::mem::discriminant(body)),
    }
}

/// Which continuation is on every way from the entry to another, in its function.
struct Dominance {
    /// Place of each continuation in reverse postorder.
    number: Vec<u32>,
    tree: DomTree,
}

impl Dominance {
    fn new(draft: &Draft) -> Dominance {
        let mut number = vec![u32::MAX; draft.p().conts.len()];
        let mut postorder = Vec::new();
        let mut stack = vec![(draft.entry, false)];
        while let Some((c, done)) = stack.pop() {
            if done {
                postorder.push(c);
            } else if std::mem::replace(&mut number[c.index()], 0) == u32::MAX {
                stack.push((c, true));
                draft.body(c).operands(&mut |x| stack.extend(draft.cont_of(x).map(|to| (to, false))));
            }
        }
        postorder.reverse();
        for (i, c) in postorder.iter().enumerate() {
            number[c.index()] = i as u32;
        }
        let mut preds: Vec<Vec<u32>> = vec![Vec::new(); postorder.len()];
        for (i, c) in postorder.iter().enumerate() {
            draft.body(*c).operands(&mut |x| {
                if let Some(to) = draft.cont_of(x) {
                    let from = if draft.p().cont(to).role == Role::Fun { 0 } else { i as u32 };
                    preds[number[to.index()] as usize].push(from);
                }
            });
        }
        Dominance { number, tree: DomTree::new(&preds) }
    }

    fn dominates(&self, above: ContId, below: ContId) -> bool {
        self.tree.dominates(self.number[above.index()], self.number[below.index()])
    }
}

/// One exact comparison: assumes that pairs are equal until they are not.
struct Compare<'a> {
    draft: &'a Draft,
    dom: &'a Dominance,
    steps: &'a mut usize,
    pairs: FxHashMap<ContId, ContId>,
    nodes: FxHashSet<(NodeId, NodeId)>,
    /// Do both lead to one continuation?
    shared: bool,
}

impl<'a> Compare<'a> {
    fn new(draft: &'a Draft, dom: &'a Dominance, steps: &'a mut usize) -> Compare<'a> {
        let (pairs, nodes) = (FxHashMap::default(), FxHashSet::default());
        Compare { draft, dom, steps, pairs, nodes, shared: false }
    }

    fn equal(mut self, a: ContId, b: ContId) -> bool {
        let mut stack = vec![(a, b)];
        self.pairs.insert(a, b);
        while let Some((a, b)) = stack.pop() {
            if !self.bodies(a, b, &mut stack) {
                return false;
            }
        }
        // What both lead to must not depend on parameters of what goes. It cannot where a way to the other side, and so
        // to what is shared, avoids all that goes.
        let goes = |c: &ContId| self.pairs.contains_key(c);
        !self.shared || !(self.pairs.values().any(goes) || self.pairs.keys().any(|c| self.dom.dominates(*c, b)))
    }

    fn bodies(&mut self, a: ContId, b: ContId, stack: &mut Vec<(ContId, ContId)>) -> bool {
        let p = self.draft.p();
        let (ca, cb) = (p.cont(a), p.cont(b));
        let same_shape = ca.params.iter().map(|p| p.ty).eq(cb.params.iter().map(|p| p.ty))
            && (ca.role == Role::Fun) == (cb.role == Role::Fun)
            && kind(&ca.body) == kind(&cb.body);
        let (mut left, mut right) = (Vec::new(), Vec::new());
        ca.body.operands(&mut |x| left.push(x));
        cb.body.operands(&mut |x| right.push(x));
        same_shape && left.len() == right.len() && left.iter().zip(&right).all(|(x, y)| self.values(*x, *y, stack))
    }

    fn values(&mut self, x: NodeId, y: NodeId, stack: &mut Vec<(ContId, ContId)>) -> bool {
        let p = self.draft.p();
        let mut work = vec![(x, y)];
        while let Some((x, y)) = work.pop() {
            if !self.nodes.insert((x, y)) {
                continue;
            }
            if *self.steps == 0 || p.ty(x) != p.ty(y) {
                return false;
            }
            *self.steps -= 1;
            let fits = match (p.node(x), p.node(y)) {
                (Node::Param { cont: c, index: i }, Node::Param { cont: d, index: j }) => match self.pairs.get(c) {
                    Some(pair) => pair == d && i == j,
                    None => x == y,
                },
                (Node::Cont(c), Node::Cont(d)) if c == d => {
                    self.shared = true;
                    true
                }
                (Node::Cont(c), Node::Cont(d)) => self.pair(*c, *d, stack),
                (Node::Lit(a), Node::Lit(b)) => a == b,
                (Node::Prim { op, .. }, Node::Prim { op: other, .. }) => op == other,
                (Node::Lane { lane, .. }, Node::Lane { lane: other, .. }) => lane == other,
                (Node::Read { column, .. }, Node::Read { column: other, .. }) => column == other,
                (Node::Pack(_), Node::Pack(_)) => true,
                _ => false,
            };
            if !fits {
                return false;
            }
            let (mut left, mut right) = (Vec::new(), Vec::new());
            p.operands(x, &mut |n| left.push(n));
            p.operands(y, &mut |n| right.push(n));
            work.extend(left.into_iter().zip(right));
        }
        true
    }

    fn pair(&mut self, c: ContId, d: ContId, stack: &mut Vec<(ContId, ContId)>) -> bool {
        match self.pairs.get(&c) {
            Some(known) => *known == d,
            None => {
                self.pairs.insert(c, d);
                stack.push((c, d));
                true
            }
        }
    }
}
