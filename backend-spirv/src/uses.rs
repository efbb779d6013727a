//! Which values outlive the piece of program that computes them.
//!
//! naga lets an expression be used from where it is evaluated to the end of the naga block around it. A value that is used
//! elsewhere, say behind the loop that computed it, goes through a local variable. Parameters of blocks that several
//! others go on in lie in variables anyway.

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
    /// Nodes, with the block that computes them, that are used out of its naga block.
    pub far: Vec<(NodeId, u32)>,
}

/// A naga block, by when the walk over all of them came to it and left it.
#[derive(Clone, Copy, Default)]
struct Scope {
    enter: u32,
    leave: u32,
}

impl Uses {
    pub fn new(p: &Program, f: &Function, schedule: &Schedule, pieces: &[Piece]) -> Uses {
        let mut scopes = Scopes { of_block: vec![0; f.blocks.len()], all: Vec::new(), clock: 0 };
        scopes.walk(pieces);
        let mut uses = Uses { made: FxHashMap::default(), params: FxHashSet::default(), far: Vec::new() };
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
                if let Some(def) = uses.def(p, f, x, block)
                    && !scopes.sees(block, def)
                    && far.insert((x, def))
                {
                    uses.far.push((x, def));
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

/// The naga block of each block's code.
struct Scopes {
    /// Place in `all`.
    of_block: Vec<usize>,
    all: Vec<Scope>,
    clock: u32,
}

impl Scopes {
    fn walk(&mut self, pieces: &[Piece]) {
        let here = self.all.len();
        self.all.push(Scope { enter: self.clock, leave: 0 });
        self.clock += 1;
        for piece in pieces {
            match piece {
                Piece::Code(block) => self.of_block[*block as usize] = here,
                Piece::Choice { arms, .. } => arms.iter().for_each(|arm| self.walk(arm)),
                Piece::Label(body) | Piece::Loop(body) => self.walk(body),
                Piece::Leave(_) | Piece::Far(_) | Piece::Reset | Piece::Arrive(..) => {}
            }
        }
        self.all[here].leave = self.clock;
    }

    /// Does the code of `user` see what the code of `def` computes?
    fn sees(&self, user: u32, def: u32) -> bool {
        let scope = |block: u32| self.all[self.of_block[block as usize]];
        let (def, user) = (scope(def), scope(user));
        def.enter <= user.enter && user.enter < def.leave
    }
}
