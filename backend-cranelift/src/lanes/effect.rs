//! Effects in lane code: loads, stores, local arrays and calls.
//!
//! | scalar program | lane code |
//! |---|---|
//! | load of a stream at a uniform index | the same, one scalar for all lanes |
//! | load, store of a stream at a consecutive index | a run |
//! | load, store at a varying index | a gather, a scatter |
//! | unchecked load at a varying index | a gather, inactive lanes at index 0 |
//! | element e of a local array of n elements | the run e·W … e·W + W − 1 of one of n·W elements, W the number of lanes |
//! | call | call of the lane version, or of the very function if all arguments are uniform |
//!
//! Stores take the mask. Loads need none, because they clamp.

use jerboa_ir::*;

use super::Fault;
use super::function::Writing;
use super::shape::Shape;
use super::value::{Value, parts};

impl Writing<'_, '_> {
    /// The effect of a block's body, and what it gives to the next one.
    pub(super) fn effect(&mut self, cont: ContId) -> Result<Vec<Value>, Fault> {
        let p = self.lanes.p;
        match &p.cont(cont).body {
            Body::Load { mem, index, .. } => Ok(vec![self.load(*mem, *index)]),
            Body::Store { mem, index, value, .. } => {
                self.store(*mem, *index, *value);
                Ok(Vec::new())
            }
            Body::Local { scalar, len, next } => {
                self.array(*scalar, *len, *next);
                Ok(Vec::new())
            }
            Body::Vectorize { .. } => Err(Fault::Nested { name: p.cont(cont).name.clone(), loc: p.cont(cont).loc }),
            // All arms of a branch or a switch lead to the same block.
            _ => Ok(Vec::new()),
        }
    }

    fn load(&mut self, mem: Mem, index: NodeId) -> Value {
        self.stay_alive();
        let p = self.lanes.p;
        let index = self.value(index);
        let mask = self.path_mut().mask();
        let (mem, scalar, index) = match mem {
            Mem::Local(array) => {
                let (array, scalar, index) = self.element(array, &index, true);
                (Mem::Local(array), scalar, index)
            }
            Mem::Stream(column) | Mem::Unchecked(column) => {
                let w = &mut self.lanes.writer;
                let trusted = matches!(mem, Mem::Unchecked(_)) && index.shape() != Shape::Uniform;
                let zero = Value::Uniform(w.w.lit(Lit::U32(0)));
                let index = if trusted { w.select(mask, &index, &zero) } else { index };
                (mem, p.column(column).ty.ty().as_scalar().unwrap_or(Scalar::U32), index)
            }
        };
        let uniform = index.shape() == Shape::Uniform && !matches!(mem, Mem::Local(_));
        let shape = if uniform { Shape::Uniform } else { Shape::Varying };
        let w = &mut self.lanes.writer;
        let (next, loaded) = w.cont("loaded", Role::Rest, &parts(Ty::scalar(scalar), shape, w.width), w.loc);
        let body = Body::Load { mem, index: index.nodes()[0], next: w.w.cont_value(next) };
        self.go_on(body, next);
        Value::of(Ty::scalar(scalar), shape, &mut loaded.into_iter())
    }

    fn store(&mut self, mem: Mem, index: NodeId, value: NodeId) {
        self.stay_alive();
        let (index, value) = (self.value(index), self.value(value));
        let mask = self.path_mut().mask();
        let (mem, index) = match mem {
            Mem::Local(array) => {
                let (array, _, index) = self.element(array, &index, false);
                (Mem::Local(array), index)
            }
            // All lanes store to one row, the last one's value stays.
            _ if index.shape() == Shape::Uniform => (mem, Value::Varying(self.lanes.writer.widen(&index))),
            _ => (mem, index),
        };
        let w = &mut self.lanes.writer;
        let value = w.vector(&value);
        self.store_vector(mem, index.nodes()[0], value, mask);
    }

    fn store_vector(&mut self, mem: Mem, index: NodeId, value: NodeId, mask: NodeId) {
        let w = &mut self.lanes.writer;
        let (next, _) = w.cont("stored", Role::Rest, &[], w.loc);
        let body = Body::Store { mem, index, value, mask, next: w.w.cont_value(next) };
        self.go_on(body, next);
    }

    /// Leave the current continuation by this body, for `next`.
    fn go_on(&mut self, body: Body, next: ContId) {
        let path = self.path.as_mut().expect("a path is under way");
        let w = &mut self.lanes.writer;
        w.w.set_body(path.at, body, w.loc);
        path.at = next;
    }

    // ---- local arrays

