//! A program: pure nodes that float, continuations that are placed, and the buffers they read and write.
//!
//! A [`Program`] is plain data, frozen and shareable between threads. A [`crate::World`] makes one. The generic program,
//! the residual and (in time) the vectorised program are all values of this one type; a residual is *first-order*: no
//! continuation is a value except as a jump's target, a branch's arm or a call's return.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use crate::lit::Lit;
use crate::op::Op;
use crate::ty::{Scalar, Ty};

/// A pure node, by its place in [`Program::nodes`]. Operands come before their users, parameters excepted.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct NodeId(pub u32);

/// A continuation, by its place in [`Program::conts`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct ContId(pub u32);

/// A buffer, by its place in [`Program::buffers`]: the binding number.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct BufId(pub u32);

/// A column of a buffer.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct Column {
    /// The buffer.
    pub buf: BufId,
    /// The column's place in [`Buffer::columns`].
    pub col: u32,
}

/// A pure node: a value without a place. Equal nodes are one node.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub enum Node {
    /// A literal.
    Lit(Lit),
    /// Parameter `index` of a continuation.
    Param {
        /// Whose parameter.
        cont: ContId,
        /// Which one.
        index: u32,
    },
    /// A continuation as a value: where the program is higher-order.
    Cont(ContId),
    /// A primitive operation over scalars, or lane by lane over vectors of equal length. Unused operands are
    /// [`NodeId::NONE`].
    Prim {
        /// The operation.
        op: Op,
        /// Its operands, [`Op::arity`] of them.
        args: [NodeId; 3],
    },
    /// A vector made of its lanes.
    Pack(Box<[NodeId]>),
    /// One lane of a vector.
    Lane {
        /// The vector.
        vector: NodeId,
        /// Which lane.
        lane: u8,
    },
    /// A tuple.
    Tuple(Box<[NodeId]>),
    /// A component of a tuple.
    Extract {
        /// The tuple.
        tuple: NodeId,
        /// Which component.
        index: u32,
    },
    /// What a table holds. Total: the index is clamped to the last row. `index` is a `u32`, a row of the same table, or a
    /// vector of `u32`, which gathers a vector of scalars.
    Read {
        /// What is read; the buffer is a table.
        column: Column,
        /// Of which row.
        index: NodeId,
    },
    /// The row of a table at a `u32` index; nothing is known of its class.
    Row {
        /// The table.
        table: BufId,
        /// The index.
        index: NodeId,
    },
    /// The row at a `u32` index that has the class of another row of the table. The author vouches for the class.
    Sibling {
        /// The row whose class it has.
        row: NodeId,
        /// The index.
        index: NodeId,
    },
    /// The `u32` index of a row.
    RowIndex(NodeId),
    /// Does the evaluator know this value? Occurs in filters only, so it never changes a result. A row is known when its
    /// class is.
    Known(NodeId),
}

impl NodeId {
    /// No node: an unused operand of [`Node::Prim`], the mask of a scalar [`Body::Store`].
    pub const NONE: NodeId = NodeId(u32::MAX);

    /// Place in a dense side table.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl ContId {
    /// Place in a dense side table.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl BufId {
    /// Place in a dense side table.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A line of the author's source.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Loc {
    /// File as the compiler names it.
    pub file: &'static str,
    /// Line, from 1.
    pub line: u32,
}

impl Loc {
    /// No source: a program that was read from text.
    pub const NONE: Loc = Loc { file: "", line: 0 };

    /// The line of the nearest caller that does not track its own caller.
    #[track_caller]
    pub fn caller() -> Loc {
        let at = std::panic::Location::caller();
        Loc { file: at.file(), line: at.line() }
    }
}

impl std::fmt::Display for Loc {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.line == 0 { f.write_str("?") } else { write!(f, "{}:{}", self.file, self.line) }
    }
}

/// A parameter of a continuation.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Param {
    /// Its type.
    pub ty: Ty,
    /// The author's name for it, a hint only.
    pub name: Option<Arc<str>>,
    /// Stays specialised even where the call is not unfolded.
    pub keep: bool,
}

