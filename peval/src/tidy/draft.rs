//! A residual while it is tidied: bodies are edited in place, values by substitution.
//!
//! A pass looks at the reachable continuations, edits their bodies, and says which nodes stand for which others; only
//! nodes that depend on a replaced one are made again. Nothing is deleted: what is not reached any more is left behind
//! when the draft is finished.

use jerboa_ir::*;
use rustc_hash::FxHashMap;

/// How a body mentions a continuation.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Mention {
    /// As the callee of a jump in this continuation: its arguments can be seen.
    Call(ContId),
    /// As an arm, or as what follows a load or a store.
    Arm(ContId),
    /// As the return of a call.
    Return(ContId),
    /// As the body of a `vectorize`: its arguments can be seen, but for index and return, which come last.
    Body(ContId),
}

impl Mention {
    /// The continuation that mentions.
    pub fn from(self) -> ContId {
        let (Mention::Call(from) | Mention::Arm(from) | Mention::Return(from) | Mention::Body(from)) = self;
        from
    }
}

/// A residual that is being tidied.
pub(crate) struct Draft {
    pub world: World,
    pub entry: ContId,
}

/// Which nodes stand for which others. Targets are substituted too, so chains are followed; they must not be circular.
pub(crate) type Subst = FxHashMap<NodeId, NodeId>;

impl Draft {
    pub fn p(&self) -> &Program {
        self.world.program()
    }

    pub fn body(&self, c: ContId) -> &Body {
        &self.p().cont(c).body
    }

    /// The continuation that a node is, if it is one.
    pub fn cont_of(&self, node: NodeId) -> Option<ContId> {
        match self.p().node(node) {
            Node::Cont(c) => Some(*c),
            _ => None,
        }
    }

    /// Reachable continuations, each after one that mentions it.
    pub fn order(&self) -> Vec<ContId> {
        reached(self.p(), self.entry)
    }

    /// Mentions of each continuation in the bodies of `order`.
    pub fn mentions(&self, order: &[ContId]) -> Vec<Vec<Mention>> {
        let mut all: Vec<Vec<Mention>> = vec![Vec::new(); self.p().conts.len()];
        for c in order {
            let mut add = |node: NodeId, mention: Mention| {
                if let Some(to) = self.cont_of(node) {
                    all[to.index()].push(mention);
                }
            };
            match self.body(*c) {
                Body::Jump { callee, args, .. } => {
                    add(*callee, Mention::Call(*c));
                    args.last().into_iter().for_each(|x| add(*x, Mention::Return(*c)));
                }
                Body::Vectorize { body, next, .. } => {
                    add(*body, Mention::Body(*c));
                    add(*next, Mention::Arm(*c));
                }
                body => body.operands(&mut |x| add(x, Mention::Arm(*c))),
            }
        }
        all
    }

    /// Replace nodes everywhere in the bodies of `order`.
    pub fn apply(&mut self, order: &[ContId], subst: &Subst) {
        if subst.is_empty() {
            return;
        }
        let stale = self.stale(subst);
        let mut done: FxHashMap<NodeId, NodeId> = FxHashMap::default();
        for c in order {
            let mut body = std::mem::replace(&mut self.world.cont_mut(*c).body, Body::Unset);
            map_body(&mut body, &mut |x| self.rewrite(x, subst, &stale, &mut done));
            self.world.cont_mut(*c).body = body;
        }
    }

    /// Nodes that depend on a replaced one.
    fn stale(&self, subst: &Subst) -> Vec<bool> {
        let mut stale = vec![false; self.p().nodes.len()];
        for id in (0..stale.len() as u32).map(NodeId) {
            let mut any = subst.contains_key(&id);
            self.p().operands(id, &mut |x| any |= stale[x.index()]);
            stale[id.index()] = any;
        }
        stale
    }

