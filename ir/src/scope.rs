//! Scope by free variables (Leißa, Köster, Hack, CGO 2015): where a continuation and a node belong.
//!
//! A continuation's *free parameters* are those that its body and filter use, through pure nodes and through the
//! continuations they mention, less its own. The continuations that own them form a chain; the innermost is the *parent*.
//! So nesting is computed, never written down. A node belongs to the innermost continuation whose parameters it depends
//! on, its *owner*, and has a *slot* there: an index for a dense table per activation.
//!
//! Cost: one bottom-up pass over the nodes, then a fixpoint over the continuations, on interned sets.

use std::rc::Rc;

use rustc_hash::FxHashMap;

use crate::program::*;
use crate::stats::Reach;

/// Nesting of a program; tables are indexed by continuation or by node.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    /// The innermost continuation around each continuation; none at the top.
    pub parent: Vec<Option<ContId>>,
    /// Depth in the nesting tree: 0 at the top.
    pub level: Vec<u32>,
    /// The innermost continuation whose parameters a node depends on; none for constants.
    pub owner: Vec<Option<ContId>>,
    /// The node's number among those of its owner.
    pub slot: Vec<u32>,
    /// Number of nodes that each continuation owns.
    pub slots: Vec<u32>,
    /// Number of nodes without owner.
    pub constants: u32,
    /// Free parameters of each continuation, ascending.
    pub free: Vec<Box<[NodeId]>>,
    /// What is out of scope, in words: a value used where it is not made. If there are entries, only what they reach.
    pub faults: Vec<(ContId, String)>,
    /// Preorder numbers of the nesting tree: of a continuation, and one past the last inside it.
    span: Vec<(u32, u32)>,
}

impl Scope {
    /// Compute the nesting of a program.
    pub fn new(p: &Program) -> Scope {
        let mut sets = Sets::default();
        let uses = node_uses(p, &mut sets);
        let free = free_params(p, &uses, &mut sets);
        let mut scope = Scope { free: free.iter().map(|s| sets.params(*s)).collect(), ..Scope::default() };
        scope.nest(p);
        scope.own(p);
        scope.forgive_unused(p);
        scope
    }

    /// Only what an entry reaches has to nest: a function that is never called is mentioned nowhere, so what holds its
    /// free parameters together is missing.
    fn forgive_unused(&mut self, p: &Program) {
        if !p.entries.is_empty() && !self.faults.is_empty() {
            let reach = Reach::of(p);
            self.faults.retain(|(c, _)| reach.conts.contains(c));
        }
    }

    /// Is `outer` the continuation itself or around it?
    pub fn encloses(&self, outer: ContId, inner: ContId) -> bool {
        let (from, to) = self.span[outer.index()];
        (from..to).contains(&self.span[inner.index()].0)
    }

    /// Number the nesting tree in preorder.
    fn number(&mut self) {
        let n = self.parent.len();
        let mut by_level: Vec<usize> = (0..n).collect();
        by_level.sort_by_key(|c| self.level[*c]);
        let mut size = vec![1u32; n];
        for c in by_level.iter().rev() {
            if let Some(up) = self.parent[*c] {
                size[up.index()] += size[*c];
            }
        }
        // The next free number at the top, and inside each continuation.
        let (mut top, mut inside) = (0, vec![0; n]);
        self.span = vec![(0, 0); n];
        for c in by_level {
            let next = match self.parent[c] {
                Some(up) => &mut inside[up.index()],
                None => &mut top,
            };
            let from = *next;
            *next += size[c];
            inside[c] = from + 1;
            self.span[c] = (from, from + size[c]);
        }
    }

    /// The deeper of two owners.
    fn deeper(&self, a: Option<ContId>, b: Option<ContId>) -> Option<ContId> {
        match (a, b) {
            (Some(x), Some(y)) => Some(if self.level[x.index()] >= self.level[y.index()] { x } else { y }),
            (x, y) => x.or(y),
        }
    }

