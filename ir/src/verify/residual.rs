//! The form of residual programs: first-order, so that a back end needs no closures.
//!
//! A *function* is a continuation of role `fun`; its last parameter is its return. All others are *blocks* of the
//! function around them.
//!
//! | rule | what must hold |
//! |---|---|
//! | `residual-buffer` | columns hold scalars: a reference has become an index |
//! | `residual-filter` | every filter is `false`: nothing is left to unfold |
//! | `residual-node` | no tuples, rows or `known`, and no continuation in a node |
//! | `residual-function` | a function uses no value of another; its return takes data; its other parameters are data |
//! | `residual-block` | a block's parameters are data, or the one array that a `local` jump makes |
//! | `residual-jump` | the callee is a block, a function or the return; arguments are data, and a call's last one is a block or the return |
//! | `residual-arm` | arms and `next` are blocks; no dispatch |
//! | `residual-vectorize` | the body is a function; its arguments are data |
//! | `independent` | the iterations of a `vectorize` do not meet: see `independent.rs` |

use super::{Verifier, verify};
use crate::error::Fault;
use crate::lit::Lit;
use crate::program::*;
use crate::scope::Scope;
use crate::stats::Reach;
use crate::ty::{Ty, TyKind};

/// All faults of a residual program: those of [`verify`], or where there are none those of the first-order form.
pub fn verify_residual(p: &Program) -> Vec<Fault> {
    let faults = verify(p);
    if !faults.is_empty() {
        return faults;
    }
    let mut v = Verifier { p, reach: Reach::of(p), faults };
    v.residual_buffers();
    v.residual_nodes();
    let scope = Scope::new(p);
    for c in v.reach.conts.clone() {
        v.residual_filter(c);
        v.residual_params(c, &scope);
        v.residual_body(c);
    }
    v.faults.dedup();
    v.faults
}

impl Verifier<'_> {
    fn residual_buffers(&mut self) {
        for b in &self.p.buffers {
            for c in b.columns.iter().filter(|c| matches!(c.ty, ColTy::Ref(_))) {
                self.fault("residual-buffer", format!("`{}.{}` is a reference, not an index", b.name, c.name));
            }
        }
    }

    fn residual_nodes(&mut self) {
        let p = self.p;
        for id in self.reach.nodes.clone() {
            let mut conts = 0;
            p.operands(id, &mut |x| conts += matches!(p.node(x), Node::Cont(_)) as usize);
            let staged = matches!(
                p.node(id),
                Node::Tuple(_)
                    | Node::Extract { .. }
                    | Node::Row { .. }
                    | Node::Sibling { .. }
                    | Node::RowIndex(_)
                    | Node::Known(_)
            );
            if staged || conts > 0 {
                self.fault_of("residual-node", id, "left in a first-order program".to_owned());
            }
        }
    }

    fn residual_filter(&mut self, c: ContId) {
        if self.p.as_lit(self.p.cont(c).filter) != Some(Lit::Bool(false)) {
            self.fault_at("residual-filter", c, "the filter is not `false`".to_owned());
        }
    }

    fn residual_params(&mut self, c: ContId, scope: &Scope) {
        let cont = self.p.cont(c);
        let types: Vec<Ty> = cont.params.iter().map(|x| x.ty).collect();
        if cont.role != Role::Fun {
            let array = matches!(types[..], [ty] if matches!(ty.kind(), TyKind::Local(..)));
            if let Some(ty) = types.iter().find(|ty| !ty.is_data() && !array) {
                self.fault_at("residual-block", c, format!("a block takes {ty}; only data pass between blocks"));
            }
            return;
        }
        match types.split_last().and_then(|(last, data)| Some((last.params()?, data))) {
            None => self.fault_at("residual-function", c, "its last parameter is no return".to_owned()),
            Some((results, data)) => {
                if let Some(ty) = data.iter().chain(results).find(|ty| !ty.is_data()) {
                    self.fault_at("residual-function", c, format!("takes or returns {ty}, which is no data"));
                }
            }
        }
        if let Some(x) = scope.free[c.index()].first() {
            let what = format!("uses {}, which belongs to another function", self.describe(*x));
            self.fault_at("residual-function", c, what);
        }
    }

    fn residual_body(&mut self, c: ContId) {
        let p = self.p;
        match &p.cont(c).body {
            Body::Jump { callee, args, .. } => self.residual_jump(c, *callee, args),
            Body::Dispatch { .. } => self.fault_at("residual-arm", c, "a dispatch is left".to_owned()),
            Body::Branch { then, other, .. } => {
                self.block(c, *then);
                self.block(c, *other);
            }
            Body::Switch { arms, default, .. } => {
                for arm in arms.iter().map(|(_, arm)| arm).chain([default]) {
                    self.block(c, *arm);
                }
            }
            Body::Load { next, .. } | Body::Store { next, .. } | Body::Local { next, .. } => self.block(c, *next),
            Body::Vectorize { body, args, next, .. } => {
                self.block(c, *next);
                self.residual_vectorize(c, *body, args);
            }
            Body::Unset => {}
        }
    }

    fn residual_jump(&mut self, c: ContId, callee: NodeId, args: &[NodeId]) {
        let whom = self.describe(callee);
        let mut data = args;
        match self.p.node(callee) {
            Node::Cont(f) if self.p.cont(*f).role == Role::Fun => {
                // A function without return is a fault of its own.
                let Some((last, others)) = args.split_last() else { return };
                data = others;
                if !self.is_block(*last) && !self.is_return(*last) {
                    let what = format!("the call of {whom} returns to {}, a closure", self.describe(*last));
                    self.fault_at("residual-jump", c, what);
                }
            }
            Node::Cont(_) => {}
            _ if self.is_return(callee) => {}
            _ => self.fault_at("residual-jump", c, format!("the jump's target, {whom}, is a closure")),
        }
        for arg in data.iter().filter(|x| !self.p.ty(**x).is_data()) {
            let what = format!("{} is passed to {whom}; only data may be", self.describe(*arg));
            self.fault_at("residual-jump", c, what);
        }
    }

    fn residual_vectorize(&mut self, c: ContId, body: NodeId, args: &[NodeId]) {
        let whom = self.describe(body);
        match *self.p.node(body) {
            Node::Cont(body) if self.p.cont(body).role == Role::Fun => self.independent(body),
            _ => self.fault_at("residual-vectorize", c, format!("the body, {whom}, is no function")),
        }
        for arg in args.iter().filter(|x| !self.p.ty(**x).is_data()) {
            let what = format!("{} is passed to {whom}; only data may be", self.describe(*arg));
            self.fault_at("residual-vectorize", c, what);
        }
    }

    fn block(&mut self, c: ContId, x: NodeId) {
        if !self.is_block(x) {
            self.fault_at("residual-arm", c, format!("goes on in {}, which is no block", self.describe(x)));
        }
    }

    fn is_block(&self, x: NodeId) -> bool {
        matches!(self.p.node(x), Node::Cont(c) if self.p.cont(*c).role != Role::Fun)
    }

    fn is_return(&self, x: NodeId) -> bool {
        let Node::Param { cont, index } = *self.p.node(x) else { return false };
        let owner = self.p.cont(cont);
        owner.role == Role::Fun && index as usize + 1 == owner.params.len() && self.p.ty(x).params().is_some()
    }
}
