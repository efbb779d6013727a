//! Residual functions: calls that stay and share one body wherever they are made.
//!
//! A function whose only way out is its return may stay as a call. What its body can reach is its arguments and the free
//! variables of its closure, transitively. So the callee is identified by *content*: literals as literals, closures as
//! continuations with the content of their own free variables, unknowns by position (the same unknown twice is the same
//! position). Unknowns become extra parameters, and the environment is rebuilt over them, so two calls that differ in
//! unknowns only share one residual function. Where an exit of the current function or a local array can be reached,
//! there is no such function, and the call stays as a block.

use std::collections::BTreeSet;

use jerboa_ir::*;
use rustc_hash::FxHashMap;

use crate::call::Kept;
use crate::error::Error;
use crate::frame::ROOT;
use crate::log::{Decision, Reason};
use crate::machine::{Machine, Step};
use crate::value::{FrameId, NO_CLASS, Value};

/// Closures that an environment may reach; a larger one is no function worth sharing, and looking at it again for each
/// copy of a growing argument would take quadratic time. The largest component of a renderer reaches some hundred.
const MOST_CLOSURES: usize = 4096;

/// What identifies a residual function, and what a call must pass to it.
#[derive(Default)]
struct Lift {
    key: Vec<u32>,
    /// Unknowns of the environment, by position.
    unknowns: Vec<NodeId>,
    position: FxHashMap<NodeId, u32>,
    /// Closures that can be reached, in the order they were found.
    closures: Vec<(ContId, FrameId)>,
    number: FxHashMap<(ContId, FrameId), u32>,
    /// Arguments of frames that can be reached.
    reached: FxHashMap<(FrameId, u32), Value>,
    /// Scalars passed as arguments.
    actuals: Vec<NodeId>,
}

/// The scalars and vectors that a value of this type is at run time; none if functions or local arrays are in it.
pub(crate) fn flat(ty: Ty, out: &mut Vec<Ty>) -> bool {
    match ty.kind() {
        TyKind::Scalar(_) | TyKind::Vector(..) => out.push(ty),
        TyKind::Row(_) => out.push(Ty::u32()),
        TyKind::Tuple(elems) => return elems.iter().all(|t| flat(*t, out)),
        TyKind::Fn(_) | TyKind::Local(..) => return false,
    }
    true
}

/// The residual type of a return continuation, if all it takes is data.
pub(crate) fn return_ty(ty: Ty) -> Option<Ty> {
    let mut out = Vec::new();
    ty.params()?.iter().all(|t| flat(*t, &mut out)).then(|| Ty::func(&out))
}

