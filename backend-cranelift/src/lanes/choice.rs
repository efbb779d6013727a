//! Choices in lane code: a branch where all lanes agree, else the arms one after the other.

use jerboa_ir::cfg::{Block, Exit};
use jerboa_ir::structure::Step;
use jerboa_ir::*;
use rustc_hash::FxHashMap;

use super::Fault;
use super::flow::leaves;
use super::function::Writing;
use super::path::{Path, Var, meet};
use super::place::Place;
use super::value::Value;

/// An arm of so many operations is not worth a branch around it. A test of a mask and a branch are four instructions.
const CHEAP: usize = 4;

impl Writing<'_, '_> {
    /// All lanes go the same way: a branch.
    pub(super) fn uniform_choice(&mut self, block: u32, arms: &[Vec<Step>]) -> Result<(), Fault> {
        let (p, f) = (self.lanes.p, self.f);
        let Block { cont, succs, .. } = &f.blocks[block as usize];
        let loc = p.cont(*cont).loc;
        let mut heads = FxHashMap::default();
        for succ in succs {
            let name = p.cont(f.blocks[*succ as usize].cont).name.clone();
            heads.insert(*succ, self.lanes.writer.cont(&name, Role::Arm, &[], loc).0);
        }
        let head = |w: &mut World, arm: NodeId| match p.node(arm) {
            Node::Cont(arm) => w.cont_value(heads[&f.number[arm]]),
            _ => unreachable!("arms of a residual are blocks"),
        };
        let body = match &p.cont(*cont).body {
            Body::Branch { cond, then, other } => {
                let cond = self.uniform(*cond);
                let w = &mut self.lanes.writer.w;
                Body::Branch { cond, then: head(w, *then), other: head(w, *other) }
            }
            Body::Switch { index, arms, default } => {
                let index = self.uniform(*index);
                let w = &mut self.lanes.writer.w;
                let arms = arms.iter().map(|(n, arm)| (*n, head(w, *arm))).collect();
                Body::Switch { index, arms, default: head(w, *default) }
            }
            _ => unreachable!("only these go on in several blocks"),
        };
        let before = self.path.take().expect("a path is under way");
        self.lanes.writer.w.set_body(before.at, body, loc);
        let mut through = Vec::new();
        for (succ, arm) in succs.iter().zip(arms) {
            self.path = Some(Path { at: heads[succ], ..before.clone() });
            self.steps(arm)?;
            through.extend(self.path.take());
        }
        self.path = meet(&mut self.lanes.writer, "join", through);
        Ok(())
    }

    fn uniform(&mut self, x: NodeId) -> NodeId {
        match self.value(x) {
            Value::Uniform(node) => node,
            other => unreachable!("{other:?} decides a uniform choice"),
        }
    }

    /// Lanes go different ways: one arm after the other, each for its lanes.
    pub(super) fn varying_choice(&mut self, block: u32, arms: &[Vec<Step>]) -> Result<(), Fault> {
        let masks = self.arm_masks(block);
        let (before, alive) = (self.path_mut().mask(), self.path_mut().alive);
        let f = self.f;
        let all_come_through = !arms.iter().any(|arm| leaves(f, arm));
        // Cheap arms first, which are not skipped: what they pass needs no selection, and what others pass selects from it
        // where they are not skipped either.
        let mut order: Vec<(bool, usize)> = (0..arms.len()).map(|i| (!self.is_cheap(&arms[i]), i)).collect();
        order.sort_unstable();
        for (skippable, i) in order {
            let (arm, mask) = (&arms[i], masks[i]);
            let all_of_arm = !leaves(f, arm);
            if !arm.is_empty() {
                self.arm(block, arm, mask, skippable, all_come_through || all_of_arm)?;
            }
            if !all_come_through && all_of_arm {
                self.come_through(block, mask);
            }
        }
        let path = self.path.as_mut().expect("arms end in their place");
        if all_come_through {
            path.set_mask(before);
            path.alive = alive;
        } else if let Some(through) = path.env.remove(&Var::Through(block)) {
            path.env.insert(Var::Mask, through);
            path.alive = false;
        } else {
            self.die();
        }
        Ok(())
    }

