//! Values in lane code, and the nodes that are made of them.

use jerboa_ir::op::Rule;
use jerboa_ir::*;

use super::shape::Shape;

/// A value of the scalar program as lane code has it, by its shape.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Value {
    /// The very value.
    Uniform(NodeId),
    /// That of lane 0.
    Consecutive(NodeId),
    /// A vector over the lanes; for a short vector of the program, one for each of its elements.
    Varying(Vec<NodeId>),
}

impl Value {
    pub fn shape(&self) -> Shape {
        match self {
            Value::Uniform(_) => Shape::Uniform,
            Value::Consecutive(_) => Shape::Consecutive,
            Value::Varying(_) => Shape::Varying,
        }
    }

    /// The nodes it is made of.
    pub fn nodes(&self) -> &[NodeId] {
        match self {
            Value::Uniform(x) | Value::Consecutive(x) => std::slice::from_ref(x),
            Value::Varying(parts) => parts,
        }
    }

    /// A value of this shape made of the next nodes. `ty` is its type in the scalar program.
    pub fn of(ty: Ty, shape: Shape, nodes: &mut impl Iterator<Item = NodeId>) -> Value {
        let mut next = || nodes.next().expect("there is a node for each part");
        match shape {
            Shape::Uniform => Value::Uniform(next()),
            Shape::Consecutive => Value::Consecutive(next()),
            Shape::Varying => Value::Varying((0..elements(ty)).map(|_| next()).collect()),
        }
    }
}

/// Scalars in a value of the scalar program.
pub(crate) fn elements(ty: Ty) -> usize {
    ty.lanes().map_or(1, |(_, n)| n)
}

/// The types of the nodes that a value of this shape is made of.
pub(crate) fn parts(ty: Ty, shape: Shape, width: usize) -> Vec<Ty> {
    match (shape, ty.lanes()) {
        (Shape::Varying, Some((scalar, n))) => vec![Ty::vector(scalar, width); n],
        _ => vec![ty],
    }
}

/// Makes nodes for a number of lanes.
pub(crate) struct Writer {
    pub w: World,
    /// Number of lanes.
    pub width: usize,
    /// Where the author wrote what is being made.
    pub loc: Loc,
}

impl Writer {
    /// A block or a function without a body, and its parameters.
    pub fn cont(&mut self, name: &str, role: Role, types: &[Ty], loc: Loc) -> (ContId, Vec<NodeId>) {
        let params = types.iter().map(|ty| Param { ty: *ty, name: None, keep: false }).collect();
        let cont = self.w.cont(name, role, params, loc);
        let filter = self.w.lit(Lit::Bool(false));
        self.w.cont_mut(cont).filter = filter;
        (cont, self.w.params(cont))
    }

    /// Call a value by the author's name, unless it has one.
    pub fn name(&mut self, value: &Value, name: &str) {
        for x in value.nodes() {
            match *self.w.program().node(*x) {
                Node::Lit(_) => {}
                Node::Param { cont, index } => {
                    self.w.cont_mut(cont).params[index as usize].name.get_or_insert_with(|| name.into());
                }
                _ => self.w.name(*x, name),
            }
        }
    }

    /// Go on elsewhere.
    pub fn jump(&mut self, from: ContId, to: ContId, args: Vec<NodeId>) {
        let callee = self.w.cont_value(to);
        self.w.set_body(from, Body::Jump { callee, args, mode: Mode::Filter }, self.loc);
    }

    /// The same in all lanes.
    pub fn splat(&mut self, x: NodeId) -> NodeId {
        self.w.pack(&vec![x; self.width], self.loc)
    }

    /// A literal in all lanes.
    pub fn splat_lit(&mut self, lit: Lit) -> NodeId {
        let x = self.w.lit(lit);
        self.splat(x)
    }

    /// 0, 1, 2, …
    pub fn iota(&mut self, scalar: Scalar) -> NodeId {
        let number = |l: u32| if scalar == Scalar::I32 { Lit::I32(l as i32) } else { Lit::U32(l) };
        let lanes: Vec<NodeId> = (0..self.width as u32).map(|l| self.w.lit(number(l))).collect();
        self.w.pack(&lanes, self.loc)
    }

