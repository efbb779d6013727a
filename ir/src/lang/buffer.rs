//! Buffers in the language: tables, streams and local arrays.

use std::marker::PhantomData;

use crate::lang::block::Block;
use crate::lang::fun::always;
use crate::lang::staged::{Staged, leaf, next};
use crate::lang::value::{Bool, F32, I32, U32};
use crate::lang::vector::Vector;
use crate::lang::{here, with};
use crate::program::*;
use crate::ty::{Scalar, Ty};

/// A staged scalar that memory can hold.
pub trait Elem: Staged {
    /// Its scalar type.
    const SCALAR: Scalar;
}

macro_rules! elems {
    ($($name:ident $scalar:ident),+) => { $(impl Elem for $name { const SCALAR: Scalar = Scalar::$scalar; })+ };
}
elems! { F32 F32, I32 I32, U32 U32, Bool Bool }

/// A column's declaration, as data that host code can read too.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ColumnSpec {
    /// Name.
    pub name: &'static str,
    /// Type of its words.
    pub ty: SpecTy,
    /// Binding time.
    pub time: Time,
}

/// Type of a declared column.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SpecTy {
    /// A scalar.
    Scalar(Scalar),
    /// A row of the table of this name.
    Ref(&'static str),
}

/// A buffer's declaration, as a type. Made by [`table!`](crate::table) and [`stream!`](crate::stream).
pub trait Buf: Copy + 'static {
    /// Name of the buffer.
    const NAME: &'static str;
    /// Table or stream.
    const KIND: BufKind;
    /// Memory layout.
    const LAYOUT: Layout;
    /// Its columns. A classed table has its class first.
    const COLUMNS: &'static [ColumnSpec];
}

/// The number of a buffer in the world.
fn id(name: &str) -> BufId {
    with(|w| {
        let at = w.program().buffers.iter().position(|b| &*b.name == name);
        BufId(at.unwrap_or_else(|| panic!("buffer `{name}` is not declared: see lang::declare")) as u32)
    })
}

/// A buffer's declaration as a value: see [`spec`].
pub type Spec = (&'static str, BufKind, Layout, &'static [ColumnSpec]);

/// The declaration of a buffer type, for [`declare`].
pub const fn spec<B: Buf>() -> Spec {
    (B::NAME, B::KIND, B::LAYOUT, B::COLUMNS)
}

/// Declare all buffers of a program, in order of their binding numbers.
///
/// # Panics
/// When a column refers to a table that is not in the list.
pub fn declare(specs: &[Spec]) {
    let at =
        |name: &str| BufId(specs.iter().position(|s| s.0 == name).expect("a column refers to a declared table") as u32);
    for (name, kind, layout, columns) in specs {
        let column = |c: &ColumnSpec| ColumnDecl {
            name: c.name.into(),
            ty: match c.ty {
                SpecTy::Scalar(s) => ColTy::Scalar(s),
                SpecTy::Ref(table) => ColTy::Ref(at(table)),
            },
            time: c.time,
        };
        let columns = columns.iter().map(column).collect();
        with(|w| w.buffer(Buffer { name: (*name).into(), kind: *kind, layout: *layout, columns }));
    }
}

/// A column of buffer `B` whose values are `T`.
pub struct Col<B, T>(pub u32, PhantomData<fn(B) -> T>);

impl<B, T> Clone for Col<B, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<B, T> Copy for Col<B, T> {}

impl<B: Buf, T> Col<B, T> {
    /// Column `index` of the declaration.
    pub const fn new(index: u32) -> Self {
        Col(index, PhantomData)
    }

    fn column(self) -> Column {
        Column { buf: id(B::NAME), col: self.0 }
    }
}

/// A row of table `B`.
pub struct Row<B>(NodeId, PhantomData<B>);

impl<B> Clone for Row<B> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<B> Copy for Row<B> {}

impl<B: Buf> Staged for Row<B> {
    fn params(name: &str, out: &mut Vec<Param>) {
        leaf(name, Ty::row(id(B::NAME)), out);
    }
    fn flatten(&self, out: &mut Vec<NodeId>) {
        out.push(self.0);
    }
    fn unflatten(nodes: &mut dyn Iterator<Item = NodeId>) -> Self {
        Row(next(nodes), PhantomData)
    }
}

impl<B: Buf> Row<B> {
    /// The row at an index; nothing is known of its class.
    #[track_caller]
    pub fn at(index: impl Into<U32>) -> Row<B> {
        let (table, loc, index) = (id(B::NAME), here(), index.into());
        Row(with(|w| w.row(table, index.node(), loc)), PhantomData)
    }

    /// The row at an index that has the class of this one: the host has sorted by class what the index comes from. A kernel
    /// that is specialised for the class of one row so knows that of all.
    #[track_caller]
    pub fn sibling(self, index: impl Into<U32>) -> Row<B> {
        let (loc, index) = (here(), index.into());
        Row(with(|w| w.sibling(self.0, index.node(), loc)), PhantomData)
    }

