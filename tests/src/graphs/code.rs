//! The code of one function: a random shape filled with random values, accesses and calls.

use std::sync::LazyLock;

use jerboa_ir::*;

use super::{STREAMS, Shape, TABLES};
use crate::choices::Choices;
use crate::forms::{Form, forms};
use crate::values;

/// Forms over scalars and over short vectors; no `fma`, which not every back end has.
static FORMS: LazyLock<Vec<Form>> =
    LazyLock::new(|| [1, 1, 2, 4].into_iter().flat_map(forms).filter(|f| f.op != Op::Fma).collect());

/// Elements of a local array at most, and statements of a block.
const ELEMENTS: u32 = 5;
const STATEMENTS: u32 = 4;

/// The state of generation.
struct Gen<'a> {
    w: &'a mut World,
    c: &'a mut Choices,
    /// The function.
    function: ContId,
    /// The continuation that is being written.
    at: ContId,
    /// Values and local arrays in scope.
    env: Vec<NodeId>,
    /// What entering a header costs; the fuel that is left.
    fuel: NodeId,
    /// Functions that may be called.
    callees: &'a [ContId],
    /// Rows of the buffers.
    rows: &'a [u32],
    /// Where headers without fuel leave to, if several share it.
    spent: Option<NodeId>,
}

/// What is in scope at the end of a block.
struct End {
    env: Vec<NodeId>,
    fuel: NodeId,
}

/// Write a function of `most` blocks at most that has so much fuel.
pub fn function(
    w: &mut World,
    c: &mut Choices,
    name: &str,
    most: u32,
    fuel: u32,
    callees: &[ContId],
    rows: &[u32],
) -> ContId {
    let mut params: Vec<Ty> = (0..1 + c.below(4)).map(|_| data_ty(c)).collect();
    let results: Vec<Ty> = (0..1 + c.below(4)).map(|_| data_ty(c)).collect();
    params.push(Ty::func(&results));
    let function = cont(w, name, Role::Fun, &params);
    let fuel = w.lit(Lit::U32(fuel));
    let mut env = w.params(function);
    env.pop();
    let shape = Shape::random(c, most);
    let mut g = Gen { w, c, function, at: function, env, fuel, callees, rows, spent: None };
    g.graph(&shape);
    function
}

/// A scalar, rarely a vector.
fn data_ty(c: &mut Choices) -> Ty {
    let s = c.pick(&[Scalar::U32, Scalar::F32, Scalar::I32, Scalar::Bool]);
    if c.below(8) < 7 { Ty::scalar(s) } else { Ty::vector(s, c.pick(&[2, 4])) }
}

/// A continuation of a residual: nothing is left to unfold.
fn cont(w: &mut World, name: &str, role: Role, params: &[Ty]) -> ContId {
    let params = params.iter().map(|ty| Param { ty: *ty, name: None, keep: false }).collect();
    let cont = w.cont(name, role, params, Loc::NONE);
    let filter = w.lit(Lit::Bool(false));
    w.cont_mut(cont).filter = filter;
    cont
}

