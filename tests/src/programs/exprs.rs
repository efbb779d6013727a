//! Types and pure values of random programs.

use std::sync::LazyLock;

use super::*;
use crate::forms::{Form, forms};

/// Forms over scalars and over vectors of the lengths in use.
static FORMS: LazyLock<Vec<Form>> = LazyLock::new(|| [1, 1, 1, 2, 3, 4, 16].into_iter().flat_map(forms).collect());

impl Gen<'_> {
    pub fn loc(&self) -> Loc {
        Loc { file: "random", line: self.line }
    }

    pub fn scalar_ty(&mut self) -> Ty {
        Ty::scalar(self.c.pick(&[Scalar::F32, Scalar::U32, Scalar::I32, Scalar::Bool, Scalar::F32, Scalar::U32]))
    }

    pub fn vector_ty(&mut self) -> Ty {
        let scalar = self.c.pick(&Scalar::ALL);
        Ty::vector(scalar, self.c.pick(&[2, 3, 4, 16]))
    }

    /// A type of values that may meet at joins.
    pub fn data_ty(&mut self) -> Ty {
        match self.c.below(14) {
            10 | 11 => self.vector_ty(),
            12 => {
                let elems = [self.data_ty(), self.scalar_ty()];
                Ty::tuple(&elems)
            }
            13 => Ty::row(self.c.pick(&[KINDS, PLAIN])),
            _ => self.scalar_ty(),
        }
    }

    /// At most `n` such types.
    pub fn data_tys(&mut self, n: u32) -> Vec<Ty> {
        (0..self.c.below(n + 1)).map(|_| self.data_ty()).collect()
    }

    /// The type of a function, or of an exit.
    pub fn code_ty(&mut self) -> Ty {
        let mut params = self.data_tys(2);
        if self.c.below(4) > 0 {
            let results = self.data_tys(2);
            params.push(Ty::func(&results));
        }
        Ty::func(&params)
    }

    /// A record of a function and data.
    pub fn record_ty(&mut self) -> Ty {
        let elems = [self.code_ty(), self.data_ty()];
        Ty::tuple(&elems)
    }

    /// Add to what is in scope.
    pub fn show(&mut self, node: NodeId, tied: bool) {
        self.env.push(Value { node, tied });
    }

    pub fn show_all(&mut self, nodes: &[NodeId]) {
        for n in nodes {
            let tied = has_code(self.w.program().ty(*n));
            self.show(*n, tied);
        }
    }

    fn visible(&mut self, ty: Ty) -> Option<NodeId> {
        let fits: Vec<NodeId> =
            self.env.iter().rev().map(|v| v.node).filter(|n| self.w.program().ty(*n) == ty).collect();
        (!fits.is_empty()).then(|| self.c.pick(&fits))
    }

    /// A value of this type.
    pub fn value(&mut self, ty: Ty) -> NodeId {
        self.value_of(ty, 2)
    }

    pub fn u32(&mut self, x: u32) -> NodeId {
        self.w.lit(Lit::U32(x))
    }

    fn value_of(&mut self, ty: Ty, depth: u32) -> NodeId {
        if ty.params().is_some() {
            let known = if self.c.below(4) == 0 { None } else { self.visible(ty) };
            return known.unwrap_or_else(|| self.code(ty));
        }
        match self.c.below(6) {
            0 => self.literal(ty),
            1 if depth > 0 => self.computed(ty, depth - 1),
            _ => self.visible(ty).unwrap_or_else(|| self.literal(ty)),
        }
    }

    fn literal(&mut self, ty: Ty) -> NodeId {
        let loc = self.loc();
        match ty.kind() {
            TyKind::Scalar(s) => {
                let lit = values::random(*s, self.c);
                self.w.lit(lit)
            }
            TyKind::Vector(s, n) => {
                let lanes: Vec<NodeId> = (0..*n).map(|_| self.literal(Ty::scalar(*s))).collect();
                self.w.pack(&lanes, loc)
            }
            TyKind::Tuple(elems) => {
                let elems: Vec<NodeId> = elems.iter().map(|t| self.value_of(*t, 0)).collect();
                self.w.tuple(&elems, loc)
            }
            TyKind::Row(table) => {
                let index = self.c.below(5);
                let index = self.u32(index);
                self.w.row(*table, index, loc)
            }
            TyKind::Fn(_) | TyKind::Local(..) => unreachable!("{ty} has no literals"),
        }
    }

    fn computed(&mut self, ty: Ty, depth: u32) -> NodeId {
        let loc = self.loc();
        match ty.kind() {
            TyKind::Scalar(s) if self.c.one_in(4) => self.read(*s, depth),
            TyKind::Scalar(Scalar::U32) if self.c.one_in(4) => {
                let table = self.c.pick(&[KINDS, PLAIN]);
                let row = self.value_of(Ty::row(table), depth);
                self.w.row_index(row, loc)
            }
            TyKind::Scalar(s) if self.c.one_in(4) => {
                let lanes = self.c.pick(&[2, 4]);
                let vector = self.value_of(Ty::vector(*s, lanes), depth);
                let lane = self.c.below(lanes as u32) as usize;
                self.w.lane(vector, lane, loc)
            }
            TyKind::Vector(s, n) if self.c.one_in(3) => {
                let lanes: Vec<NodeId> = (0..*n).map(|_| self.value_of(Ty::scalar(*s), 0)).collect();
                self.w.pack(&lanes, loc)
            }
            TyKind::Scalar(_) | TyKind::Vector(..) => {
                let fits: Vec<&Form> = FORMS.iter().filter(|f| f.result == ty).collect();
                let form = self.c.pick(&fits);
                self.apply(form, depth)
            }
            TyKind::Tuple(elems) => {
                let elems: Vec<NodeId> = elems.iter().map(|t| self.value_of(*t, depth)).collect();
                self.w.tuple(&elems, loc)
            }
            TyKind::Row(PLAIN) if self.c.one_in(2) => {
                let row = self.value_of(Ty::row(KINDS), depth);
                self.w.read(Column { buf: KINDS, col: 5 }, row, loc)
            }
            TyKind::Row(KINDS) if self.c.one_in(2) => {
                let (buf, col) = self.c.pick(&[(PLAIN, 3), (KINDS, 6)]);
                let row = self.value_of(Ty::row(buf), depth);
                self.w.read(Column { buf, col }, row, loc)
            }
            TyKind::Row(table) => {
                let index = self.value_of(Ty::u32(), depth);
                self.w.row(*table, index, loc)
            }
            TyKind::Fn(_) | TyKind::Local(..) => unreachable!("{ty} is not computed"),
        }
    }

    /// A table's column of this type, at a row or at an index.
    fn read(&mut self, s: Scalar, depth: u32) -> NodeId {
        let columns: &[(BufId, u32)] = match s {
            Scalar::U32 => &[(KINDS, 1), (KINDS, 0), (PLAIN, 1)],
            Scalar::Bool => &[(KINDS, 2)],
            Scalar::F32 => &[(KINDS, 3), (PLAIN, 0)],
            Scalar::I32 => &[(KINDS, 4), (PLAIN, 2)],
        };
        let (buf, col) = self.c.pick(columns);
        let index = if self.c.one_in(3) { Ty::u32() } else { Ty::row(buf) };
        let index = self.value_of(index, depth);
        let loc = self.loc();
        self.w.read(Column { buf, col }, index, loc)
    }

    fn apply(&mut self, form: &Form, depth: u32) -> NodeId {
        let args: Vec<NodeId> = form.args.iter().map(|t| self.value_of(*t, depth)).collect();
        self.raw(form.op, &args, form.result)
    }

    /// An operation as it stands: not folded, so that every engine gets to fold it.
    fn raw(&mut self, op: Op, args: &[NodeId], result: Ty) -> NodeId {
        let mut padded = [NodeId::NONE; 3];
        padded[..args.len()].copy_from_slice(args);
        let loc = self.loc();
        self.w.node(Node::Prim { op, args: padded }, result, loc)
    }

    /// Some operation, each equally likely, on values in scope.
    pub fn some_operation(&mut self) -> NodeId {
        let op = self.c.pick(Op::ALL);
        let fits: Vec<&Form> = FORMS.iter().filter(|f| f.op == op).collect();
        let form = self.c.pick(&fits);
        self.apply(form, 1)
    }

    /// Show some other value: one of a random type, or a component of a tuple or record.
    pub fn some_value(&mut self) {
        let ty = if self.c.one_in(6) { self.record_ty() } else { self.data_ty() };
        let mut value = self.value(ty);
        let loc = self.loc();
        if let TyKind::Tuple(elems) = ty.kind() {
            let index = self.c.below(elems.len() as u32) as usize;
            value = self.w.extract(value, index, loc);
        }
        self.show_all(&[value]);
    }

    /// A filter over what is in scope at the start of a function, `always` or not.
    pub fn filter(&mut self, params: &[NodeId]) -> NodeId {
        let loc = self.loc();
        let known = |g: &mut Self| match params.is_empty() {
            true => g.w.lit(Lit::Bool(true)),
            false => {
                let param = g.c.pick(params);
                g.w.known(param, loc)
            }
        };
        match self.c.below(7) {
            0 | 1 => self.w.lit(Lit::Bool(true)),
            2 | 3 => self.w.lit(Lit::Bool(false)),
            4 => known(self),
            5 => {
                let (a, b) = (known(self), known(self));
                let (op, not) = (self.c.pick(&[Op::And, Op::Or, Op::Xor]), self.c.one_in(3));
                let both = self.w.prim(op, &[a, b], loc);
                if not { self.w.prim(Op::Not, &[both], loc) } else { both }
            }
            _ => {
                let (a, b) = (known(self), self.value(Ty::bool()));
                self.w.prim(Op::And, &[a, b], loc)
            }
        }
    }
}

/// Is it a function, or a record with one?
pub fn has_code(ty: Ty) -> bool {
    match ty.kind() {
        TyKind::Fn(_) => true,
        TyKind::Tuple(elems) => elems.iter().any(|t| has_code(*t)),
        _ => false,
    }
}
