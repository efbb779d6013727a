//! Types. A [`Ty`] is a copyable handle; equal types have equal handles in the whole process.
//!
//! There are four scalars, short vectors of them, tuples, continuations, rows of tables and local arrays. There are no
//! addresses: a reference is an index ([`TyKind::Row`] or a plain `u32`), and a buffer is a binding number that is known
//! wherever it is used.

use std::fmt;
use std::hash::{Hash, Hasher};
use std::sync::{LazyLock, Mutex};

use rustc_hash::FxHashSet;

use crate::program::BufId;

/// The scalar types. All are 32 bits wide in memory; a `bool` is stored as the `u32` 0 or 1.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub enum Scalar {
    /// `bool`
    Bool,
    /// `i32`, two's complement, wrapping
    I32,
    /// `u32`, wrapping
    U32,
    /// `f32`, IEEE 754 binary32
    F32,
}

impl Scalar {
    /// All scalars, in the order of declaration.
    pub const ALL: [Scalar; 4] = [Scalar::Bool, Scalar::I32, Scalar::U32, Scalar::F32];

    /// The word that the text uses.
    pub fn name(self) -> &'static str {
        match self {
            Scalar::Bool => "bool",
            Scalar::I32 => "i32",
            Scalar::U32 => "u32",
            Scalar::F32 => "f32",
        }
    }
}

/// What a type is. Made through the constructors of [`Ty`].
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub enum TyKind {
    /// One scalar.
    Scalar(Scalar),
    /// A short vector of 2 to 16 lanes.
    Vector(Scalar, u8),
    /// A tuple; `()` is the empty one.
    Tuple(Box<[Ty]>),
    /// A continuation that takes these parameters and never returns. A direct-style function is one whose last
    /// parameter is its return continuation.
    Fn(Box<[Ty]>),
    /// A row of a table: an index that remembers its table and, while specialising, its class.
    Row(BufId),
    /// A local array of so many scalars.
    Local(Scalar, u32),
}

/// A type.
#[derive(Clone, Copy)]
pub struct Ty(&'static TyKind);

/// Types are few (they follow the program's declarations) and live as long as the process.
static TYPES: LazyLock<Mutex<FxHashSet<&'static TyKind>>> = LazyLock::new(Default::default);

impl Ty {
    fn intern(kind: TyKind) -> Ty {
        let mut types = TYPES.lock().expect("no holder of this lock panics");
        if let Some(known) = types.get(&kind) {
            return Ty(known);
        }
        let kind: &'static TyKind = Box::leak(Box::new(kind));
        types.insert(kind);
        Ty(kind)
    }

    /// What this type is.
    pub fn kind(self) -> &'static TyKind {
        self.0
    }

    /// A scalar type.
    pub fn scalar(s: Scalar) -> Ty {
        static SCALARS: LazyLock<[Ty; 4]> = LazyLock::new(|| Scalar::ALL.map(|s| Ty::intern(TyKind::Scalar(s))));
        SCALARS[s as usize]
    }

    /// `bool`
    pub fn bool() -> Ty {
        Ty::scalar(Scalar::Bool)
    }

    /// `i32`
    pub fn i32() -> Ty {
        Ty::scalar(Scalar::I32)
    }

    /// `u32`
    pub fn u32() -> Ty {
        Ty::scalar(Scalar::U32)
    }

    /// `f32`
    pub fn f32() -> Ty {
        Ty::scalar(Scalar::F32)
    }

    /// A vector of `lanes` scalars.
    ///
    /// # Panics
    /// Unless `lanes` is 2 to 16.
    pub fn vector(s: Scalar, lanes: usize) -> Ty {
        assert!((2..=16).contains(&lanes), "a short vector has 2 to 16 lanes, not {lanes}");
        Ty::intern(TyKind::Vector(s, lanes as u8))
    }

    /// A tuple.
    pub fn tuple(elems: &[Ty]) -> Ty {
        Ty::intern(TyKind::Tuple(elems.into()))
    }

    /// A continuation taking `params`.
    pub fn func(params: &[Ty]) -> Ty {
        Ty::intern(TyKind::Fn(params.into()))
    }

    /// A row of `table`.
    pub fn row(table: BufId) -> Ty {
        Ty::intern(TyKind::Row(table))
    }

    /// A local array of `len` scalars.
    pub fn local(s: Scalar, len: u32) -> Ty {
        Ty::intern(TyKind::Local(s, len))
    }

    /// The scalar, if this is one.
    pub fn as_scalar(self) -> Option<Scalar> {
        match self.kind() {
            TyKind::Scalar(s) => Some(*s),
            _ => None,
        }
    }

    /// Scalar and lanes of a scalar (one lane) or a vector.
    pub fn lanes(self) -> Option<(Scalar, usize)> {
        match self.kind() {
            TyKind::Scalar(s) => Some((*s, 1)),
            TyKind::Vector(s, n) => Some((*s, *n as usize)),
            _ => None,
        }
    }

    /// The same shape (scalar or vector) with another scalar.
    pub fn with_scalar(self, s: Scalar) -> Ty {
        match self.lanes() {
            Some((_, n)) if n > 1 => Ty::vector(s, n),
            _ => Ty::scalar(s),
        }
    }

    /// The parameters, if this is a continuation type.
    pub fn params(self) -> Option<&'static [Ty]> {
        match self.kind() {
            TyKind::Fn(params) => Some(params),
            _ => None,
        }
    }

    /// Is this a continuation whose last parameter is a continuation, that is, a direct-style function?
    pub fn is_function(self) -> bool {
        self.params().and_then(|p| p.last()).is_some_and(|last| last.params().is_some())
    }

    /// Can a value of this type be a parameter of a residual continuation (a scalar or a vector)?
    pub fn is_data(self) -> bool {
        self.lanes().is_some()
    }
}

impl PartialEq for Ty {
    fn eq(&self, other: &Ty) -> bool {
        std::ptr::eq(self.0, other.0)
    }
}

impl Eq for Ty {}

impl Hash for Ty {
    fn hash<H: Hasher>(&self, state: &mut H) {
        std::ptr::hash(self.0, state);
    }
}

impl fmt::Display for Ty {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list = |f: &mut fmt::Formatter<'_>, elems: &[Ty]| {
            for (i, t) in elems.iter().enumerate() {
                write!(f, "{}{t}", if i > 0 { ", " } else { "" })?;
            }
            Ok(())
        };
        match self.kind() {
            TyKind::Scalar(s) => f.write_str(s.name()),
            TyKind::Vector(s, n) => write!(f, "{}x{n}", s.name()),
            TyKind::Tuple(elems) => {
                f.write_str("(")?;
                list(f, elems)?;
                f.write_str(")")
            }
            TyKind::Fn(params) => {
                f.write_str("fn(")?;
                list(f, params)?;
                f.write_str(")")
            }
            TyKind::Row(table) => write!(f, "row({})", table.0),
            TyKind::Local(s, n) => write!(f, "local({} {n})", s.name()),
        }
    }
}

impl fmt::Debug for Ty {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}
