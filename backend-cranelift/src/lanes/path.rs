//! A point of lane code that is being written, what is known there, and how such points meet.

use std::collections::BTreeMap;

use jerboa_ir::*;

use super::flow::Target;
use super::value::{Value, Writer};

/// What changes along a path, apart from what the scalar program itself passes from block to block.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Var {
    /// The lanes that are active.
    Mask,
    /// The lanes that wait at this target.
    Waiting(Target),
    /// The lanes that have come through the arms of this block's choice so far.
    Through(u32),
    /// What is passed to the target's parameter of this number.
    Passed(Target, usize),
    /// A value that outlives the round in which it is made, by parameter.
    Kept(NodeId),
}

/// A point of lane code.
#[derive(Clone)]
pub(crate) struct Path {
    /// The continuation that has no body yet.
    pub at: ContId,
    pub env: BTreeMap<Var, Value>,
    /// Is some lane active for sure?
    pub alive: bool,
}

impl Path {
    /// The lanes that are active.
    pub fn mask(&self) -> NodeId {
        self.env[&Var::Mask].nodes()[0]
    }

    pub fn set_mask(&mut self, mask: NodeId) {
        self.env.insert(Var::Mask, Value::Varying(vec![mask]));
    }
}

/// Lets paths meet. What differs becomes parameters of a block; what is not there on one of them is zero.
pub(crate) fn meet(w: &mut Writer, name: &str, mut paths: Vec<Path>) -> Option<Path> {
    if paths.len() < 2 {
        return paths.pop();
    }
    let alive = paths.iter().all(|path| path.alive);
    let mut all: BTreeMap<Var, Value> = BTreeMap::new();
    for (var, value) in paths.iter().flat_map(|path| &path.env) {
        let known = all.entry(*var).or_insert_with(|| value.clone());
        if known.shape() != value.shape() {
            *known = Value::Varying(w.widen(known));
        }
    }
    let agrees = |var: &Var, value: &Value| paths.iter().all(|path| path.env.get(var) == Some(value));
    let differing: Vec<Var> = all.iter().filter(|(var, value)| !agrees(var, value)).map(|(var, _)| *var).collect();
    let types: Vec<Ty> = differing.iter().flat_map(|var| all[var].nodes()).map(|x| w.w.program().ty(*x)).collect();
    // Without parameters any of the paths can take the others in.
    let is_plain = |path: &Path| w.w.program().cont(path.at).params.is_empty();
    let host = paths.iter().rposition(is_plain).filter(|_| differing.is_empty());
    let (block, params) = match host {
        Some(host) => (paths.remove(host).at, Vec::new()),
        None => w.cont(name, Role::Join, &types, w.loc),
    };
    for path in &paths {
        let mut args = Vec::new();
        for var in &differing {
            let value = match path.env.get(var) {
                Some(value) if value.shape() == all[var].shape() => value.clone(),
                Some(value) => Value::Varying(w.widen(value)),
                None => w.zero_like(&all[var]),
            };
            args.extend(value.nodes());
        }
        w.jump(path.at, block, args);
    }
    let mut params = params.into_iter();
    for var in differing {
        let value = all.get_mut(&var).expect("it differs, so it is there");
        *value = with_nodes(value, &mut params);
    }
    Some(Path { at: block, env: all, alive })
}

/// A value of the same form, of the next nodes.
pub(crate) fn with_nodes(value: &Value, nodes: &mut impl Iterator<Item = NodeId>) -> Value {
    let mut next = || nodes.next().expect("there is a node for each part");
    match value {
        Value::Uniform(_) => Value::Uniform(next()),
        Value::Consecutive(_) => Value::Consecutive(next()),
        Value::Varying(parts) => Value::Varying(parts.iter().map(|_| next()).collect()),
    }
}
