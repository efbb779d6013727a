//! The rules of jumps: one function per built-in.

use super::Verifier;
use crate::program::*;
use crate::scope::Scope;
use crate::ty::{Scalar, Ty, TyKind};

impl Verifier<'_> {
    /// The rules of one continuation's jump.
    pub(super) fn body(&mut self, c: ContId) {
        let p = self.p;
        match &p.cont(c).body {
            Body::Unset => self.fault_at("unset", c, "it has no jump".to_owned()),
            Body::Jump { callee, args, .. } => self.jump(c, *callee, args),
            Body::Branch { cond, then, other } => {
                self.takes("branch", c, *cond, Ty::bool(), "the condition");
                self.continues("branch", c, *then, &[]);
                self.continues("branch", c, *other, &[]);
            }
            Body::Switch { index, arms, default } => {
                self.takes("switch", c, *index, Ty::u32(), "the index");
                if !arms.is_sorted_by(|(a, _), (b, _)| a < b) {
                    self.fault_at("switch", c, "the arms' numbers do not ascend".to_owned());
                }
                for arm in arms.iter().map(|(_, arm)| arm).chain([default]) {
                    self.continues("switch", c, *arm, &[]);
                }
            }
            Body::Dispatch { row, arm } => match p.ty(*row).kind() {
                TyKind::Row(_) => self.continues("dispatch", c, *arm, &[p.ty(*row)]),
                _ => self.fault_at("dispatch", c, format!("{} is {}, not a row", self.describe(*row), p.ty(*row))),
            },
            Body::Load { mem, index, next } => {
                let lanes = self.index(c, *index, p.loaded(*next));
                if let Some(ty) = self.element(c, mem, true).and_then(|ty| self.widened(c, ty, lanes)) {
                    self.continues("memory", c, *next, &[ty]);
                }
            }
            Body::Store { mem, index, value, mask, next } => {
                let lanes = self.index(c, *index, Some(p.ty(*value)));
                if let Some(ty) = self.element(c, mem, false).and_then(|ty| self.widened(c, ty, lanes)) {
                    self.takes("memory", c, *value, ty, "the value");
                }
                self.mask(c, *mask, lanes);
                self.continues("memory", c, *next, &[]);
            }
            Body::Vectorize { width, lo, hi, body, args, next } => {
                if ![4, 8, 16].contains(width) {
                    self.fault_at("vectorize", c, format!("the width is {width}, not 4, 8 or 16"));
                }
                self.takes("vectorize", c, *lo, Ty::u32(), "the first index");
                self.takes("vectorize", c, *hi, Ty::u32(), "the end");
                let mut params: Vec<Ty> = args.iter().map(|x| p.ty(*x)).collect();
                params.extend([Ty::u32(), Ty::func(&[])]);
                self.continues("vectorize", c, *body, &params);
                self.continues("vectorize", c, *next, &[]);
                if let Node::Cont(body) = p.node(*body)
                    && let [.., index, _] = &p.cont(*body).params[..]
                    && index.keep
                {
                    self.fault_at("vectorize", *body, "an index cannot stay specialised; drop the `keep`".to_owned());
                }
            }
            Body::Local { scalar, len, next } => self.local(c, *scalar, *len, *next),
        }
    }

    /// What the bodies of `vectorize` may not use of the function around them.
    pub(super) fn captures(&mut self, scope: &Scope) {
        let p = self.p;
        for c in self.reach.conts.clone() {
            let Body::Vectorize { body, .. } = &p.cont(c).body else { continue };
            let Node::Cont(body) = *p.node(*body) else { continue };
            for x in &scope.free[body.index()] {
                let what = match p.ty(*x).kind() {
                    TyKind::Local(..) => "a local array: each iteration has its own",
                    TyKind::Fn(_) if !p.ty(*x).is_function() => "an exit: an iteration ends by its return only",
                    _ => continue,
                };
                let what = format!("an iteration of `vectorize` uses {}, {what}", self.describe(*x));
                self.fault_at("vectorize", body, what);
            }
        }
    }

    fn jump(&mut self, c: ContId, callee: NodeId, args: &[NodeId]) {
        let p = self.p;
        let whom = self.describe(callee);
        let Some(params) = p.ty(callee).params() else {
            return self.fault_at("jump", c, format!("{whom} is {}, not a continuation", p.ty(callee)));
        };
        if params.len() != args.len() {
            let what = format!("{whom} is {}, but the jump has {} arguments", p.ty(callee), args.len());
            return self.fault_at("jump", c, what);
        }
        for (i, (arg, param)) in args.iter().zip(params).enumerate() {
            self.takes("jump", c, *arg, *param, &format!("argument {} of {whom}", i + 1));
        }
        // A continuation that is neither there to see nor a function with a return of its own leaves the function.
        let leaves = !matches!(p.node(callee), Node::Cont(_)) && !p.ty(callee).is_function();
        if leaves && params.iter().any(|ty| matches!(ty.kind(), TyKind::Local(..))) {
            self.fault_at("array", c, format!("{whom} would get a local array that ends with this function"));
        }
    }

    fn local(&mut self, c: ContId, scalar: Scalar, len: u32, next: NodeId) {
        if len == 0 {
            self.fault_at("array", c, "a local array has at least 1 element".to_owned());
        }
        self.continues("array", c, next, &[Ty::local(scalar, len)]);
    }

    /// How many lanes an access has: those of its index, else those of the value that comes from or goes to memory.
    fn index(&mut self, c: ContId, index: NodeId, value: Option<Ty>) -> usize {
        let lanes = |ty: Ty| ty.lanes().map_or(1, |(_, lanes)| lanes);
        match self.p.ty(index).lanes() {
            Some((Scalar::U32, 1)) => value.map_or(1, lanes),
            Some((Scalar::U32, lanes)) => lanes,
            _ => {
                self.takes("memory", c, index, Ty::u32(), "the index");
                1
            }
        }
    }

    /// The type of so many elements.
    fn widened(&mut self, c: ContId, element: Ty, lanes: usize) -> Option<Ty> {
        match element.as_scalar() {
            _ if lanes == 1 => Some(element),
            Some(s) => Some(Ty::vector(s, lanes)),
            None => {
                self.fault_at("memory", c, format!("there are no vectors of {element}"));
                None
            }
        }
    }

    fn mask(&mut self, c: ContId, mask: NodeId, lanes: usize) {
        match (mask == NodeId::NONE, lanes) {
            (true, 1) => {}
            (true, _) => self.fault_at("mask", c, "it stores a vector without a mask".to_owned()),
            (false, 1) => self.fault_at("mask", c, "it stores a scalar under a mask".to_owned()),
            (false, _) => self.takes("mask", c, mask, Ty::vector(Scalar::Bool, lanes), "the mask"),
        }
    }

    /// The type of a memory's elements, if it may be loaded or stored.
    fn element(&mut self, c: ContId, mem: &Mem, load: bool) -> Option<Ty> {
        let p = self.p;
        let fault = match mem {
            Mem::Local(array) => match p.ty(*array).kind() {
                TyKind::Local(s, _) => return Some(Ty::scalar(*s)),
                _ => format!("{} is {}, not a local array", self.describe(*array), p.ty(*array)),
            },
            Mem::Stream(column) | Mem::Unchecked(column) => {
                let stream = p.buffer(column.buf).kind == BufKind::Stream;
                let name = format!("`{}.{}`", p.buffer(column.buf).name, p.column(*column).name);
                match mem {
                    Mem::Stream(_) if stream => return Some(p.column(*column).ty.ty()),
                    Mem::Unchecked(_) if !stream && load => return Some(p.column(*column).ty.ty()),
                    Mem::Unchecked(_) if stream => format!("{name} is a stream's; only tables are loaded unchecked"),
                    Mem::Stream(_) if load => format!("{name} is a table's: read it, or load it unchecked"),
                    _ => format!("{name} is a table's; nothing stores there"),
                }
            }
        };
        self.fault_at("memory", c, fault);
        None
    }

    /// A value has this type.
    fn takes(&mut self, rule: &'static str, c: ContId, x: NodeId, ty: Ty, what: &str) {
        if self.p.ty(x) != ty {
            self.fault_at(rule, c, format!("{what}, {}, is {}, not {ty}", self.describe(x), self.p.ty(x)));
        }
    }

    /// A continuation takes exactly these.
    fn continues(&mut self, rule: &'static str, c: ContId, next: NodeId, params: &[Ty]) {
        let wanted = Ty::func(params);
        if self.p.ty(next) != wanted {
            self.fault_at(rule, c, format!("{} is {}, not {wanted}", self.describe(next), self.p.ty(next)));
        }
    }
}
