//! Shape analysis of a function: which values, choices, labels and loops differ from lane to lane.
//!
//! A fixpoint from below: all is uniform until something says otherwise. What says so is
//! - an operation on something that is not uniform, a load or a read at such an index, a local array, a call;
//! - a *join at which lanes wait*: where lanes that went different ways meet, what they bring with them differs, even where
//!   each brings something uniform (Coutinho et al., *Divergence Analysis and Optimizations*, PACT 2011);
//! - a loop that lanes leave in different rounds: what was uniform in the round differs behind the loop.
//!
//! Choices on a varying value in turn make labels linear, see [`super::flow`].

use std::collections::{BTreeMap, BTreeSet};

use jerboa_ir::cfg::{Block, Exit, Function};
use jerboa_ir::structure::Step;
use jerboa_ir::*;
use rustc_hash::FxHashMap;

use super::flow::{Flow, Target};
use super::nodes::{Params, operands_first, used_params};
use super::shape::Shape;

/// What the analysis finds for one function and the shapes of its parameters.
pub(crate) struct Plan {
    pub tree: Vec<Step>,
    pub flow: Flow,
    /// Shapes of the parameters of the function and its blocks, where they are made.
    pub shapes: FxHashMap<NodeId, Shape>,
    /// Shapes of the results.
    pub results: Vec<Shape>,
    /// Values that outlive the round of a divergent loop in which they are made, and so are kept lane by lane as lanes
    /// leave; by parameter.
    pub kept: BTreeSet<NodeId>,
    /// Parameters of the headers of divergent loops that keep themselves: lanes that have left have their last value.
    pub frozen: BTreeSet<NodeId>,
    /// Local arrays that are made before all else, because their place is not around all their uses, or they are made
    /// again while lanes that left a loop still use the last one; by parameter.
    pub early: BTreeSet<NodeId>,
}

/// What passes along an edge of the control flow graph.
struct Edge<'p> {
    from: u32,
    target: Target,
    values: Passed<'p>,
}

enum Passed<'p> {
    /// Nodes of the program.
    Nodes(&'p [NodeId]),
    /// What an effect gave: its shapes.
    Effect(Vec<Shape>),
}

/// Where a value comes from.
#[derive(Clone, Copy, PartialEq)]
enum Source {
    Node(NodeId),
    /// The effect of this block.
    Effect(u32),
}

/// What comes into one parameter.
#[derive(Default)]
struct Incoming {
    shape: Option<Shape>,
    source: Option<Source>,
    /// Are there several sources?
    differs: bool,
    /// Do lanes wait on the way?
    waits: bool,
}

impl Incoming {
    fn add(&mut self, source: Source, shape: Option<Shape>, waits: bool) {
        self.differs |= self.source.is_some_and(|s| s != source);
        self.source = Some(source);
        self.waits |= waits;
        raise(&mut self.shape, shape);
    }
}

/// Gives the shapes of a function's results from those of its arguments.
type Call<'c> = &'c mut dyn FnMut(ContId, Vec<Shape>) -> Vec<Shape>;

/// An analysis under way.
pub(crate) struct Analysis<'a> {
    p: &'a Program,
    f: &'a Function,
    params: &'a Params,
    tree: Vec<Step>,
    flow: Flow,
    shapes: FxHashMap<NodeId, Shape>,
    results: Vec<Option<Shape>>,
    /// Shapes of nodes as seen in the innermost loop of this header.
    seen: FxHashMap<(NodeId, Option<u32>), Option<Shape>>,
}

