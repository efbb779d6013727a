//! Where each pure node of a function is computed (Click, *Global Code Motion, Global Value Numbering*, PLDI 1995).
//!
//! A node may stand in any block between its *earliest* one, the deepest that defines an operand, and its *latest* one,
//! the common dominator of its uses. It is computed
//! 1. in the block of the fewest loops, and of these the latest, so a loop-invariant node leaves the loop (a loop is
//!    taken to run, even if its first test can end it);
//! 2. if it is a table read, a division, a remainder or a root, and some path from its latest block does not use it, in
//!    each of the arms that do, unless that moves it into a loop or needs more than [`COPIES`] copies.
//!
//! Literals, parameters and continuations have no place. Users are visited before operands, on dense tables over the
//! function's own nodes; finding a block costs O(log blocks + depth of loops), so a function of 10⁵ nodes in 10⁵ blocks
//! is scheduled in time nearly linear in its size.

use crate::cfg::Function;
use crate::op::Op;
use crate::program::*;

/// At most so many copies of one node in disjoint arms. Four arms that share a division want it four times; more would
/// be paid in code size.
pub const COPIES: usize = 8;

/// At most so many blocks are looked at to find a path that does not use a node; then there is taken to be one.
const SEARCH: usize = 64;

/// The nodes that each block of a function computes before it leaves, operands first. A node stands in one block, or in
/// several of which none dominates another.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Schedule {
    /// By the block's place in [`Function::blocks`].
    pub blocks: Vec<Vec<NodeId>>,
}

/// Schedules the functions of one program; keeps a table over the program's nodes between them.
pub struct Scheduler<'p> {
    program: &'p Program,
    /// Place of a node among those of the function at hand.
    slot: Vec<u32>,
}

/// No place.
const NONE: u32 = u32::MAX;

