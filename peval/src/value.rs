//! What the evaluator knows of a value.

use jerboa_ir::{BufId, ContId, NodeId};
use rustc_hash::FxHashMap;

/// An activation of a continuation, by its place in [`crate::frame::Frames`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub(crate) struct FrameId(pub u32);

/// A tuple, by its place in [`Tuples`]; equal tuples have equal ids.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) struct TupleId(pub u32);

/// A value while specialising. Equal values are identical: everything behind an id is hash-consed.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum Value {
    /// Not computed yet, or left out of a lifted environment because nobody reads it.
    Nothing,
    /// A scalar or a vector: a node of the residual. It is known when that node is a literal.
    Data(NodeId),
    /// A tuple of values.
    Tuple(TupleId),
    /// A continuation and the frame of its parent in the nesting tree.
    Closure(ContId, FrameId),
    /// A row of a table: its class, if known, and its `u32` index, a node of the residual.
    Row {
        /// The table.
        table: BufId,
        /// The class; [`NO_CLASS`] if unknown.
        class: u32,
        /// The index.
        index: NodeId,
    },
    /// A local array: a parameter of the residual.
    Local(NodeId),
    /// The return of the residual function that is being made: a parameter of continuation type.
    Exit(NodeId),
}

/// The class of a row of unknown class.
pub(crate) const NO_CLASS: u32 = u32::MAX;

/// Interned tuples.
#[derive(Default)]
pub(crate) struct Tuples {
    all: Vec<Box<[Value]>>,
    index: FxHashMap<Box<[Value]>, TupleId>,
}

impl Tuples {
    /// The tuple of these values.
    pub fn make(&mut self, elems: &[Value]) -> Value {
        if let Some(id) = self.index.get(elems) {
            return Value::Tuple(*id);
        }
        let id = TupleId(self.all.len() as u32);
        self.all.push(elems.into());
        self.index.insert(elems.into(), id);
        Value::Tuple(id)
    }

    /// Its components.
    pub fn elems(&self, id: TupleId) -> &[Value] {
        &self.all[id.0 as usize]
    }
}