impl Machine<'_> {
    /// Leave a call to a residual function; `None` where it must stay a block.
    pub(crate) fn stay_function(
        &mut self,
        c: ContId,
        parent: FrameId,
        args: &[Value],
        reason: Reason,
    ) -> Result<Option<Step>, Error> {
        let p = self.p;
        let cont = p.cont(c);
        let Some(ret_ty) = cont.params.last().and_then(|last| return_ty(last.ty)).filter(|_| cont.role == Role::Fun)
        else {
            return Ok(None);
        };
        let (ret, args) = args.split_last().expect("a function has a return");
        let Some((callee, mut actuals)) = self.function(c, parent, args, ret_ty, reason)? else { return Ok(None) };
        actuals.push(self.return_point(*ret, ret_ty, cont.params[args.len()].ty));
        Ok(Some(self.leave(Body::Jump { callee, args: actuals, mode: Mode::Filter }, cont.loc)))
    }

    /// The residual function of a call, which may be there already, and what to pass to it but the return; `None` where
    /// there is no such function.
    pub(crate) fn function(
        &mut self,
        c: ContId,
        parent: FrameId,
        args: &[Value],
        ret_ty: Ty,
        reason: Reason,
    ) -> Result<Option<(NodeId, Vec<NodeId>)>, Error> {
        let Some(lift) = self.lift(c, parent, args, reason) else { return Ok(None) };
        let function = match self.functions.get(&lift.key[..]) {
            Some(function) => {
                let function = *function;
                self.log(c, reason, Decision::Shared, args);
                function
            }
            None => {
                self.log(c, reason, Decision::Function, args);
                self.make_function(c, parent, args, &lift, ret_ty, reason)?
            }
        };
        let actuals = [lift.unknowns, lift.actuals].concat();
        Ok(Some((self.world.cont_value(function), actuals)))
    }

    /// Where a residual call goes on: the own return (a tail call), or a new block that takes the results.
    fn return_point(&mut self, ret: Value, residual: Ty, generic: Ty) -> NodeId {
        if let Value::Exit(node) = ret {
            return node;
        }
        let types = residual.params().expect("a return is a continuation");
        let names: Vec<_> = match ret {
            Value::Closure(r, _) => self.p.cont(r).params.iter().map(|p| p.name.clone()).collect(),
            _ => Vec::new(),
        };
        let name = |i: usize| names.get(i).filter(|_| names.len() == types.len()).cloned().flatten();
        let params = types.iter().enumerate().map(|(i, ty)| Param { ty: *ty, name: name(i), keep: false }).collect();
        let loc = match ret {
            Value::Closure(r, _) => self.p.cont(r).loc,
            _ => Loc::NONE,
        };
        let (block, node) = self.block(ret, Role::Rest, params, loc);
        let mut nodes = self.world.params(block).into_iter();
        let results = generic.params().expect("a return is a continuation");
        let results = results.iter().map(|ty| self.of_type(*ty, &mut nodes)).collect();
        self.wait(block, self.function, Step::Call(ret, results, Mode::Filter));
        node
    }

    /// A value of a data type made of residual parameters.
    pub(crate) fn of_type(&mut self, ty: Ty, nodes: &mut dyn Iterator<Item = NodeId>) -> Value {
        let mut next = || nodes.next().expect("one parameter for each scalar or vector of the type");
        match ty.kind() {
            TyKind::Row(table) => {
                let index = next();
                self.row(*table, None, index)
            }
            TyKind::Tuple(elems) => {
                let elems: Vec<Value> = elems.iter().map(|t| self.of_type(*t, nodes)).collect();
                self.tuples.make(&elems)
            }
            _ => Value::Data(next()),
        }
    }

    /// Make the residual function and let its body wait.
    fn make_function(
        &mut self,
        c: ContId,
        parent: FrameId,
        args: &[Value],
        lift: &Lift,
        ret_ty: Ty,
        reason: Reason,
    ) -> Result<ContId, Error> {
        let loc = self.p.cont(c).loc;
        let param = |x: &NodeId| {
            let program = self.world.program();
            let name = match *program.node(*x) {
                Node::Param { cont, index } => program.cont(cont).params[index as usize].name.clone(),
                _ => program.names.get(x).cloned(),
            };
            Param { ty: program.ty(*x), name, keep: false }
        };
        let mut params: Vec<Param> = lift.unknowns.iter().map(param).collect();
        params.extend(self.params_for(c, args, reason));
        params.push(Param { ty: ret_ty, name: Some("return".into()), keep: false });
        let (function, _) = self.block(Value::Closure(c, parent), Role::Fun, params, loc);
        self.check_copies(c, ROOT, args, function)?;
        self.functions.insert(lift.key.clone().into(), function);
        let nodes = self.world.params(function);
        let frames = self.rebuild_frames(lift, &nodes);
        let move_to = |f: FrameId| frames.get(&f).copied().unwrap_or(f);
        let mut rest = nodes[lift.unknowns.len()..].iter().copied();
        let mut new_args: Vec<Value> = Vec::new();
        for (i, arg) in args.iter().enumerate() {
            new_args.push(self.rebuild(*arg, self.kept(c, i, reason), &mut rest, &move_to));
        }
        new_args.push(Value::Exit(rest.next().expect("the return is the last parameter")));
        let frame = self.frames.enter(self.scope, c, move_to(parent), &new_args, self.trail);
        self.wait(function, function, Step::Enter(c, frame));
        Ok(function)
    }

    /// The frames of all reached closures again, with unknowns replaced by the function's parameters. Frames are made
    /// after all that they refer to, so ascending order meets parts before wholes.
    fn rebuild_frames(&mut self, lift: &Lift, params: &[NodeId]) -> FxHashMap<FrameId, FrameId> {
        let mut old: BTreeSet<FrameId> = BTreeSet::new();
        for (_, f) in &lift.closures {
            let mut f = *f;
            while f != ROOT && old.insert(f) {
                f = self.frames.parent(f);
            }
        }
        let mut new: FxHashMap<FrameId, FrameId> = FxHashMap::default();
        for f in old {
            let move_to = |f: FrameId| new.get(&f).copied().unwrap_or(f);
            let cont = self.frames.cont(f);
            let mut args = vec![Value::Nothing; self.p.cont(cont).params.len()];
            for (i, arg) in args.iter_mut().enumerate() {
                if let Some(value) = lift.reached.get(&(f, i as u32)) {
                    *arg = self.replace(*value, lift, params, &move_to);
                }
            }
            let parent = move_to(self.frames.parent(f));
            let made = self.frames.enter(self.scope, cont, parent, &args, self.trail);
            new.insert(f, made);
        }
        new
    }

    /// A value of the environment with unknowns replaced by parameters.
    fn replace(&mut self, v: Value, lift: &Lift, params: &[NodeId], move_to: &dyn Fn(FrameId) -> FrameId) -> Value {
        let data = |x: NodeId| lift.position.get(&x).map_or(x, |at| params[*at as usize]);
        match v {
            Value::Data(x) => Value::Data(data(x)),
            Value::Row { table, class, index } => Value::Row { table, class, index: data(index) },
            Value::Tuple(id) => {
                let elems = self.tuples.elems(id).to_vec();
                let elems: Vec<Value> = elems.into_iter().map(|x| self.replace(x, lift, params, move_to)).collect();
                self.tuples.make(&elems)
            }
            Value::Closure(c, f) => Value::Closure(c, move_to(f)),
            other => other,
        }
    }

    /// Identify a callee by content; `None` if an exit or a local array can be reached.
    fn lift(&self, c: ContId, parent: FrameId, args: &[Value], reason: Reason) -> Option<Lift> {
        let mut lift = Lift::default();
        lift.closure(c, parent);
        for (i, arg) in args.iter().enumerate() {
            self.lift_arg(&mut lift, *arg, self.kept(c, i, reason))?;
        }
        let mut next = 0;
        while let Some(&(c, f)) = lift.closures.get(next) {
            if next == MOST_CLOSURES {
                return None;
            }
            lift.key.push(c.0);
            for free in &self.scope.free[c.index()] {
                let Node::Param { cont, index } = *self.p.node(*free) else {
                    unreachable!("free variables are parameters")
                };
                let frame = self.frame_of(cont, f);
                let value = self.frames.arg(frame, index);
                lift.reached.insert((frame, index), value);
                self.lift_free(&mut lift, value)?;
            }
            next += 1;
        }
        Some(lift)
    }

    /// An argument: what is not kept is passed as it stands.
    fn lift_arg(&self, lift: &mut Lift, arg: Value, kept: Kept) -> Option<()> {
        let scalar = |lift: &mut Lift, x: NodeId| match kept.literals && self.lit(x).is_some() {
            true => lift.key.extend([1, x.0]),
            false => {
                lift.key.push(0);
                lift.actuals.push(x);
            }
        };
        match arg {
            Value::Data(x) => scalar(lift, x),
            Value::Row { class, index, .. } => {
                lift.key.push(if kept.classes { class } else { NO_CLASS });
                scalar(lift, index);
            }
            Value::Tuple(id) => self.tuples.elems(id).iter().try_for_each(|x| self.lift_arg(lift, *x, kept))?,
            Value::Closure(c, f) => lift.closure(c, f),
            Value::Local(_) | Value::Exit(_) | Value::Nothing => return None,
        }
        Some(())
    }

    /// A free variable: unknowns count by position.
    fn lift_free(&self, lift: &mut Lift, value: Value) -> Option<()> {
        match value {
            Value::Data(x) => self.lift_data(lift, x),
            Value::Row { class, index, .. } => {
                lift.key.push(class);
                self.lift_data(lift, index);
            }
            Value::Tuple(id) => self.tuples.elems(id).iter().try_for_each(|x| self.lift_free(lift, *x))?,
            Value::Closure(c, f) => lift.closure(c, f),
            Value::Local(_) | Value::Exit(_) | Value::Nothing => return None,
        }
        Some(())
    }

    fn lift_data(&self, lift: &mut Lift, x: NodeId) {
        if self.lit(x).is_some() {
            return lift.key.extend([1, x.0]);
        }
        let next = lift.unknowns.len() as u32;
        let at = *lift.position.entry(x).or_insert(next);
        if at == next {
            lift.unknowns.push(x);
        }
        lift.key.extend([0, at]);
    }
}

impl Lift {
    /// A closure counts by its number; its content follows in the order of numbers.
    fn closure(&mut self, c: ContId, f: FrameId) {
        let next = self.closures.len() as u32;
        let at = *self.number.entry((c, f)).or_insert(next);
        if at == next {
            self.closures.push((c, f));
        }
        self.key.push(at);
    }
}
