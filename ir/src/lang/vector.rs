//! Short explicit vectors of scalars. `any`, `all` and `ballot` speak of their elements, never of lanes around them.

use std::marker::PhantomData;
use std::ops;

use crate::lang::staged::{Staged, leaf, next};
use crate::lang::value::{Bool, F32, I32, U32, prim};
use crate::lang::{Elem, here, with};
use crate::op::Op;
use crate::program::{NodeId, Param};
use crate::ty::Ty;

/// A vector of `N` elements, 2 to 16.
pub struct Vector<T, const N: usize>(NodeId, PhantomData<T>);

impl<T, const N: usize> Clone for Vector<T, N> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T, const N: usize> Copy for Vector<T, N> {}

impl<T: Elem, const N: usize> Staged for Vector<T, N> {
    fn params(name: &str, out: &mut Vec<Param>) {
        leaf(name, Ty::vector(T::SCALAR, N), out);
    }
    fn flatten(&self, out: &mut Vec<NodeId>) {
        out.push(self.0);
    }
    fn unflatten(nodes: &mut dyn Iterator<Item = NodeId>) -> Self {
        Vector(next(nodes), PhantomData)
    }
}

impl<T: Elem, const N: usize> Vector<T, N> {
    fn make(op: Op, args: &[NodeId], loc: crate::program::Loc) -> Self {
        Vector(prim(op, args, loc), PhantomData)
    }

    /// A vector of these elements.
    #[track_caller]
    pub fn new(elems: [T; N]) -> Self {
        let (nodes, loc) = (elems.nodes(), here());
        Vector(with(|w| w.pack(&nodes, loc)), PhantomData)
    }

    /// The same element everywhere.
    #[track_caller]
    pub fn splat(x: impl Into<T>) -> Self {
        Self::new([x.into(); N])
    }

    /// Element `i`.
    #[track_caller]
    pub fn extract(self, i: usize) -> T {
        let loc = here();
        let lane = with(|w| w.lane(self.0, i, loc));
        T::unflatten(&mut [lane].into_iter())
    }

    /// All elements.
    #[track_caller]
    pub fn elems(self) -> [T; N] {
        std::array::from_fn(|i| self.extract(i))
    }

    /// The vector with element `i` replaced.
    #[track_caller]
    pub fn insert(self, i: usize, x: impl Into<T>) -> Self {
        let mut elems = self.elems();
        elems[i] = x.into();
        Self::new(elems)
    }

    /// Elements in another order, or repeated.
    #[track_caller]
    pub fn shuffle<const M: usize>(self, from: [usize; M]) -> Vector<T, M> {
        Vector::new(from.map(|i| self.extract(i)))
    }

    /// Combine all elements as a balanced tree of pairs, which fixes the order of roundings.
    #[track_caller]
    pub fn reduce(self, combine: impl Fn(T, T) -> T) -> T {
        let mut elems = self.elems().to_vec();
        while elems.len() > 1 {
            elems = elems.chunks(2).map(|c| if let [a, b] = c { combine(*a, *b) } else { c[0] }).collect();
        }
        elems[0]
    }

    /// Element by element: self = other.
    #[track_caller]
    pub fn eq(self, other: Self) -> Vector<Bool, N> {
        Vector::make(Op::Eq, &[self.0, other.0], here())
    }
}

/// Arithmetic of numeric vectors.
macro_rules! numeric {
    ($($elem:ident)+) => { $(
        numeric!(@op $elem Add add, Sub sub, Mul mul, Div div);
        impl<const N: usize> Vector<$elem, N> {
            /// Element by element: self < other.
            #[track_caller]
            pub fn lt(self, other: Self) -> Vector<Bool, N> { Vector::make(Op::Lt, &[self.0, other.0], here()) }
            /// Element by element: self ≤ other.
            #[track_caller]
            pub fn le(self, other: Self) -> Vector<Bool, N> { Vector::make(Op::Le, &[self.0, other.0], here()) }
            /// Element by element: self > other.
            #[track_caller]
            pub fn gt(self, other: Self) -> Vector<Bool, N> { Vector::make(Op::Gt, &[self.0, other.0], here()) }
            /// Element by element: self ≥ other.
            #[track_caller]
            pub fn ge(self, other: Self) -> Vector<Bool, N> { Vector::make(Op::Ge, &[self.0, other.0], here()) }
            /// Element by element: self < other ? self : other.
            #[track_caller]
            pub fn min(self, other: Self) -> Self { Vector::make(Op::Min, &[self.0, other.0], here()) }
            /// Element by element: self > other ? self : other.
            #[track_caller]
            pub fn max(self, other: Self) -> Self { Vector::make(Op::Max, &[self.0, other.0], here()) }
        }
    )+ };
    (@op $elem:ident $($trait:ident $method:ident),+) => { $(
        impl<const N: usize> ops::$trait for Vector<$elem, N> {
            type Output = Self;
            #[track_caller]
            fn $method(self, other: Self) -> Self { Vector::make(Op::$trait, &[self.0, other.0], here()) }
        }
    )+ };
}
numeric! { F32 I32 U32 }

impl<const N: usize> Vector<F32, N> {
    /// Element by element: see [`F32::fma`].
    #[track_caller]
    pub fn fma(self, a: Self, c: Self) -> Self {
        Vector::make(Op::Fma, &[self.0, a.0, c.0], here())
    }

    /// Element by element: see [`F32::bits`].
    #[track_caller]
    pub fn bits(self) -> Vector<U32, N> {
        Vector::make(Op::Bits, &[self.0], here())
    }
}

impl<const N: usize> Vector<U32, N> {
    /// Element by element: see [`U32::float_of_bits`].
    #[track_caller]
    pub fn float_of_bits(self) -> Vector<F32, N> {
        Vector::make(Op::FloatOfBits, &[self.0], here())
    }
}

/// Bitwise (or logical) operations.
macro_rules! logic {
    ($($elem:ident)+) => { $(logic!(@op $elem BitAnd bitand And, BitOr bitor Or);)+ };
    (@op $elem:ident $($trait:ident $method:ident $op:ident),+) => { $(
        impl<const N: usize> ops::$trait for Vector<$elem, N> {
            type Output = Self;
            #[track_caller]
            fn $method(self, other: Self) -> Self { Vector::make(Op::$op, &[self.0, other.0], here()) }
        }
    )+ };
}
logic! { Bool U32 }

impl<const N: usize> Vector<Bool, N> {
    /// Does any element hold?
    #[track_caller]
    pub fn any(self) -> Bool {
        Bool(prim(Op::Any, &[self.0], here()))
    }

    /// Do all elements hold?
    #[track_caller]
    pub fn all(self) -> Bool {
        Bool(prim(Op::All, &[self.0], here()))
    }

    /// Bit i is element i.
    #[track_caller]
    pub fn ballot(self) -> U32 {
        U32(prim(Op::Ballot, &[self.0], here()))
    }

    /// Element by element: `self ? a : b`.
    #[track_caller]
    pub fn select<T: Elem>(self, a: Vector<T, N>, b: Vector<T, N>) -> Vector<T, N> {
        Vector::make(Op::Select, &[self.0, a.0, b.0], here())
    }
}
