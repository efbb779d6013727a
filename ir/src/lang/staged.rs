//! Staged records: how a Rust value spreads over the parameters of a continuation.

use crate::program::{NodeId, Param};
use crate::ty::Ty;

/// A value that can be passed to a continuation: it flattens to nodes and is made from nodes again.
///
/// Implemented for the scalars, rows, functions, tuples and arrays; for a struct by
/// [`impl_staged!`](crate::impl_staged).
pub trait Staged: Copy {
    /// Appends the parameters this type takes, named after `name`.
    fn params(name: &str, out: &mut Vec<Param>);
    /// Appends the nodes of this value, in the same order.
    fn flatten(&self, out: &mut Vec<NodeId>);
    /// Takes as many nodes as [`Staged::params`] declares.
    fn unflatten(nodes: &mut dyn Iterator<Item = NodeId>) -> Self;

    /// The nodes of this value.
    fn nodes(&self) -> Vec<NodeId> {
        let mut out = Vec::new();
        self.flatten(&mut out);
        out
    }

    /// The parameters of this type.
    fn all_params(name: &str) -> Vec<Param> {
        let mut out = Vec::new();
        Self::params(name, &mut out);
        out
    }

    /// The types of the parameters.
    fn types() -> Vec<Ty> {
        Self::all_params("").iter().map(|p| p.ty).collect()
    }
}

/// A parameter that stays specialised even where the call is not unfolded: any-hit or closest-hit, one traversal each.
#[derive(Clone, Copy)]
pub struct Keep<T>(pub T);

impl<T: Staged> Staged for Keep<T> {
    fn params(name: &str, out: &mut Vec<Param>) {
        let from = out.len();
        T::params(name, out);
        out[from..].iter_mut().for_each(|p| p.keep = true);
    }
    fn flatten(&self, out: &mut Vec<NodeId>) {
        self.0.flatten(out);
    }
    fn unflatten(nodes: &mut dyn Iterator<Item = NodeId>) -> Self {
        Keep(T::unflatten(nodes))
    }
}

/// A parameter of a leaf type.
pub(crate) fn leaf(name: &str, ty: Ty, out: &mut Vec<Param>) {
    out.push(Param { ty, name: (!name.is_empty()).then(|| name.into()), keep: false });
}

/// The next node of a value that is being made.
pub(crate) fn next(nodes: &mut dyn Iterator<Item = NodeId>) -> NodeId {
    nodes.next().expect("a value is made from as many nodes as it declares")
}

/// `outer_inner`, or whichever of the two there is.
#[doc(hidden)]
pub fn join_names(outer: &str, inner: &str) -> String {
    match (outer, inner) {
        ("", x) | (x, "") => x.to_string(),
        _ => format!("{outer}_{inner}"),
    }
}

macro_rules! tuples {
    ($(($($t:ident $i:tt),*))*) => { $(
        impl<$($t: Staged),*> Staged for ($($t,)*) {
            #[allow(unused_variables)] // the empty tuple uses neither
            fn params(name: &str, out: &mut Vec<Param>) { $($t::params(name, out);)* }
            #[allow(unused_variables)]
            fn flatten(&self, out: &mut Vec<NodeId>) { $(self.$i.flatten(out);)* }
            #[allow(unused_variables, clippy::unused_unit)]
            fn unflatten(nodes: &mut dyn Iterator<Item = NodeId>) -> Self { ($($t::unflatten(nodes),)*) }
        }
    )* };
}
tuples! { () (A 0) (A 0, B 1) (A 0, B 1, C 2) (A 0, B 1, C 2, D 3) (A 0, B 1, C 2, D 3, E 4) (A 0, B 1, C 2, D 3, E 4, F 5)
(A 0, B 1, C 2, D 3, E 4, F 5, G 6) (A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7) }

impl<T: Staged, const N: usize> Staged for [T; N] {
    fn params(name: &str, out: &mut Vec<Param>) {
        (0..N).for_each(|i| T::params(&join_names(name, &i.to_string()), out));
    }
    fn flatten(&self, out: &mut Vec<NodeId>) {
        self.iter().for_each(|x| x.flatten(out));
    }
    fn unflatten(nodes: &mut dyn Iterator<Item = NodeId>) -> Self {
        std::array::from_fn(|_| T::unflatten(nodes))
    }
}

/// Implements [`Staged`] for a struct with named fields. All fields are listed; one that is forgotten does not compile.
///
/// ```
/// use jerboa_ir::lang::*;
///
/// #[derive(Clone, Copy)]
/// struct Sample { x: F32, pdf: F32 }
/// jerboa_ir::impl_staged!(Sample { x, pdf });
/// assert_eq!(Sample::types().len(), 2);
/// ```
#[macro_export]
macro_rules! impl_staged {
    ($name:ident { $($field:ident),* $(,)? }) => {
        impl $crate::lang::Staged for $name {
            fn params(name: &str, out: &mut Vec<$crate::Param>) {
                /// One field's parameters; the struct names the type.
                fn field<T: $crate::lang::Staged>(
                    _: fn(&$name) -> &T, outer: &str, inner: &str, out: &mut Vec<$crate::Param>,
                ) {
                    T::params(&$crate::lang::staged::join_names(outer, inner), out);
                }
                $(field(|s| &s.$field, name, stringify!($field), out);)*
            }
            fn flatten(&self, out: &mut Vec<$crate::NodeId>) {
                let $name { $($field),* } = self;
                $($crate::lang::Staged::flatten($field, out);)*
            }
            fn unflatten(nodes: &mut dyn Iterator<Item = $crate::NodeId>) -> Self {
                $(let $field = $crate::lang::Staged::unflatten(nodes);)*
                $name { $($field),* }
            }
        }
    };
}
