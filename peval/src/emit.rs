//! Blocks of the residual.

use jerboa_ir::*;

use crate::machine::{Machine, Step};
use crate::value::{FrameId, Value};

/// A residual continuation, and its node.
pub(crate) type Block = (ContId, NodeId);

impl Machine<'_> {
    /// A new block that waits, for an arm called with `args`.
    pub(crate) fn arm(&mut self, arm: NodeId, f: FrameId, args: Vec<Value>) -> NodeId {
        let callee = self.eval(arm, f);
        let (block, node) = self.block(callee, Role::Arm, vec![], self.p.locs[arm.index()]);
        self.wait(block, self.function, Step::Call(callee, args, Mode::Filter));
        node
    }

    /// A new block with one parameter, for the continuation of a load or a local array.
    pub(crate) fn rest(&mut self, next: Value, ty: Ty, loc: Loc) -> (Block, Value) {
        let name = match next {
            Value::Closure(c, _) => self.p.cont(c).params[0].name.clone(),
            _ => None,
        };
        let stored = if let TyKind::Row(_) = ty.kind() { Ty::u32() } else { ty };
        let rest = self.block(next, Role::Rest, vec![Param { ty: stored, name, keep: false }], loc);
        let node = self.world.param(rest.0, 0);
        let value = match ty.kind() {
            TyKind::Local(..) => Value::Local(node),
            TyKind::Row(table) => self.row(*table, None, node),
            _ => Value::Data(node),
        };
        (rest, value)
    }

    /// A new residual continuation, named after what it calls; it is made in the current block.
    pub(crate) fn block(&mut self, like: Value, role: Role, params: Vec<Param>, loc: Loc) -> Block {
        let name = match like {
            Value::Closure(c, _) => {
                self.residuals[c.index()] += 1;
                if self.residuals[c.index()] == 2 {
                    self.several.push(c);
                }
                self.p.cont(c).name.clone()
            }
            _ => "return".into(),
        };
        let block = self.world.cont(name, role, params, loc);
        let stays = self.world.lit(Lit::Bool(false));
        self.world.cont_mut(block).filter = stays;
        self.made_in.push(self.at);
        (block, self.world.cont_value(block))
    }

    /// Close the current block.
    pub(crate) fn leave(&mut self, body: Body, loc: Loc) -> Step {
        self.world.set_body(self.at, body, loc);
        Step::Done
    }
}

/// The declaration of a buffer in the residual: there, a reference is a plain index.
pub(crate) fn residual_buffer(buffer: &Buffer) -> Buffer {
    let mut buffer = buffer.clone();
    for column in &mut buffer.columns {
        if let ColTy::Ref(_) = column.ty {
            column.ty = ColTy::Scalar(Scalar::U32);
        }
    }
    buffer
}
