//! Loops whose iterations are independent: the body stays as a function, whatever its filter says.

use jerboa_ir::*;

use crate::error::Error;
use crate::lift::return_ty;
use crate::log::{Decision, Reason};
use crate::machine::{Machine, Step};
use crate::value::Value;

impl Machine<'_> {
    /// Leave a `vectorize` over the body's residual function, to which it passes what the body captures; nothing where the
    /// bounds are known to hold nothing.
    pub(crate) fn vectorize(
        &mut self,
        width: u8,
        (lo, hi): (NodeId, NodeId),
        body: Value,
        mut args: Vec<Value>,
        next: Value,
        loc: Loc,
    ) -> Result<Step, Error> {
        let (c, parent) = match body {
            Value::Closure(c, parent) => (c, parent),
            other => unreachable!("the verifier lets only a body of independent iterations through, not {other:?}"),
        };
        // Any `u32` stands for the index: what is not kept becomes a parameter.
        args.push(Value::Data(lo));
        let bound = |x: NodeId| self.lit(x).and_then(Lit::as_u32);
        if let (Some(lo), Some(hi)) = (bound(lo), bound(hi))
            && lo >= hi
        {
            self.log(c, Reason::Vectorize, Decision::Dropped, &args);
            return Ok(Step::Call(next, vec![], Mode::Filter));
        }
        let ret = self.p.cont(c).params.last().and_then(|last| return_ty(last.ty)).expect("a body has a return");
        let Some((body, mut args)) = self.function(c, parent, &args, ret, Reason::Vectorize)? else {
            return Err(Error::NotIndependent { body: self.place(c), chain: self.chain() });
        };
        args.pop();
        let rest = self.block(next, Role::Rest, vec![], loc);
        self.leave(Body::Vectorize { width, lo, hi, body, args, next: rest.1 }, loc);
        self.at = rest.0;
        Ok(Step::Call(next, vec![], Mode::Filter))
    }
}