impl<'p> Scheduler<'p> {
    /// A scheduler for this program.
    pub fn new(program: &'p Program) -> Scheduler<'p> {
        Scheduler { program, slot: vec![NONE; program.nodes.len()] }
    }

    /// Schedule one function.
    ///
    /// # Panics
    /// When a node is used where it is not in scope; the verifier refuses such a program.
    pub fn function(&mut self, f: &Function) -> Schedule {
        let nodes = self.nodes(f);
        let early = self.early(f, &nodes);
        let mut uses = self.uses_by_bodies(f, nodes.len());
        let mut blocks = vec![Vec::new(); f.blocks.len()];
        for (i, node) in nodes.iter().enumerate().rev() {
            let mut used = std::mem::take(&mut uses[i]);
            used.sort_unstable_by_key(|b| f.dom.preorder_number(*b));
            used.dedup();
            for block in place(f, self.is_costly(*node), early[i], &used) {
                blocks[block as usize].push(*node);
                self.program.operands(*node, &mut |x| self.note(&mut uses, x, block));
            }
        }
        blocks.iter_mut().for_each(|b| b.reverse());
        nodes.iter().for_each(|n| self.slot[n.index()] = NONE);
        Schedule { blocks }
    }

    /// The nodes that the function computes, ascending, hence operands first. Fills in their slots.
    fn nodes(&mut self, f: &Function) -> Vec<NodeId> {
        let mut nodes = Vec::new();
        let mut work = Vec::new();
        for block in &f.blocks {
            self.program.cont(block.cont).body.operands(&mut |x| work.push(x));
            while let Some(x) = work.pop() {
                if self.slot[x.index()] == NONE && is_computed(self.program.node(x)) {
                    self.slot[x.index()] = 0;
                    nodes.push(x);
                    self.program.operands(x, &mut |y| work.push(y));
                }
            }
        }
        nodes.sort_unstable();
        nodes.iter().enumerate().for_each(|(i, n)| self.slot[n.index()] = i as u32);
        nodes
    }

    /// The deepest block that defines something the node depends on.
    fn early(&self, f: &Function, nodes: &[NodeId]) -> Vec<u32> {
        let mut early: Vec<u32> = Vec::with_capacity(nodes.len());
        for node in nodes {
            let mut at = 0;
            self.program.operands(*node, &mut |x| {
                let block = match self.program.node(x) {
                    Node::Param { cont, .. } => f.number[cont],
                    _ if self.slot[x.index()] != NONE => early[self.slot[x.index()] as usize],
                    _ => 0,
                };
                if f.dom.depth(block) > f.dom.depth(at) {
                    at = block;
                }
            });
            early.push(at);
        }
        early
    }

    /// The blocks whose bodies use each node.
    fn uses_by_bodies(&self, f: &Function, nodes: usize) -> Vec<Vec<u32>> {
        let mut uses = vec![Vec::new(); nodes];
        for (b, block) in f.blocks.iter().enumerate() {
            self.program.cont(block.cont).body.operands(&mut |x| self.note(&mut uses, x, b as u32));
        }
        uses
    }

    fn note(&self, uses: &mut [Vec<u32>], x: NodeId, block: u32) {
        if let Some(uses) = uses.get_mut(self.slot[x.index()] as usize)
            && uses.last() != Some(&block)
        {
            uses.push(block);
        }
    }

    fn is_costly(&self, node: NodeId) -> bool {
        match self.program.node(node) {
            Node::Read { .. } => true,
            Node::Prim { op, .. } => matches!(op, Op::Div | Op::Rem | Op::Sqrt),
            _ => false,
        }
    }
}

/// Is this a node that a block computes?
fn is_computed(node: &Node) -> bool {
    !matches!(node, Node::Lit(_) | Node::Param { .. } | Node::Cont(_))
}

/// The blocks that compute a node which may stand no higher than `early` and is used in `used` (by preorder number).
fn place(f: &Function, costly: bool, early: u32, used: &[u32]) -> Vec<u32> {
    let mut placed = Vec::new();
    let mut work = vec![(used, early)];
    while let Some((used, top)) = work.pop() {
        let late = common(f, used);
        let best = leave_loops(f, late, top);
        let stays = best != late || !costly || used[0] == late || used.len() > COPIES || every_path_uses(f, late, used);
        if stays {
            placed.push(best);
            continue;
        }
        let arm = |block: &u32| f.dom.child_towards(late, *block);
        let arms: Vec<(&[u32], u32)> =
            used.chunk_by(|a, b| arm(a) == arm(b)).map(|part| (part, arm(&part[0]))).collect();
        let deeper =
            |(part, top): &(&[u32], u32)| f.loops.depth(leave_loops(f, common(f, part), *top)) > f.loops.depth(late);
        if arms.iter().any(deeper) {
            placed.push(late);
        } else {
            work.extend(arms);
        }
    }
    placed
}

/// The common dominator of blocks in preorder: that of the first and the last.
fn common(f: &Function, used: &[u32]) -> u32 {
    f.dom.common(used[0], used[used.len() - 1])
}

/// The block of the fewest loops between `late` and its dominator `top`; of these the deepest. A block of fewer loops
/// lies above the header of a loop.
fn leave_loops(f: &Function, late: u32, top: u32) -> u32 {
    let (mut best, mut at) = (late, late);
    while let Some(header) = f.loops.header(at)
        && let Some(above) = f.dom.idom(header)
        && f.dom.dominates(top, above)
    {
        at = above;
        if f.loops.depth(at) < f.loops.depth(best) {
            best = at;
        }
    }
    best
}

/// Does every path from `from` meet one of the blocks `used`, which it dominates, before it returns or joins others?
fn every_path_uses(f: &Function, from: u32, used: &[u32]) -> bool {
    let mut seen = vec![from];
    let mut at = 0;
    while at < seen.len() {
        let succs = &f.blocks[seen[at] as usize].succs;
        if succs.is_empty() || seen.len() + succs.len() > SEARCH {
            return false;
        }
        for s in succs {
            let number = f.dom.preorder_number(*s);
            if seen.contains(s) || used.binary_search_by_key(&number, |u| f.dom.preorder_number(*u)).is_ok() {
                continue;
            }
            if !f.dom.dominates(from, *s) {
                return false;
            }
            seen.push(*s);
        }
        at += 1;
    }
    true
}

/// What is wrong with a schedule, in words: a check for tests. Every use must be dominated by exactly one definition.
pub fn check(p: &Program, f: &Function, s: &Schedule) -> Vec<String> {
    let mut faults = Vec::new();
    let mut at: rustc_hash::FxHashMap<NodeId, Vec<u32>> = rustc_hash::FxHashMap::default();
    for (b, nodes) in s.blocks.iter().enumerate() {
        nodes.iter().for_each(|n| at.entry(*n).or_default().push(b as u32));
    }
    let mut used_in = |x: NodeId, block: u32, user: &str| {
        let definitions = match p.node(x) {
            Node::Param { cont, .. } => std::slice::from_ref(&f.number[cont]),
            _ if is_computed(p.node(x)) => at.get(&x).map_or(&[][..], Vec::as_slice),
            _ => return,
        };
        let reaching = definitions.iter().filter(|d| f.dom.dominates(**d, block)).count();
        if reaching != 1 {
            faults.push(format!("{user} in block {block} has {reaching} definitions of {x:?} of {definitions:?}"));
        }
    };
    for (b, block) in f.blocks.iter().enumerate() {
        p.cont(block.cont).body.operands(&mut |x| used_in(x, b as u32, "the body"));
        for n in &s.blocks[b] {
            p.operands(*n, &mut |x| used_in(x, b as u32, &format!("{n:?}")));
        }
    }
    for nodes in &s.blocks {
        if !nodes.is_sorted() {
            faults.push("a block does not compute its nodes in order".to_owned());
        }
    }
    faults
}
