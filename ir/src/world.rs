//! The world: makes a program. Equal nodes are made once; continuations are made first and filled later.

use std::hash::{Hash, Hasher};
use std::sync::Arc;

use rustc_hash::{FxHashMap, FxHasher};

use crate::fold::{Folded, fold};
use crate::lit::Lit;
use crate::op::Op;
use crate::program::*;
use crate::ty::{Ty, TyKind};
use crate::typing::type_of;

/// Builds a [`Program`]. Node constructors panic with the author's line when the types do not fit: that is a mistake of
/// the program's author, never of a scene.
#[derive(Default)]
pub struct World {
    program: Program,
    /// The latest node of each hash of content.
    latest: FxHashMap<u64, NodeId>,
    /// For each node, the one before it with the same hash; collisions are resolved by comparison.
    before: Vec<NodeId>,
    /// Functions that are made once, by name.
    shared: FxHashMap<&'static str, NodeId>,
}

impl World {
    /// An empty world.
    pub fn new() -> World {
        World::default()
    }

    /// The program as far as it is made.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// The function that is shared by this name, once it is made.
    pub fn shared(&self, name: &str) -> Option<NodeId> {
        self.shared.get(name).copied()
    }

    /// Share a function by this name.
    pub fn share(&mut self, name: &'static str, function: NodeId) {
        self.shared.insert(name, function);
    }

    /// The finished program.
    pub fn finish(self) -> Program {
        self.program
    }

    /// A node as it stands, without folding. `ty` must be its type.
    pub fn node(&mut self, node: Node, ty: Ty, loc: Loc) -> NodeId {
        let mut hasher = FxHasher::default();
        node.hash(&mut hasher);
        let id = NodeId(self.program.nodes.len() as u32);
        let latest = self.latest.entry(hasher.finish()).or_insert(NodeId::NONE);
        let mut known = *latest;
        while known != NodeId::NONE {
            if self.program.nodes[known.index()] == node {
                return known;
            }
            known = self.before[known.index()];
        }
        self.before.push(std::mem::replace(latest, id));
        self.program.nodes.push(node);
        self.program.types.push(ty);
        self.program.locs.push(loc);
        id
    }

    /// A literal.
    pub fn lit(&mut self, lit: Lit) -> NodeId {
        self.node(Node::Lit(lit), lit.ty(), Loc::NONE)
    }

    /// An operation over scalars or vectors, folded where running would give the same bits.
    ///
    /// # Panics
    /// When the operands do not fit the operation's rule.
    #[track_caller]
    pub fn prim(&mut self, op: Op, args: &[NodeId], loc: Loc) -> NodeId {
        let mut types = [Ty::bool(); 3];
        types.iter_mut().zip(args).for_each(|(ty, a)| *ty = self.program.ty(*a));
        let ty = op.result(&types[..args.len()]).unwrap_or_else(|why| panic!("{loc}: {why}"));
        if let Some((_, lanes)) = types[0].lanes()
            && lanes > 1
            && let Some(folded) = self.fold_lanes(op, args, lanes, loc)
        {
            return folded;
        }
        if types[0].as_scalar().is_some() {
            match fold(self, op, args) {
                Some(Folded::Lit(lit)) => return self.lit(lit),
                Some(Folded::Node(node)) => return node,
                None => {}
            }
        }
        let mut padded = [NodeId::NONE; 3];
        padded[..args.len()].copy_from_slice(args);
        self.node(Node::Prim { op, args: padded }, ty, loc)
    }

    /// A vector operation whose operands are all made of literals.
    fn fold_lanes(&mut self, op: Op, args: &[NodeId], lanes: usize, loc: Loc) -> Option<NodeId> {
        let known: Vec<Vec<Lit>> = args.iter().map(|a| self.lit_lanes(*a)).collect::<Option<_>>()?;
        if matches!(op.rule(), crate::op::Rule::Lanes(_)) {
            return Some(self.lit(op.eval(&known[0])));
        }
        let column = |lane: usize| known.iter().map(|k| k[lane]).collect::<Vec<_>>();
        let lits: Vec<NodeId> = (0..lanes).map(|lane| self.lit(op.eval(&column(lane)))).collect();
        Some(self.pack(&lits, loc))
    }

