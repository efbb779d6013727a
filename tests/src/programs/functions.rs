//! Functions of random programs: recursive ones, closures, and calls.

use super::exprs::has_code;
use super::stmts::DEEP;
use super::*;

impl Gen<'_> {
    /// A function that calls itself with a smaller number, and a function in scope that calls it with a small one.
    pub fn recursion(&mut self) {
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
        self.note_calm(rec_value, |g| {
            g.recursive_body(rec, rec_value, &data);
        });
        let (start, start_value) = self.function("start", &params, &results);
        let s = self.w.params(start);
        let filter = self.filter(&s[..params.len()]);
        self.w.cont_mut(start).filter = filter;
        self.note_calm(start_value, |g| {
            g.note_call(rec_value);
            g.write(start, false, |g| {
                let three = g.u32(3);
                let mut args = s.clone();
                args[0] = g.w.prim(Op::And, &[s[0], three], loc);
                g.jump(rec_value, args);
            });
        });
        self.show(start_value, false);
    }

    /// The result where the number is 0, else calls with a smaller one.
    fn recursive_body(&mut self, rec: ContId, rec_value: NodeId, data: &[Ty]) {
        let (r, loc) = (self.w.params(rec), self.loc());
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
    }

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
    pub fn define(&mut self) {
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
        self.note_calm(value, |g| {
            g.write(cont, open, |g| {
                g.block();
                g.finish(g.exits[0]);
            });
        });
        self.show(value, open);
    }

    /// The functions in scope.
    pub fn functions(&self) -> Vec<NodeId> {
        self.env.iter().map(|v| v.node).filter(|n| self.w.program().ty(*n).is_function()).collect()
    }

    /// Call some function in scope.
    pub fn call(&mut self) {
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
        self.note_call(callee);
        let ret = *self.w.program().ty(callee).params().and_then(|p| p.last()).expect("a function returns");
        let (rest, results) = self.cont("rest", Role::Rest, ret.params().expect("a return is code"));
        args.push(self.w.cont_value(rest));
        self.leave(Body::Jump { callee, args, mode });
        self.go_on(rest, &results);
    }
}
