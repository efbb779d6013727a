//! The lane version of a function: its tree, walked once from front to back.
//!
//! There is one *path* under way at most, and a stack of *places* around it: arms of varying choices, labels, rounds of
//! loops, the function. A path that comes to the end of its place, or leaves to it, waits there; where the place ends, all
//! that wait meet and one path goes on.

use std::rc::Rc;

use jerboa_ir::cfg::{Exit, Function};
use jerboa_ir::structure::Step;
use jerboa_ir::*;
use rustc_hash::FxHashMap;

use super::flow::Target;
use super::nodes::operands_first;
use super::path::{Path, Var, meet};
use super::place::Place;
use super::plan::Plan;
use super::shape::Shape;
use super::value::{Value, parts};
use super::{Fault, Lanes};

/// A function that is being written.
pub(super) struct Writing<'a, 'p> {
    pub lanes: &'a mut Lanes<'p>,
    pub f: &'p Function,
    pub plan: Rc<Plan>,
    /// What parameters of the scalar program are.
    pub bound: FxHashMap<NodeId, Value>,
    /// What its nodes are, as long as `bound` holds.
    pub written: FxHashMap<NodeId, Value>,
    pub places: Vec<Place>,
    pub path: Option<Path>,
    /// The return of the lane version.
    ret: NodeId,
}

impl<'a, 'p> Writing<'a, 'p> {
    /// Write the body of a lane version. `params` are its parameters: the mask first, the return last.
    pub(super) fn run(
        lanes: &'a mut Lanes<'p>,
        f: &'p Function,
        plan: Rc<Plan>,
        shapes: &[Shape],
        version: ContId,
    ) -> Result<(), Fault> {
        let params = lanes.writer.w.params(version);
        let (mask, ret) = (params[0], params[params.len() - 1]);
        let mut path = Path { at: version, env: Default::default(), alive: true };
        path.set_mask(mask);
        let (bound, written) = Default::default();
        let mut w = Writing { lanes, f, plan, bound, written, places: Vec::new(), path: Some(path), ret };
        let mut rest = params[1..].iter().copied();
        for (i, shape) in shapes.iter().enumerate() {
            let value = Value::of(w.lanes.p.cont(f.cont).params[i].ty, *shape, &mut rest);
            if let Some(node) = w.lanes.params.get(f.cont, i) {
                w.bound.insert(node, value);
            }
        }
        w.make_early_arrays();
        w.function()
    }

    fn function(&mut self) -> Result<(), Fault> {
        let plan = self.plan.clone();
        let linear = plan.flow.linear.contains(&Target::Return);
        self.places.push(Place { target: Some(Target::Return), linear, waiting: Vec::new() });
        self.steps(&plan.tree)?;
        let waiting = self.places.pop().map_or(Vec::new(), |place| place.waiting);
        if let Some(mut path) = meet(&mut self.lanes.writer, "done", waiting) {
            let types = self.return_types();
            let mut values = Vec::new();
            for (i, (ty, shape)) in types.iter().zip(&plan.results).enumerate() {
                match path.env.remove(&Var::Passed(Target::Return, i)) {
                    Some(value) => values.extend(value.nodes()),
                    None => values.extend(self.zero(*ty, *shape).nodes()),
                }
            }
            self.lanes.writer.w.set_body(path.at, self.return_body(values), Loc::NONE);
        }
        Ok(())
    }

    fn return_body(&self, args: Vec<NodeId>) -> Body {
        Body::Jump { callee: self.ret, args, mode: Mode::Filter }
    }

