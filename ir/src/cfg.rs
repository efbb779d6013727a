//! Control flow of a residual: its functions, their blocks, who calls whom.
//!
//! A residual is first-order, so every jump has a visible target. This analysis groups the continuations into *functions*
//! (a continuation whose last parameter is its return continuation) and *blocks* (all others), and orders the blocks of
//! each function in reverse postorder, with predecessors, dominators ([`DomTree`]) and loops ([`Loops`]). The call graph's
//! strongly connected components (Tarjan, *Depth-first search and linear graph algorithms*, 1972) say which functions may
//! recurse. Everything is iterative: a chain of 10⁵ blocks does not need a deep stack.

use std::collections::hash_map::Entry;
use std::fmt;
use std::sync::Arc;

use rustc_hash::FxHashMap;

use crate::dom::DomTree;
use crate::loops::Loops;
use crate::program::*;
use crate::ty::TyKind;

/// How a continuation of a residual ends.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Exit<'p> {
    /// The function returns these values.
    Return(&'p [NodeId]),
    /// Go on in a block of this function.
    Jump {
        /// The block.
        block: ContId,
        /// Its arguments.
        args: &'p [NodeId],
    },
    /// Call a function.
    Call {
        /// The function.
        callee: ContId,
        /// Its arguments, without the return.
        args: &'p [NodeId],
        /// The block that takes the results; none when the caller returns what the callee returns (a tail call).
        back: Option<ContId>,
    },
    /// Any other body; [`Exit::arms`] gives where it goes on.
    Arms,
}

impl<'p> Exit<'p> {
    /// The exit of a continuation, or what is not first-order about it.
    pub fn of(p: &'p Program, cont: ContId) -> Result<Exit<'p>, NotFirstOrder> {
        let wrong = |why: &str| Err(NotFirstOrder::new(p, cont, why));
        let Body::Jump { callee, args, .. } = &p.cont(cont).body else {
            return match &p.cont(cont).body {
                Body::Unset => wrong("it has no body"),
                Body::Dispatch { .. } => wrong("it dispatches on a row"),
                _ => Ok(Exit::Arms),
            };
        };
        match *p.node(*callee) {
            Node::Param { .. } => Ok(Exit::Return(args)),
            Node::Cont(block) if !p.cont_ty(block).is_function() => Ok(Exit::Jump { block, args }),
            Node::Cont(callee) => match args.split_last().map(|(last, args)| (p.node(*last), args)) {
                Some((Node::Cont(back), args)) => Ok(Exit::Call { callee, args, back: Some(*back) }),
                Some((Node::Param { .. }, args)) => Ok(Exit::Call { callee, args, back: None }),
                _ => wrong("it calls without a return"),
            },
            _ => wrong("its callee is computed"),
        }
    }

    /// Calls `f` with each node of continuation type where a body other than a jump goes on. The body of a `vectorize` is
    /// none of these: it is called.
    pub fn arms(body: &Body, f: &mut dyn FnMut(NodeId)) {
        match body {
            Body::Branch { then, other, .. } => [*then, *other].into_iter().for_each(f),
            Body::Switch { arms, default, .. } => {
                arms.iter().for_each(|(_, arm)| f(*arm));
                f(*default)
            }
            Body::Load { next, .. }
            | Body::Store { next, .. }
            | Body::Vectorize { next, .. }
            | Body::Local { next, .. } => f(*next),
            Body::Unset | Body::Jump { .. } | Body::Dispatch { .. } => {}
        }
    }
}

/// A block of a function.
#[derive(Clone, Debug)]
pub struct Block {
    /// Its continuation.
    pub cont: ContId,
    /// Blocks that it may go on in, in the order of its body, without repetition.
    pub succs: Vec<u32>,
    /// Blocks that may go on in it, ascending.
    pub preds: Vec<u32>,
}

/// A call of one function by another; a `vectorize` calls its body.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct Call {
    /// The callee's place in [`Cfg::functions`].
    pub callee: u32,
    /// Does the caller return what the callee returns?
    pub tail: bool,
}

/// A function of a residual: an entry or one that an entry reaches.
#[derive(Clone, Debug)]
pub struct Function {
    /// Its continuation, which is also its first block.
    pub cont: ContId,
    /// Its blocks in reverse postorder.
    pub blocks: Vec<Block>,
    /// Place of a continuation in `blocks`.
    pub number: FxHashMap<ContId, u32>,
    /// Dominators of the blocks.
    pub dom: DomTree,
    /// Loops of the blocks.
    pub loops: Loops,
    /// Whom it calls, ascending, without repetition.
    pub calls: Vec<Call>,
    /// Number of its strongly connected component of the call graph; callees outside of it have smaller ones.
    pub component: u32,
    /// Can it be active twice? True when a call that is no tail call leads back to it.
    pub recursive: bool,
}

