//! Scalar functions in the new program: copies, in which a `vectorize` is a loop over lanes.

use jerboa_ir::cfg::Function;
use jerboa_ir::*;
use rustc_hash::FxHashMap;

use super::nodes::operands_first;
use super::shape::Shape;
use super::{Lanes, Width};

/// What the copies made so far are of.
#[derive(Default)]
pub(super) struct Copies {
    conts: FxHashMap<ContId, ContId>,
    nodes: FxHashMap<NodeId, NodeId>,
}

impl Lanes<'_> {
    /// The copy of a function; its body is written later.
    pub(super) fn scalar(&mut self, function: ContId) -> ContId {
        if let Some(copy) = self.copies.conts.get(&function) {
            return *copy;
        }
        let cfg = self.cfg;
        let f = cfg.function(function).expect("what is called is a function");
        for block in &f.blocks {
            let Cont { name, role, params, loc, .. } = self.p.cont(block.cont);
            let copy = self.writer.w.cont(name.clone(), *role, params.clone(), *loc);
            let filter = self.writer.w.lit(Lit::Bool(false));
            self.writer.w.cont_mut(copy).filter = filter;
            self.copies.conts.insert(block.cont, copy);
        }
        self.to_copy.push(f);
        self.copies.conts[&function]
    }

    /// Write the bodies of a copy.
    pub(super) fn copy(&mut self, f: &Function) {
        for block in &f.blocks {
            let Cont { body, loc, .. } = self.p.cont(block.cont);
            self.writer.loc = *loc;
            let to = self.copies.conts[&block.cont];
            match body {
                Body::Vectorize { width, lo, hi, body, args, next } => {
                    let Node::Cont(body) = *self.p.node(*body) else {
                        unreachable!("the body of a residual `vectorize` is a function")
                    };
                    let [lo, hi, next] = [lo, hi, next].map(|x| self.copied(*x));
                    let args = args.iter().map(|x| self.copied(*x)).collect();
                    self.strips(to, self.width.of(*width), [lo, hi], body, args, next);
                }
                _ => {
                    let body = self.copied_body(body);
                    self.writer.w.set_body(to, body, *loc);
                }
            }
        }
    }

    fn copied(&mut self, node: NodeId) -> NodeId {
        let p = self.p;
        // Functions first, which making a node cannot make.
        let mut work = vec![node];
        while let Some(x) = work.pop() {
            match p.node(x) {
                Node::Cont(c) if p.cont(*c).role == Role::Fun => _ = self.scalar(*c),
                _ => p.operands(x, &mut |y| work.push(y)),
            }
        }
        let (w, conts) = (&mut self.writer.w, &self.copies.conts);
        operands_first(
            p,
            node,
            &mut self.copies.nodes,
            |copies, x| copies.contains_key(&x),
            |copies, x| {
                let (of, loc) = (|x: &NodeId| copies[x], p.locs[x.index()]);
                let copy = match p.node(x) {
                    Node::Param { cont, index } => w.param(conts[cont], *index as usize),
                    Node::Cont(cont) => w.cont_value(conts[cont]),
                    Node::Lit(lit) => w.lit(*lit),
                    Node::Prim { op, args } => {
                        let args: Vec<NodeId> = args[..op.arity()].iter().map(of).collect();
                        w.prim(*op, &args, loc)
                    }
                    Node::Pack(elems) => w.pack(&elems.iter().map(of).collect::<Vec<_>>(), loc),
                    Node::Lane { vector, lane } => w.lane(of(vector), *lane as usize, loc),
                    Node::Read { column, index } => w.read(*column, of(index), loc),
                    other => unreachable!("{other:?} is left in a residual"),
                };
                copies.insert(x, copy);
            },
        );
        let copy = self.copies.nodes[&node];
        if let Some(name) = p.names.get(&node) {
            self.writer.w.name(copy, name);
        }
        copy
    }

    fn copied_body(&mut self, body: &Body) -> Body {
        let mem = |lanes: &mut Self, mem: &Mem| match mem {
            Mem::Local(array) => Mem::Local(lanes.copied(*array)),
            other => *other,
        };
        match body {
            Body::Jump { callee, args, mode } => Body::Jump {
                callee: self.copied(*callee),
                args: args.iter().map(|x| self.copied(*x)).collect(),
                mode: *mode,
            },
            Body::Branch { cond, then, other } => {
                let [cond, then, other] = [cond, then, other].map(|x| self.copied(*x));
                Body::Branch { cond, then, other }
            }
            Body::Switch { index, arms, default } => Body::Switch {
                index: self.copied(*index),
                arms: arms.iter().map(|(n, arm)| (*n, self.copied(*arm))).collect(),
                default: self.copied(*default),
            },
            Body::Load { mem: m, index, next } => {
                let mem = mem(self, m);
                Body::Load { mem, index: self.copied(*index), next: self.copied(*next) }
            }
            Body::Store { mem: m, index, value, mask, next } => {
                let mem = mem(self, m);
                let [index, value, next] = [index, value, next].map(|x| self.copied(*x));
                let mask = if *mask == NodeId::NONE { *mask } else { self.copied(*mask) };
                Body::Store { mem, index, value, mask, next }
            }
            Body::Local { scalar, len, next } => Body::Local { scalar: *scalar, len: *len, next: self.copied(*next) },
            Body::Unset | Body::Dispatch { .. } | Body::Vectorize { .. } => {
                unreachable!("control flow has no such body")
            }
        }
    }

    /// A loop that calls the lane version for as many indices at once as there are lanes.
    ///
    /// It counts how many are left, not up to the last, so that it ends even where the last index is the largest `u32`.
    fn strips(
        &mut self,
        at: ContId,
        width: usize,
        [lo, hi]: [NodeId; 2],
        body: ContId,
        args: Vec<NodeId>,
        next: NodeId,
    ) {
        let shapes: Vec<Shape> = args.iter().map(|_| Shape::Uniform).chain([Shape::Consecutive]).collect();
        let loc = self.writer.loc;
        self.writer.width = width;
        let (version, _) = self.version(body, &shapes);
        let w = &mut self.writer;
        w.loc = loc;
        let zero = w.w.lit(Lit::U32(0));
        let lanes = w.w.lit(Lit::U32(width as u32));
        let some = w.w.prim(Op::Lt, &[lo, hi], loc);
        let count = w.w.prim(Op::Sub, &[hi, lo], loc);
        let count = w.w.prim(Op::Select, &[some, count, zero], loc);

        let (head, params) = w.cont("strips", Role::Loop, &[Ty::u32(); 2], loc);
        let ((strip, _), (done, _)) = (w.cont("strip", Role::Arm, &[], loc), w.cont("done", Role::Arm, &[], loc));
        let (back, _) = w.cont("back", Role::Rest, &[], loc);
        let (base, left) = (params[0], params[1]);
        w.w.name(base, "base");
        w.w.name(left, "left");
        w.jump(at, head, vec![lo, count]);
        let cond = w.w.prim(Op::Ne, &[left, zero], loc);
        let (then, other) = (w.w.cont_value(strip), w.w.cont_value(done));
        w.w.set_body(head, Body::Branch { cond, then, other }, loc);
        w.w.set_body(done, Body::Jump { callee: next, args: Vec::new(), mode: Mode::Filter }, loc);

        let (iota, all) = (w.iota(Scalar::U32), w.splat(left));
        let mask = w.w.prim(Op::Lt, &[iota, all], loc);
        let ret = w.w.cont_value(back);
        w.jump(strip, version, [vec![mask], args, vec![base, ret]].concat());

        let next_base = w.w.prim(Op::Add, &[base, lanes], loc);
        let fewer = w.w.prim(Op::Min, &[left, lanes], loc);
        let next_left = w.w.prim(Op::Sub, &[left, fewer], loc);
        w.jump(back, head, vec![next_base, next_left]);
    }
}

impl Width {
    /// The number of lanes for a `vectorize` with this hint.
    fn of(self, hint: u8) -> usize {
        match self {
            Width::Hint => hint as usize,
            Width::Lanes(width) => width as usize,
        }
    }
}