/// What a continuation is for. It decides how it prints and which rules hold; evaluation follows the filter alone.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Role {
    /// A function or a named continuation of the author's.
    Fun,
    /// An arm of a branch, a switch or a dispatch.
    Arm,
    /// The rest of a function after a call or an effect.
    Rest,
    /// Where the arms of a branch meet. Two different closures must not (Law 4) unless the author asked for a copy
    /// per branch.
    Join,
    /// The header of a loop.
    Loop,
    /// The exit of a labelled block.
    Label,
}

impl Role {
    /// All roles, in the order of declaration.
    pub const ALL: [Role; 6] = [Role::Fun, Role::Arm, Role::Rest, Role::Join, Role::Loop, Role::Label];

    /// The word that the text uses.
    pub fn word(self) -> &'static str {
        match self {
            Role::Fun => "fun",
            Role::Arm => "arm",
            Role::Rest => "rest",
            Role::Join => "join",
            Role::Loop => "loop",
            Role::Label => "label",
        }
    }

    /// The role of this word.
    pub fn by_word(word: &str) -> Option<Role> {
        Role::ALL.into_iter().find(|role| role.word() == word)
    }
}

/// A continuation: parameters, a filter, and one jump.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Cont {
    /// Name, a hint only: the printer makes it unique.
    pub name: Arc<str>,
    /// What it is for.
    pub role: Role,
    /// Parameters.
    pub params: Vec<Param>,
    /// Whether a call of it is unfolded: a `bool` node over its parameters and what is in scope. The literal `true` is
    /// `@`, the literal `false` no filter.
    pub filter: NodeId,
    /// Its jump.
    pub body: Body,
    /// Where the author wrote it.
    pub loc: Loc,
}

/// How a call treats the callee's filter.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Mode {
    /// The filter decides.
    #[default]
    Filter,
    /// Unfold, whatever the filter says.
    Now,
    /// Leave the call, whatever the filter says.
    Later,
}

/// Memory that a placed load or store touches: a word, or the words of a vector.
///
/// The types say which. An index of `u32` and a scalar value: one word. A vector of `u32` and a vector of as many lanes:
/// lane by lane, at the index of each (a *gather*, a *scatter*; where indices are equal, the last lane's value stays).
/// A `u32` and a vector: a *run* of rows from that index on, where lane l is at index + l, wrapping. Clamping and dropping
/// is per lane.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Mem {
    /// A column of a stream. Loads clamp the index, stores out of range are dropped.
    Stream(Column),
    /// A column of a table whose indices were validated when the scene was loaded: `read_unchecked`, loads only. The index
    /// of each lane must be in range.
    Unchecked(Column),
    /// A local array (a node of type [`crate::TyKind::Local`]). Loads clamp, stores out of range are dropped.
    Local(NodeId),
}