    fn rewrite(&mut self, node: NodeId, subst: &Subst, stale: &[bool], done: &mut FxHashMap<NodeId, NodeId>) -> NodeId {
        let fresh = |n: NodeId| !stale.get(n.index()).is_some_and(|s| *s);
        if fresh(node) {
            return node;
        }
        let mut stack = vec![node];
        while let Some(&n) = stack.last() {
            let height = stack.len();
            if !done.contains_key(&n) {
                let missing = |x: &NodeId| !fresh(*x) && !done.contains_key(x);
                match subst.get(&n) {
                    Some(to) => stack.extend(Some(*to).filter(missing)),
                    None => self.p().operands(n, &mut |x| stack.extend(Some(x).filter(missing))),
                }
                if stack.len() > height {
                    continue;
                }
                let get = |x: NodeId| done.get(&x).copied().unwrap_or(x);
                let new = match subst.get(&n) {
                    Some(to) => get(*to),
                    None => {
                        let (node, ty, loc) = (self.p().node(n).clone(), self.p().ty(n), self.p().locs[n.index()]);
                        let name = self.p().names.get(&n).cloned();
                        remake(&mut self.world, &node, ty, loc, name.as_deref(), &get)
                    }
                };
                done.insert(n, new);
            }
            stack.pop();
        }
        done[&node]
    }

    /// A copy of a block that takes only these of its parameters. Their nodes, and the block, are substituted; the
    /// caller shortens the jumps.
    pub fn shorten(&mut self, c: ContId, keep: &[usize], subst: &mut Subst) {
        let old = self.p().cont(c).clone();
        let params = keep.iter().map(|i| old.params[*i].clone()).collect();
        let new = self.world.cont(old.name, old.role, params, old.loc);
        self.world.cont_mut(new).filter = old.filter;
        self.world.cont_mut(new).body = old.body;
        for (to, from) in keep.iter().enumerate() {
            let (from, to) = (self.world.param(c, *from), self.world.param(new, to));
            subst.insert(from, to);
        }
        let (from, to) = (self.world.cont_value(c), self.world.cont_value(new));
        subst.insert(from, to);
        if self.entry == c {
            self.entry = new;
        }
    }

    /// Leave behind what is not reached, and put the rest in canonical order. Gives the number of nodes dropped.
    pub fn compact(&mut self) -> u64 {
        let before = self.p().nodes.len();
        *self = Draft::copy(self.p(), self.entry);
        self.name_labels();
        before.saturating_sub(self.p().nodes.len()) as u64
    }

    /// An arm with more than one way in is a label, as it is when the residual is specialised again.
    fn name_labels(&mut self) {
        let order = self.order();
        let mentions = self.mentions(&order);
        for c in order {
            let cont = self.world.cont_mut(c);
            if cont.role == Role::Arm && mentions[c.index()].len() > 1 {
                cont.role = Role::Label;
            }
        }
    }

    /// What `entry` reaches of a residual, in canonical order.
    pub fn copy(old: &Program, entry: ContId) -> Draft {
        let order = reached(old, entry);
        let mut world = World::new();
        for buffer in &old.buffers {
            world.buffer(buffer.clone());
        }
        let mut conts: FxHashMap<ContId, ContId> = FxHashMap::default();
        let stays = world.lit(Lit::Bool(false));
        for c in &order {
            let cont = old.cont(*c);
            let new = world.cont(cont.name.clone(), cont.role, cont.params.clone(), cont.loc);
            world.cont_mut(new).filter = stays;
            conts.insert(*c, new);
        }
        let mut done = vec![NodeId::NONE; old.nodes.len()];
        for c in &order {
            let mut body = old.cont(*c).body.clone();
            map_body(&mut body, &mut |x| copy_node(old, &mut world, x, &conts, &mut done));
            world.cont_mut(conts[c]).body = body;
        }
        let entry = conts[&entry];
        world.entry(old.entries[0].0.clone(), entry);
        Draft { world, entry }
    }
}