    /// Levels and parents: a continuation stands one below the deepest owner of its free parameters.
    fn nest(&mut self, p: &Program) {
        const UNKNOWN: u32 = u32::MAX;
        const OPEN: u32 = u32::MAX - 1;
        let n = p.conts.len();
        self.parent = vec![None; n];
        self.level = vec![UNKNOWN; n];
        let owner = |node: &NodeId| match p.node(*node) {
            Node::Param { cont, .. } => *cont,
            _ => unreachable!("free variables are parameters"),
        };
        for start in 0..n {
            let mut stack = vec![ContId(start as u32)];
            while let Some(&c) = stack.last() {
                if self.level[c.index()] < OPEN {
                    stack.pop();
                    continue;
                }
                let first_visit = self.level[c.index()] == UNKNOWN;
                self.level[c.index()] = OPEN;
                let waiting: Vec<ContId> =
                    self.free[c.index()].iter().map(owner).filter(|o| self.level[o.index()] >= OPEN).collect();
                if first_visit && !waiting.is_empty() {
                    stack.extend(waiting);
                    continue;
                }
                if let Some(cycle) = waiting.first() {
                    self.faults.push((c, format!("a value of `{}` is used outside of it", p.cont(*cycle).name)));
                }
                let around = self.free[c.index()].iter().map(owner).filter(|o| self.level[o.index()] < OPEN);
                self.parent[c.index()] = around.max_by_key(|o| self.level[o.index()]);
                self.level[c.index()] = self.parent[c.index()].map_or(0, |o| self.level[o.index()] + 1);
                stack.pop();
            }
        }
        self.number();
        for c in 0..n {
            let stray = self.free[c].iter().map(owner).find(|o| !self.encloses(*o, ContId(c as u32)));
            if let Some(o) = stray {
                self.faults.push((ContId(c as u32), format!("a value of `{}` is used outside of it", p.cont(o).name)));
            }
        }
    }

    /// Owners and slots of the nodes.
    fn own(&mut self, p: &Program) {
        self.slots = vec![0; p.conts.len()];
        for id in (0..p.nodes.len() as u32).map(NodeId) {
            let mut owner = match p.node(id) {
                Node::Param { cont, .. } => Some(*cont),
                Node::Cont(cont) => self.parent[cont.index()],
                _ => None,
            };
            p.operands(id, &mut |x| owner = self.deeper(owner, self.owner[x.index()]));
            let next = match owner {
                Some(c) => &mut self.slots[c.index()],
                None => &mut self.constants,
            };
            self.owner.push(owner);
            self.slot.push(*next);
            *next += 1;
        }
    }
}

/// Interned ascending sets of small numbers, with memoised union. An element is a parameter's node (even) or a mentioned
/// continuation (odd).
struct Sets {
    sets: Vec<Rc<[u32]>>,
    index: FxHashMap<Rc<[u32]>, u32>,
    unions: FxHashMap<(u32, u32), u32>,
    /// Scratch of [`Sets::union`].
    merged: Vec<u32>,
}

impl Default for Sets {
    fn default() -> Sets {
        let empty: Rc<[u32]> = [].into();
        let index = FxHashMap::from_iter([(empty.clone(), 0)]);
        Sets { sets: vec![empty], index, unions: FxHashMap::default(), merged: Vec::new() }
    }
}

impl Sets {
    const EMPTY: u32 = 0;

    fn intern(&mut self, elems: &[u32]) -> u32 {
        if let Some(known) = self.index.get(elems) {
            return *known;
        }
        let (id, elems) = (self.sets.len() as u32, Rc::<[u32]>::from(elems));
        self.sets.push(elems.clone());
        self.index.insert(elems, id);
        id
    }