/// A body: one jump, to a continuation or to one of the built-in ones.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub enum Body {
    /// Not written yet; the verifier refuses it.
    Unset,
    /// Jump to `callee` with `args`.
    Jump {
        /// A node of continuation type.
        callee: NodeId,
        /// Its arguments.
        args: Vec<NodeId>,
        /// Whether the callee's filter decides.
        mode: Mode,
    },
    /// Go on in one of two continuations without parameters.
    Branch {
        /// A `bool`.
        cond: NodeId,
        /// Taken when `cond` holds.
        then: NodeId,
        /// Taken otherwise.
        other: NodeId,
    },
    /// Go on in the arm whose number is `index` (an `u32`), else in `default`. Arms take no parameters; numbers ascend.
    Switch {
        /// A `u32`.
        index: NodeId,
        /// Number and continuation of each arm.
        arms: Vec<(u32, NodeId)>,
        /// Taken when no number fits.
        default: NodeId,
    },
    /// "Do it with this row": go on in `arm`, a continuation of one row. The evaluator may run the arm once per class of
    /// the table and leave a switch.
    Dispatch {
        /// A row.
        row: NodeId,
        /// `fn(row)`.
        arm: NodeId,
    },
    /// Load a scalar or a vector and pass it to `next`, whose parameter says which.
    Load {
        /// From where.
        mem: Mem,
        /// A `u32` or a vector of them.
        index: NodeId,
        /// `fn(value)`.
        next: NodeId,
    },
    /// Store a scalar or a vector and go on in `next`.
    Store {
        /// Where to; never [`Mem::Unchecked`].
        mem: Mem,
        /// A `u32` or a vector of them.
        index: NodeId,
        /// The value.
        value: NodeId,
        /// Which lanes are stored: a `bool` for each lane of a vector; [`NodeId::NONE`] for a scalar.
        mask: NodeId,
        /// `fn()`.
        next: NodeId,
    },
    /// Call `body(args…, i, k)` for each `i` from `lo` up to, not including, `hi`, where `k` is the end of an iteration; then
    /// go on in `next`. Iterations are independent: any order, and any number of them at once, gives the same bits
    /// ([`crate::verify_residual`] has the rules; from a column that iterations store to, they load within its rows).
    Vectorize {
        /// How many iterations to run at once, a hint: 4, 8 or 16.
        width: u8,
        /// The first index, a `u32`.
        lo: NodeId,
        /// One past the last index, a `u32`; no iteration where it is not above `lo`.
        hi: NodeId,
        /// `fn(args…, u32, fn())`.
        body: NodeId,
        /// What is the same in all iterations. Empty in generic programs, where the body captures it; in a residual the
        /// body is a function and captures nothing.
        args: Vec<NodeId>,
        /// `fn()`.
        next: NodeId,
    },
    /// Make a local array, all zero, and pass it to `next`. It lives until the enclosing function returns.
    Local {
        /// Element type.
        scalar: Scalar,
        /// Number of elements, at least 1.
        len: u32,
        /// `fn(local)`.
        next: NodeId,
    },
}

/// How a column's content is bound, Law 2.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub enum Time {
    /// Kinds, flags, counts, presences: known at level `structure` and above.
    Structure,
    /// Numbers: known at level `all` only.
    Value,
    /// Texels, vertices, trees: never known.
    Bulk,
}

/// Type of a column: all take one 32-bit word per row.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum ColTy {
    /// A scalar.
    Scalar(Scalar),
    /// A row of another table, stored as its index.
    Ref(BufId),
}

impl ColTy {
    /// The type of a value read from it.
    pub fn ty(self) -> Ty {
        match self {
            ColTy::Scalar(s) => Ty::scalar(s),
            ColTy::Ref(table) => Ty::row(table),
        }
    }
}

/// A column's declaration.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub struct ColumnDecl {
    /// Name.
    pub name: Arc<str>,
    /// Type.
    pub ty: ColTy,
    /// Binding time; [`Time::Bulk`] for streams.
    pub time: Time,
}

/// What a buffer is.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum BufKind {
    /// Read-only in a kernel; at least one row. Rows with equal known columns form classes; if `classed`, column 0 is a
    /// `u32` that holds each row's class, so that a residual can switch on it.
    Table {
        /// Has column 0 the class?
        classed: bool,
    },
    /// Read and written by kernels.
    Stream,
}

/// How rows and columns lie in memory; a word is 32 bits.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Layout {
    /// Row by row: word of (row, col) = row · columns + col.
    Rows,
    /// Column by column: word of (row, col) = col · rows + row.
    Columns,
}

/// A buffer's declaration: a binding. Distinct bindings never alias.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub struct Buffer {
    /// Name.
    pub name: Arc<str>,
    /// Table or stream.
    pub kind: BufKind,
    /// Memory layout.
    pub layout: Layout,
    /// Columns.
    pub columns: Vec<ColumnDecl>,
}

impl Buffer {
    /// The word that holds `(row, col)` when the buffer has `rows` rows.
    pub fn word(&self, rows: usize, row: usize, col: usize) -> usize {
        match self.layout {
            Layout::Rows => row * self.columns.len() + col,
            Layout::Columns => col * rows + row,
        }
    }
}

