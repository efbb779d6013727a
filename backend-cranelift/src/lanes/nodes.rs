//! Walks over pure nodes, without recursion: chains of them may be long.

use jerboa_ir::{ContId, Node, NodeId, Program};
use rustc_hash::{FxHashMap, FxHashSet};

/// Calls `f` for `root` and all nodes below that are not done yet, operands first. `f` must make its node done.
pub(crate) fn operands_first<S>(
    p: &Program,
    root: NodeId,
    state: &mut S,
    is_done: impl Fn(&S, NodeId) -> bool,
    mut f: impl FnMut(&mut S, NodeId),
) {
    let mut pending = vec![root];
    while let Some(&next) = pending.last() {
        let before = pending.len();
        if !is_done(state, next) {
            p.operands(next, &mut |x| {
                if !is_done(state, x) {
                    pending.push(x);
                }
            });
        }
        if pending.len() == before {
            pending.pop();
            if !is_done(state, next) {
                f(state, next);
            }
        }
    }
}

/// The nodes of a program's parameters. One that is not used has none.
pub(crate) struct Params(FxHashMap<(ContId, u32), NodeId>);

impl Params {
    pub fn new(p: &Program) -> Params {
        let param = |(i, node): (usize, &Node)| match node {
            Node::Param { cont, index } => Some(((*cont, *index), NodeId(i as u32))),
            _ => None,
        };
        Params(p.nodes.iter().enumerate().filter_map(param).collect())
    }

    /// The node of a parameter.
    pub fn get(&self, cont: ContId, index: usize) -> Option<NodeId> {
        self.0.get(&(cont, index as u32)).copied()
    }

    /// The nodes of all parameters of a continuation, as far as they are used.
    pub fn of(&self, p: &Program, cont: ContId) -> impl Iterator<Item = NodeId> {
        (0..p.cont(cont).params.len()).filter_map(move |i| self.get(cont, i))
    }
}

/// The parameters that the jumps of these continuations use, through pure nodes.
pub(crate) fn used_params(p: &Program, conts: impl Iterator<Item = ContId>) -> Vec<NodeId> {
    let (mut seen, mut work, mut used) = (FxHashSet::default(), Vec::new(), Vec::new());
    conts.for_each(|cont| p.cont(cont).body.operands(&mut |x| work.push(x)));
    while let Some(x) = work.pop() {
        if !seen.insert(x) {
            continue;
        }
        if matches!(p.node(x), Node::Param { .. }) {
            used.push(x);
        }
        p.operands(x, &mut |y| work.push(y));
    }
    used
}
