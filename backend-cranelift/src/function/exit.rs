//! How blocks are left.

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{Block, BlockArg, FuncRef, InstBuilder, MemFlagsData, Value, types};
use cranelift_frontend::Switch;
use jerboa_ir::cfg::Exit;
use jerboa_ir::{Body, ContId, Node, NodeId};

use super::Emitter;
use crate::abi::{POINTER, Shape, parts};
use crate::memory::Local;

impl Emitter<'_> {
    /// Leaves a block.
    pub(super) fn body(&mut self, block: u32) -> Result<(), String> {
        let p = self.unit.program;
        let cont = self.f.blocks[block as usize].cont;
        let exit = Exit::of(p, cont).map_err(|e| e.why)?;
        self.settle(exit, &p.cont(cont).body);
        match exit {
            Exit::Return(values) => {
                let values = self.all_values(values);
                self.give_back(&values);
            }
            Exit::Jump { block, args } => {
                let args = self.all_values(args);
                self.go_to(block, &args);
            }
            Exit::Call { callee, args, back } => {
                self.call(callee, args, back);
                self.buffers.changed();
            }
            Exit::Arms => self.arms(block, &p.cont(cont).body)?,
        }
        Ok(())
    }

    /// Returns results.
    fn give_back(&mut self, values: &[Value]) {
        let mut results = Vec::new();
        if self.shape.counted {
            results.push(self.b.ins().iconst(types::I32, 0));
        }
        match self.entry.area {
            None => results.extend(values),
            Some(area) => {
                for (value, (_, at)) in values.iter().zip(self.shape.places()) {
                    self.b.ins().store(MemFlagsData::trusted(), *value, area, at);
                }
            }
        }
        self.b.ins().return_(&results);
    }

    /// Goes on in a block: a jump, unless the block is appended to this one.
    fn go_to(&mut self, cont: ContId, args: &[Value]) {
        let number = self.f.number[&cont];
        if !self.is_appended(number) {
            let args: Vec<BlockArg> = args.iter().map(|v| BlockArg::Value(*v)).collect();
            self.b.ins().jump(self.blocks[number as usize], &args);
            return;
        }
        let mut args = args.iter().copied();
        let params = &self.unit.program.cont(cont).params;
        self.params[number as usize] =
            params.iter().map(|p| args.by_ref().take(parts(p.ty).count()).collect()).collect();
    }

    /// The block that an arm goes on in.
    pub(super) fn target(&self, arm: NodeId) -> ContId {
        match self.unit.program.node(arm) {
            Node::Cont(cont) => *cont,
            _ => unreachable!("the analysis of control flow found a block here"),
        }
    }

    fn block_of(&self, arm: NodeId) -> Block {
        self.blocks[self.f.number[&self.target(arm)] as usize]
    }

    fn call(&mut self, callee: ContId, args: &[NodeId], back: Option<ContId>) {
        let index = self.unit.cfg.number[&callee];
        let shape = &self.unit.shapes[index as usize];
        let function = self.callees.functions[&index];
        // Then the caller takes and returns the same hidden values, and its frame can go.
        let in_place = back.is_none() && shape.counted == self.shape.counted;
        let mut values = Vec::new();
        if shape.bindings {
            values.extend(self.entry.bindings);
        }
        if let (true, Some(depth)) = (shape.counted, self.entry.depth) {
            let takes_one = self.f.recursive && !in_place;
            values.push(if takes_one { self.b.ins().iadd_imm_s(depth, -1) } else { depth });
        }
        let mut area = None;
        if shape.has_area() && in_place {
            values.extend(self.entry.area);
        } else if shape.has_area() {
            area = self.area.map(|slot| self.b.ins().stack_addr(POINTER, slot, 0));
            values.extend(area);
        }
        values.extend(self.all_values(args));
        if in_place {
            self.b.ins().return_call(function, &values);
            return;
        }
        let mut results = self.returned(shape, function, &values);
        if let Some(area) = area {
            let flags = MemFlagsData::trusted();
            results = shape.places().map(|(ty, at)| self.b.ins().load(ty, flags, area, at)).collect();
        }
        match back {
            Some(back) => self.go_to(back, &results),
            None => self.give_back(&results),
        }
    }

    /// Calls a function with all values, hidden ones first; what it returns but for the status.
    fn returned(&mut self, shape: &Shape, function: FuncRef, values: &[Value]) -> Vec<Value> {
        let call = self.b.ins().call(function, values);
        let mut results = self.b.inst_results(call).to_vec();
        if shape.counted {
            let status = results.remove(0);
            self.leave_if(status);
        }
        results
    }

    /// Calls the body of a `vectorize` for one index after the other.
    fn vectorize(&mut self, lo: NodeId, hi: NodeId, body: NodeId, args: &[NodeId]) {
        let callee = self.unit.cfg.number[&self.target(body)];
        let shape = &self.unit.shapes[callee as usize];
        let function = self.callees.functions[&callee];
        let (lo, hi) = (self.scalar(lo), self.scalar(hi));
        let mut values = Vec::new();
        if shape.bindings {
            values.extend(self.entry.bindings);
        }
        if let (true, Some(depth)) = (shape.counted, self.entry.depth) {
            values.push(if self.f.recursive { self.b.ins().iadd_imm_s(depth, -1) } else { depth });
        }
        values.extend(self.all_values(args));
        let (head, each, done) = (self.b.create_block(), self.b.create_block(), self.b.create_block());
        let index = self.b.append_block_param(head, types::I32);
        self.b.ins().jump(head, &[lo.into()]);
        self.switch_to(head);
        let more = self.b.ins().icmp(IntCC::UnsignedLessThan, index, hi);
        self.b.ins().brif(more, each, &[], done, &[]);
        self.switch_to(each);
        values.push(index);
        self.returned(shape, function, &values);
        let next = self.b.ins().iadd_imm_u(index, 1);
        self.b.ins().jump(head, &[next.into()]);
        self.switch_to(done);
    }

    /// Leaves a block by a body that is no jump.
    fn arms(&mut self, block: u32, body: &Body) -> Result<(), String> {
        match body {
            Body::Branch { then, other, .. } if then == other => self.go_to(self.target(*then), &[]),
            Body::Branch { cond, then, other } => {
                let cond = self.scalar(*cond);
                let (then, other) = (self.block_of(*then), self.block_of(*other));
                self.b.ins().brif(cond, then, &[], other, &[]);
            }
            Body::Switch { arms, default, .. } if arms.iter().all(|(_, arm)| arm == default) => {
                self.go_to(self.target(*default), &[])
            }
            Body::Switch { index, arms, default } => {
                let index = self.scalar(*index);
                // As 64 bits, because the search compares with signed immediates.
                let index = self.b.ins().uextend(types::I64, index);
                let mut switch = Switch::new();
                for (number, arm) in arms {
                    switch.set_entry(u128::from(*number), self.block_of(*arm));
                }
                let default = self.block_of(*default);
                switch.emit(&mut self.b, index, default);
            }
            Body::Load { mem, index, next } if self.defer(block, mem, *index, *next)? => {}
            Body::Load { mem, index, next } => {
                let values = self.load(block, mem, *index, *next)?;
                self.go_to(self.target(*next), &values);
            }
            Body::Store { mem, index, value, mask, next } => {
                self.store(block, mem, *index, *value, *mask)?;
                self.go_to(self.target(*next), &[]);
            }
            Body::Vectorize { lo, hi, body, args, next, .. } => {
                self.vectorize(*lo, *hi, *body, args);
                self.buffers.changed();
                self.go_to(self.target(*next), &[]);
            }
            Body::Local { len, next, .. } => {
                let block = self.f.number[&self.target(*next)];
                let b = &mut self.b;
                let local = *self.locals.entry(block).or_insert_with(|| Local::new(b, *len));
                local.clear(&mut self.b);
                // The array is no value: loads and stores find it by its block.
                self.go_to(self.target(*next), &[]);
            }
            Body::Unset | Body::Jump { .. } | Body::Dispatch { .. } => return Err("its body is no arm".to_owned()),
        }
        Ok(())
    }
}
