//! A hash of what a program says, without what it is called: names, hints and source lines do not count.
//!
//! It keys a cache of machine code and tells whether the generic program is the same for two scenes. It is the same in
//! every run of one build. It hashes a program as it is numbered: two that were made by the same steps agree, two that
//! differ only in the order of their nodes need not. The function is FNV-1a of 128 bits (Fowler, Noll, Vo, 1991), which an
//! adversary can defeat but an accident hardly; a hit in a cache is confirmed by comparison, [`is_same`].
//!
//! ```
//! let hash = |x: &str, factor: &str| {
//!     let body = format!("fun f({x}: f32, return: fn(f32))\n  y = mul {x} {factor}\n  jump return(y)\n");
//!     let program = jerboa_ir::parse(&format!("jerboa-ir 1\nentry f = f\n{body}")).expect("it is a program");
//!     jerboa_ir::hash::hash(&program)
//! };
//! assert_eq!(hash("x", "2.0"), hash("width", "2.0"));
//! assert_ne!(hash("x", "2.0"), hash("x", "3.0"));
//! ```

use std::hash::{Hash, Hasher};

use rustc_hash::FxHashMap;

use crate::program::*;
use crate::ty::{Ty, TyKind};

/// Hash of a program, generic or residual: buffers, nodes, continuations and which of these are entries.
pub fn hash(p: &Program) -> u128 {
    let Program { nodes, types, locs: _, names: _, conts, buffers, entries } = p;
    let mut h = Content { fnv: Fnv(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d), types: FxHashMap::default() };
    h.list(buffers, |h, Buffer { name: _, kind, layout, columns }| {
        h.add((kind, layout));
        h.list(columns, |h, ColumnDecl { name: _, ty, time }| h.add((ty, time)));
    });
    h.list(nodes, |h, node| h.add(node));
    h.list(types, |h, ty| h.ty(*ty));
    h.list(conts, |h, Cont { name: _, role, params, filter, body, loc: _ }| {
        h.add((role, filter, body));
        h.list(params, |h, Param { ty, name: _, keep }| {
            h.ty(*ty);
            h.add(keep);
        });
    });
    h.list(entries, |h, (_, cont)| h.add(cont));
    h.fnv.0
}

/// Do two programs say the same, names and lines aside? Equal programs have equal hashes.
pub fn is_same(a: &Program, b: &Program) -> bool {
    fn all<T>(a: &[T], b: &[T], same: impl Fn(&T, &T) -> bool) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b))
    }
    let column = |a: &ColumnDecl, b: &ColumnDecl| (a.ty, a.time) == (b.ty, b.time);
    let buffer =
        |a: &Buffer, b: &Buffer| (a.kind, a.layout) == (b.kind, b.layout) && all(&a.columns, &b.columns, column);
    let param = |a: &Param, b: &Param| (a.ty, a.keep) == (b.ty, b.keep);
    let cont = |a: &Cont, b: &Cont| {
        (a.role, a.filter, &a.body) == (b.role, b.filter, &b.body) && all(&a.params, &b.params, param)
    };
    a.nodes == b.nodes
        && a.types == b.types
        && all(&a.conts, &b.conts, cont)
        && all(&a.buffers, &b.buffers, buffer)
        && all(&a.entries, &b.entries, |(_, a), (_, b)| a == b)
}

/// What has been hashed so far.
struct Content {
    fnv: Fnv,
    /// Types are numbered as they come, because a type written out may be exponentially larger than it is shared.
    types: FxHashMap<Ty, usize>,
}

impl Content {
    fn add(&mut self, x: impl Hash) {
        x.hash(&mut self.fnv);
    }

    fn list<T>(&mut self, elems: &[T], mut each: impl FnMut(&mut Content, &T)) {
        self.add(elems.len());
        elems.iter().for_each(|x| each(self, x));
    }

    /// A type by its content (its own `Hash` is that of an address). Nesting is as deep as the author wrote it.
    fn ty(&mut self, ty: Ty) {
        let known = self.types.get(&ty).copied();
        self.add(known);
        if known.is_some() {
            return;
        }
        self.add(std::mem::discriminant(ty.kind()));
        match ty.kind() {
            TyKind::Scalar(s) => self.add(s),
            TyKind::Vector(s, n) => self.add((s, n)),
            TyKind::Tuple(elems) | TyKind::Fn(elems) => self.list(elems, |h, ty| h.ty(*ty)),
            TyKind::Row(table) => self.add(table),
            TyKind::Local(s, n) => self.add((s, n)),
        }
        let number = self.types.len();
        self.types.insert(ty, number);
    }
}

/// FNV-1a.
struct Fnv(u128);

impl Hasher for Fnv {
    fn write(&mut self, bytes: &[u8]) {
        const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
        for byte in bytes {
            self.0 = (self.0 ^ u128::from(*byte)).wrapping_mul(PRIME);
        }
    }

    fn finish(&self) -> u64 {
        self.0 as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::op::Op;
    use crate::world::World;

    fn program(op: Op, ty: Ty, name: &str, loc: Loc) -> Program {
        let mut w = World::new();
        let param = |ty| Param { ty, name: Some(name.into()), keep: false };
        let f = w.cont(name, Role::Fun, vec![param(ty), param(Ty::func(&[ty]))], loc);
        let (x, ret) = (w.param(f, 0), w.param(f, 1));
        let y = w.prim(op, &[x, x], loc);
        w.name(y, name);
        w.set_body(f, Body::Jump { callee: ret, args: vec![y], mode: Mode::Filter }, loc);
        w.entry(name, f);
        w.finish()
    }

    #[test]
    fn names_and_lines_do_not_count_but_all_else_does() {
        let base = program(Op::Add, Ty::f32(), "f", Loc::NONE);
        let renamed = program(Op::Add, Ty::f32(), "g", Loc { file: "x.rs", line: 3 });
        assert!(hash(&renamed) == hash(&base) && is_same(&renamed, &base));
        let mut kept = base.clone();
        kept.conts[0].params[0].keep = true;
        let others = [program(Op::Mul, Ty::f32(), "f", Loc::NONE), program(Op::Add, Ty::i32(), "f", Loc::NONE), kept];
        assert!(others.iter().all(|p| hash(p) != hash(&base) && !is_same(p, &base)));
    }

    #[test]
    fn a_type_that_doubles_is_hashed_once() {
        let deep = (0..60).fold(Ty::f32(), |ty, _| Ty::tuple(&[ty, ty]));
        let mut w = World::new();
        w.cont("f", Role::Fun, vec![Param { ty: deep, name: None, keep: false }], Loc::NONE);
        hash(&w.finish());
    }

    #[test]
    fn the_hash_function_is_fnv() {
        // A test vector of FNV-1a, 128 bits: the byte "a".
        let mut h = Fnv(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d);
        h.write(b"a");
        assert_eq!(h.0, 0xd228_cb69_6f1a_8caf_7891_2b70_4e4a_8964);
    }
}
