//! Statements that branch, repeat and leave.

use super::*;

impl Gen<'_> {
    /// A block without parameters that ends in `join`.
    pub fn arm(&mut self, join: NodeId) -> NodeId {
        let (arm, _) = self.cont("arm", Role::Arm, &[]);
        self.aside(arm, |g| {
            g.block();
            g.finish(join);
        });
        self.w.cont_value(arm)
    }

    /// Where branches meet, which mostly unfolds where the branch is decided.
    fn join(&mut self, decided_by: NodeId) -> (ContId, Vec<NodeId>, NodeId) {
        let (join, params) = self.meeting("join", Role::Join);
        let loc = self.loc();
        let filter = match self.c.below(10) {
            8 => self.w.lit(Lit::Bool(true)),
            9 => self.w.lit(Lit::Bool(false)),
            _ => self.w.known(decided_by, loc),
        };
        self.w.cont_mut(join).filter = filter;
        (join, params, self.w.cont_value(join))
    }

    /// A continuation where paths meet: with data that differ, and now and then a function that does not.
    fn meeting(&mut self, name: &str, role: Role) -> (ContId, Vec<NodeId>) {
        let shared = self.shared();
        let mut types = Vec::from_iter(shared.map(|f| self.w.program().ty(f)));
        // Data last: a continuation that takes a function last would look like a function itself.
        types.extend(shared.map(|_| self.scalar_ty()));
        types.extend(self.data_tys(2));
        let (cont, params) = self.cont(name, role, &types);
        if let Some(shared) = shared {
            let to = self.w.cont_value(cont);
            self.pinned.push((to, shared));
        }
        (cont, params)
    }

    /// Now and then a function that is passed along.
    fn shared(&mut self) -> Option<NodeId> {
        let functions = self.functions();
        (!functions.is_empty() && self.c.one_in(4)).then(|| self.c.pick(&functions))
    }

    pub fn branch(&mut self) {
        let mut cond = self.value(Ty::bool());
        // The contrary is rare among values, and passes over branches look for it.
        if self.c.one_in(4) {
            let loc = self.loc();
            cond = self.w.prim(Op::Not, &[cond], loc);
        }
        let (join, params, to) = self.join(cond);
        let (then, other) = (self.arm(to), self.arm(to));
        self.leave(Body::Branch { cond, then, other });
        self.go_on(join, &params);
    }

    pub fn switch(&mut self) {
        let index = self.value(Ty::u32());
        let (join, params, to) = self.join(index);
        let mut number = self.c.below(3);
        let mut arms = Vec::new();
        for _ in 0..self.c.below(4) {
            arms.push((number, self.arm(to)));
            number += 1 + self.c.below(2);
        }
        if self.c.one_in(4) {
            arms.push((u32::MAX, self.arm(to)));
        }
        let default = self.arm(to);
        self.leave(Body::Switch { index, arms, default });
        self.go_on(join, &params);
    }

    pub fn dispatch(&mut self) {
        let table = self.c.pick(&[KINDS, PLAIN]);
        let row = self.value(Ty::row(table));
        let (join, params, to) = self.join(row);
        let (arm, inner) = self.cont("row", Role::Arm, &[Ty::row(table)]);
        self.aside(arm, |g| {
            g.show_all(&inner);
            g.block();
            g.finish(to);
        });
        let arm = self.w.cont_value(arm);
        self.leave(Body::Dispatch { row, arm });
        self.go_on(join, &params);
    }

    /// A block that may be left by an exit of its own.
    pub fn label(&mut self) {
        let (after, params) = self.meeting("label", Role::Label);
        let never = self.w.lit(Lit::Bool(false));
        self.w.cont_mut(after).filter = never;
        let to = self.w.cont_value(after);
        let (env, exits) = (self.env.len(), self.exits.len());
        self.exits.push(to);
        self.show(to, true);
        self.depth += 1;
        self.block();
        self.depth -= 1;
        self.finish(to);
        self.env.truncate(env);
        self.exits.truncate(exits);
        self.go_on(after, &params);
    }

    /// `for i in 0..n`, with n a small literal or a small unknown, a break now and then, unrolled or not.
    pub fn bounded_loop(&mut self) {
        let loc = self.loc();
        let n = self.small();
        let state = self.data_tys(2);
        // A function may go round with the state, but it stays the same.
        let shared = self.shared();
        let with_shared = |g: &Self, first: Ty| {
            let shared = shared.map(|f| g.w.program().ty(f));
            [Vec::from_iter(shared), vec![first], state.clone()].concat()
        };
        let (head, s) = self.cont("loop", Role::Loop, &with_shared(self, Ty::u32()));
        // As the embedded language has it: the exit is told which condition ended the loop.
        let (done, d) = self.cont("done", Role::Label, &with_shared(self, Ty::bool()));
        let at = usize::from(shared.is_some());
        let (i, why) = (s[at], d[at]);
        let (known_i, known_n, known_why) = (self.w.known(i, loc), self.w.known(n, loc), self.w.known(why, loc));
        let never = self.w.lit(Lit::Bool(false));
        let unroll = self.w.prim(Op::And, &[known_i, known_n], loc);
        self.w.cont_mut(head).filter = self.c.pick(&[never, unroll]);
        self.w.cont_mut(done).filter = self.c.pick(&[known_why, never]);
        let (again, to_done) = (self.w.cont_value(head), self.w.cont_value(done));
        self.pinned.extend(shared.map(|f| (to_done, f)));
        let zero = self.u32(0);
        let mut first = [Vec::from_iter(shared), vec![zero]].concat();
        first.extend(state.iter().map(|t| self.value(*t)));
        self.jump(again, first);
        self.aside(head, |g| {
            g.show_all(&s);
            let more = g.w.prim(Op::Lt, &[i, n], loc);
            let (body, _) = g.cont("body", Role::Arm, &[]);
            let (exit, _) = g.cont("exit", Role::Arm, &[]);
            let (then, other) = (g.w.cont_value(body), g.w.cont_value(exit));
            g.leave(Body::Branch { cond: more, then, other });
            g.aside(exit, |g| g.jump(to_done, [&s[..at], &[more], &s[at + 1..]].concat()));
            g.aside(body, |g| {
                g.exits.push(to_done);
                g.block();
                let one = g.u32(1);
                let mut next = s[..at].to_vec();
                next.push(g.w.prim(Op::Add, &[i, one], loc));
                next.extend(state.iter().map(|t| g.value(*t)));
                g.jump(again, next);
            });
        });
        self.go_on(done, &d);
    }

    /// A number of 0 to 5, known or not.
    fn small(&mut self) -> NodeId {
        if self.c.one_in(2) {
            let (x, loc) = (self.value(Ty::u32()), self.loc());
            let three = self.u32(3);
            self.w.prim(Op::And, &[x, three], loc)
        } else {
            let n = self.c.below(6);
            self.u32(n)
        }
    }
}