    /// One arm, for the lanes of this mask.
    fn arm(
        &mut self,
        block: u32,
        arm: &[Step],
        mask: NodeId,
        skippable: bool,
        all_come_through: bool,
    ) -> Result<(), Fault> {
        self.places.push(Place { target: None, linear: true, waiting: Vec::new() });
        self.path_mut().set_mask(mask);
        self.path_mut().alive = false;
        if skippable {
            self.stay_alive();
        }
        self.steps(arm)?;
        if self.path.is_some() {
            let mask = self.path_mut().mask();
            if !all_come_through {
                self.come_through(block, mask);
            }
            self.die();
        }
        let waiting = self.places.pop().map_or(Vec::new(), |place| place.waiting);
        self.path = meet(&mut self.lanes.writer, "skip", waiting);
        Ok(())
    }

    /// These lanes go on behind the choice.
    fn come_through(&mut self, block: u32, mask: NodeId) {
        let path = self.path.as_mut().expect("a path is under way");
        let mask = match path.env.get(&Var::Through(block)) {
            Some(others) => self.lanes.writer.or(others.nodes()[0], mask),
            None => mask,
        };
        path.env.insert(Var::Through(block), Value::Varying(vec![mask]));
    }

    /// The lanes that take each arm.
    fn arm_masks(&mut self, block: u32) -> Vec<NodeId> {
        let (p, f) = (self.lanes.p, self.f);
        let Block { cont, succs, .. } = &f.blocks[block as usize];
        let mask = self.path_mut().mask();
        let number = |arm: &NodeId| match p.node(*arm) {
            Node::Cont(arm) => f.number[arm],
            _ => unreachable!("arms of a residual are blocks"),
        };
        match &p.cont(*cont).body {
            Body::Branch { cond, .. } => {
                let cond = self.value(*cond);
                let w = &mut self.lanes.writer;
                let cond = w.vector(&cond);
                vec![w.and(mask, cond), w.without(mask, cond)]
            }
            Body::Switch { index, arms, default } => {
                let index = self.value(*index);
                let w = &mut self.lanes.writer;
                let index = w.vector(&index);
                let default = number(default);
                let mut taken = vec![None; succs.len()];
                let mut others = None;
                for (n, arm) in arms.iter().map(|(n, arm)| (*n, number(arm))).filter(|(_, arm)| *arm != default) {
                    let n = w.splat_lit(Lit::U32(n));
                    let equal = w.w.prim(Op::Eq, &[index, n], w.loc);
                    let at = succs.iter().position(|s| *s == arm).expect("an arm is a successor");
                    for so_far in [&mut taken[at], &mut others] {
                        *so_far = Some(so_far.map_or(equal, |x| w.or(x, equal)));
                    }
                }
                let none = w.splat_lit(Lit::Bool(false));
                let others = others.unwrap_or(none);
                let arm = |(succ, taken): (&u32, Option<NodeId>)| match taken {
                    _ if *succ == default => w.without(mask, others),
                    taken => w.and(mask, taken.unwrap_or(none)),
                };
                succs.iter().zip(taken).map(arm).collect()
            }
            _ => unreachable!("only these go on in several blocks"),
        }
    }

    /// Is an arm so short that skipping it costs more? It has no effect and computes little.
    fn is_cheap(&self, arm: &[Step]) -> bool {
        let p = self.lanes.p;
        let mut nodes = 0;
        arm.iter().all(|step| match step {
            Step::Break(_) | Step::Continue(_) => true,
            Step::Block(block) => {
                let cont = self.f.blocks[*block as usize].cont;
                let (Ok(Exit::Jump { args, .. }) | Ok(Exit::Return(args))) = Exit::of(p, cont) else { return false };
                let mut work = args.to_vec();
                while let Some(x) = work.pop().filter(|_| nodes <= CHEAP) {
                    let free = matches!(p.node(x), Node::Lit(_) | Node::Param { .. }) || self.written.contains_key(&x);
                    if !free {
                        nodes += if matches!(p.node(x), Node::Read { .. }) { CHEAP } else { 1 };
                        p.operands(x, &mut |y| work.push(y));
                    }
                }
                nodes <= CHEAP
            }
            _ => false,
        })
    }
}
