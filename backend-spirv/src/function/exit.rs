//! What a block does: its nodes, then its jump, as far as that is no choice.

use jerboa_ir::cfg::Exit;
use jerboa_ir::{Body, ContId, NodeId, Scalar};
use naga::{BinaryOperator as B, Block, Expression, Statement};

use super::{Emitter, scalars};
use crate::code::Value;

impl Emitter<'_> {
    /// The code of a block.
    pub(super) fn block_code(&mut self, block: u32) {
        self.at = block;
        let cont = self.f.blocks[block as usize].cont;
        self.params_of(cont);
        for node in &self.unit.schedules[self.index].blocks[block as usize] {
            self.node(*node);
        }
        let p = self.unit.program;
        match Exit::of(p, cont).expect("the analysis of control flow has seen it") {
            Exit::Return(values) => {
                let values = self.all_lanes(values);
                self.give_back(values);
            }
            Exit::Jump { block, args } => {
                let args = self.all_lanes(args);
                self.enter(block, &args);
            }
            Exit::Call { callee, args, back } => {
                let args = self.all_lanes(args);
                let results = self.call(callee, args);
                match back {
                    Some(back) => self.enter(back, &results),
                    None => self.give_back(results),
                }
            }
            Exit::Arms => self.effect(&p.cont(cont).body),
        }
    }

    /// Takes the parameters of a block that several go on in out of their variables.
    fn params_of(&mut self, cont: ContId) {
        for i in 0..self.unit.program.cont(cont).params.len() as u32 {
            if let Some(param) = self.unit.params.get(&(cont, i)).copied()
                && self.params.contains_key(&param)
            {
                self.lanes(param);
            }
        }
    }

    /// Passes values to a block. All of them are there before the first is stored, so that this is a parallel copy.
    fn enter(&mut self, cont: ContId, values: &[Value]) {
        let p = self.unit.program;
        let mut rest = values;
        for (i, param) in p.cont(cont).params.iter().enumerate() {
            let (lanes, others) = rest.split_at(scalars([param.ty]).len());
            rest = others;
            let Some(node) = self.unit.params.get(&(cont, i as u32)).copied().filter(|x| self.uses.is_used(*x)) else {
                continue;
            };
            match self.params.get(&node).cloned() {
                Some(places) => self.assign(&places, lanes),
                None => self.define(node, lanes),
            }
        }
    }

    /// Returns values; those of the entry go to the results.
    fn give_back(&mut self, values: Vec<Value>) {
        self.make_stores();
        let Some(ty) = self.code.function.result.as_ref().map(|r| r.ty) else {
            if let Some(results) = self.unit.globals.results {
                let types = scalars(self.results());
                let base = self.code.global(results);
                for (i, (value, scalar)) in values.into_iter().zip(types).enumerate() {
                    let word = super::memory::encode(&mut self.code, scalar, value);
                    let pointer = self.code.component(base, i as u32);
                    self.code.store(pointer, word);
                }
            }
            return self.code.push(Statement::Return { value: None });
        };
        let value = match values[..] {
            [one] => one,
            _ => self.code.pure(Expression::Compose { ty, components: values }),
        };
        self.code.push(Statement::Return { value: Some(value) });
    }

    /// Types of the function's results.
    fn results(&self) -> Vec<jerboa_ir::Ty> {
        let cont = self.unit.program.cont(self.f.cont);
        cont.params.last().and_then(|ret| ret.ty.params()).unwrap_or_default().to_vec()
    }

    /// Calls a function; gives the lanes of its results.
    fn call(&mut self, callee: ContId, args: Vec<Value>) -> Vec<Value> {
        self.make_stores();
        let ret = self.unit.program.cont(callee).params.last().and_then(|ret| ret.ty.params()).unwrap_or_default();
        let count = scalars(ret.iter().copied()).len() as u32;
        let number = self.unit.cfg.number[&callee] as usize;
        let function = self.callees[number].expect("callees are emitted first");
        match (self.code.call(function, args, count > 0), count) {
            (None, _) => Vec::new(),
            (Some(one), 1) => vec![one],
            (Some(all), _) => (0..count).map(|i| self.code.component(all, i)).collect(),
        }
    }

    /// A body that goes on in one block, or in an arm of a choice, which follows.
    fn effect(&mut self, body: &Body) {
        match body {
            Body::Load { mem, index, next } => {
                let loaded = self.unit.program.loaded(*next).and_then(|ty| ty.lanes());
                let (scalar, lanes) = loaded.expect("a load gives data");
                let values = self.load(mem, *index, scalar, lanes);
                self.enter(self.target(*next), &values);
            }
            Body::Store { mem, index, value, mask, .. } => self.store(mem, *index, *value, *mask),
            Body::Vectorize { lo, hi, body, args, .. } => self.vectorize(*lo, *hi, self.target(*body), args),
            Body::Local { next, .. } => {
                let block = self.f.number[&self.target(*next)];
                self.clear(self.arrays.get(&block).copied());
            }
            Body::Branch { .. } | Body::Switch { .. } => {}
            Body::Unset | Body::Jump { .. } | Body::Dispatch { .. } => unreachable!("`Exit::of` has said what it is"),
        }
    }

    /// Calls the body of a `vectorize` for one index after the other.
    fn vectorize(&mut self, lo: NodeId, hi: NodeId, body: ContId, args: &[NodeId]) {
        let (lo, hi) = (self.lane(lo, 0), self.lane(hi, 0));
        let args = self.all_lanes(args);
        self.make_stores();
        let index = self.variable("index", Scalar::U32);
        self.code.set(index, lo);
        self.counted(index, hi, |e, i| {
            let mut args = args.clone();
            args.push(i);
            e.call(body, args);
        });
    }

    /// A loop that counts a variable up to, not including, `hi`.
    pub(super) fn counted(
        &mut self,
        index: naga::Handle<naga::LocalVariable>,
        hi: Value,
        each: impl FnOnce(&mut Self, Value),
    ) {
        self.open();
        let i = self.code.get(index);
        let done = self.code.binary(B::GreaterEqual, i, hi);
        let leave = self.code.block(|c| c.push(Statement::Break));
        self.code.branch(done, leave, Block::new());
        each(self, i);
        let one = self.code.u32(1);
        let next = self.code.binary(B::Add, i, one);
        self.code.set(index, next);
        let body = self.close();
        self.code.repeat(body);
    }
}
