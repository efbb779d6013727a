//! Loops in lane code: as long as some lane goes on.

use jerboa_ir::structure::Step;
use jerboa_ir::*;

use super::Fault;
use super::flow::Target;
use super::function::Writing;
use super::path::{Var, with_nodes};
use super::shape::Shape;
use super::value::Value;

impl Writing<'_, '_> {
    pub(super) fn repeat(&mut self, header: u32, body: &[Step]) -> Result<(), Fault> {
        self.stay_alive();
        let (p, plan) = (self.lanes.p, self.plan.clone());
        let cont = self.f.blocks[header as usize].cont;
        let round = Target::Round(header);
        self.lanes.writer.loc = p.cont(cont).loc;

        // What changes from round to round, with its value before the first.
        let mut first: Vec<(Var, Value)> = Vec::new();
        for i in 0..p.cont(cont).params.len() {
            if let Some(value) = self.path_mut().env.remove(&Var::Passed(Target::Block(header), i)) {
                first.push((Var::Passed(round, i), value));
            }
        }
        for var in self.changing(header) {
            let value = match self.path_mut().env.get(&var).cloned() {
                Some(value) => value,
                None => self.unset(var),
            };
            first.push((var, value));
        }

        let w = &mut self.lanes.writer;
        let types: Vec<Ty> = first.iter().flat_map(|(_, v)| v.nodes()).map(|x| w.w.program().ty(*x)).collect();
        let (head, params) = w.cont(&p.cont(cont).name, Role::Loop, &types, w.loc);
        let path = self.path.as_mut().expect("a path is under way");
        w.jump(path.at, head, first.iter().flat_map(|(_, v)| v.nodes()).copied().collect());
        path.at = head;
        let mut params = params.into_iter();
        let start: Vec<(Var, Value)> = first.iter().map(|(var, v)| (*var, with_nodes(v, &mut params))).collect();
        path.env.extend(start.iter().filter(|(var, _)| !matches!(var, Var::Passed(t, _) if *t == round)).cloned());
        for (var, value) in &start {
            let Var::Passed(target, i) = var else { continue };
            let Some(node) = self.lanes.params.get(cont, *i).filter(|_| *target == round) else { continue };
            self.bind(node, value.clone());
            if plan.frozen.contains(&node) {
                self.path_mut().env.insert(*var, value.clone());
            }
        }

        let mask = self.path_mut().mask();
        self.places.push(self.place(round));
        self.steps(body)?;
        if self.path.is_some() {
            self.leave(round);
        }
        self.end(round, mask, true);
        if self.path.is_none() {
            return Ok(());
        }
        self.stay_alive();
        let path = self.path.take().expect("a path is under way");
        let mut args = Vec::new();
        for (var, value) in &start {
            args.extend(path.env.get(var).unwrap_or(value).nodes());
        }
        self.lanes.writer.jump(path.at, head, args);
        Ok(())
    }

    /// What else changes in the rounds of a loop: the mask, who waits outside and with what, what is kept.
    fn changing(&self, header: u32) -> Vec<Var> {
        let plan = &self.plan;
        let mut vars = Vec::new();
        if plan.flow.divergent[header as usize] {
            vars.push(Var::Mask);
        }
        for target in plan.flow.exits_of(header) {
            if plan.flow.open.contains(&target) && target != Target::Return {
                vars.push(Var::Waiting(target));
            }
            let count = match target {
                Target::Block(block) | Target::Round(block) => {
                    self.lanes.p.cont(self.f.blocks[block as usize].cont).params.len()
                }
                Target::Return => plan.results.len(),
            };
            vars.extend((0..count).filter(|i| self.shape_of(target, *i).is_some()).map(|i| Var::Passed(target, i)));
        }
        let kept_here = |param: &&NodeId| match self.lanes.p.node(**param) {
            Node::Param { cont, .. } => plan.flow.is_inside(self.f.number[cont], header),
            _ => false,
        };
        vars.extend(plan.kept.iter().filter(kept_here).map(|param| Var::Kept(*param)));
        vars
    }

    /// The value of what has not been set before a loop.
    fn unset(&mut self, var: Var) -> Value {
        match var {
            Var::Mask | Var::Waiting(_) | Var::Through(_) => self.zero(Ty::bool(), Shape::Varying),
            Var::Kept(param) => self.zero(self.lanes.p.ty(param), Shape::Varying),
            Var::Passed(target, i) => {
                let ty = match target {
                    Target::Return => self.return_types()[i],
                    Target::Block(block) | Target::Round(block) => {
                        self.lanes.p.cont(self.f.blocks[block as usize].cont).params[i].ty
                    }
                };
                let shape = self.shape_of(target, i).unwrap_or(Shape::Uniform);
                self.zero(ty, shape)
            }
        }
    }
}