    /// Its index.
    #[track_caller]
    pub fn index(self) -> U32 {
        let loc = here();
        U32::from_node(with(|w| w.row_index(self.0, loc)))
    }

    /// What the table holds in this column. Pure and total: an index beyond the last row reads the last row.
    #[track_caller]
    pub fn get<T: Staged>(self, column: Col<B, T>) -> T {
        let (column, loc) = (column.column(), here());
        let node = with(|w| w.read(column, self.0, loc));
        T::unflatten(&mut [node].into_iter())
    }

    /// The node behind the handle.
    pub fn node(self) -> NodeId {
        self.0
    }
}

/// A local array of scalars.
pub struct Array<T>(NodeId, PhantomData<T>);

impl<T> Clone for Array<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Array<T> {}

impl Block {
    fn load_from<T: Staged>(&mut self, mem: Mem, index: U32, loc: Loc) -> T {
        let (rest, value) = Block::continuation::<T>("loaded", Role::Rest, always(), loc);
        let next = with(|w| w.cont_value(rest));
        self.leave(Body::Load { mem, index: index.node(), next }, loc);
        *self = Block::new(rest);
        value
    }

    fn store_to(&mut self, mem: Mem, index: U32, value: NodeId, mask: NodeId, loc: Loc) {
        let (rest, ()) = Block::continuation("stored", Role::Rest, always(), loc);
        let next = with(|w| w.cont_value(rest));
        self.leave(Body::Store { mem, index: index.node(), value, mask, next }, loc);
        *self = Block::new(rest);
    }

    /// Load from a stream; the index is clamped to the last row.
    #[track_caller]
    pub fn load<B: Buf, T: Elem>(&mut self, column: Col<B, T>, index: impl Into<U32>) -> T {
        self.load_from(Mem::Stream(column.column()), index.into(), here())
    }

    /// Load from a table at an index that was validated when the scene was loaded; it is not clamped.
    #[track_caller]
    pub fn read_unchecked<B: Buf, T: Elem>(&mut self, column: Col<B, T>, index: impl Into<U32>) -> T {
        self.load_from(Mem::Unchecked(column.column()), index.into(), here())
    }

    /// As [`Block::read_unchecked`], of `N` rows from this one on.
    #[track_caller]
    pub fn read_run<B: Buf, T: Elem, const N: usize>(
        &mut self,
        column: Col<B, T>,
        first: impl Into<U32>,
    ) -> Vector<T, N> {
        self.load_from(Mem::Unchecked(column.column()), first.into(), here())
    }

    /// Store to a stream; out of range it does nothing.
    #[track_caller]
    pub fn store<B: Buf, T: Elem>(&mut self, column: Col<B, T>, index: impl Into<U32>, value: impl Into<T>) {
        let nodes = value.into().nodes();
        self.store_to(Mem::Stream(column.column()), index.into(), nodes[0], NodeId::NONE, here());
    }

    /// A local array of `len` zeros.
    #[track_caller]
    pub fn array<T: Elem>(&mut self, len: u32) -> Array<T> {
        let loc = here();
        let ty = Ty::local(T::SCALAR, len);
        let (rest, node) = with(|w| {
            let param = Param { ty, name: Some("array".into()), keep: false };
            let rest = w.cont("array", Role::Rest, vec![param], loc);
            (rest, w.param(rest, 0))
        });
        let next = with(|w| w.cont_value(rest));
        self.leave(Body::Local { scalar: T::SCALAR, len, next }, loc);
        *self = Block::new(rest);
        Array(node, PhantomData)
    }

    /// Element of a local array; the index is clamped to the last one.
    #[track_caller]
    pub fn get<T: Elem>(&mut self, array: Array<T>, index: impl Into<U32>) -> T {
        self.load_from(Mem::Local(array.0), index.into(), here())
    }

    /// Set an element of a local array; out of range it does nothing.
    #[track_caller]
    pub fn set<T: Elem>(&mut self, array: Array<T>, index: impl Into<U32>, value: impl Into<T>) {
        let nodes = value.into().nodes();
        self.store_to(Mem::Local(array.0), index.into(), nodes[0], NodeId::NONE, here());
    }

    /// `N` elements of a local array from this one on; each index is clamped to the last one.
    #[track_caller]
    pub fn get_run<T: Elem, const N: usize>(&mut self, array: Array<T>, first: impl Into<U32>) -> Vector<T, N> {
        self.load_from(Mem::Local(array.0), first.into(), here())
    }

    /// Set `N` elements of a local array from this one on; out of range it does nothing.
    #[track_caller]
    pub fn set_run<T: Elem, const N: usize>(&mut self, array: Array<T>, first: impl Into<U32>, value: Vector<T, N>) {
        let (nodes, all) = (value.nodes(), Vector::<Bool, N>::splat(true).nodes());
        self.store_to(Mem::Local(array.0), first.into(), nodes[0], all[0], here());
    }
}