    pub(super) fn return_types(&self) -> &'static [Ty] {
        self.lanes.p.cont(self.f.cont).params.last().and_then(|ret| ret.ty.params()).unwrap_or_default()
    }

    pub(super) fn zero(&mut self, ty: Ty, shape: Shape) -> Value {
        let w = &mut self.lanes.writer;
        let nodes: Vec<NodeId> = parts(ty, shape, w.width)
            .into_iter()
            .map(|ty| {
                let (scalar, n) = ty.lanes().expect("it is data");
                let zero = w.w.lit(Lit::from_word(scalar, 0));
                if n == 1 { zero } else { w.w.pack(&vec![zero; n], Loc::NONE) }
            })
            .collect();
        Value::of(ty, shape, &mut nodes.into_iter())
    }

    // ---- the tree

    pub(super) fn steps(&mut self, steps: &[Step]) -> Result<(), Fault> {
        for step in steps {
            if self.path.is_none() {
                return Ok(());
            }
            match step {
                Step::Block(block) => {
                    self.enter(*block);
                    self.block(*block)?;
                }
                Step::Choice { block, arms } => {
                    self.enter(*block);
                    match self.plan.flow.varying[*block as usize] {
                        true => self.varying_choice(*block, arms)?,
                        false => self.uniform_choice(*block, arms)?,
                    }
                }
                Step::Label { join, body } => self.label(*join, body)?,
                Step::Loop { header, body } => self.repeat(*header, body)?,
                Step::Break(join) => self.leave(Target::Block(*join)),
                Step::Continue(header) => self.leave(Target::Round(*header)),
            }
        }
        Ok(())
    }

    /// The parameters of a block are what was passed to it. Those of a header are set at the start of its round.
    fn enter(&mut self, block: u32) {
        let cont = self.f.blocks[block as usize].cont;
        self.lanes.writer.loc = self.lanes.p.cont(cont).loc;
        if block == 0 || self.f.loops.is_header(block) {
            return;
        }
        for i in 0..self.lanes.p.cont(cont).params.len() {
            let passed = self.path_mut().env.remove(&Var::Passed(Target::Block(block), i));
            if let (Some(value), Some(node)) = (passed, self.lanes.params.get(cont, i)) {
                self.bind(node, value);
            }
        }
    }

    /// Give a parameter its value, and keep it for lanes that will wait.
    pub(super) fn bind(&mut self, param: NodeId, value: Value) {
        if self.plan.kept.contains(&param) {
            let vector = Value::Varying(self.lanes.writer.widen(&value));
            let mask = self.path_mut().mask();
            let kept = match self.path_mut().env.get(&Var::Kept(param)).cloned() {
                Some(old) => self.lanes.writer.select(mask, &vector, &old),
                None => vector,
            };
            self.path_mut().env.insert(Var::Kept(param), kept);
        }
        if let Node::Param { cont, index } = *self.lanes.p.node(param)
            && let Some(name) = &self.lanes.p.cont(cont).params[index as usize].name
        {
            self.lanes.writer.name(&value, name);
        }
        if self.bound.insert(param, value.clone()).is_some_and(|old| old != value) {
            self.written.clear();
        }
    }

    pub(super) fn path_mut(&mut self) -> &mut Path {
        self.path.as_mut().expect("a path is under way")
    }

    /// Pass values along an edge. Where lanes have come with others before, each lane keeps its own.
    pub(super) fn pass(&mut self, target: Target, values: Vec<Value>) {
        for (i, value) in values.into_iter().enumerate() {
            let Some(shape) = self.shape_of(target, i) else { continue };
            let value = self.lanes.writer.shaped(value, shape);
            let mask = self.path_mut().mask();
            let var = Var::Passed(target, i);
            let value = match self.path_mut().env.get(&var).cloned() {
                Some(old) if shape == Shape::Varying => self.lanes.writer.select(mask, &value, &old),
                _ => value,
            };
            self.path_mut().env.insert(var, value);
        }
    }

    /// The shape of what is passed to a target; none where nobody uses it.
    pub(super) fn shape_of(&self, target: Target, i: usize) -> Option<Shape> {
        let (Target::Block(block) | Target::Round(block)) = target else { return Some(self.plan.results[i]) };
        let node = self.lanes.params.get(self.f.blocks[block as usize].cont, i)?;
        Some(self.plan.shapes.get(&node).copied().unwrap_or(Shape::Uniform))
    }

    /// A block that returns, or goes on in one block.
    fn block(&mut self, block: u32) -> Result<(), Fault> {
        let (p, f) = (self.lanes.p, self.f);
        let cont = f.blocks[block as usize].cont;
        let exit = Exit::of(p, cont)?;
        let values = match exit {
            Exit::Return(args) | Exit::Jump { args, .. } => args.iter().map(|x| self.value(*x)).collect(),
            Exit::Call { callee, args, back } => match self.call(callee, args, back.is_none()) {
                Some(results) => results,
                None => return Ok(()),
            },
            Exit::Arms => self.effect(cont)?,
        };
        match f.blocks[block as usize].succs[..] {
            [next] => self.pass(Target::of(block, next), values),
            _ => self.give_back(values),
        }
        Ok(())
    }

    /// Return from the function.
    fn give_back(&mut self, values: Vec<Value>) {
        if self.plan.flow.linear.contains(&Target::Return) {
            self.pass(Target::Return, values);
            return self.leave(Target::Return);
        }
        let plan = self.plan.clone();
        let mut nodes = Vec::new();
        for (value, shape) in values.into_iter().zip(&plan.results) {
            nodes.extend(self.lanes.writer.shaped(value, *shape).nodes());
        }
        let path = self.path.take().expect("a path is under way");
        self.lanes.writer.w.set_body(path.at, self.return_body(nodes), self.lanes.writer.loc);
    }

    pub(super) fn is_early(&self, array: NodeId) -> bool {
        self.plan.early.contains(&array)
    }

    pub(super) fn early_arrays(&self) -> Vec<NodeId> {
        self.plan.early.iter().copied().collect()
    }

    /// May a call with these results be the function's last, in its place?
    pub(super) fn can_tail_call(&self, results: &[Shape]) -> bool {
        !self.plan.flow.linear.contains(&Target::Return) && self.plan.results == results
    }

    pub(super) fn ret(&self) -> NodeId {
        self.ret
    }

    // ---- nodes

    /// What a node of the scalar program is here.
    pub(super) fn value(&mut self, node: NodeId) -> Value {
        let p = self.lanes.p;
        let (w, bound) = (&mut self.lanes.writer, &self.bound);
        operands_first(
            p,
            node,
            &mut self.written,
            |written, x| written.contains_key(&x),
            |written, x| {
                let of = |x: &NodeId| &written[x];
                w.loc = p.locs[x.index()];
                let value = match p.node(x) {
                    Node::Lit(lit) => Value::Uniform(w.w.lit(*lit)),
                    Node::Param { .. } => bound[&x].clone(),
                    Node::Prim { op, args } => {
                        let args: Vec<Value> = args[..op.arity()].iter().map(|x| of(x).clone()).collect();
                        w.op(*op, &args, p.ty(x))
                    }
                    Node::Pack(elems) => w.pack(&elems.iter().map(|x| of(x).clone()).collect::<Vec<_>>()),
                    Node::Lane { vector, lane } => w.element(of(vector), *lane as usize),
                    Node::Read { column, index } => w.read(*column, of(index)),
                    other => unreachable!("{other:?} is left in a residual"),
                };
                if let Some(name) = p.names.get(&x) {
                    w.name(&value, name);
                }
                written.insert(x, value);
            },
        );
        self.written[&node].clone()
    }
}