    fn lit_lanes(&self, vector: NodeId) -> Option<Vec<Lit>> {
        match self.program.node(vector) {
            Node::Pack(elems) => elems.iter().map(|e| self.program.as_lit(*e)).collect(),
            _ => None,
        }
    }

    /// A vector of these lanes.
    ///
    /// # Panics
    /// Unless they are 2 to 16 scalars of one type.
    #[track_caller]
    pub fn pack(&mut self, lanes: &[NodeId], loc: Loc) -> NodeId {
        let scalar = self.program.ty(lanes[0]);
        assert!(lanes.iter().all(|l| self.program.ty(*l) == scalar), "{loc}: the lanes of a vector have one type");
        let scalar = scalar.as_scalar().unwrap_or_else(|| panic!("{loc}: the lanes of a vector are scalars"));
        // A vector taken apart and put together again is itself.
        if let Node::Lane { vector, lane: 0 } = *self.program.node(lanes[0])
            && self.program.ty(vector) == Ty::vector(scalar, lanes.len())
            && lanes.iter().enumerate().all(|(i, l)| *self.program.node(*l) == Node::Lane { vector, lane: i as u8 })
        {
            return vector;
        }
        self.node(Node::Pack(lanes.into()), Ty::vector(scalar, lanes.len()), loc)
    }

    /// One lane of a vector.
    ///
    /// # Panics
    /// Unless the vector has that lane.
    #[track_caller]
    pub fn lane(&mut self, vector: NodeId, lane: usize, loc: Loc) -> NodeId {
        let (scalar, lanes) = self.program.ty(vector).lanes().unwrap_or_else(|| panic!("{loc}: not a vector"));
        assert!(lanes > 1 && lane < lanes, "{loc}: lane {lane} of {lanes}");
        match self.program.node(vector) {
            Node::Pack(elems) => elems[lane],
            _ => self.node(Node::Lane { vector, lane: lane as u8 }, Ty::scalar(scalar), loc),
        }
    }

    /// A tuple.
    pub fn tuple(&mut self, elems: &[NodeId], loc: Loc) -> NodeId {
        let ty = Ty::tuple(&elems.iter().map(|e| self.program.ty(*e)).collect::<Vec<_>>());
        self.node(Node::Tuple(elems.into()), ty, loc)
    }

    /// A component of a tuple.
    ///
    /// # Panics
    /// Unless the tuple has it.
    #[track_caller]
    pub fn extract(&mut self, tuple: NodeId, index: usize, loc: Loc) -> NodeId {
        let ty = match self.program.ty(tuple).kind() {
            TyKind::Tuple(elems) if index < elems.len() => elems[index],
            _ => panic!("{loc}: no component {index} in {}", self.program.ty(tuple)),
        };
        match self.program.node(tuple) {
            Node::Tuple(elems) => elems[index],
            _ => self.node(Node::Extract { tuple, index: index as u32 }, ty, loc),
        }
    }

    /// What a table holds in this column, of the row at a `u32` index or of a row of this table; of the rows at a vector
    /// of indices, a vector.
    ///
    /// # Panics
    /// When the buffer is a stream or the index is none of these.
    #[track_caller]
    pub fn read(&mut self, column: Column, index: NodeId, loc: Loc) -> NodeId {
        let read = Node::Read { column, index };
        let ty = type_of(&self.program, &read).unwrap_or_else(|why| panic!("{loc}: {why}"));
        self.node(read, ty, loc)
    }

    /// The row of a table at a `u32` index.
    ///
    /// # Panics
    /// When the index is no `u32`.
    #[track_caller]
    pub fn row(&mut self, table: BufId, index: NodeId, loc: Loc) -> NodeId {
        assert!(self.program.ty(index) == Ty::u32(), "{loc}: a row is made at a u32");
        self.node(Node::Row { table, index }, Ty::row(table), loc)
    }