/// Declares a table: a type with one constant per column. Columns are `NAME: type, time;` where the type is `F32`, `I32`,
/// `U32`, `Bool` or `ref Table`, and the time `structure`, `value` or `bulk`. A table declared `classed` gets its class
/// as column 0.
///
/// ```
/// use jerboa_ir::lang::*;
///
/// jerboa_ir::table! {
///     /// Paints.
///     pub classed Paints {
///         /// Is there gloss?
///         GLOSSY: Bool, structure;
///         /// How much.
///         GLOSS: F32, value;
///     }
/// }
/// assert_eq!(Paints::COLUMNS.len(), 3);
/// ```
#[macro_export]
macro_rules! table {
    ($(#[$doc:meta])* $vis:vis classed $name:ident { $($body:tt)* }) => {
        $crate::buffer_type! { $(#[$doc])* $vis $name, $crate::BufKind::Table { classed: true }, $crate::Layout::Rows,
            { /// The row's class.
              CLASS: U32, structure; $($body)* } }
    };
    ($(#[$doc:meta])* $vis:vis $name:ident { $($body:tt)* }) => {
        $crate::buffer_type! { $(#[$doc])* $vis $name, $crate::BufKind::Table { classed: false }, $crate::Layout::Rows,
            { $($body)* } }
    };
}

/// Declares a stream: a type with one constant per column, `NAME: type;`. It lies column by column, `rows` row by row.
#[macro_export]
macro_rules! stream {
    ($(#[$doc:meta])* $vis:vis rows $name:ident { $($(#[$cdoc:meta])* $col:ident: $ty:ident;)* }) => {
        $crate::buffer_type! { $(#[$doc])* $vis $name, $crate::BufKind::Stream, $crate::Layout::Rows,
            { $($(#[$cdoc])* $col: $ty, bulk;)* } }
    };
    ($(#[$doc:meta])* $vis:vis $name:ident { $($(#[$cdoc:meta])* $col:ident: $ty:ident;)* }) => {
        $crate::buffer_type! { $(#[$doc])* $vis $name, $crate::BufKind::Stream, $crate::Layout::Columns,
            { $($(#[$cdoc])* $col: $ty, bulk;)* } }
    };
}

/// The common part of [`table!`](crate::table) and [`stream!`](crate::stream).
#[doc(hidden)]
#[macro_export]
macro_rules! buffer_type {
    ($(#[$doc:meta])* $vis:vis $name:ident, $kind:expr, $layout:expr, { $($body:tt)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        $vis struct $name;

        impl $crate::lang::Buf for $name {
            const NAME: &'static str = stringify!($name);
            const KIND: $crate::BufKind = $kind;
            const LAYOUT: $crate::Layout = $layout;
            const COLUMNS: &'static [$crate::lang::ColumnSpec] = $crate::buffer_type!(@specs [] $($body)*);
        }

        $crate::buffer_type! { @consts $name 0, $($body)* }
    };
    (@specs [$($done:expr,)*]) => { &[$($done,)*] };
    (@specs [$($done:expr,)*] $(#[$doc:meta])* $col:ident: ref $table:ident, $time:ident; $($rest:tt)*) => {
        $crate::buffer_type!(@specs [$($done,)* $crate::lang::ColumnSpec {
            name: stringify!($col), ty: $crate::lang::buffer::SpecTy::Ref(stringify!($table)),
            time: $crate::buffer_type!(@time $time),
        },] $($rest)*)
    };
    (@specs [$($done:expr,)*] $(#[$doc:meta])* $col:ident: $ty:ident, $time:ident; $($rest:tt)*) => {
        $crate::buffer_type!(@specs [$($done,)* $crate::lang::ColumnSpec {
            name: stringify!($col),
            ty: $crate::lang::buffer::SpecTy::Scalar(<$crate::lang::$ty as $crate::lang::Elem>::SCALAR),
            time: $crate::buffer_type!(@time $time),
        },] $($rest)*)
    };
    (@time structure) => { $crate::Time::Structure };
    (@time value) => { $crate::Time::Value };
    (@time bulk) => { $crate::Time::Bulk };
    (@consts $name:ident $index:expr,) => {};
    (@consts $name:ident $index:expr, $(#[$doc:meta])* $col:ident: ref $table:ident, $time:ident; $($rest:tt)*) => {
        impl $name {
            $(#[$doc])*
            pub const $col: $crate::lang::Col<$name, $crate::lang::Row<$table>> = $crate::lang::Col::new($index);
        }
        $crate::buffer_type! { @consts $name $index + 1, $($rest)* }
    };
    (@consts $name:ident $index:expr, $(#[$doc:meta])* $col:ident: $ty:ident, $time:ident; $($rest:tt)*) => {
        impl $name {
            $(#[$doc])*
            pub const $col: $crate::lang::Col<$name, $crate::lang::$ty> = $crate::lang::Col::new($index);
        }
        $crate::buffer_type! { @consts $name $index + 1, $($rest)* }
    };
}
