//! Calls: which unfold, and what those that stay share.

use jerboa_ir::*;

use crate::budget::Event;
use crate::error::Error;
use crate::frame::ROOT;
use crate::log::{Decision, Reason};
use crate::machine::{Machine, Step};
use crate::value::{FrameId, NO_CLASS, Value};

/// What of an argument stays known where the call stays.
#[derive(Clone, Copy)]
pub(crate) struct Kept {
    /// Literals.
    pub literals: bool,
    /// Classes of rows.
    pub classes: bool,
}

impl Machine<'_> {
    /// Consider a call.
    pub(crate) fn call(&mut self, callee: Value, args: Vec<Value>, mode: Mode) -> Result<Step, Error> {
        let (c, parent) = match callee {
            Value::Closure(c, parent) => (c, parent),
            Value::Exit(to) => return self.return_to(to, &args),
            other => unreachable!("the verifier lets only continuations be called, not {other:?}"),
        };
        let (unfold, reason) = self.decide(c, parent, &args, mode)?;
        if !unfold {
            return self.stay(c, parent, &args, reason);
        }
        self.log(c, reason, Decision::Unfolded, &args);
        self.unfolded[c.index()] += 1;
        self.unfoldings += 1;
        self.trail = match self.p.cont(c).role {
            Role::Fun => self.trails.push(self.trail, c),
            // The rest of a function is entered with the calls that led to the function.
            _ if parent != ROOT => self.frames.trail(parent),
            _ => self.trail,
        };
        Ok(Step::Enter(c, self.frames.enter(self.scope, c, parent, &args, self.trail)))
    }

    /// Does the call unfold, and why?
    fn decide(&mut self, c: ContId, parent: FrameId, args: &[Value], mode: Mode) -> Result<(bool, Reason), Error> {
        let p = self.p;
        let cont = p.cont(c);
        if cont.role != Role::Arm && self.exhausted(c)? {
            return Ok((false, Reason::Budget));
        }
        match mode {
            Mode::Now => return Ok((true, Reason::Mode)),
            Mode::Later => return Ok((false, Reason::Mode)),
            Mode::Filter => {}
        }
        let unfold = match p.as_lit(cont.filter) {
            Some(lit) => lit == Lit::Bool(true),
            None => {
                let own = self.scope.owner[cont.filter.index()] == Some(c);
                let frame = if own { self.frames.enter(self.scope, c, parent, args, self.trail) } else { parent };
                let value = self.data(cont.filter, frame);
                self.lit(value) == Some(Lit::Bool(true))
            }
        };
        if unfold && cont.role == Role::Fun && self.chance() {
            return Ok((false, Reason::Chaos));
        }
        Ok((unfold, Reason::Filter(unfold)))
    }

    /// Is a budget used up, so that calls of `c` must stay?
    fn exhausted(&mut self, c: ContId) -> Result<bool, Error> {
        let budget = &self.options.budget;
        let nodes = self.world.program().nodes.len() + self.world.program().conts.len();
        let (size, room) = (self.frames.size(), budget.cells);
        if nodes > 2 * budget.nodes || size > 2 * room {
            return Err(Error::TooLarge { nodes, chain: self.chain() });
        }
        if nodes > budget.nodes || size > room {
            if !self.events.contains(&Event::Size) {
                self.events.push(Event::Size);
            }
            return Ok(true);
        }
        if self.unfolded[c.index()] < budget.unfoldings {
            return Ok(false);
        }
        let event = Event::Unfoldings(self.p.cont(c).name.to_string());
        if !self.events.contains(&event) {
            self.events.push(event);
        }
        Ok(true)
    }

    /// Leave a call: to a residual function if its only way out is its return, else to a block.
    fn stay(&mut self, c: ContId, parent: FrameId, args: &[Value], reason: Reason) -> Result<Step, Error> {
        let copies = |env| self.copies.get(&(c, env)).map_or(0, |v| v.len() as u32);
        if copies(parent).max(copies(ROOT)) >= self.options.budget.copies / 2 {
            self.generalised[c.index()] = true;
        }
        if reason != Reason::Chaos
            && let Some(step) = self.stay_function(c, parent, args, reason)?
        {
            return Ok(step);
        }
        self.stay_block(c, parent, args, reason)
    }

    /// Leave a call to a block of the current function. Blocks are shared by continuation, frame and what is kept of
    /// the arguments; scalars become parameters, so loops close.
    fn stay_block(&mut self, c: ContId, parent: FrameId, args: &[Value], reason: Reason) -> Result<Step, Error> {
        let loc = self.p.cont(c).loc;
        let mut key = vec![self.function.0, c.0, parent.0];
        let mut actuals = Vec::new();
        for (i, arg) in args.iter().enumerate() {
            self.key_of(*arg, self.kept(c, i, reason), &mut key, &mut actuals);
        }
        let block = match self.blocks.get(&key[..]) {
            Some(block) => {
                let block = *block;
                self.log(c, reason, Decision::Shared, args);
                block
            }
            None => {
                self.log(c, reason, Decision::Block, args);
                let params = self.params_for(c, args, reason);
                // Only a residual function has the role of one; a function that stays as a block is like a label.
                let role = match self.p.cont(c).role {
                    Role::Fun | Role::Arm => Role::Label,
                    role => role,
                };
                let (block, _) = self.block(Value::Closure(c, parent), role, params, loc);
                if reason != Reason::Chaos {
                    self.check_copies(c, parent, args, block)?;
                }
                self.blocks.insert(key.into(), block);
                let mut nodes = self.world.params(block).into_iter();
                let args: Vec<Value> = args
                    .iter()
                    .enumerate()
                    .map(|(i, a)| self.rebuild(*a, self.kept(c, i, reason), &mut nodes, &|f| f))
                    .collect();
                let frame = self.frames.enter(self.scope, c, parent, &args, self.trail);
                self.wait(block, self.function, Step::Enter(c, frame));
                block
            }
        };
        let callee = self.world.cont_value(block);
        Ok(self.leave(Body::Jump { callee, args: actuals, mode: Mode::Filter }, loc))
    }

    /// What stays known of argument `i` of `c`.
    pub(crate) fn kept(&self, c: ContId, i: usize, reason: Reason) -> Kept {
        let cont = self.p.cont(c);
        let general = self.generalised[c.index()];
        let literals = (cont.params[i].keep && !general) || reason == Reason::Chaos;
        Kept { literals, classes: literals || (cont.role == Role::Fun && !general) }
    }

    /// Append what identifies an argument to `key`, and the nodes to pass at run time to `actuals`.
    fn key_of(&self, arg: Value, kept: Kept, key: &mut Vec<u32>, actuals: &mut Vec<NodeId>) {
        let mut scalar = |x: NodeId, key: &mut Vec<u32>| match kept.literals && self.lit(x).is_some() {
            true => key.extend([1, x.0]),
            false => {
                key.push(0);
                actuals.push(x);
            }
        };
        match arg {
            Value::Data(x) => scalar(x, key),
            Value::Row { class, index, .. } => {
                key.push(if kept.classes { class } else { NO_CLASS });
                scalar(index, key);
            }
            Value::Tuple(id) => self.tuples.elems(id).iter().for_each(|x| self.key_of(*x, kept, key, actuals)),
            Value::Closure(c, f) => key.extend([c.0, f.0]),
            Value::Local(x) | Value::Exit(x) => key.extend([u32::MAX, x.0]),
            Value::Nothing => unreachable!("an argument has a value"),
        }
    }

    /// The residual parameters for what is not kept of the arguments.
    pub(crate) fn params_for(&self, c: ContId, args: &[Value], reason: Reason) -> Vec<Param> {
        let mut params = Vec::new();
        for (i, arg) in args.iter().enumerate() {
            let mut actuals = Vec::new();
            self.key_of(*arg, self.kept(c, i, reason), &mut Vec::new(), &mut actuals);
            let name = &self.p.cont(c).params[i].name;
            let param = |x: NodeId| Param { ty: self.world.program().ty(x), name: name.clone(), keep: false };
            params.extend(actuals.into_iter().map(param));
        }
        params
    }

    /// An argument as the callee sees it: parameters for what is not kept, `move_to` for the frames of closures.
    pub(crate) fn rebuild(
        &mut self,
        arg: Value,
        kept: Kept,
        params: &mut dyn Iterator<Item = NodeId>,
        move_to: &dyn Fn(FrameId) -> FrameId,
    ) -> Value {
        let mut scalar = |m: &Self, x: NodeId| match kept.literals && m.lit(x).is_some() {
            true => x,
            false => params.next().expect("one parameter for each scalar that is not kept"),
        };
        match arg {
            Value::Data(x) => Value::Data(scalar(self, x)),
            Value::Row { table, class, index } => {
                let index = scalar(self, index);
                self.row(table, (kept.classes && class != NO_CLASS).then_some(class), index)
            }
            Value::Tuple(id) => {
                let elems = self.tuples.elems(id).to_vec();
                let elems: Vec<Value> = elems.into_iter().map(|x| self.rebuild(x, kept, params, move_to)).collect();
                self.tuples.make(&elems)
            }
            Value::Closure(c, f) => Value::Closure(c, move_to(f)),
            other => other,
        }
    }

    /// Return from the residual function.
    fn return_to(&mut self, to: NodeId, args: &[Value]) -> Result<Step, Error> {
        let mut actuals = Vec::new();
        for arg in args {
            self.flatten(*arg, &mut actuals);
        }
        Ok(self.leave(Body::Jump { callee: to, args: actuals, mode: Mode::Filter }, Loc::NONE))
    }

    /// The scalars and vectors that a value is made of at run time.
    fn flatten(&self, value: Value, out: &mut Vec<NodeId>) {
        match value {
            Value::Data(x) | Value::Row { index: x, .. } => out.push(x),
            Value::Tuple(id) => self.tuples.elems(id).iter().for_each(|x| self.flatten(*x, out)),
            other => unreachable!("the types of results are data, not {other:?}"),
        }
    }
}