    /// A vector of each element.
    pub fn widen(&mut self, value: &Value) -> Vec<NodeId> {
        match value {
            Value::Varying(parts) => parts.clone(),
            Value::Uniform(x) => match elements(self.w.program().ty(*x)) {
                1 => vec![self.splat(*x)],
                n => {
                    let lanes: Vec<NodeId> = (0..n).map(|i| self.w.lane(*x, i, self.loc)).collect();
                    lanes.into_iter().map(|x| self.splat(x)).collect()
                }
            },
            Value::Consecutive(base) => {
                let scalar = self.w.program().ty(*base).as_scalar().expect("an integer");
                let (base, iota) = (self.splat(*base), self.iota(scalar));
                vec![self.w.prim(Op::Add, &[base, iota], self.loc)]
            }
        }
    }

    /// The vector of a value that is a scalar in the scalar program.
    pub fn vector(&mut self, value: &Value) -> NodeId {
        self.widen(value)[0]
    }

    /// A value as one of this shape. Only widening is possible: the analysis has found no smaller shape.
    pub fn shaped(&mut self, value: Value, shape: Shape) -> Value {
        match shape {
            Shape::Varying => Value::Varying(self.widen(&value)),
            _ => {
                assert_eq!(value.shape(), shape, "the analysis holds for what is written");
                value
            }
        }
    }

    /// A value like this one, all zero: where nobody looks at it.
    pub fn zero_like(&mut self, value: &Value) -> Value {
        let mut zero = |x: &NodeId| {
            let (scalar, n) = self.w.program().ty(*x).lanes().expect("it is data");
            let zero = self.w.lit(Lit::from_word(scalar, 0));
            if n == 1 { zero } else { self.w.pack(&vec![zero; n], Loc::NONE) }
        };
        match value {
            Value::Uniform(x) => Value::Uniform(zero(x)),
            Value::Consecutive(x) => Value::Consecutive(zero(x)),
            Value::Varying(parts) => Value::Varying(parts.iter().map(zero).collect()),
        }
    }

    // ---- masks

    /// Is it known to be the same in all lanes?
    pub fn known_mask(&self, mask: NodeId) -> Option<bool> {
        let p = self.w.program();
        let Node::Pack(lanes) = p.node(mask) else { return None };
        let first = p.as_lit(lanes[0])?.as_bool()?;
        lanes.iter().all(|l| *l == lanes[0]).then_some(first)
    }

    /// Lanes of both.
    pub fn and(&mut self, a: NodeId, b: NodeId) -> NodeId {
        match (self.known_mask(a), self.known_mask(b)) {
            (Some(true), _) | (_, Some(false)) => b,
            (Some(false), _) | (_, Some(true)) => a,
            _ if a == b => a,
            _ => self.w.prim(Op::And, &[a, b], self.loc),
        }
    }

    /// Lanes of either.
    pub fn or(&mut self, a: NodeId, b: NodeId) -> NodeId {
        match (self.known_mask(a), self.known_mask(b)) {
            (Some(false), _) | (_, Some(true)) => b,
            (Some(true), _) | (_, Some(false)) => a,
            _ if a == b => a,
            _ => self.w.prim(Op::Or, &[a, b], self.loc),
        }
    }

    /// Lanes of `a` that are not in `b`.
    pub fn without(&mut self, a: NodeId, b: NodeId) -> NodeId {
        let not_b = self.w.prim(Op::Not, &[b], self.loc);
        self.and(a, not_b)
    }

    /// `a` where the mask holds, else `b`.
    pub fn select(&mut self, mask: NodeId, a: &Value, b: &Value) -> Value {
        if a == b || self.known_mask(mask) == Some(true) {
            return a.clone();
        }
        let (a, b) = (self.widen(a), self.widen(b));
        Value::Varying(a.into_iter().zip(b).map(|(a, b)| self.pick(mask, a, b)).collect())
    }

