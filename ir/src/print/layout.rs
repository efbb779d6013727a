//! Where the text puts things: which continuation stands under which, and which line computes which node. A function of
//! the program's structure alone, never of arena numbers, so that a program that was read from text prints as that text.
//!
//! A continuation stands under its *dominator*: the innermost continuation without which it cannot be mentioned. The
//! owners of its free parameters are among its dominators, so the text nests at least as deep as [`Scope`], and the rest
//! of an arm stands with the arm. A node stands in the innermost continuation around all its users.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::dom::DomTree;
use crate::program::*;
use crate::scope::Scope;
use crate::stats::Reach;

/// Nested deeper than this in a filter, a node gets a line of its own.
const FILTER_DEPTH: usize = 8;

/// The order of continuations and lines.
pub(super) struct Layout {
    /// What is printed.
    pub reach: Reach,
    /// Continuations without parent, in order.
    pub roots: Vec<ContId>,
    /// Continuations that stand under each, in order.
    pub children: Vec<Vec<ContId>>,
    /// Nodes that each continuation's lines compute, operands first.
    pub lines: Vec<Vec<NodeId>>,
    /// Nodes that several roots share.
    pub shared: Vec<NodeId>,
    /// Nodes of each continuation's filter that need a line.
    pub filter_lines: Vec<Vec<NodeId>>,
    /// Free parameters of each continuation in print order.
    pub free: Vec<Vec<NodeId>>,
    /// The root above each continuation.
    pub tree: Vec<Option<ContId>>,
    /// Where each line stands; none for shared ones.
    pub line_at: FxHashMap<NodeId, Option<ContId>>,
    nesting: Nesting,
}

impl Layout {
    /// Lay out a program.
    pub fn new(p: &Program) -> Layout {
        let scope = Scope::new(p);
        let reach = Reach::of(p);
        let n = p.conts.len();
        let mut layout = Layout {
            reach,
            roots: Vec::new(),
            children: vec![Vec::new(); n],
            lines: vec![Vec::new(); n],
            shared: Vec::new(),
            filter_lines: vec![Vec::new(); n],
            free: vec![Vec::new(); n],
            tree: vec![None; n],
            line_at: FxHashMap::default(),
            nesting: Nesting::default(),
        };
        layout.nesting = Nesting::new(p, &layout.reach, &scope);
        for c in &layout.reach.conts {
            layout.filter_lines[c.index()] = filter_lines(p, p.cont(*c).filter);
            match layout.nesting.parent(*c) {
                Some(parent) => layout.children[parent.index()].push(*c),
                None => layout.roots.push(*c),
            }
        }
        layout.order_free(p, &scope);
        layout.place_lines(p);
        layout
    }

    /// The continuations under `root`, itself first, each above what it contains.
    pub fn preorder(&self, root: ContId) -> Vec<ContId> {
        let (mut order, mut stack) = (Vec::new(), vec![root]);
        while let Some(c) = stack.pop() {
            order.push(c);
            stack.extend(self.children[c.index()].iter().rev());
        }
        order
    }

    /// Does the filter of `c` name this node rather than print it in place? It does when a line above `c` computes it, or
    /// when the filter alone needs a line.
    pub fn filter_names(&self, c: ContId, id: NodeId) -> bool {
        let Some(at) = self.line_at.get(&id) else { return false };
        let outside = self.nesting.parent(c);
        self.filter_lines[c.index()].contains(&id) || at.is_none() || self.nesting.common(*at, outside) == *at
    }

    fn order_free(&mut self, p: &Program, scope: &Scope) {
        let mut position = vec![0; p.conts.len()];
        let mut next = 0;
        for root in &self.roots {
            for c in self.preorder(*root) {
                self.tree[c.index()] = Some(*root);
                position[c.index()] = next;
                next += 1;
            }
        }
        for c in &self.reach.conts {
            let mut free = scope.free[c.index()].to_vec();
            free.sort_by_key(|x| match p.node(*x) {
                Node::Param { cont, index } => (position[cont.index()], *index),
                _ => unreachable!("free variables are parameters"),
            });
            self.free[c.index()] = free;
        }
    }

    /// Each node's line stands in the innermost continuation around all its users, in the order of first need.
    fn place_lines(&mut self, p: &Program) {
        let nesting = &self.nesting;
        let mut place: Vec<Option<Option<ContId>>> = vec![None; p.nodes.len()];
        let filters = self.filter_lines.clone();
        let needs = |c: ContId, f: &mut dyn FnMut(NodeId)| {
            filters[c.index()].iter().copied().for_each(&mut *f);
            p.cont(c).body.operands(f);
        };
        let meet = |place: &mut Vec<Option<Option<ContId>>>, x: NodeId, at: Option<ContId>| {
            let slot = &mut place[x.index()];
            *slot = Some(slot.map_or(at, |old| nesting.common(old, at)));
        };
        for c in &self.reach.conts {
            needs(*c, &mut |x| meet(&mut place, x, Some(*c)));
        }
        for id in (0..p.nodes.len() as u32).rev().map(NodeId) {
            if let Some(at) = place[id.index()] {
                p.operands(id, &mut |x| meet(&mut place, x, at));
            }
        }
        let mut done = vec![false; p.nodes.len()];
        for root in self.roots.clone() {
            for c in self.preorder(root) {
                let mut stack = Vec::new();
                needs(c, &mut |x| stack.push((x, false)));
                stack.reverse();
                while let Some((id, operands_done)) = stack.pop() {
                    if done[id.index()] || is_leaf(p, id) {
                        continue;
                    }
                    if operands_done {
                        done[id.index()] = true;
                        let at = place[id.index()].flatten();
                        at.map_or(&mut self.shared, |c| &mut self.lines[c.index()]).push(id);
                        self.line_at.insert(id, at);
                    } else {
                        stack.push((id, true));
                        let first = stack.len();
                        p.operands(id, &mut |x| stack.push((x, false)));
                        stack[first..].reverse();
                    }
                }
            }
        }
    }
}