    /// An element of a local array: the array of all lanes, its scalar, and where in it; a uniform index as the start of a
    /// run. A load clamps, a store out of range is dropped.
    fn element(&mut self, array: NodeId, index: &Value, load: bool) -> (NodeId, Scalar, Value) {
        let TyKind::Local(scalar, len) = *self.lanes.p.ty(array).kind() else {
            unreachable!("only local arrays have elements")
        };
        let array = self.value(array).nodes()[0];
        let w = &mut self.lanes.writer;
        let last = Value::Uniform(w.w.lit(Lit::U32(if load { len - 1 } else { len })));
        let width = Value::Uniform(w.w.lit(Lit::U32(w.width as u32)));
        let index = w.op(Op::Min, &[index.clone(), last], Ty::u32());
        let start = w.op(Op::Mul, &[index, width], Ty::u32());
        let at = match start {
            Value::Uniform(start) => Value::Uniform(start),
            starts => {
                let iota = Value::Varying(vec![w.iota(Scalar::U32)]);
                w.op(Op::Add, &[starts, iota], Ty::u32())
            }
        };
        (array, scalar, at)
    }

    /// Make a local array, or if it is there since the beginning let the active lanes' elements be zero.
    fn array(&mut self, scalar: Scalar, len: u32, next: NodeId) {
        let p = self.lanes.p;
        let Node::Cont(next) = *p.node(next) else { unreachable!("a residual goes on in blocks") };
        let Some(param) = self.lanes.params.get(next, 0) else { return };
        if !self.is_early(param) {
            return self.make_array(param, scalar, len);
        }
        self.stay_alive();
        let mem = Mem::Local(self.value(param).nodes()[0]);
        let mask = self.path_mut().mask();
        for i in 0..len {
            let w = &mut self.lanes.writer;
            let (start, zero) = (w.w.lit(Lit::U32(i * w.width as u32)), w.splat_lit(Lit::from_word(scalar, 0)));
            self.store_vector(mem, start, zero, mask);
        }
    }

    fn make_array(&mut self, param: NodeId, scalar: Scalar, len: u32) {
        let w = &mut self.lanes.writer;
        let len = len.saturating_mul(w.width as u32);
        let (next, array) = w.cont("array", Role::Rest, &[Ty::local(scalar, len)], w.loc);
        let body = Body::Local { scalar, len, next: w.w.cont_value(next) };
        self.go_on(body, next);
        self.bound.insert(param, Value::Uniform(array[0]));
    }

    /// The arrays that are made before all else.
    pub(super) fn make_early_arrays(&mut self) {
        for param in self.early_arrays() {
            if let TyKind::Local(scalar, len) = *self.lanes.p.ty(param).kind() {
                self.make_array(param, scalar, len);
            }
        }
    }

    // ---- calls

    /// Call a function; none if that was the function's end.
    pub(super) fn call(&mut self, callee: ContId, args: &[NodeId], last: bool) -> Option<Vec<Value>> {
        self.stay_alive();
        let loc = self.lanes.writer.loc;
        let args: Vec<Value> = args.iter().map(|x| self.value(*x)).collect();
        let shapes: Vec<Shape> = args.iter().map(Value::shape).collect();
        let mut nodes: Vec<NodeId> = args.iter().flat_map(Value::nodes).copied().collect();
        let (function, results) = if shapes.iter().all(|s| *s == Shape::Uniform) {
            (self.lanes.scalar(callee), self.lanes.results(callee, &shapes))
        } else {
            nodes.insert(0, self.path_mut().mask());
            self.lanes.version(callee, &shapes)
        };
        let p = self.lanes.p;
        let types = p.cont(callee).params.last().and_then(|ret| ret.ty.params()).unwrap_or_default();
        let w = &mut self.lanes.writer;
        w.loc = loc;
        let function = w.w.cont_value(function);
        let call = |nodes: Vec<NodeId>| Body::Jump { callee: function, args: nodes, mode: Mode::Filter };
        if last && self.can_tail_call(&results) {
            nodes.push(self.ret());
            let path = self.path.take().expect("a path is under way");
            self.lanes.writer.w.set_body(path.at, call(nodes), loc);
            return None;
        }
        let w = &mut self.lanes.writer;
        let of = types.iter().zip(&results);
        let returned: Vec<Ty> = of.clone().flat_map(|(ty, shape)| parts(*ty, *shape, w.width)).collect();
        let (next, returned) = w.cont("rest", Role::Rest, &returned, loc);
        nodes.push(w.w.cont_value(next));
        self.go_on(call(nodes), next);
        let mut returned = returned.into_iter();
        Some(of.map(|(ty, shape)| Value::of(*ty, *shape, &mut returned)).collect())
    }
}