    fn pick(&mut self, mask: NodeId, a: NodeId, b: NodeId) -> NodeId {
        match (self.known_mask(mask), self.known_mask(a), self.known_mask(b)) {
            _ if a == b => a,
            (Some(known), ..) => [b, a][known as usize],
            // Of masks, of which one is all or nothing.
            (_, Some(true), _) => self.or(mask, b),
            (_, Some(false), _) => self.without(b, mask),
            (_, _, Some(false)) => self.and(mask, a),
            (_, _, Some(true)) => {
                let others = self.w.prim(Op::Not, &[mask], self.loc);
                self.or(others, a)
            }
            _ => self.w.prim(Op::Select, &[mask, a, b], self.loc),
        }
    }

    // ---- operations

    /// An operation of the scalar program, whose result is of type `ty` there.
    pub fn op(&mut self, op: Op, args: &[Value], ty: Ty) -> Value {
        let shapes: Vec<Shape> = args.iter().map(Value::shape).collect();
        let shape = Shape::of_op(op, &shapes, ty);
        if shape != Shape::Varying {
            let nodes: Vec<NodeId> = args.iter().map(|a| a.nodes()[0]).collect();
            let node = self.w.prim(op, &nodes, self.loc);
            return if shape == Shape::Uniform { Value::Uniform(node) } else { Value::Consecutive(node) };
        }
        let args: Vec<Vec<NodeId>> = args.iter().map(|a| self.widen(a)).collect();
        if let Rule::Lanes(_) = op.rule() {
            return Value::Varying(vec![self.over_elements(op, &args[0])]);
        }
        let element = |i: usize| args.iter().map(|parts| parts[i]).collect::<Vec<_>>();
        Value::Varying((0..elements(ty)).map(|i| self.lanewise(op, &element(i))).collect())
    }

    /// An operation in each lane.
    fn lanewise(&mut self, op: Op, args: &[NodeId]) -> NodeId {
        match (op, args) {
            (Op::Select, [mask, a, b]) => self.pick(*mask, *a, *b),
            (Op::And, [a, b]) if self.is_mask(*a) => self.and(*a, *b),
            (Op::Or, [a, b]) if self.is_mask(*a) => self.or(*a, *b),
            _ => self.w.prim(op, args, self.loc),
        }
    }

    fn is_mask(&self, x: NodeId) -> bool {
        self.w.program().ty(x).lanes().is_some_and(|(s, _)| s == Scalar::Bool)
    }

    /// `any`, `all` or `ballot` of a short vector of the program, in each lane.
    fn over_elements(&mut self, op: Op, elements: &[NodeId]) -> NodeId {
        let mut all = Vec::new();
        for (i, element) in elements.iter().enumerate() {
            all.push(match op {
                Op::Ballot => {
                    let (bit, place) =
                        (self.w.prim(Op::Bits, &[*element], self.loc), self.splat_lit(Lit::U32(i as u32)));
                    self.w.prim(Op::Shl, &[bit, place], self.loc)
                }
                _ => *element,
            });
        }
        let fold = if op == Op::All { Op::And } else { Op::Or };
        all.into_iter().reduce(|a, b| self.lanewise(fold, &[a, b])).expect("a vector has lanes")
    }

    /// A short vector of these elements.
    pub fn pack(&mut self, elements: &[Value]) -> Value {
        if elements.iter().all(|e| e.shape() == Shape::Uniform) {
            let nodes: Vec<NodeId> = elements.iter().map(|e| e.nodes()[0]).collect();
            return Value::Uniform(self.w.pack(&nodes, self.loc));
        }
        Value::Varying(elements.iter().map(|e| self.vector(e)).collect())
    }

    /// An element of a short vector.
    pub fn element(&mut self, vector: &Value, i: usize) -> Value {
        match vector {
            Value::Varying(parts) => Value::Varying(vec![parts[i]]),
            other => Value::Uniform(self.w.lane(other.nodes()[0], i, self.loc)),
        }
    }

    /// A read of a table.
    pub fn read(&mut self, column: Column, index: &Value) -> Value {
        match index {
            Value::Uniform(index) => Value::Uniform(self.w.read(column, *index, self.loc)),
            other => {
                let index = self.vector(other);
                Value::Varying(vec![self.w.read(column, index, self.loc)])
            }
        }
    }
}
