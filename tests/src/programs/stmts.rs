//! Statements of random programs: everything that has a place.

use super::*;

/// Deepest nesting of statements.
pub const DEEP: u32 = 5;

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
                24 if !flat && self.iteration.is_none() => self.vectorize(),
                _ => {}
            }
        }
    }

    // ---- plumbing

    pub fn cont(&mut self, name: &str, role: Role, types: &[Ty]) -> (ContId, Vec<NodeId>) {
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

    pub fn leave(&mut self, body: Body) {
        let loc = self.loc();
        self.w.set_body(self.at, body, loc);
    }

    pub fn jump(&mut self, callee: NodeId, args: Vec<NodeId>) {
        self.leave(Body::Jump { callee, args, mode: Mode::Filter });
    }

    /// Go on in a block of the same function, with its parameters in scope.
    pub fn go_on(&mut self, cont: ContId, params: &[NodeId]) {
        self.at = cont;
        self.show_all(params);
    }

    /// Write a block aside, then come back.
    pub fn aside(&mut self, cont: ContId, body: impl FnOnce(&mut Self)) {
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
            self.note_call(callee);
            let mut args = self.arguments(callee);
            args.push(to);
            return self.jump(callee, args);
        }
        let args = self.arguments(to);
        self.jump(to, args);
    }

    /// Arguments for a callee, less the return.
    pub fn arguments(&mut self, callee: NodeId) -> Vec<NodeId> {
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

    // ---- memory

    pub fn load(&mut self) {
        let Some((mem, scalar)) = self.memory(false) else { return };
        let index = self.index(mem);
        if let Mem::Stream(column) = mem
            && self.iteration.as_ref().is_some_and(|iteration| iteration.place(column).is_some())
        {
            return self.load_own(column, scalar, index);
        }
        let (rest, value) = self.cont("loaded", Role::Rest, &[Ty::scalar(scalar)]);
        let next = self.w.cont_value(rest);
        self.leave(Body::Load { mem, index, next });
        self.go_on(rest, &value);
    }

    pub fn store(&mut self) {
        let Some((mem, scalar)) = self.memory(true) else { return };
        let (index, value) = (self.index(mem), self.value(Ty::scalar(scalar)));
        let (rest, _) = self.cont("stored", Role::Rest, &[]);
        let next = self.w.cont_value(rest);
        self.leave(Body::Store { mem, index, value, mask: NodeId::NONE, next });
        self.go_on(rest, &[]);
    }

    /// An index, which an iteration's own column decides.
    fn index(&mut self, mem: Mem) -> NodeId {
        let place = match (mem, &self.iteration) {
            (Mem::Stream(column), Some(iteration)) => iteration.place(column),
            _ => None,
        };
        place.unwrap_or_else(|| self.value(Ty::u32()))
    }

    /// A local array in scope, else a column of a stream that may be stored to; none if an iteration has none.
    fn memory(&mut self, store: bool) -> Option<(Mem, Scalar)> {
        let mut arrays = Vec::new();
        for v in &self.env {
            if let TyKind::Local(scalar, _) = self.w.program().ty(v.node).kind() {
                arrays.push((v.node, *scalar));
            }
        }
        if !arrays.is_empty() && self.c.below(3) > 0 {
            let (array, scalar) = self.c.pick(&arrays);
            return Some((Mem::Local(array), scalar));
        }
        self.touched = true;
        let any = Column { buf: self.c.pick(&STREAMS), col: self.c.below(4) };
        let column = match &self.iteration {
            Some(iteration) if store => {
                let own = iteration.columns();
                if own.is_empty() {
                    return None;
                }
                self.c.pick(&own)
            }
            _ => any,
        };
        match self.w.program().column(column).ty {
            ColTy::Scalar(scalar) => Some((Mem::Stream(column), scalar)),
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