/// Continuations that `entry` reaches, each after one that mentions it.
fn reached(p: &Program, entry: ContId) -> Vec<ContId> {
    let mut seen = vec![false; p.conts.len()];
    let mut stack = vec![entry];
    let mut order = Vec::new();
    while let Some(c) = stack.pop() {
        if std::mem::replace(&mut seen[c.index()], true) {
            continue;
        }
        order.push(c);
        let from = stack.len();
        p.cont(c).body.operands(&mut |x| {
            if let Node::Cont(to) = p.node(x) {
                stack.push(*to);
            }
        });
        stack[from..].reverse();
    }
    order
}

/// Copy a node and what it depends on to another world.
fn copy_node(
    old: &Program,
    world: &mut World,
    node: NodeId,
    conts: &FxHashMap<ContId, ContId>,
    done: &mut [NodeId],
) -> NodeId {
    let mut stack = vec![node];
    while let Some(&n) = stack.last() {
        let height = stack.len();
        if done[n.index()] == NodeId::NONE {
            old.operands(n, &mut |x| stack.extend(Some(x).filter(|x| done[x.index()] == NodeId::NONE)));
            if stack.len() > height {
                continue;
            }
            let new = match old.node(n) {
                Node::Param { cont, index } => world.param(conts[cont], *index as usize),
                Node::Cont(c) => world.cont_value(conts[c]),
                node => {
                    let name = old.names.get(&n).map(|n| &**n);
                    remake(world, node, old.ty(n), old.locs[n.index()], name, &|x| done[x.index()])
                }
            };
            done[n.index()] = new;
        }
        stack.pop();
    }
    done[node.index()]
}

/// A residual node over other operands, folded again.
fn remake(
    world: &mut World,
    node: &Node,
    ty: Ty,
    loc: Loc,
    name: Option<&str>,
    get: &dyn Fn(NodeId) -> NodeId,
) -> NodeId {
    let new = match node {
        Node::Prim { op, args } => {
            let args: Vec<NodeId> = args[..op.arity()].iter().map(|x| get(*x)).collect();
            world.prim(*op, &args, loc)
        }
        Node::Pack(lanes) => {
            let lanes: Vec<NodeId> = lanes.iter().map(|x| get(*x)).collect();
            world.pack(&lanes, loc)
        }
        Node::Lane { vector, lane } => world.lane(get(*vector), *lane as usize, loc),
        Node::Read { column, index } => world.read(*column, get(*index), loc),
        other => world.node(other.clone(), ty, loc),
    };
    if let Some(name) = name {
        world.name(new, name);
    }
    new
}

/// Replace each node that a body mentions.
pub(crate) fn map_body(body: &mut Body, f: &mut dyn FnMut(NodeId) -> NodeId) {
    fn mem(m: &mut Mem, f: &mut dyn FnMut(NodeId) -> NodeId) {
        if let Mem::Local(x) = m {
            *x = f(*x);
        }
    }
    let mut all = |nodes: &mut [&mut NodeId]| nodes.iter_mut().for_each(|x| **x = f(**x));
    match body {
        Body::Unset => {}
        Body::Jump { callee, args, .. } => {
            args.iter_mut().for_each(|x| all(&mut [x]));
            all(&mut [callee])
        }
        Body::Branch { cond, then, other } => all(&mut [cond, then, other]),
        Body::Switch { index, arms, default } => {
            all(&mut [index]);
            arms.iter_mut().for_each(|(_, arm)| all(&mut [arm]));
            all(&mut [default])
        }
        Body::Dispatch { row, arm } => all(&mut [row, arm]),
        Body::Load { mem: m, index, next } => {
            all(&mut [index, next]);
            mem(m, f)
        }
        Body::Store { mem: m, index, value, mask, next } => {
            all(&mut [index, value, next]);
            if *mask != NodeId::NONE {
                all(&mut [mask]);
            }
            mem(m, f)
        }
        Body::Vectorize { lo, hi, body, args, next, .. } => {
            args.iter_mut().for_each(|x| all(&mut [x]));
            all(&mut [lo, hi, body, next])
        }
        Body::Local { next, .. } => all(&mut [next]),
    }
}
