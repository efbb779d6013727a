//! Finds all faults of a program, each with its rule, its place and the author's line.
//!
//! | rule | what must hold |
//! |---|---|
//! | `number` | numbers of nodes, continuations, buffers and columns exist; operands come before their users |
//! | `buffer` | references point to tables; a classed table begins with a `u32` column; streams are bulk |
//! | `entry` | entry names differ; an entry's last parameter is its return |
//! | `type` | a node has the type that its operands give it; rows in types are of tables |
//! | `nan` | every NaN literal is the one NaN |
//! | `filter` | a filter is a `bool` |
//! | `known` | `known` occurs in filters only |
//! | `unset` | every continuation has a jump |
//! | `jump` | the callee is a continuation and takes these arguments |
//! | `branch` | the condition is a `bool`; arms take nothing |
//! | `switch` | the index is a `u32`; numbers ascend; arms take nothing |
//! | `dispatch` | the arm takes one row of that table |
//! | `memory` | streams are loaded and stored, tables only loaded (unchecked); index, value and `next` fit |
//! | `mask` | a store of a vector has a `bool` for each lane; a store of a scalar has no mask |
//! | `vectorize` | the width is 4, 8 or 16; bounds, body and `next` fit; the body uses no exit and no local array from outside |
//! | `array` | a local array has elements and is not passed to a return, which would outlive it |
//! | `scope` | a value is used only where it is made |
//!
//! [`verify_residual`] adds the rules of first-order programs (Law 4); they stand in its own table. Only what is printed
//! is judged (what the entries reach), except by `number`.

mod independent;
mod jumps;
mod residual;

pub use residual::verify_residual;

use rustc_hash::FxHashSet;

use crate::error::Fault;
use crate::lit::{Lit, NAN_BITS};
use crate::program::*;
use crate::scope::Scope;
use crate::stats::Reach;
use crate::ty::{Ty, TyKind};
use crate::typing::type_of;

/// All faults of a program, in the order of the rules' table.
pub fn verify(p: &Program) -> Vec<Fault> {
    let mut v = Verifier { p, reach: Reach::default(), faults: Vec::new() };
    v.numbers();
    if !v.faults.is_empty() {
        return v.faults; // The other rules would look outside of the program's tables.
    }
    v.reach = Reach::of(p);
    v.buffers();
    v.entries();
    v.nodes();
    v.known();
    v.conts();
    v.scope();
    v.faults.dedup();
    v.faults
}

struct Verifier<'p> {
    p: &'p Program,
    reach: Reach,
    faults: Vec<Fault>,
}