impl Gen<'_> {
    fn graph(&mut self, shape: &Shape) {
        let n = shape.succs.len();
        let heads: Vec<ContId> = (0..n).map(|b| if b == 0 { self.function } else { self.head(shape, b) }).collect();
        let mut done: Vec<End> = Vec::new();
        for (b, head) in heads.iter().enumerate() {
            self.at = *head;
            if b > 0 {
                let above = &done[shape.idom[b]];
                (self.env, self.fuel) = (above.env.clone(), above.fuel);
                if let Some((fuel, params)) = self.w.params(*head).split_first() {
                    self.fuel = *fuel;
                    self.env.extend(params);
                }
            }
            if shape.header[b] {
                self.pay();
            }
            for _ in 0..self.c.below(STATEMENTS + 1) {
                self.statement();
            }
            let targets: Vec<ContId> = shape.succs[b].iter().map(|to| heads[*to]).collect();
            done.push(End { env: self.env.clone(), fuel: self.fuel });
            self.leave(&targets);
        }
    }

    /// The head of a block. If it has parameters, the first is the fuel. Headers have it, joins often, others rarely.
    fn head(&mut self, shape: &Shape, b: usize) -> ContId {
        let (role, takes) = match (shape.header[b], shape.entered[b]) {
            (true, _) => (Role::Loop, true),
            (_, 1) => (Role::Arm, self.c.one_in(6)),
            _ => (Role::Join, self.c.below(4) < 3),
        };
        let mut params = Vec::new();
        if takes {
            params.push(Ty::u32());
            params.extend((0..self.c.below(4)).map(|_| data_ty(self.c)).collect::<Vec<_>>());
        }
        cont(self.w, &format!("b{b}"), role, &params)
    }

    /// At a header: without fuel return, else go on with less.
    fn pay(&mut self) {
        let spent = match self.spent {
            Some(spent) if self.c.below(3) > 0 => spent,
            _ => self.way_out(),
        };
        let (zero, one) = (self.u32(0), self.u32(1));
        let is_empty = self.prim(Op::Eq, &[self.fuel, zero]);
        let go = cont(self.w, "go", Role::Arm, &[]);
        let other = self.w.cont_value(go);
        self.set(Body::Branch { cond: is_empty, then: spent, other });
        self.at = go;
        self.fuel = self.prim(Op::Sub, &[self.fuel, one]);
        self.env.push(self.fuel);
    }

    /// A block that returns. If it uses what the function is called with alone, all headers may share it.
    fn way_out(&mut self) -> NodeId {
        let out = cont(self.w, "spent", Role::Label, &[]);
        let node = self.w.cont_value(out);
        let at = std::mem::replace(&mut self.at, out);
        if self.spent.is_none() {
            let mut params = self.w.params(self.function);
            params.pop();
            let env = std::mem::replace(&mut self.env, params);
            self.give_back();
            self.env = env;
            self.spent = Some(node);
        } else {
            self.give_back();
        }
        self.at = at;
        node
    }

    /// The end of a block.
    fn leave(&mut self, targets: &[ContId]) {
        match *targets {
            [] => self.give_back(),
            [to] => {
                let jump = self.jump(to);
                self.set(jump);
            }
            [then, other] => {
                let cond = self.condition();
                let (then, other) = (self.arm(then), self.arm(other));
                self.set(Body::Branch { cond, then, other });
            }
            [ref arms @ .., default] => {
                let index = self.value(Ty::u32());
                let n = self.u32(arms.len() as u32 + 2);
                let index = self.prim(Op::Rem, &[index, n]);
                let gap = self.c.below(3);
                let arms =
                    arms.iter().zip(0..).map(|(to, i)| (if i == 0 { i } else { i + gap }, self.arm(*to))).collect();
                let default = self.arm(default);
                self.set(Body::Switch { index, arms, default });
            }
        }
    }

    /// A branch's arm that goes on there: the block itself, or one before it.
    fn arm(&mut self, to: ContId) -> NodeId {
        if self.w.program().cont(to).params.is_empty() && self.c.below(4) < 3 {
            return self.w.cont_value(to);
        }
        let arm = cont(self.w, "arm", Role::Arm, &[]);
        let at = std::mem::replace(&mut self.at, arm);
        let seen = self.env.len();
        if self.c.one_in(3) {
            self.statement();
        }
        let jump = self.jump(to);
        self.set(jump);
        self.env.truncate(seen);
        self.at = at;
        self.w.cont_value(arm)
    }

    fn jump(&mut self, to: ContId) -> Body {
        let types: Vec<Ty> = self.w.program().cont(to).params.iter().map(|p| p.ty).collect();
        let args = types.iter().enumerate().map(|(i, ty)| if i == 0 { self.fuel } else { self.value(*ty) }).collect();
        Body::Jump { callee: self.w.cont_value(to), args, mode: Mode::Filter }
    }

    /// Return, or return what a function returns.
    fn give_back(&mut self) {
        let params = self.w.params(self.function);
        let ret = params[params.len() - 1];
        let ty = self.w.program().ty(ret);
        let same = |f: &&ContId| self.w.program().cont(**f).params.last().is_some_and(|p| p.ty == ty);
        let tail = self.callees.iter().find(same).copied();
        let (callee, mut args) = match tail.filter(|_| self.c.one_in(2)) {
            Some(f) => (self.w.cont_value(f), self.arguments(f)),
            None => (ret, ty.params().expect("a return").iter().map(|ty| self.value(*ty)).collect()),
        };
        if callee != ret {
            args.push(ret);
        }
        self.set(Body::Jump { callee, args, mode: Mode::Filter });
    }

    /// Arguments of a call, without the return.
    fn arguments(&mut self, f: ContId) -> Vec<NodeId> {
        let mut types: Vec<Ty> = self.w.program().cont(f).params.iter().map(|p| p.ty).collect();
        types.pop();
        types.into_iter().map(|ty| self.value(ty)).collect()
    }

    fn statement(&mut self) {
        match self.c.below(9) {
            0..=2 => {
                let fits = self.c.below(FORMS.len() as u32) as usize;
                let value = self.apply(&FORMS[fits]);
                self.env.push(value);
            }
            3 => {
                let value = self.read();
                self.env.push(value);
            }
            4 => self.local(),
            5 => self.load(),
            6 | 7 => self.store(),
            _ => self.call(),
        }
    }

    /// Go on behind a call or an access.
    fn rest(&mut self, params: &[Ty], body: impl FnOnce(NodeId) -> Body) {
        let rest = cont(self.w, "rest", Role::Rest, params);
        let next = self.w.cont_value(rest);
        self.set(body(next));
        self.at = rest;
        self.env.extend(self.w.params(rest));
    }

    fn call(&mut self) {
        let Some(last) = self.callees.len().checked_sub(1) else { return };
        let f = self.callees[self.c.below(last as u32 + 1) as usize];
        let mut args = self.arguments(f);
        let callee = self.w.cont_value(f);
        let ret = self.w.program().cont(f).params.last().expect("a function returns").ty;
        self.rest(ret.params().expect("a return"), |back| {
            args.push(back);
            Body::Jump { callee, args, mode: Mode::Filter }
        });
    }

    /// A table's column at an index.
    fn read(&mut self) -> NodeId {
        let column = Column { buf: self.c.pick(&TABLES), col: self.c.below(4) };
        let index = self.index();
        self.w.read(column, index, Loc::NONE)
    }

    fn local(&mut self) {
        let (scalar, len) = (self.c.pick(&Scalar::ALL), 1 + self.c.below(ELEMENTS));
        self.rest(&[Ty::local(scalar, len)], |next| Body::Local { scalar, len, next });
    }

    /// Something to load from or to store to, and its elements: a stream, or a local array in scope.
    fn memory(&mut self) -> (Mem, Scalar) {
        let is_array = |n: &&NodeId| matches!(self.w.program().ty(**n).kind(), TyKind::Local(..));
        let arrays: Vec<NodeId> = self.env.iter().filter(is_array).copied().collect();
        if !arrays.is_empty() && self.c.below(2) == 0 {
            let array = self.c.pick(&arrays);
            let TyKind::Local(scalar, _) = *self.w.program().ty(array).kind() else { unreachable!("an array") };
            return (Mem::Local(array), scalar);
        }
        let col = self.c.below(4);
        (Mem::Stream(Column { buf: self.c.pick(&STREAMS), col }), Scalar::ALL[col as usize])
    }

    /// The index of an access, and the lanes of its value: one word, a gather or scatter, or a run of rows.
    fn place(&mut self) -> (NodeId, usize) {
        match self.c.below(8) {
            6 => (self.value(Ty::vector(Scalar::U32, 4)), 4),
            7 => (self.index(), 2),
            _ => (self.index(), 1),
        }
    }

    fn load(&mut self) {
        if self.c.one_in(4) {
            return self.load_unchecked();
        }
        let (mem, scalar) = self.memory();
        let (index, lanes) = self.place();
        self.rest(&[data(scalar, lanes)], |next| Body::Load { mem, index, next });
    }

    /// A load of a table whose index is in range.
    fn load_unchecked(&mut self) {
        let col = self.c.below(4);
        let buf = self.c.pick(&TABLES);
        let index = self.value(Ty::u32());
        let rows = self.u32(self.rows[buf.index()]);
        let index = self.prim(Op::Rem, &[index, rows]);
        let mem = Mem::Unchecked(Column { buf, col });
        self.rest(&[Ty::scalar(Scalar::ALL[col as usize])], |next| Body::Load { mem, index, next });
    }

    fn store(&mut self) {
        let (mem, scalar) = self.memory();
        let (index, lanes) = self.place();
        let value = self.value(data(scalar, lanes));
        let mask = if lanes == 1 { NodeId::NONE } else { self.value(Ty::vector(Scalar::Bool, lanes)) };
        self.rest(&[], |next| Body::Store { mem, index, value, mask, next });
    }

    /// An index near the rows that there are.
    fn index(&mut self) -> NodeId {
        let index = self.value(Ty::u32());
        let near = self.u32(7);
        if self.c.one_in(6) { index } else { self.prim(Op::And, &[index, near]) }
    }

    /// A condition that goes both ways: a bit of some number, or any `bool`.
    fn condition(&mut self) -> NodeId {
        if self.c.one_in(3) {
            return self.value(Ty::bool());
        }
        let number = self.value(Ty::u32());
        let (bit, zero) = (self.c.below(3), self.u32(0));
        let bit = self.u32(1 << bit);
        let masked = self.prim(Op::And, &[number, bit]);
        self.prim(Op::Ne, &[masked, zero])
    }

    /// A value of this type: mostly one in scope, from any block above.
    fn value(&mut self, ty: Ty) -> NodeId {
        if self.c.below(5) < 4 {
            let fits: Vec<NodeId> = self.env.iter().rev().filter(|n| self.w.program().ty(**n) == ty).copied().collect();
            if !fits.is_empty() {
                return self.c.pick(&fits);
            }
        }
        match *ty.kind() {
            TyKind::Vector(s, n) => {
                let lanes: Vec<NodeId> = (0..n).map(|_| self.value(Ty::scalar(s))).collect();
                self.w.pack(&lanes, Loc::NONE)
            }
            TyKind::Scalar(s) if self.c.below(2) == 0 => {
                let lit = values::random(s, self.c);
                self.w.lit(lit)
            }
            _ => {
                let fits: Vec<&Form> =
                    FORMS.iter().filter(|f| f.result == ty && f.args.iter().all(|a| seen(self, *a))).collect();
                match fits.len() {
                    0 => self.zero(ty),
                    n => {
                        let form = fits[self.c.below(n as u32) as usize];
                        self.apply(form)
                    }
                }
            }
        }
    }

    fn zero(&mut self, ty: Ty) -> NodeId {
        let scalar = ty.as_scalar().expect("vectors are packed");
        self.w.lit(Lit::from_word(scalar, 0))
    }

    /// An operation as it stands: not folded, so that every engine gets to fold it.
    fn apply(&mut self, form: &Form) -> NodeId {
        let mut args = [NodeId::NONE; 3];
        for (arg, ty) in args.iter_mut().zip(&form.args) {
            *arg = self.value(*ty);
        }
        self.w.node(Node::Prim { op: form.op, args }, form.result, Loc::NONE)
    }

    fn prim(&mut self, op: Op, args: &[NodeId]) -> NodeId {
        self.w.prim(op, args, Loc::NONE)
    }

    fn u32(&mut self, x: u32) -> NodeId {
        self.w.lit(Lit::U32(x))
    }

    fn set(&mut self, body: Body) {
        self.w.set_body(self.at, body, Loc::NONE);
    }
}

/// Is a value of this type in scope?
fn seen(g: &Gen, ty: Ty) -> bool {
    g.env.iter().any(|n| g.w.program().ty(*n) == ty)
}

/// So many lanes of a scalar.
fn data(scalar: Scalar, lanes: usize) -> Ty {
    if lanes == 1 { Ty::scalar(scalar) } else { Ty::vector(scalar, lanes) }
}
