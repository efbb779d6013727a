//! Which values outlive the piece of program that computes them.
//!
//! naga lets an expression be used from where it is evaluated to the end of the naga block around it. A value that is used
//! elsewhere, say behind the loop that computed it, goes through a local variable. Parameters of blocks that several
//! others go on in lie in variables anyway.
//!
//! Invocations that have left a loop wait for those that go on in it, and what is computed there is theirs alone. SPIR-V says
//! that each keeps what it had; Mesa's lavapipe (22.3) keeps what a loop carries from round to round, and computes all else
//! again for all of them, so that a load gives 0 to those that have left. So a value that leaves a loop, unless the loop
//! carries it, is *kept*: in an element of a local array, which drivers leave in memory.

use jerboa_ir::cfg::Function;
use jerboa_ir::schedule::Schedule;
use jerboa_ir::{Node, NodeId, Program};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::flow::Piece;

/// What is known of a function's values before they are emitted.
pub(crate) struct Uses {
    /// The blocks that compute a node; none of them dominates another.
    made: FxHashMap<NodeId, Vec<u32>>,
    /// Parameters that are used.
    params: FxHashSet<NodeId>,
    /// Nodes and parameters that leave a loop which does not carry them.
    kept: FxHashSet<NodeId>,
    /// Nodes, with the block that computes them, that are used out of its naga block.
    pub far: Vec<(NodeId, u32)>,
}

/// A naga block, by when the walk over all of them came to it and left it.
#[derive(Clone, Copy, Default)]
struct Scope {
    enter: u32,
    leave: u32,
    /// The innermost loop around it, its own included: place of the loop's body.
    body: Option<usize>,
}

impl Uses {
    pub fn new(p: &Program, f: &Function, schedule: &Schedule, pieces: &[Piece]) -> Uses {
        let mut scopes = Scopes { of_block: vec![0; f.blocks.len()], all: Vec::new(), clock: 0 };
        scopes.walk(pieces, None);
        let mut uses = Uses {
            made: FxHashMap::default(),
            params: FxHashSet::default(),
            kept: FxHashSet::default(),
            far: Vec::new(),
        };
        for (block, nodes) in schedule.blocks.iter().enumerate() {
            nodes.iter().for_each(|x| uses.made.entry(*x).or_default().push(block as u32));
        }
        let mut far = FxHashSet::default();
        for (block, nodes) in schedule.blocks.iter().enumerate() {
            let block = block as u32;
            let mut used = |x: NodeId| {
                if matches!(p.node(x), Node::Param { .. }) {
                    uses.params.insert(x);
                }
                let def = uses.def(p, f, x, block);
                if let Some(def) = def
                    && !scopes.sees(block, def)
                    && far.insert((x, def))
                {
                    uses.far.push((x, def));
                }
                let mut makers = def.as_slice().iter().chain(passed_by(p, f, x));
                if makers.any(|maker| scopes.leaves_a_loop(block, *maker)) {
                    uses.kept.insert(x);
                }
            };
            nodes.iter().for_each(|x| p.operands(*x, &mut used));
            p.cont(f.blocks[block as usize].cont).body.operands(&mut used);
        }
        uses
    }

    /// Is the parameter used?
    pub fn is_used(&self, param: NodeId) -> bool {
        self.params.contains(&param)
    }

    /// Must it lie where the rounds that others take in a loop do not touch it?
    pub fn is_kept(&self, x: NodeId) -> bool {
        self.kept.contains(&x)
    }

    /// The block that computes a node for one that uses it; none for what is the same everywhere, or lies in a variable.
    pub fn def(&self, p: &Program, f: &Function, x: NodeId, user: u32) -> Option<u32> {
        match p.node(x) {
            Node::Param { cont, .. } if p.ty(x).is_data() => match f.blocks[*f.number.get(cont)? as usize].preds[..] {
                [pred] => Some(pred),
                _ => None,
            },
            Node::Param { .. } => None,
            _ => self.made.get(&x)?.iter().copied().find(|def| f.dom.dominates(*def, user)),
        }
    }
}

impl Scope {
    /// Is a naga block this one, or within it?
    fn holds(self, other: Scope) -> bool {
        self.enter <= other.enter && other.enter < self.leave
    }
}

/// The blocks that pass a parameter on through its variable. None of what a loop carries.
fn passed_by<'f>(p: &Program, f: &'f Function, x: NodeId) -> &'f [u32] {
    let block = match p.node(x) {
        Node::Param { cont, .. } if p.ty(x).is_data() => f.number.get(cont).copied(),
        _ => None,
    };
    match block {
        Some(block) if f.blocks[block as usize].preds.len() > 1 && !f.loops.is_header(block) => {
            &f.blocks[block as usize].preds
        }
        _ => &[],
    }
}

/// The naga block of each block's code.
struct Scopes {
    /// Place in `all`.
    of_block: Vec<usize>,
    all: Vec<Scope>,
    clock: u32,
}

impl Scopes {
    /// The pieces of a naga block, whose innermost loop has its body at `body`.
    fn walk(&mut self, pieces: &[Piece], body: Option<usize>) {
        let here = self.all.len();
        self.all.push(Scope { enter: self.clock, leave: 0, body });
        self.clock += 1;
        for piece in pieces {
            match piece {
                Piece::Code(block) => self.of_block[*block as usize] = here,
                Piece::Choice { arms, .. } => arms.iter().for_each(|arm| self.walk(arm, body)),
                Piece::Label(label) => self.walk(label, body),
                Piece::Loop(pieces) => self.walk(pieces, Some(self.all.len())),
                Piece::Leave(_) | Piece::Far(_) | Piece::Reset | Piece::Arrive(..) => {}
            }
        }
        self.all[here].leave = self.clock;
    }

    /// Does the code of `user` see what the code of `def` computes?
    fn sees(&self, user: u32, def: u32) -> bool {
        self.scope(def).holds(self.scope(user))
    }

    /// Is the code of `def` in a loop that the code of `user` is not in?
    fn leaves_a_loop(&self, user: u32, def: u32) -> bool {
        self.scope(def).body.is_some_and(|body| !self.all[body].holds(self.scope(user)))
    }

    fn scope(&self, block: u32) -> Scope {
        self.all[self.of_block[block as usize]]
    }
}