/// The functions that some entries of a program reach.
#[derive(Clone, Debug, Default)]
pub struct Cfg {
    /// The functions; the entries come first, in their order.
    pub functions: Vec<Function>,
    /// Place of a function's continuation in `functions`.
    pub number: FxHashMap<ContId, u32>,
}

impl Cfg {
    /// Analyse what these entries reach.
    pub fn new(p: &Program, entries: &[ContId]) -> Result<Cfg, NotFirstOrder> {
        let mut cfg = Cfg::default();
        let mut found: Vec<ContId> = Vec::new();
        let mut number = |cont: ContId, found: &mut Vec<ContId>| {
            *cfg.number.entry(cont).or_insert_with(|| {
                found.push(cont);
                found.len() as u32 - 1
            })
        };
        entries.iter().for_each(|e| _ = number(*e, &mut found));
        let mut next = 0;
        while next < found.len() {
            let (mut function, calls) = Function::new(p, found[next])?;
            function.calls =
                calls.iter().map(|(c, tail)| Call { callee: number(*c, &mut found), tail: *tail }).collect();
            function.calls.sort_unstable();
            function.calls.dedup();
            cfg.functions.push(function);
            next += 1;
        }
        cfg.components();
        Ok(cfg)
    }

    /// The function of this continuation.
    pub fn function(&self, cont: ContId) -> Option<&Function> {
        self.number.get(&cont).map(|f| &self.functions[*f as usize])
    }

    /// Components of the call graph, callees first, and who is recursive.
    fn components(&mut self) {
        let n = self.functions.len();
        let (mut index, mut low, mut open) = (vec![u32::MAX; n], vec![0u32; n], vec![false; n]);
        let (mut clock, mut component) = (0, 0);
        let mut stack: Vec<usize> = Vec::new();
        for root in 0..n {
            // (function, next call to look at)
            let mut path = if index[root] == u32::MAX { vec![(root, 0)] } else { Vec::new() };
            while let Some((f, at)) = path.last_mut() {
                let f = *f;
                if *at == 0 {
                    (index[f], low[f], open[f]) = (clock, clock, true);
                    clock += 1;
                    stack.push(f);
                }
                if let Some(call) = self.functions[f].calls.get(*at) {
                    *at += 1;
                    let g = call.callee as usize;
                    if index[g] == u32::MAX {
                        path.push((g, 0));
                    } else if open[g] {
                        low[f] = low[f].min(index[g]);
                    }
                    // A function whose calls are all looked at must not be entered again.
                    continue;
                }
                path.pop();
                if let Some((caller, _)) = path.last() {
                    low[*caller] = low[*caller].min(low[f]);
                }
                if low[f] == index[f] {
                    while let Some(g) = stack.pop() {
                        open[g] = false;
                        self.functions[g].component = component;
                        if g == f {
                            break;
                        }
                    }
                    component += 1;
                }
            }
        }
        let mut recursive = vec![false; component as usize];
        for f in &self.functions {
            for call in f.calls.iter().filter(|c| !c.tail) {
                recursive[f.component as usize] |= self.functions[call.callee as usize].component == f.component;
            }
        }
        self.functions.iter_mut().for_each(|f| f.recursive = recursive[f.component as usize]);
    }
}