impl<'a> Analysis<'a> {
    /// An analysis of a function whose parameters have these shapes.
    pub fn new(p: &'a Program, f: &'a Function, tree: Vec<Step>, params: &'a Params, shapes: &[Shape]) -> Analysis<'a> {
        let shape = |(i, shape): (usize, &Shape)| Some((params.get(f.cont, i)?, *shape));
        let shapes = shapes.iter().enumerate().filter_map(shape).collect();
        let returned = p.cont(f.cont).params.last().and_then(|ret| ret.ty.params()).map_or(0, <[Ty]>::len);
        let flow = Flow::new(f, &tree);
        Analysis { p, f, params, tree, flow, shapes, results: vec![None; returned], seen: FxHashMap::default() }
    }

    /// What it finds. `call` gives the shapes of a callee's results.
    pub fn run(mut self, call: Call) -> Plan {
        while self.pass(call) {}
        let outlive = self.outliving();
        let (kept, frozen) = self.kept(&outlive);
        let early = self.early(&outlive);
        let results = self.results.iter().map(|s| s.unwrap_or(Shape::Uniform)).collect();
        Plan { tree: self.tree, flow: self.flow, shapes: self.shapes, results, kept, frozen, early }
    }

    /// One pass over all edges and choices; says whether it found anything.
    fn pass(&mut self, call: Call) -> bool {
        self.seen.clear();
        let mut changed = false;
        for block in 0..self.f.blocks.len() as u32 {
            if !self.flow.varying[block as usize]
                && let Some(cond) = condition(&self.p.cont(self.f.blocks[block as usize].cont).body)
                && self.shape(cond, self.f.loops.header(block)).is_some_and(|s| s != Shape::Uniform)
            {
                self.flow.varying[block as usize] = true;
                changed = true;
            }
        }
        self.flow.update();
        let mut incoming: BTreeMap<(Target, usize), Incoming> = BTreeMap::new();
        for block in 0..self.f.blocks.len() as u32 {
            for edge in self.edges(block, call) {
                self.pass_along(&edge, &mut incoming);
            }
        }
        for ((target, i), what) in incoming {
            let shape = if what.waits && what.differs { Some(Shape::Varying) } else { what.shape };
            let (Target::Block(to) | Target::Round(to)) = target else {
                changed |= raise(&mut self.results[i], shape);
                continue;
            };
            let Some(node) = self.params.get(self.f.blocks[to as usize].cont, i) else { continue };
            let mut now = self.shapes.get(&node).copied();
            if raise(&mut now, shape) {
                self.shapes.extend(now.map(|shape| (node, shape)));
                changed = true;
            }
        }
        changed
    }

    /// The edges out of a block, with what passes along them.
    fn edges(&mut self, block: u32, call: Call) -> Vec<Edge<'a>> {
        let (p, f) = (self.p, self.f);
        let here = f.loops.header(block);
        let Block { cont, succs, .. } = &f.blocks[block as usize];
        let edge = |target, values| vec![Edge { from: block, target, values }];
        let to = |target: ContId| Target::of(block, f.number[&target]);
        let Ok(exit) = Exit::of(p, *cont) else { return Vec::new() };
        match exit {
            Exit::Return(values) => edge(Target::Return, Passed::Nodes(values)),
            Exit::Jump { block, args } => edge(to(block), Passed::Nodes(args)),
            Exit::Call { callee, args, back } => {
                let shapes: Option<Vec<Shape>> = args.iter().map(|x| self.shape(*x, here)).collect();
                // Not all is known yet; a later pass comes back.
                let Some(shapes) = shapes else { return Vec::new() };
                edge(back.map_or(Target::Return, to), Passed::Effect(call(callee, shapes)))
            }
            Exit::Arms => {
                let given = match &p.cont(*cont).body {
                    Body::Load { mem, index, .. } => match (mem, self.shape(*index, here)) {
                        (_, None) => return Vec::new(),
                        (Mem::Stream(_) | Mem::Unchecked(_), Some(Shape::Uniform)) => vec![Shape::Uniform],
                        _ => vec![Shape::Varying],
                    },
                    _ => Vec::new(),
                };
                match succs[..] {
                    [next] => edge(Target::of(block, next), Passed::Effect(given)),
                    _ => Vec::new(),
                }
            }
        }
    }

    fn pass_along(&mut self, edge: &Edge<'a>, incoming: &mut BTreeMap<(Target, usize), Incoming>) {
        let waits = self.flow.waits(edge.from, edge.target);
        // Lanes that wait may come from different rounds.
        let seen_from = match edge.target {
            _ if !waits => self.f.loops.header(edge.from),
            Target::Round(header) => Some(header),
            Target::Block(block) if self.f.loops.is_header(block) => self.f.loops.outer(block),
            Target::Block(block) => self.f.loops.header(block),
            Target::Return => None,
        };
        let crosses = self.leaves_divergent(edge.from, seen_from);
        let count = match &edge.values {
            Passed::Nodes(nodes) => nodes.len(),
            Passed::Effect(shapes) => shapes.len(),
        };
        for i in 0..count {
            let (source, shape) = match &edge.values {
                Passed::Nodes(nodes) => (Source::Node(nodes[i]), self.shape(nodes[i], seen_from)),
                Passed::Effect(_) if crosses => (Source::Effect(edge.from), Some(Shape::Varying)),
                Passed::Effect(shapes) => (Source::Effect(edge.from), Some(shapes[i])),
            };
            incoming.entry((edge.target, i)).or_default().add(source, shape, waits);
        }
    }