    /// The row at a `u32` index that has the class of `row`.
    ///
    /// # Panics
    /// When `row` is no row or the index is no `u32`.
    #[track_caller]
    pub fn sibling(&mut self, row: NodeId, index: NodeId, loc: Loc) -> NodeId {
        let ty = self.program.ty(row);
        assert!(matches!(ty.kind(), TyKind::Row(_)), "{loc}: not a row");
        assert!(self.program.ty(index) == Ty::u32(), "{loc}: a row is made at a u32");
        self.node(Node::Sibling { row, index }, ty, loc)
    }

    /// The index of a row.
    ///
    /// # Panics
    /// When it is no row.
    #[track_caller]
    pub fn row_index(&mut self, row: NodeId, loc: Loc) -> NodeId {
        assert!(matches!(self.program.ty(row).kind(), TyKind::Row(_)), "{loc}: not a row");
        match *self.program.node(row) {
            Node::Row { index, .. } | Node::Sibling { index, .. } => index,
            _ => self.node(Node::RowIndex(row), Ty::u32(), loc),
        }
    }

    /// Is the value known to the evaluator? For filters.
    pub fn known(&mut self, x: NodeId, loc: Loc) -> NodeId {
        self.node(Node::Known(x), Ty::bool(), loc)
    }

    /// A parameter of a continuation.
    pub fn param(&mut self, cont: ContId, index: usize) -> NodeId {
        let param = &self.program.cont(cont).params[index];
        let (ty, loc) = (param.ty, self.program.cont(cont).loc);
        self.node(Node::Param { cont, index: index as u32 }, ty, loc)
    }

    /// All parameters of a continuation.
    pub fn params(&mut self, cont: ContId) -> Vec<NodeId> {
        (0..self.program.cont(cont).params.len()).map(|i| self.param(cont, i)).collect()
    }

    /// A continuation as a value.
    pub fn cont_value(&mut self, cont: ContId) -> NodeId {
        let ty = self.program.cont_ty(cont);
        self.node(Node::Cont(cont), ty, self.program.cont(cont).loc)
    }

    /// A new continuation without a body; its filter is `true`.
    pub fn cont(&mut self, name: impl Into<Arc<str>>, role: Role, params: Vec<Param>, loc: Loc) -> ContId {
        let filter = self.lit(Lit::Bool(true));
        let id = ContId(self.program.conts.len() as u32);
        self.program.conts.push(Cont { name: name.into(), role, params, filter, body: Body::Unset, loc });
        id
    }

    /// The continuation, to fill in its body, its filter or its parameters' hints.
    pub fn cont_mut(&mut self, cont: ContId) -> &mut Cont {
        &mut self.program.conts[cont.index()]
    }

    /// Set the body. A continuation has one.
    ///
    /// # Panics
    /// When it has a body already: two calls on the same path, or a block left twice.
    #[track_caller]
    pub fn set_body(&mut self, cont: ContId, body: Body, loc: Loc) {
        let c = &mut self.program.conts[cont.index()];
        assert!(c.body == Body::Unset, "{loc}: this path has already left `{}`; nothing may follow it", c.name);
        c.body = body;
    }

    /// Give a node a name for dumps; the first name stays.
    pub fn name(&mut self, node: NodeId, name: &str) {
        self.program.names.entry(node).or_insert_with(|| name.into());
    }

    /// Declare a buffer.
    pub fn buffer(&mut self, buffer: Buffer) -> BufId {
        self.program.buffers.push(buffer);
        BufId(self.program.buffers.len() as u32 - 1)
    }

    /// The buffer, to add columns that refer to later tables.
    pub fn buffer_mut(&mut self, buffer: BufId) -> &mut Buffer {
        &mut self.program.buffers[buffer.index()]
    }

    /// Declare an entry: a kernel.
    pub fn entry(&mut self, name: impl Into<Arc<str>>, cont: ContId) {
        self.program.entries.push((name.into(), cont));
    }
}
