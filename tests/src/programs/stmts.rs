//! Statements of random programs: everything that has a place.

use super::exprs::has_code;
use super::*;

/// Deepest nesting of statements.
const DEEP: u32 = 5;

impl Gen<'_> {
    /// Statements, until one of them says stop.
    pub fn block(&mut self) {
        while self.budget > 0 {
            self.budget -= 1;
            self.line += 1;
            let flat = self.depth >= DEEP;
            match self.c.below(26) {
                0 if self.c.one_in(2) => return,
                1..=5 => {
                    let x = self.some_operation();
                    self.show(x, false);
                }
                6 | 7 => self.some_value(),
                8 => self.load(),
                9 => self.store(),
                10 if !flat => self.array(),
                11 => self.call(),
                12 | 13 if !flat => self.branch(),
                14 if !flat => self.switch(),
                15 if !flat => self.dispatch(),
                16 | 17 if !flat => self.bounded_loop(),
                18 if !flat => self.label(),
                19 if !flat => self.recursion(),
                20 | 21 if !flat => self.define(),
                22 | 23 => self.call(),
                _ => {}
            }
        }
    }

    // ---- plumbing

    fn cont(&mut self, name: &str, role: Role, types: &[Ty]) -> (ContId, Vec<NodeId>) {
        let params = types.iter().map(|t| Param { ty: *t, name: None, keep: false }).collect();
        let loc = self.loc();
        let cont = self.w.cont(name, role, params, loc);
        (cont, self.w.params(cont))
    }

    /// A function's continuation without a body, and the function as a value.
    pub fn function(&mut self, name: &str, params: &[Ty], results: &[Ty]) -> (ContId, NodeId) {
        let types = [params, &[Ty::func(results)]].concat();
        let (cont, _) = self.cont(name, Role::Fun, &types);
        (cont, self.w.cont_value(cont))
    }

    fn leave(&mut self, body: Body) {
        let loc = self.loc();
        self.w.set_body(self.at, body, loc);
    }

    fn jump(&mut self, callee: NodeId, args: Vec<NodeId>) {
        self.leave(Body::Jump { callee, args, mode: Mode::Filter });
    }

    /// Go on in a block of the same function, with its parameters in scope.
    fn go_on(&mut self, cont: ContId, params: &[NodeId]) {
        self.at = cont;
        self.show_all(params);
    }

    /// Write a block aside, then come back.
    fn aside(&mut self, cont: ContId, body: impl FnOnce(&mut Self)) {
        let (at, env, exits, depth) = (self.at, self.env.len(), self.exits.len(), self.depth);
        (self.at, self.depth) = (cont, depth + 1);
        body(self);
        self.env.truncate(env);
        self.exits.truncate(exits);
        (self.at, self.depth) = (at, depth);
    }

    /// Write a function aside. An open one sees all that is in scope; else only what is not tied, and its only exit is
    /// its return.
    pub fn write(&mut self, cont: ContId, open: bool, body: impl FnOnce(&mut Self)) {
        let nodes = self.w.params(cont);
        let (params, ret) = match nodes.split_last() {
            Some((last, params)) if self.w.program().ty(*last).params().is_some() => (params, Some(*last)),
            _ => (&nodes[..], None),
        };
        let (env, exits) = (self.env.clone(), self.exits.clone());
        if !open {
            self.env.retain(|v| !v.tied);
            self.exits.clear();
        }
        self.exits.splice(0..0, ret);
        let before = self.budget;
        self.budget = before / 2;
        self.aside(cont, |g| {
            g.show_all(params);
            body(g);
        });
        self.budget += before - before / 2;
        (self.env, self.exits) = (env, exits);
    }

    /// End the path: go to `to`, or by another exit, or with a tail call.
    pub fn finish(&mut self, to: NodeId) {
        let to = if self.c.one_in(12) { self.c.pick(&self.exits.clone()) } else { to };
        let returns_alike = |g: &Self, f: NodeId| {
            let ty = g.w.program().ty(f);
            ty.is_function() && ty.params().and_then(|p| p.last()) == Some(&g.w.program().ty(to))
        };
        let callees: Vec<NodeId> = self.env.iter().map(|v| v.node).filter(|f| returns_alike(self, *f)).collect();
        if !callees.is_empty() && self.c.one_in(6) {
            let callee = self.c.pick(&callees);
            let mut args = self.arguments(callee);
            args.push(to);
            return self.jump(callee, args);
        }
        let args = self.arguments(to);
        self.jump(to, args);
    }

    /// Arguments for a callee, less the return.
    fn arguments(&mut self, callee: NodeId) -> Vec<NodeId> {
        let ty = self.w.program().ty(callee);
        let params = ty.params().expect("a callee is code");
        let params = &params[..params.len() - usize::from(ty.is_function())];
        let pinned = self.pinned.iter().find(|(to, _)| *to == callee).map(|(_, value)| *value);
        let mut args = Vec::from_iter(pinned);
        for ty in &params[args.len()..] {
            args.push(self.value(*ty));
        }
        args
    }

    // ---- branches

    /// A block without parameters that ends in `join`.
    fn arm(&mut self, join: NodeId) -> NodeId {
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

    fn branch(&mut self) {
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

    fn switch(&mut self) {
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

    fn dispatch(&mut self) {
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
    fn label(&mut self) {
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

    // ---- repetition

    /// `for i in 0..n`, with n a small literal or a small unknown, a break now and then, unrolled or not.
    fn bounded_loop(&mut self) {
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

    /// A function that calls itself with a smaller number, and a function in scope that calls it with a small one.
    fn recursion(&mut self) {
        let loc = self.loc();
        let (data, results) = (self.data_tys(2), self.data_tys(2));
        let params = [&[Ty::u32()], &data[..]].concat();
        let (rec, rec_value) = self.function("rec", &params, &results);
        let r = self.w.params(rec);
        let mut filter = self.w.known(r[0], loc);
        if self.c.one_in(3) {
            filter = self.w.lit(Lit::Bool(false));
        }
        self.w.cont_mut(rec).filter = filter;
        self.write(rec, false, |g| {
            let (zero, one) = (g.u32(0), g.u32(1));
            let cond = g.w.prim(Op::Eq, &[r[0], zero], loc);
            let ret = g.exits[0];
            let then = g.arm(ret);
            let (step, _) = g.cont("step", Role::Arm, &[]);
            let other = g.w.cont_value(step);
            g.leave(Body::Branch { cond, then, other });
            g.aside(step, |g| {
                g.block();
                for _ in 0..1 + g.c.below(2) {
                    let mut args = vec![g.w.prim(Op::Sub, &[r[0], one], loc)];
                    args.extend(data.iter().map(|t| g.value(*t)));
                    // Not `Mode::Now`, which would unfold without end.
                    let mode = g.c.pick(&[Mode::Filter, Mode::Filter, Mode::Later]);
                    g.call_with(rec_value, args, mode);
                }
                g.finish(ret);
            });
        });
        let (start, start_value) = self.function("start", &params, &results);
        let s = self.w.params(start);
        let filter = self.filter(&s[..params.len()]);
        self.w.cont_mut(start).filter = filter;
        self.write(start, false, |g| {
            let three = g.u32(3);
            let mut args = s.clone();
            args[0] = g.w.prim(Op::And, &[s[0], three], loc);
            g.jump(rec_value, args);
        });
        self.show(start_value, false);
    }

    // ---- functions

    /// A function or an exit of this type, made here.
    pub fn code(&mut self, ty: Ty) -> NodeId {
        let params = ty.params().expect("code");
        let (cont, _) = self.cont("lam", Role::Fun, params);
        self.write(cont, true, |g| {
            if g.depth < DEEP {
                g.block();
            }
            g.finish(g.exits[0]);
        });
        self.w.cont_value(cont)
    }

    /// A function in scope from here on: a closure that is always unfolded, or one with a filter.
    fn define(&mut self) {
        let open = self.c.one_in(3);
        let mut params = self.data_tys(3);
        match self.c.below(6) {
            4 => params.push(self.code_ty()),
            5 => params.push(self.record_ty()),
            _ => {}
        }
        let results = self.data_tys(2);
        let (cont, value) = self.function("fun", &params, &results);
        for i in 0..params.len() {
            self.w.cont_mut(cont).params[i].keep = self.c.one_in(8);
        }
        if !open {
            let own = self.w.params(cont);
            let data: Vec<NodeId> = own.into_iter().filter(|p| !has_code(self.w.program().ty(*p))).collect();
            let filter = self.filter(&data);
            self.w.cont_mut(cont).filter = filter;
        }
        self.write(cont, open, |g| {
            g.block();
            g.finish(g.exits[0]);
        });
        self.show(value, open);
    }

    /// The functions in scope.
    fn functions(&self) -> Vec<NodeId> {
        self.env.iter().map(|v| v.node).filter(|n| self.w.program().ty(*n).is_function()).collect()
    }

    /// Call some function in scope.
    fn call(&mut self) {
        let functions = self.functions();
        if functions.is_empty() {
            return;
        }
        let callee = self.c.pick(&functions);
        let args = self.arguments(callee);
        let mode = self.c.pick(&[Mode::Filter, Mode::Filter, Mode::Filter, Mode::Now, Mode::Later]);
        self.call_with(callee, args, mode);
    }

    fn call_with(&mut self, callee: NodeId, mut args: Vec<NodeId>, mode: Mode) {
        let ret = *self.w.program().ty(callee).params().and_then(|p| p.last()).expect("a function returns");
        let (rest, results) = self.cont("rest", Role::Rest, ret.params().expect("a return is code"));
        args.push(self.w.cont_value(rest));
        self.leave(Body::Jump { callee, args, mode });
        self.go_on(rest, &results);
    }

    // ---- memory

    fn load(&mut self) {
        let (mem, scalar) = self.memory();
        let index = self.value(Ty::u32());
        let (rest, value) = self.cont("loaded", Role::Rest, &[Ty::scalar(scalar)]);
        let next = self.w.cont_value(rest);
        self.leave(Body::Load { mem, index, next });
        self.go_on(rest, &value);
    }

    fn store(&mut self) {
        let (mem, scalar) = self.memory();
        let (index, value) = (self.value(Ty::u32()), self.value(Ty::scalar(scalar)));
        let (rest, _) = self.cont("stored", Role::Rest, &[]);
        let next = self.w.cont_value(rest);
        self.leave(Body::Store { mem, index, value, next });
        self.go_on(rest, &[]);
    }

    /// A local array in scope, else a column of a stream.
    fn memory(&mut self) -> (Mem, Scalar) {
        let mut arrays = Vec::new();
        for v in &self.env {
            if let TyKind::Local(scalar, _) = self.w.program().ty(v.node).kind() {
                arrays.push((v.node, *scalar));
            }
        }
        if !arrays.is_empty() && self.c.below(3) > 0 {
            let (array, scalar) = self.c.pick(&arrays);
            return (Mem::Local(array), scalar);
        }
        let column = Column { buf: self.c.pick(&STREAMS), col: self.c.below(4) };
        match self.w.program().column(column).ty {
            ColTy::Scalar(scalar) => (Mem::Stream(column), scalar),
            ColTy::Ref(_) => unreachable!("streams hold scalars"),
        }
    }

    fn array(&mut self) {
        let (scalar, len) = (self.c.pick(&Scalar::ALL), 1 + self.c.below(4));
        let (rest, array) = self.cont("array", Role::Rest, &[Ty::local(scalar, len)]);
        let next = self.w.cont_value(rest);
        self.leave(Body::Local { scalar, len, next });
        self.at = rest;
        self.show(array[0], true);
    }
}
