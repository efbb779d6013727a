//! Places with an end where lanes wait for others: leaving to it, and going on from it.

use jerboa_ir::structure::Step;
use jerboa_ir::*;

use super::Fault;
use super::flow::Target;
use super::function::Writing;
use super::path::{Path, Var, meet};
use super::value::Value;

/// Something with an end where paths wait.
pub(super) struct Place {
    /// How exits call it; an arm has no exits to its end.
    pub target: Option<Target>,
    pub linear: bool,
    pub waiting: Vec<Path>,
}

impl Writing<'_, '_> {
    pub(super) fn label(&mut self, join: u32, body: &[Step]) -> Result<(), Fault> {
        if begins_with_loop(body) {
            // Here, so that what the loop's header gives is there for all who come out of the label.
            self.stay_alive();
        }
        let target = Target::Block(join);
        let (mask, alive) = (self.path_mut().mask(), self.path_mut().alive);
        self.places.push(self.place(target));
        self.steps(body)?;
        if self.path.is_some() {
            self.leave(target);
        }
        self.end(target, mask, alive);
        if self.path.is_some() {
            self.bring_back(join);
        }
        Ok(())
    }

    pub(super) fn place(&self, target: Target) -> Place {
        Place { target: Some(target), linear: self.plan.flow.linear.contains(&target), waiting: Vec::new() }
    }

    /// The end of a label or of a round: those who wait go on. `mask` is who was active at its start.
    pub(super) fn end(&mut self, target: Target, mask: NodeId, alive: bool) {
        let place = self.places.pop().expect("it was pushed");
        let name = match target {
            Target::Block(block) | Target::Round(block) => {
                self.lanes.p.cont(self.f.blocks[block as usize].cont).name.clone()
            }
            Target::Return => "done".into(),
        };
        self.path = meet(&mut self.lanes.writer, &name, place.waiting);
        let Some(path) = self.path.as_mut().filter(|_| place.linear) else { return };
        if !self.plan.flow.open.contains(&target) {
            path.set_mask(mask);
            path.alive = alive;
        } else if let Some(waiting) = path.env.remove(&Var::Waiting(target)) {
            path.env.insert(Var::Mask, waiting);
            path.alive = false;
        } else {
            self.die();
        }
    }

    /// Behind divergent loops, a value that outlives them is what each lane had when it left.
    fn bring_back(&mut self, join: u32) {
        let plan = self.plan.clone();
        let loops = &self.f.loops;
        for param in &plan.kept {
            let Node::Param { cont, .. } = self.lanes.p.node(*param) else { continue };
            let made = self.f.number[cont];
            let around = |header: Option<u32>| std::iter::successors(header, |h| loops.outer(*h));
            let mut left = around(loops.header(made)).filter(|h| !around(loops.header(join)).any(|x| x == *h));
            if !left.any(|h| plan.flow.divergent[h as usize]) {
                continue;
            }
            if let Some(kept) = self.path_mut().env.get(&Var::Kept(*param)).cloned() {
                self.bound.insert(*param, kept);
                self.written.clear();
            }
        }
    }

    /// The lanes that are active leave to a place's end.
    pub(super) fn leave(&mut self, target: Target) {
        let place =
            self.places.iter_mut().rfind(|place| place.target == Some(target)).expect("exits are in their place");
        if !place.linear {
            place.waiting.extend(self.path.take());
            return;
        }
        if self.plan.flow.open.contains(&target) && target != Target::Return {
            let path = self.path.as_mut().expect("a path is under way");
            let mask = path.mask();
            let waiting = match path.env.get(&Var::Waiting(target)) {
                Some(others) => self.lanes.writer.or(others.nodes()[0], mask),
                None => mask,
            };
            path.env.insert(Var::Waiting(target), Value::Varying(vec![waiting]));
        }
        self.die();
    }

    /// No lane is active here any more: go on where some may wait.
    pub(super) fn die(&mut self) {
        let Some(mut path) = self.path.take() else { return };
        path.env.remove(&Var::Mask);
        let place = self.places.iter_mut().rfind(|place| place.linear).expect("lanes wait at linear places only");
        place.waiting.push(path);
    }

    /// Go on only if some lane is active.
    pub(super) fn stay_alive(&mut self) {
        if self.path_mut().alive {
            return;
        }
        let mask = self.path_mut().mask();
        let none = self.guard(mask);
        let path = self.path.replace(none);
        self.die();
        self.path = path;
        self.path_mut().alive = true;
    }

    /// Go on if the mask holds for some lane; gives the other path.
    fn guard(&mut self, mask: NodeId) -> Path {
        let w = &mut self.lanes.writer;
        let loc = w.loc;
        let cond = w.w.prim(Op::Any, &[mask], loc);
        let ((some, _), (none, _)) = (w.cont("some", Role::Arm, &[], loc), w.cont("none", Role::Arm, &[], loc));
        let (then, other) = (w.w.cont_value(some), w.w.cont_value(none));
        let path = self.path.as_mut().expect("a path is under way");
        w.w.set_body(path.at, Body::Branch { cond, then, other }, loc);
        path.at = some;
        Path { at: none, ..path.clone() }
    }
}

/// Do these steps begin with a loop?
fn begins_with_loop(steps: &[Step]) -> bool {
    match steps.first() {
        Some(Step::Loop { .. }) => true,
        Some(Step::Label { body, .. }) => begins_with_loop(body),
        _ => false,
    }
}