/// A program. See the module's page.
#[derive(Clone, Default, Debug)]
pub struct Program {
    /// Pure nodes.
    pub nodes: Vec<Node>,
    /// Type of each node.
    pub types: Vec<Ty>,
    /// Where each node was first made.
    pub locs: Vec<Loc>,
    /// Names the author gave to nodes, hints only.
    pub names: FxHashMap<NodeId, Arc<str>>,
    /// Continuations.
    pub conts: Vec<Cont>,
    /// Buffers, by binding number.
    pub buffers: Vec<Buffer>,
    /// Kernels: name and continuation, whose last parameter is its return `fn()`.
    pub entries: Vec<(Arc<str>, ContId)>,
}

impl Program {
    /// The node.
    pub fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.index()]
    }

    /// The type of a node.
    pub fn ty(&self, id: NodeId) -> Ty {
        self.types[id.index()]
    }

    /// The continuation.
    pub fn cont(&self, id: ContId) -> &Cont {
        &self.conts[id.index()]
    }

    /// The buffer.
    pub fn buffer(&self, id: BufId) -> &Buffer {
        &self.buffers[id.index()]
    }

    /// The column's declaration.
    pub fn column(&self, c: Column) -> &ColumnDecl {
        &self.buffer(c.buf).columns[c.col as usize]
    }

    /// The type of a continuation as a value.
    pub fn cont_ty(&self, id: ContId) -> Ty {
        Ty::func(&self.cont(id).params.iter().map(|p| p.ty).collect::<Vec<_>>())
    }

    /// What a load that goes on in `next` gives: the type of the one parameter.
    pub fn loaded(&self, next: NodeId) -> Option<Ty> {
        match self.ty(next).params() {
            Some([ty]) => Some(*ty),
            _ => None,
        }
    }

    /// The literal, if the node is one.
    pub fn as_lit(&self, id: NodeId) -> Option<Lit> {
        match self.node(id) {
            Node::Lit(lit) => Some(*lit),
            _ => None,
        }
    }

    /// The entry of this name.
    pub fn entry(&self, name: &str) -> Option<ContId> {
        self.entries.iter().find(|(n, _)| &**n == name).map(|(_, c)| *c)
    }

    /// Calls `f` for each operand of a node.
    pub fn operands(&self, id: NodeId, f: &mut dyn FnMut(NodeId)) {
        match self.node(id) {
            Node::Lit(_) | Node::Param { .. } | Node::Cont(_) => {}
            Node::Prim { op, args } => args[..op.arity()].iter().copied().for_each(f),
            Node::Pack(elems) | Node::Tuple(elems) => elems.iter().copied().for_each(f),
            Node::Sibling { row, index } => [*row, *index].into_iter().for_each(f),
            Node::Lane { vector: x, .. }
            | Node::Extract { tuple: x, .. }
            | Node::Read { index: x, .. }
            | Node::Row { index: x, .. }
            | Node::RowIndex(x)
            | Node::Known(x) => f(*x),
        }
    }
}

impl Body {
    /// Calls `f` for each node that the jump uses: data first, continuations last.
    pub fn operands(&self, f: &mut dyn FnMut(NodeId)) {
        let mem = |m: &Mem, f: &mut dyn FnMut(NodeId)| {
            if let Mem::Local(x) = m {
                f(*x)
            }
        };
        match self {
            Body::Unset => {}
            Body::Jump { callee, args, .. } => {
                args.iter().copied().for_each(&mut *f);
                f(*callee)
            }
            Body::Branch { cond, then, other } => [*cond, *then, *other].into_iter().for_each(f),
            Body::Switch { index, arms, default } => {
                f(*index);
                arms.iter().for_each(|(_, arm)| f(*arm));
                f(*default)
            }
            Body::Dispatch { row, arm } => [*row, *arm].into_iter().for_each(f),
            Body::Load { mem: m, index, next } => {
                mem(m, f);
                f(*index);
                f(*next)
            }
            Body::Store { mem: m, index, value, mask, next } => {
                mem(m, f);
                f(*index);
                f(*value);
                if *mask != NodeId::NONE {
                    f(*mask);
                }
                f(*next)
            }
            Body::Vectorize { lo, hi, body, args, next, .. } => {
                args.iter().chain([lo, hi, body, next]).copied().for_each(f)
            }
            Body::Local { next, .. } => f(*next),
        }
    }
}