impl Verifier<'_> {
    fn fault(&mut self, rule: &'static str, what: String) {
        self.faults.push(Fault { rule, cont: None, node: None, loc: Loc::NONE, what });
    }

    fn fault_at(&mut self, rule: &'static str, c: ContId, what: String) {
        let cont = self.p.cont(c);
        let what = format!("in `{}`: {what}", cont.name);
        self.faults.push(Fault { rule, cont: Some(c), node: None, loc: cont.loc, what });
    }

    fn fault_of(&mut self, rule: &'static str, x: NodeId, what: String) {
        let what = format!("{}: {what}", self.describe(x));
        self.faults.push(Fault { rule, cont: None, node: Some(x), loc: self.p.locs[x.index()], what });
    }

    /// A node in words: its name, or what it is.
    fn describe(&self, x: NodeId) -> String {
        let word = match self.p.node(x) {
            Node::Lit(lit) => return lit.to_string(),
            Node::Param { cont, index } => {
                let cont = self.p.cont(*cont);
                match cont.params.get(*index as usize).and_then(|x| x.name.as_ref()) {
                    Some(name) => return format!("`{name}`"),
                    None => return format!("parameter {index} of `{}`", cont.name),
                }
            }
            Node::Cont(cont) => return format!("`{}`", self.p.cont(*cont).name),
            Node::Prim { op, .. } => op.name(),
            Node::Pack(_) => "pack",
            Node::Lane { .. } => "lane",
            Node::Tuple(_) => "tuple",
            Node::Extract { .. } => "extract",
            Node::Read { .. } => "read",
            Node::Row { .. } => "row",
            Node::Sibling { .. } => "sibling",
            Node::RowIndex(_) => "row_index",
            Node::Known(_) => "known",
        };
        match self.p.names.get(&x) {
            Some(name) => format!("`{name}` ({word})"),
            None => format!("a node `{word}`"),
        }
    }

    fn numbers(&mut self) {
        let p = self.p;
        let (nodes, conts) = (p.nodes.len(), p.conts.len());
        if p.types.len() != nodes || p.locs.len() != nodes {
            self.fault("number", format!("{nodes} nodes have {} types and {} lines", p.types.len(), p.locs.len()));
        }
        let column = |c: &Column| p.buffers.get(c.buf.index()).is_some_and(|b| (c.col as usize) < b.columns.len());
        for id in (0..nodes as u32).map(NodeId) {
            let mut good = match p.node(id) {
                Node::Param { cont, index } => {
                    p.conts.get(cont.index()).is_some_and(|c| (*index as usize) < c.params.len())
                }
                Node::Cont(cont) => cont.index() < conts,
                Node::Read { column: c, .. } => column(c),
                Node::Row { table, .. } => table.index() < p.buffers.len(),
                _ => true,
            };
            p.operands(id, &mut |x| good &= x < id);
            if !good {
                self.fault("number", format!("node {} refers to what is not there or comes later", id.0));
            }
        }
        for c in &p.conts {
            let mut good = c.filter.index() < nodes;
            c.body.operands(&mut |x| good &= x.index() < nodes);
            if let Body::Load { mem, .. } | Body::Store { mem, .. } = &c.body
                && let Mem::Stream(c) | Mem::Unchecked(c) = mem
            {
                good &= column(c);
            }
            if !good {
                self.fault("number", format!("`{}` refers to what is not there", c.name));
            }
        }
        for (name, cont) in &p.entries {
            if cont.index() >= conts {
                self.fault("number", format!("entry `{name}` is no continuation"));
            }
        }
    }

    fn buffers(&mut self) {
        for b in &self.p.buffers {
            for c in &b.columns {
                if let ColTy::Ref(table) = c.ty
                    && !self.is_table(table)
                {
                    self.fault("buffer", format!("`{}.{}` refers to no table", b.name, c.name));
                }
                if b.kind == BufKind::Stream && c.time != Time::Bulk {
                    self.fault("buffer", format!("`{}.{}` is a stream's, so its binding time is bulk", b.name, c.name));
                }
            }
            let class = b.columns.first().is_some_and(|c| c.ty.ty() == Ty::u32());
            if b.kind == (BufKind::Table { classed: true }) && !class {
                self.fault("buffer", format!("`{}` is classed, so its first column is a u32", b.name));
            }
        }
    }

    fn is_table(&self, table: BufId) -> bool {
        self.p.buffers.get(table.index()).is_some_and(|b| b.kind != BufKind::Stream)
    }

    fn entries(&mut self) {
        let mut names = FxHashSet::default();
        for (name, cont) in &self.p.entries {
            if !names.insert(name) {
                self.fault("entry", format!("two entries are named `{name}`"));
            }
            if !self.p.cont_ty(*cont).is_function() {
                self.fault_at("entry", *cont, format!("entry `{name}` has no return as its last parameter"));
            }
        }
    }

    fn nodes(&mut self) {
        for id in self.reach.nodes.clone() {
            if let Node::Lit(Lit::F32(bits)) = *self.p.node(id)
                && f32::from_bits(bits).is_nan()
                && bits != NAN_BITS
            {
                self.fault_of("nan", id, format!("its bits are {bits:#x}, not {NAN_BITS:#x}"));
            }
            match type_of(self.p, self.p.node(id)) {
                Ok(ty) if ty == self.p.ty(id) => {}
                Ok(ty) => self.fault_of("type", id, format!("it is noted as {}, but is {ty}", self.p.ty(id))),
                Err(what) => self.fault_of("type", id, what),
            }
        }
        for c in self.reach.conts.clone() {
            for x in &self.p.cont(c).params {
                if let TyKind::Row(table) = x.ty.kind()
                    && !self.is_table(*table)
                {
                    self.fault_at(
                        "type",
                        c,
                        format!("{} is a row of no table", x.name.as_deref().unwrap_or("a parameter")),
                    );
                }
            }
        }
    }

    /// `known` in what a body needs, through pure nodes.
    fn known(&mut self) {
        let p = self.p;
        let mut has_known = vec![false; p.nodes.len()];
        for id in (0..p.nodes.len() as u32).map(NodeId) {
            let mut has = matches!(p.node(id), Node::Known(_));
            p.operands(id, &mut |x| has |= has_known[x.index()]);
            has_known[id.index()] = has;
        }
        for c in self.reach.conts.clone() {
            let mut found = None;
            p.cont(c).body.operands(&mut |x| found = found.or(has_known[x.index()].then_some(x)));
            if let Some(x) = found {
                let what = format!("{} depends on `known`, which only filters may ask", self.describe(x));
                self.fault_at("known", c, what);
            }
        }
    }

    fn conts(&mut self) {
        for c in self.reach.conts.clone() {
            let filter = self.p.ty(self.p.cont(c).filter);
            if filter != Ty::bool() {
                self.fault_at("filter", c, format!("the filter is {filter}, not bool"));
            }
            self.body(c);
        }
    }

    fn scope(&mut self) {
        let reached: FxHashSet<ContId> = self.reach.conts.iter().copied().collect();
        let scope = Scope::new(self.p);
        self.captures(&scope);
        for (name, cont) in &self.p.entries {
            if let Some(x) = scope.free[cont.index()].first() {
                let what = format!("entry `{name}` uses {} of another continuation", self.describe(*x));
                self.fault_at("scope", *cont, what);
            }
        }
        for (c, what) in scope.faults {
            if reached.contains(&c) {
                self.fault_at("scope", c, what);
            }
        }
    }
}