impl Function {
    /// Blocks, dominators and loops of a function, and whom it calls (with: is it a tail call?).
    fn new(p: &Program, cont: ContId) -> Result<(Function, Vec<(ContId, bool)>), NotFirstOrder> {
        if !p.cont_ty(cont).is_function() {
            return Err(NotFirstOrder::new(p, cont, "it is called, but its last parameter is no return"));
        }
        check_params(p, cont, p.cont(cont).params.len() - 1)?;
        let mut calls = Vec::new();
        let mut succs: FxHashMap<ContId, Vec<ContId>> = FxHashMap::default();
        let mut postorder = Vec::new();
        let mut path: Vec<(ContId, usize)> = vec![(cont, 0)];
        succs.insert(cont, successors(p, cont, cont, &mut calls)?);
        while let Some((at, next)) = path.last_mut() {
            let Some(&succ) = succs[at].get(*next) else {
                postorder.push(*at);
                path.pop();
                continue;
            };
            *next += 1;
            if let Entry::Vacant(vacant) = succs.entry(succ) {
                check_params(p, succ, p.cont(succ).params.len())?;
                vacant.insert(successors(p, cont, succ, &mut calls)?);
                path.push((succ, 0));
            }
        }
        postorder.reverse();
        let number: FxHashMap<ContId, u32> = postorder.iter().enumerate().map(|(i, c)| (*c, i as u32)).collect();
        let mut preds = vec![Vec::new(); postorder.len()];
        let mut blocks = Vec::with_capacity(postorder.len());
        for (i, cont) in postorder.iter().enumerate() {
            let succs: Vec<u32> = succs[cont].iter().map(|s| number[s]).collect();
            succs.iter().for_each(|s| preds[*s as usize].push(i as u32));
            blocks.push(Block { cont: *cont, succs, preds: Vec::new() });
        }
        let dom = DomTree::new(&preds);
        let loops = Loops::new(&preds, &dom);
        blocks.iter_mut().zip(preds).for_each(|(block, preds)| block.preds = preds);
        let function = Function { cont, blocks, number, dom, loops, calls: Vec::new(), component: 0, recursive: false };
        Ok((function, calls))
    }
}

/// The blocks of a function where a continuation of it goes on, without repetition; its call is added to `calls`.
fn successors(
    p: &Program,
    function: ContId,
    cont: ContId,
    calls: &mut Vec<(ContId, bool)>,
) -> Result<Vec<ContId>, NotFirstOrder> {
    if let Body::Jump { callee, args, .. } = &p.cont(cont).body {
        let foreign = |x: &&NodeId| {
            let of_function =
                |c: &ContId, index: &u32| *c == function && *index as usize + 1 == p.cont(function).params.len();
            matches!(p.node(**x), Node::Param { cont, index } if p.ty(**x).params().is_some() && !of_function(cont, index))
        };
        if args.last().iter().chain(&[callee]).any(foreign) {
            return Err(NotFirstOrder::new(p, cont, "it leaves by what is not its function's return"));
        }
    }
    let mut succs = Vec::new();
    match Exit::of(p, cont)? {
        Exit::Return(_) => {}
        Exit::Jump { block, .. } => succs.push(block),
        Exit::Call { callee, back, .. } => {
            calls.push((callee, back.is_none()));
            succs.extend(back);
        }
        Exit::Arms => {
            let mut computed = false;
            if let Body::Vectorize { body, .. } = &p.cont(cont).body {
                match p.node(*body) {
                    Node::Cont(callee) => calls.push((*callee, false)),
                    _ => computed = true,
                }
            }
            Exit::arms(&p.cont(cont).body, &mut |arm| match p.node(arm) {
                Node::Cont(c) => succs.push(*c),
                _ => computed = true,
            });
            if computed {
                return Err(NotFirstOrder::new(p, cont, "it goes on in a computed continuation"));
            }
        }
    }
    let mut seen = rustc_hash::FxHashSet::default();
    succs.retain(|s| seen.insert(*s));
    Ok(succs)
}

/// The first `count` parameters are data, or the array that follows the making of a local array.
fn check_params(p: &Program, cont: ContId, count: usize) -> Result<(), NotFirstOrder> {
    let data = |ty: crate::ty::Ty| ty.is_data() || matches!(ty.kind(), TyKind::Local(..));
    match p.cont(cont).params[..count].iter().find(|param| !data(param.ty)) {
        Some(param) => Err(NotFirstOrder::new(p, cont, &format!("it takes a {}", param.ty))),
        None => Ok(()),
    }
}

/// Why a program is no residual: a fault of whoever made it, usually of the evaluator.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct NotFirstOrder {
    /// The continuation's name.
    pub name: Arc<str>,
    /// Where the author wrote it.
    pub loc: Loc,
    /// What is not first-order, in words.
    pub why: String,
}

impl NotFirstOrder {
    fn new(p: &Program, cont: ContId, why: &str) -> NotFirstOrder {
        let Cont { name, loc, .. } = p.cont(cont);
        NotFirstOrder { name: name.clone(), loc: *loc, why: why.to_owned() }
    }
}

impl fmt::Display for NotFirstOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` is not first-order: {}; specialise the program first", self.name, self.why)?;
        if self.loc != Loc::NONE { write!(f, " ({})", self.loc) } else { Ok(()) }
    }
}

impl std::error::Error for NotFirstOrder {}