/// Does the node print in place rather than by a line?
pub(super) fn is_leaf(p: &Program, id: NodeId) -> bool {
    matches!(p.node(id), Node::Lit(_) | Node::Param { .. } | Node::Cont(_))
}

/// Under which continuation each one stands: its immediate dominator among mentions. A virtual root is above all.
#[derive(Default)]
struct Nesting {
    tree: DomTree,
    /// Number of each continuation in the tree; 0, the virtual root, for what is not printed.
    block: Vec<u32>,
    /// The continuation of each number.
    cont: Vec<Option<ContId>>,
}

impl Nesting {
    fn new(p: &Program, reach: &Reach, scope: &Scope) -> Nesting {
        let mentions = mentions(p, reach);
        let is_top = |c: ContId| scope.parent[c.index()].is_none();
        // What no top leads to is out of scope: a stray.
        let tops = reach.conts.iter().copied().filter(|c| is_top(*c));
        let starts: Vec<ContId> = reach.conts.iter().copied().filter(|c| !is_top(*c)).chain(tops).collect();
        let order = reverse_postorder(p, &mentions, &starts);
        let cont: Vec<Option<ContId>> = [None].into_iter().chain(order.into_iter().map(Some)).collect();
        let mut block = vec![0; p.conts.len()];
        for (number, c) in cont.iter().enumerate() {
            c.iter().for_each(|c| block[c.index()] = number as u32);
        }
        let mut preds = vec![Vec::new(); cont.len()];
        for c in &reach.conts {
            for d in mentions[c.index()].iter().filter(|d| !is_top(**d)) {
                preds[block[d.index()] as usize].push(block[c.index()]);
            }
        }
        // A top stands under nothing, whoever mentions it; nor does what only strays mention.
        for (b, preds) in preds.iter_mut().enumerate().skip(1) {
            if preds.iter().all(|pred| *pred as usize >= b) {
                preds.push(0);
            }
        }
        Nesting { tree: DomTree::new(&preds), block, cont }
    }

    /// What the continuation stands under.
    fn parent(&self, c: ContId) -> Option<ContId> {
        self.tree.idom(self.block[c.index()]).and_then(|above| self.cont[above as usize])
    }

    /// The innermost continuation around both.
    fn common(&self, a: Option<ContId>, b: Option<ContId>) -> Option<ContId> {
        self.cont[self.tree.common(self.block[a?.index()], self.block[b?.index()]) as usize]
    }
}

/// The continuations that each one's filter and body mention, through pure nodes, in order.
fn mentions(p: &Program, reach: &Reach) -> Vec<Vec<ContId>> {
    let mut has_cont = vec![false; p.nodes.len()];
    for id in (0..p.nodes.len() as u32).map(NodeId) {
        let mut has = matches!(p.node(id), Node::Cont(_));
        p.operands(id, &mut |x| has |= has_cont[x.index()]);
        has_cont[id.index()] = has;
    }
    let mut mentions = vec![Vec::new(); p.conts.len()];
    for c in &reach.conts {
        let (mut stack, mut seen) = (vec![p.cont(*c).filter], FxHashSet::default());
        p.cont(*c).body.operands(&mut |x| stack.push(x));
        stack.reverse();
        while let Some(id) = stack.pop() {
            if !has_cont[id.index()] || !seen.insert(id) {
                continue;
            }
            if let Node::Cont(d) = p.node(id) {
                mentions[c.index()].push(*d);
            }
            let first = stack.len();
            p.operands(id, &mut |x| stack.push(x));
            stack[first..].reverse();
        }
    }
    mentions
}

fn reverse_postorder(p: &Program, mentions: &[Vec<ContId>], tops: &[ContId]) -> Vec<ContId> {
    let (mut order, mut seen) = (Vec::new(), vec![false; p.conts.len()]);
    let mut stack: Vec<(ContId, bool)> = tops.iter().map(|c| (*c, false)).collect();
    while let Some((c, done)) = stack.pop() {
        if done {
            order.push(c);
        } else if !std::mem::replace(&mut seen[c.index()], true) {
            stack.push((c, true));
            stack.extend(mentions[c.index()].iter().map(|d| (*d, false)));
        }
    }
    order.reverse();
    order
}

/// Nodes of a filter that need a line: those that it uses twice, or that lie deep. The others print as expressions.
fn filter_lines(p: &Program, filter: NodeId) -> Vec<NodeId> {
    let (mut seen, mut lines, mut stack) = (FxHashSet::default(), Vec::new(), vec![(filter, 0)]);
    while let Some((id, depth)) = stack.pop() {
        if is_leaf(p, id) {
            continue;
        }
        if !seen.insert(id) || depth >= FILTER_DEPTH {
            if !lines.contains(&id) {
                lines.push(id);
            }
            continue;
        }
        let first = stack.len();
        p.operands(id, &mut |x| stack.push((x, depth + 1)));
        stack[first..].reverse();
    }
    lines
}
