//! The decision log: one line for each call that was considered, and why what stayed unknown did.

use std::fmt;

use jerboa_ir::{Body, ContId, Loc, Node, NodeId, Role};

use crate::machine::Machine;
use crate::value::{NO_CLASS, Value};

/// A path of unfolded calls, by its place in [`Trails`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct TrailId(u32);

impl TrailId {
    /// No call yet.
    pub const NONE: TrailId = TrailId(u32::MAX);
}

/// Paths of calls that share their beginnings.
#[derive(Default)]
pub(crate) struct Trails(Vec<(TrailId, ContId)>);

impl Trails {
    /// The path `from`, then a call of `cont`.
    pub fn push(&mut self, from: TrailId, cont: ContId) -> TrailId {
        self.0.push((from, cont));
        TrailId(self.0.len() as u32 - 1)
    }

    /// The last `most` calls of a path, outermost first; a call repeated in a row counts once.
    pub fn last(&self, mut at: TrailId, most: usize) -> Vec<ContId> {
        let mut calls: Vec<ContId> = Vec::new();
        while at != TrailId::NONE && calls.len() < most {
            let (up, cont) = self.0[at.0 as usize];
            if calls.last() != Some(&cont) {
                calls.push(cont);
            }
            at = up;
        }
        calls.reverse();
        calls
    }
}

/// What became of a call.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Decision {
    /// Its body was evaluated in place.
    Unfolded,
    /// It became a new block of the residual function.
    Block,
    /// It became a call of a new residual function.
    Function,
    /// It shares a block or function that was there already.
    Shared,
    /// A dispatch: the body once per class.
    Classes(u32),
    /// Its body is never evaluated.
    Dropped,
}

/// Why a call was decided as it was.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Reason {
    /// The filter is this.
    Filter(bool),
    /// The call site says "now" or "later".
    Mode,
    /// It is the body of a `vectorize`.
    Vectorize,
    /// A budget is used up.
    Budget,
    /// Chaos, for tests.
    Chaos,
}

/// Where an unknown comes from.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Origin {
    /// The parameter that is unknown.
    pub param: String,
    /// In words: a load, a read, a parameter.
    pub source: String,
    /// The author's line of that.
    pub loc: Loc,
}

/// A call that was considered.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Call {
    /// The callee's name.
    pub name: String,
    /// The callee's line.
    pub loc: Loc,
    /// Why.
    pub reason: Reason,
    /// What became of it.
    pub decision: Decision,
    /// Arguments that stayed unknown.
    pub unknown: Vec<Origin>,
}

impl fmt::Display for Call {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({}): ", self.name, self.loc)?;
        match self.reason {
            Reason::Filter(value) => write!(f, "filter {value}, ")?,
            Reason::Mode => f.write_str("as the call says, ")?,
            Reason::Vectorize => f.write_str("body of a vectorize, ")?,
            Reason::Budget => f.write_str("over budget, ")?,
            Reason::Chaos => f.write_str("chaos, ")?,
        }
        match self.decision {
            Decision::Unfolded => f.write_str("unfolded")?,
            Decision::Block => f.write_str("stays as a block")?,
            Decision::Function => f.write_str("stays as a function")?,
            Decision::Shared => f.write_str("stays, shares what is there")?,
            Decision::Dropped => f.write_str("never runs")?,
            Decision::Classes(n) => write!(f, "run once for each of {n} classes")?,
        }
        for (i, origin) in self.unknown.iter().enumerate() {
            let sep = if i == 0 { "; " } else { ", " };
            write!(f, "{sep}`{}` comes from {} at {}", origin.param, origin.source, origin.loc)?;
        }
        Ok(())
    }
}

/// The decisions of one specialisation, in the order they were made.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Log {
    /// One for each call considered; empty unless [`crate::Options::log`] asks for it.
    pub calls: Vec<Call>,
}

impl fmt::Display for Log {
    /// One line for each call.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.calls.iter().try_for_each(|c| writeln!(f, "{c}"))
    }
}

impl Machine<'_> {
    /// Note a decision, if somebody wants to read it. Arms and rests that go on as they must are no decisions.
    pub(crate) fn log(&mut self, c: ContId, reason: Reason, decision: Decision, args: &[Value]) {
        let cont = self.p.cont(c);
        let plain = matches!(cont.role, Role::Arm | Role::Rest) && reason == Reason::Filter(true);
        if !self.options.log || (plain && decision == Decision::Unfolded) {
            return;
        }
        // The index of a loop is unknown by nature.
        let args = &args[..args.len() - (reason == Reason::Vectorize) as usize];
        let unknown = args.iter().zip(&cont.params).filter_map(|(arg, param)| {
            let (source, loc) = self.source(self.unknown_in(*arg)?);
            Some(Origin { param: param.name.as_deref().unwrap_or("_").into(), source, loc })
        });
        let call = Call { name: cont.name.to_string(), loc: cont.loc, reason, decision, unknown: unknown.collect() };
        self.calls.push(call);
    }

    /// The first unknown node in a value.
    fn unknown_in(&self, value: Value) -> Option<NodeId> {
        match value {
            Value::Data(x) | Value::Row { class: NO_CLASS, index: x, .. } => Some(x).filter(|x| self.lit(*x).is_none()),
            Value::Tuple(id) => self.tuples.elems(id).iter().find_map(|x| self.unknown_in(*x)),
            _ => None,
        }
    }

    /// Where a residual node comes from: its first read or parameter, in words, with the author's line.
    fn source(&self, mut node: NodeId) -> (String, Loc) {
        let program = self.world.program();
        loop {
            match program.node(node) {
                Node::Param { cont, index } => return self.source_of_param(*cont, *index as usize),
                Node::Read { column, .. } => {
                    let name =
                        format!("a read of {}.{}", program.buffer(column.buf).name, program.column(*column).name);
                    return (name, program.locs[node.index()]);
                }
                _ => {}
            }
            let mut next = None;
            program.operands(node, &mut |x| next = next.or(program.as_lit(x).is_none().then_some(x)));
            match next {
                Some(x) => node = x,
                None => return ("a constant".into(), program.locs[node.index()]),
            }
        }
    }

    fn source_of_param(&self, cont: ContId, index: usize) -> (String, Loc) {
        let program = self.world.program();
        let c = program.cont(cont);
        let name = c.params[index].name.as_deref().unwrap_or("_");
        let words = match (c.role, &program.cont(self.made_in[cont.index()]).body) {
            (Role::Rest, Body::Load { .. }) => "a load".into(),
            (Role::Rest, _) => "the result of a call".into(),
            (Role::Loop, _) => format!("`{name}` of the loop `{}`", c.name),
            (Role::Join, _) => "the join of an unknown branch".into(),
            _ => format!("parameter `{name}` of `{}`", c.name),
        };
        (words, c.loc)
    }
}