    fn union(&mut self, a: u32, b: u32) -> u32 {
        if a == b || b == Self::EMPTY {
            return a;
        }
        if a == Self::EMPTY {
            return b;
        }
        let key = (a.min(b), a.max(b));
        if let Some(known) = self.unions.get(&key) {
            return *known;
        }
        let mut merged = std::mem::take(&mut self.merged);
        let (x, y) = (&self.sets[a as usize], &self.sets[b as usize]);
        merge(x, y, &mut merged);
        // Most often one is a part of the other.
        let id = match merged.len() {
            n if n == x.len() => a,
            n if n == y.len() => b,
            _ => self.intern(&merged),
        };
        self.merged = merged;
        self.unions.insert(key, id);
        id
    }

    fn params(&self, set: u32) -> Box<[NodeId]> {
        self.sets[set as usize].iter().filter(|e| *e % 2 == 0).map(|e| NodeId(e / 2)).collect()
    }
}

/// All elements of two ascending lists, each once.
fn merge(a: &[u32], b: &[u32], into: &mut Vec<u32>) {
    into.clear();
    into.reserve(a.len() + b.len());
    let (mut i, mut j) = (0, 0);
    while i < a.len() && j < b.len() {
        let (x, y) = (a[i], b[j]);
        into.push(x.min(y));
        i += usize::from(x <= y);
        j += usize::from(y <= x);
    }
    into.extend_from_slice(&a[i..]);
    into.extend_from_slice(&b[j..]);
}

/// Parameters and continuations that each node mentions, through pure nodes only.
fn node_uses(p: &Program, sets: &mut Sets) -> Vec<u32> {
    let mut uses: Vec<u32> = Vec::with_capacity(p.nodes.len());
    for id in (0..p.nodes.len() as u32).map(NodeId) {
        let mut set = match p.node(id) {
            Node::Param { .. } => sets.intern(&[id.0 * 2]),
            Node::Cont(cont) => sets.intern(&[cont.0 * 2 + 1]),
            _ => Sets::EMPTY,
        };
        p.operands(id, &mut |x| set = sets.union(set, uses[x.index()]));
        uses.push(set);
    }
    uses
}

/// Least solution of free(c) = (parameters used ∪ free(d) for each continuation d mentioned) − own parameters.
fn free_params(p: &Program, uses: &[u32], sets: &mut Sets) -> Vec<u32> {
    let mut direct = Vec::with_capacity(p.conts.len());
    for c in &p.conts {
        let mut set = uses[c.filter.index()];
        c.body.operands(&mut |x| set = sets.union(set, uses[x.index()]));
        direct.push(set);
    }
    let owned_by = |c: usize, e: u32| {
        e.is_multiple_of(2) && matches!(p.node(NodeId(e / 2)), Node::Param { cont, .. } if cont.index() == c)
    };
    let mut mentioned: Vec<Vec<usize>> = Vec::with_capacity(p.conts.len());
    let mut users: Vec<Vec<usize>> = vec![Vec::new(); p.conts.len()];
    let mut free = Vec::with_capacity(p.conts.len());
    for (c, set) in direct.iter().enumerate() {
        let elems = sets.sets[*set as usize].clone();
        mentioned.push(elems.iter().filter(|e| *e % 2 == 1).map(|e| (e / 2) as usize).collect());
        for d in mentioned.last().expect("just pushed") {
            users[*d].push(c);
        }
        let own: Vec<u32> = elems.iter().copied().filter(|e| e % 2 == 0 && !owned_by(c, *e)).collect();
        free.push(sets.intern(&own));
    }
    // Inner continuations are usually made after outer ones, so the stack starts with the innermost.
    let mut work: Vec<usize> = (0..p.conts.len()).collect();
    let mut queued = vec![true; p.conts.len()];
    while let Some(c) = work.pop() {
        queued[c] = false;
        let set = mentioned[c].iter().fold(free[c], |set, d| sets.union(set, free[*d]));
        if set == free[c] {
            continue;
        }
        let elems: Vec<u32> = sets.sets[set as usize].iter().copied().filter(|e| !owned_by(c, *e)).collect();
        let set = sets.intern(&elems);
        if set != free[c] {
            free[c] = set;
            for u in &users[c] {
                if !std::mem::replace(&mut queued[*u], true) {
                    work.push(*u);
                }
            }
        }
    }
    free
}
