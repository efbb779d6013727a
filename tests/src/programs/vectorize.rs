//! Loops of independent iterations.
//!
//! An iteration has columns of its own, which it stores at one place, its index, or that and something from outside, and
//! loads there if the stream has such a row. From other columns it loads anywhere. Of the functions around it, it calls the *calm* ones, which touch no
//! stream; those that it makes itself keep its rules.

use super::exprs::has_code;
use super::*;

/// Statements of an iteration that a program has no statements left for.
const STATEMENTS_WITHIN: u32 = 15;

/// What the iteration that is being written may touch.
pub(super) struct Iteration {
    /// The columns that it may store to, each with the place.
    own: Vec<(Column, NodeId)>,
}

impl Iteration {
    /// Where it touches this column, if that is its own.
    pub fn place(&self, column: Column) -> Option<NodeId> {
        self.own.iter().find(|(own, _)| *own == column).map(|(_, place)| *place)
    }

    /// The columns that it may store to.
    pub fn columns(&self) -> Vec<Column> {
        self.own.iter().map(|(column, _)| *column).collect()
    }
}

impl Gen<'_> {
    pub fn vectorize(&mut self) {
        self.touched = true;
        let loc = self.loc();
        let width = self.c.pick(&[4, 8, 16]);
        let lo = if self.c.one_in(3) { self.bound() } else { self.u32(0) };
        let (hi, by) = (self.bound(), self.value(Ty::u32()));
        let (each, body) = self.function("each", &[Ty::u32()], &[]);
        let i = self.w.params(each)[0];
        let (above, below) = (self.w.prim(Op::Add, &[by, i], loc), self.w.prim(Op::Sub, &[i, by], loc));
        let mut own = Vec::new();
        for buf in STREAMS {
            for col in (0..4).filter(|_| self.c.one_in(2)).collect::<Vec<_>>() {
                own.push((Column { buf, col }, self.c.pick(&[i, i, above, below])));
            }
        }
        self.iteration = Some(Iteration { own });
        // An iteration is worth statements of its own.
        let budget = self.budget;
        self.budget += 2 * STATEMENTS_WITHIN;
        self.write(each, false, |g| {
            let (p, calm) = (g.w.program(), &g.calm);
            g.env.retain(|v| calm.contains(&v.node) || !has_code(p.ty(v.node)));
            g.load();
            g.block();
            // What it has computed shows in what it stores.
            (0..1 + g.c.below(2)).for_each(|_| g.store());
            g.finish(g.exits[0]);
        });
        self.iteration = None;
        self.budget = self.budget.min(budget);
        let (rest, _) = self.cont("rest", Role::Rest, &[]);
        let next = self.w.cont_value(rest);
        self.leave(Body::Vectorize { width, lo, hi, body, args: vec![], next });
        self.go_on(rest, &[]);
    }

    /// Load from a column of the iteration's own, where it has such a row: beyond, there is a row of another iteration.
    pub fn load_own(&mut self, column: Column, scalar: Scalar, place: NodeId) {
        let (loc, rows, default) = (self.loc(), self.rows[column.buf.index()], self.value(Ty::scalar(scalar)));
        let rows = self.u32(rows);
        let cond = self.w.prim(Op::Lt, &[place, rows], loc);
        let (join, value) = self.cont("join", Role::Join, &[Ty::scalar(scalar)]);
        let filter = self.w.known(cond, loc);
        self.w.cont_mut(join).filter = filter;
        let to = self.w.cont_value(join);
        let ((there, _), (beyond, _)) = (self.cont("there", Role::Arm, &[]), self.cont("beyond", Role::Arm, &[]));
        let (then, other) = (self.w.cont_value(there), self.w.cont_value(beyond));
        self.leave(Body::Branch { cond, then, other });
        self.aside(there, |g| g.leave(Body::Load { mem: Mem::Stream(column), index: place, next: to }));
        self.aside(beyond, |g| g.jump(to, vec![default]));
        self.go_on(join, &value);
    }

    /// A number of 0 to 39, known or not.
    fn bound(&mut self) -> NodeId {
        if self.c.one_in(2) {
            let n = self.c.below(40);
            return self.u32(n);
        }
        let (x, loc) = (self.value(Ty::u32()), self.loc());
        let mask = self.c.pick(&[31, 7, 3]);
        let mask = self.u32(mask);
        self.w.prim(Op::And, &[x, mask], loc)
    }

    /// Write a function, and note whether it is calm. It may call itself.
    pub fn note_calm(&mut self, function: NodeId, write: impl FnOnce(&mut Self)) {
        let touched = std::mem::take(&mut self.touched);
        self.calm.push(function);
        write(self);
        if self.touched {
            self.calm.retain(|f| *f != function);
        }
        self.touched |= touched;
    }

    /// A call is as calm as its callee.
    pub fn note_call(&mut self, callee: NodeId) {
        self.touched |= !self.calm.contains(&callee);
    }
}