    /// The shape of a node as seen in the loop of this header; none if it is not known yet.
    fn shape(&mut self, node: NodeId, seen_from: Option<u32>) -> Option<Shape> {
        let p = self.p;
        let mut seen = std::mem::take(&mut self.seen);
        operands_first(
            p,
            node,
            &mut seen,
            |seen, x| seen.contains_key(&(x, seen_from)),
            |seen, x| {
                let shape = match p.node(x) {
                    Node::Param { cont, .. } => {
                        let shape = self.shapes.get(&x).copied();
                        let made = self.f.number.get(cont).copied().unwrap_or(0);
                        shape.map(|s| if self.leaves_divergent(made, seen_from) { Shape::Varying } else { s })
                    }
                    node => {
                        let mut parts = Some(Vec::new());
                        p.operands(
                            x,
                            &mut |part| match (&mut parts, seen.get(&(part, seen_from)).copied().flatten()) {
                                (Some(parts), Some(shape)) => parts.push(shape),
                                (parts, _) => *parts = None,
                            },
                        );
                        parts.map(|parts| match node {
                            Node::Prim { op, .. } => Shape::of_op(*op, &parts, p.ty(x)),
                            _ => Shape::of_parts(&parts),
                        })
                    }
                };
                seen.insert((x, seen_from), shape);
            },
        );
        let shape = seen.get(&(node, seen_from)).copied().flatten();
        self.seen = seen;
        shape
    }

    /// Is there a divergent loop around `made` that is not around what is in the loop of this header?
    fn leaves_divergent(&self, made: u32, seen_from: Option<u32>) -> bool {
        self.left(made, seen_from).any(|h| self.flow.divergent[h as usize])
    }

    /// The loops around a block that do not contain the loop of this header.
    fn left(&self, made: u32, seen_from: Option<u32>) -> impl Iterator<Item = u32> {
        let loops = &self.f.loops;
        let around = move |header: Option<u32>| std::iter::successors(header, |h| loops.outer(*h));
        around(loops.header(made)).take_while(move |h| around(seen_from).all(|other| other != *h))
    }

    /// Parameters that are used outside of divergent loops in which they are made, with the headers of these.
    fn outliving(&self) -> BTreeMap<NodeId, BTreeSet<u32>> {
        let mut outlive: BTreeMap<NodeId, BTreeSet<u32>> = BTreeMap::new();
        let f = self.f;
        let is_around = |header: u32, block: u32| {
            std::iter::successors(f.loops.header(block), |h| f.loops.outer(*h)).any(|h| h == header)
        };
        for header in (0..f.blocks.len() as u32).filter(|h| self.flow.divergent[*h as usize]) {
            let outside = (0..f.blocks.len() as u32).filter(|block| !is_around(header, *block));
            for x in used_params(self.p, outside.map(|block| f.blocks[block as usize].cont)) {
                if let Node::Param { cont, .. } = self.p.node(x)
                    && f.number.get(cont).is_some_and(|made| is_around(header, *made))
                {
                    outlive.entry(x).or_default().insert(header);
                }
            }
        }
        outlive
    }

    /// Which of them are kept aside, and which keep themselves.
    fn kept(&self, outlive: &BTreeMap<NodeId, BTreeSet<u32>>) -> (BTreeSet<NodeId>, BTreeSet<NodeId>) {
        let (mut kept, mut frozen) = (BTreeSet::new(), BTreeSet::new());
        for (x, loops) in outlive {
            let Node::Param { cont, .. } = self.p.node(*x) else { continue };
            let made = self.f.number[cont];
            let freezes = loops.contains(&made) && self.shapes.get(x) == Some(&Shape::Varying);
            if freezes {
                frozen.insert(*x);
            }
            let array = matches!(self.p.ty(*x).kind(), TyKind::Local(..));
            if !array && loops.iter().any(|h| !(freezes && *h == made)) {
                kept.insert(*x);
            }
        }
        (kept, frozen)
    }

    fn early(&self, outlive: &BTreeMap<NodeId, BTreeSet<u32>>) -> BTreeSet<NodeId> {
        let mut early = BTreeSet::new();
        for b in &self.f.blocks {
            for x in self.params.of(self.p, b.cont) {
                let array = matches!(self.p.ty(x).kind(), TyKind::Local(..));
                if array && (b.preds.len() > 1 || outlive.contains_key(&x)) {
                    early.insert(x);
                }
            }
        }
        early
    }
}

/// What a branch or a switch depends on.
fn condition(body: &Body) -> Option<NodeId> {
    match body {
        Body::Branch { cond: x, .. } | Body::Switch { index: x, .. } => Some(*x),
        _ => None,
    }
}

/// Raise a shape to one that holds for both; says whether it changed.
fn raise(now: &mut Option<Shape>, other: Option<Shape>) -> bool {
    let both = match (*now, other) {
        (Some(a), Some(b)) => Some(a.or(b)),
        (a, b) => a.or(b),
    };
    std::mem::replace(now, both) != both
}
