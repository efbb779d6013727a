//! Scalars: copyable handles with operators. They take host literals on either side, and have no `PartialEq`, so a host
//! comparison does not compile.

use std::ops;

use crate::lang::staged::{Staged, leaf, next};
use crate::lang::{here, with};
use crate::lit::Lit;
use crate::op::Op;
use crate::program::{Loc, NodeId, Param};
use crate::ty::Ty;

/// Make an operation.
pub(crate) fn prim(op: Op, args: &[NodeId], loc: Loc) -> NodeId {
    with(|w| w.prim(op, args, loc))
}

macro_rules! scalar {
    ($(#[$doc:meta])* $name:ident $host:ty, $ty:ident, $lit:expr) => {
        $(#[$doc])*
        #[derive(Clone, Copy)]
        pub struct $name(pub(crate) NodeId);

        impl $name {
            /// The node behind the handle.
            pub fn node(self) -> NodeId { self.0 }

            /// A handle on a node of this type.
            pub fn from_node(node: NodeId) -> $name { $name(node) }

            /// Give the value a name for dumps.
            pub fn named(self, name: &str) -> $name {
                with(|w| w.name(self.0, name));
                self
            }

            /// self = other, IEEE for floats.
            #[track_caller]
            pub fn eq(self, other: impl Into<$name>) -> Bool { Bool(prim(Op::Eq, &[self.0, other.into().0], here())) }

            /// Not self = other.
            #[track_caller]
            pub fn ne(self, other: impl Into<$name>) -> Bool { Bool(prim(Op::Ne, &[self.0, other.into().0], here())) }
        }

        impl From<$host> for $name {
            fn from(x: $host) -> $name {
                let lit: fn($host) -> Lit = $lit;
                $name(with(|w| w.lit(lit(x))))
            }
        }

        impl Staged for $name {
            fn params(name: &str, out: &mut Vec<Param>) { leaf(name, Ty::$ty(), out); }
            fn flatten(&self, out: &mut Vec<NodeId>) { out.push(self.0); }
            fn unflatten(nodes: &mut dyn Iterator<Item = NodeId>) -> Self { $name(next(nodes)) }
        }
    };
}

scalar! { /// A staged `f32`.
F32 f32, f32, Lit::f32 }
scalar! { /// A staged `i32`.
I32 i32, i32, Lit::I32 }
scalar! { /// A staged `u32`.
U32 u32, u32, Lit::U32 }
scalar! { /// A staged `bool`. `&` and `|` do not short-circuit: use [`crate::lang::Block::if_`] to skip work.
Bool bool, bool, Lit::Bool }

/// A binary operator between handles and with host literals on both sides.
macro_rules! binary {
    ($($name:ident $host:ty: $($trait:ident $method:ident $op:ident),+;)+) => { $($(
        impl ops::$trait for $name {
            type Output = $name;
            #[track_caller]
            fn $method(self, other: $name) -> $name { $name(prim(Op::$op, &[self.0, other.0], here())) }
        }
        impl ops::$trait<$host> for $name {
            type Output = $name;
            #[track_caller]
            fn $method(self, other: $host) -> $name { $name(prim(Op::$op, &[self.0, $name::from(other).0], here())) }
        }
        impl ops::$trait<$name> for $host {
            type Output = $name;
            #[track_caller]
            fn $method(self, other: $name) -> $name { $name(prim(Op::$op, &[$name::from(self).0, other.0], here())) }
        }
    )+)+ };
}
binary! {
    F32 f32: Add add Add, Sub sub Sub, Mul mul Mul, Div div Div;
    I32 i32: Add add Add, Sub sub Sub, Mul mul Mul, Div div Div, Rem rem Rem, BitAnd bitand And, BitOr bitor Or, BitXor bitxor Xor;
    U32 u32: Add add Add, Sub sub Sub, Mul mul Mul, Div div Div, Rem rem Rem, BitAnd bitand And, BitOr bitor Or, BitXor bitxor Xor;
    Bool bool: BitAnd bitand And, BitOr bitor Or, BitXor bitxor Xor;
}

/// A unary operator.
macro_rules! unary {
    ($($name:ident $trait:ident $method:ident $op:ident;)+) => { $(
        impl ops::$trait for $name {
            type Output = $name;
            #[track_caller]
            fn $method(self) -> $name { $name(prim(Op::$op, &[self.0], here())) }
        }
    )+ };
}
unary! { F32 Neg neg Neg; I32 Neg neg Neg; I32 Not not Not; U32 Not not Not; Bool Not not Not; }

/// Methods of ordered scalars.
macro_rules! ordered {
    ($($name:ident)+) => { $(impl $name {
        /// self < other
        #[track_caller]
        pub fn lt(self, other: impl Into<$name>) -> Bool { Bool(prim(Op::Lt, &[self.0, other.into().0], here())) }
        /// self ≤ other
        #[track_caller]
        pub fn le(self, other: impl Into<$name>) -> Bool { Bool(prim(Op::Le, &[self.0, other.into().0], here())) }
        /// self > other
        #[track_caller]
        pub fn gt(self, other: impl Into<$name>) -> Bool { Bool(prim(Op::Gt, &[self.0, other.into().0], here())) }
        /// self ≥ other
        #[track_caller]
        pub fn ge(self, other: impl Into<$name>) -> Bool { Bool(prim(Op::Ge, &[self.0, other.into().0], here())) }
        /// self < other ? self : other, so `other` when either is NaN.
        #[track_caller]
        pub fn min(self, other: impl Into<$name>) -> $name { $name(prim(Op::Min, &[self.0, other.into().0], here())) }
        /// self > other ? self : other, so `other` when either is NaN.
        #[track_caller]
        pub fn max(self, other: impl Into<$name>) -> $name { $name(prim(Op::Max, &[self.0, other.into().0], here())) }
    })+ };
}
ordered! { F32 I32 U32 }

/// Methods of one operand.
macro_rules! methods {
    ($($name:ident { $($(#[$doc:meta])* $method:ident $op:ident -> $out:ident;)+ })+) => { $(impl $name { $(
        $(#[$doc])*
        #[track_caller]
        pub fn $method(self) -> $out { $out(prim(Op::$op, &[self.0], here())) }
    )+ })+ };
}
methods! {
    F32 {
        /// |self|
        abs Abs -> F32;
        /// Square root, correctly rounded; NaN below −0.
        sqrt Sqrt -> F32;
        /// Largest integer not above.
        floor Floor -> F32;
        /// Smallest integer not below.
        ceil Ceil -> F32;
        /// Integer part, towards zero.
        trunc Trunc -> F32;
        /// Nearest integer, ties to even.
        round Round -> F32;
        /// Truncated; NaN gives 0, out of range the nearest bound.
        to_i32 ToI32 -> I32;
        /// Truncated; NaN gives 0, out of range the nearest bound.
        to_u32 ToU32 -> U32;
        /// The bits; 0x7fc00000 for every NaN.
        bits Bits -> U32;
    }
    I32 {
        /// |self|, wrapping.
        abs Abs -> I32;
        /// The nearest float.
        to_f32 ToF32 -> F32;
        /// Two's complement.
        bits Bits -> U32;
    }
    U32 {
        /// The nearest float.
        to_f32 ToF32 -> F32;
        /// The float with these bits.
        float_of_bits FloatOfBits -> F32;
        /// The signed integer with these bits.
        int_of_bits IntOfBits -> I32;
    }
    Bool {
        /// 0 or 1.
        bits Bits -> U32;
    }
}

impl F32 {
    /// self · a + c, rounded once. Only where it is measured to be worth it: GPUs may not fuse.
    #[track_caller]
    pub fn fma(self, a: impl Into<F32>, c: impl Into<F32>) -> F32 {
        F32(prim(Op::Fma, &[self.0, a.into().0, c.into().0], here()))
    }

    /// The absorbing product: +0 when either is ±0, whatever the other is.
    #[track_caller]
    pub fn absorb(self, other: impl Into<F32>) -> F32 {
        F32(prim(Op::Absorb, &[self.0, other.into().0], here()))
    }

    /// Is it NaN? By the bits, since some drivers fold x ≠ x.
    #[track_caller]
    pub fn is_nan(self) -> Bool {
        (self.bits() & 0x7fff_ffffu32).gt(0x7f80_0000u32)
    }

    /// The magnitude of self with the sign of `sign`.
    #[track_caller]
    pub fn copysign(self, sign: F32) -> F32 {
        ((self.bits() & 0x7fff_ffffu32) | (sign.bits() & 0x8000_0000u32)).float_of_bits()
    }
}

/// Shifts by an amount modulo 32; `>>` of an `i32` is arithmetic.
macro_rules! shifts {
    ($($name:ident $trait:ident $method:ident;)+) => { $(
        impl ops::$trait<U32> for $name {
            type Output = $name;
            #[track_caller]
            fn $method(self, n: U32) -> $name { $name(prim(Op::$trait, &[self.0, n.0], here())) }
        }
        impl ops::$trait<u32> for $name {
            type Output = $name;
            #[track_caller]
            fn $method(self, n: u32) -> $name { $name(prim(Op::$trait, &[self.0, U32::from(n).0], here())) }
        }
    )+ };
}
shifts! { I32 Shl shl; I32 Shr shr; U32 Shl shl; U32 Shr shr; }

impl Bool {
    /// `self ? a : b`, field by field. Both are computed; use [`crate::lang::Block::if_`] to skip work.
    #[track_caller]
    pub fn select<T: Staged>(self, a: T, b: T) -> T {
        let loc = here();
        let pairs = a.nodes().into_iter().zip(b.nodes());
        let nodes: Vec<NodeId> = pairs.map(|(x, y)| select(self, x, y, loc)).collect();
        T::unflatten(&mut nodes.into_iter())
    }
}

/// Selects a data node; a row is chosen by its index, a function cannot be (Law 4).
fn select(c: Bool, x: NodeId, y: NodeId, loc: Loc) -> NodeId {
    if x == y {
        return x;
    }
    with(|w| match w.program().ty(x).kind() {
        crate::ty::TyKind::Row(table) => {
            let (x, y) = (w.row_index(x, loc), w.row_index(y, loc));
            let index = w.prim(Op::Select, &[c.0, x, y], loc);
            w.row(*table, index, loc)
        }
        _ => w.prim(Op::Select, &[c.0, x, y], loc),
    })
}
