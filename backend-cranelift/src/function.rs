//! One residual function as CLIF: blocks become blocks, continuation parameters become block parameters.
//!
//! Blocks are filled in an order in which a block follows its dominators and is followed by all that it dominates, so the
//! latest value that was made for a node is the one that dominates. A block with one predecessor that goes nowhere else
//! is appended to it: a chain of loads is one block.

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::immediates::Ieee32;
use cranelift_codegen::ir::{
    Block, BlockArg, FuncRef, InstBuilder, MemFlagsData, StackSlot, StackSlotData, StackSlotKind, Value, types,
};
use cranelift_codegen::isa::TargetFrontendConfig;
use cranelift_frontend::{FunctionBuilder, Switch};
use jerboa_ir::cfg::{Cfg, Exit, Function};
use jerboa_ir::schedule::Schedule;
use jerboa_ir::{Body, Column, ContId, Lit, Mem, Node, NodeId, Op, Program, Scalar};
use rustc_hash::FxHashMap;

use crate::abi::{POINTER, Shape, clif, lanes};
use crate::memory::{self, Buffers, Local, Place};
use crate::ops;

/// What is known of a kernel before its functions are emitted.
pub(crate) struct Unit<'p> {
    pub program: &'p Program,
    pub cfg: Cfg,
    pub schedules: Vec<Schedule>,
    pub shapes: Vec<Shape>,
}

/// The functions that code may call, in the function under construction.
pub(crate) struct Callees {
    /// By place in [`Cfg::functions`]; only those that are called.
    pub functions: FxHashMap<u32, FuncRef>,
    /// The fused multiply-add, where it is a call.
    pub fma: Option<FuncRef>,
}

/// Emits one function into a builder that has nothing yet but the signature. An error says what is not first-order.
pub(crate) fn emit(
    unit: &Unit,
    index: usize,
    callees: Callees,
    b: FunctionBuilder,
    config: TargetFrontendConfig,
) -> Result<(), String> {
    let f = &unit.cfg.functions[index];
    let mut e = Emitter {
        unit,
        f,
        shape: &unit.shapes[index],
        callees,
        b,
        entry: Hidden::default(),
        buffers: Buffers::default(),
        blocks: Vec::new(),
        params: vec![Vec::new(); f.blocks.len()],
        locals: FxHashMap::default(),
        first_lane: FxHashMap::default(),
        made: Vec::new(),
        literals: FxHashMap::default(),
        area: None,
    };
    e.begin(&unit.schedules[index]);
    for &block in f.dom.preorder() {
        if block != 0 && !e.is_appended(block) {
            e.switch_to(e.blocks[block as usize]);
        }
        for node in &unit.schedules[index].blocks[block as usize] {
            e.node(*node)?;
        }
        e.body(block)?;
    }
    e.b.seal_all_blocks();
    e.b.finalize(config);
    Ok(())
}

/// The hidden parameters.
#[derive(Default)]
struct Hidden {
    bindings: Option<Value>,
    /// So many frames of recursive functions may be made still, this function's own included.
    depth: Option<Value>,
    area: Option<Value>,
}

/// A row of a buffer or an element of a local array, as an index gives it.
#[derive(Clone, Copy)]
enum Row {
    /// Row 0.
    First,
    /// Any.
    At(Value),
}

struct Emitter<'a> {
    unit: &'a Unit<'a>,
    f: &'a Function,
    shape: &'a Shape,
    callees: Callees,
    b: FunctionBuilder<'a>,
    entry: Hidden,
    buffers: Buffers,
    /// By the number of the block.
    blocks: Vec<Block>,
    /// Lanes of the parameters of each block, one list each.
    params: Vec<Vec<Vec<Value>>>,
    /// Local arrays, by the block whose parameter they are.
    locals: FxHashMap<u32, Local>,
    /// Where the lanes of a node are in `made`.
    first_lane: FxHashMap<NodeId, usize>,
    made: Vec<Value>,
    /// Literals of the block at hand.
    literals: FxHashMap<Lit, Value>,
    /// Room for the results of any call that needs it; they are loaded right after the call.
    area: Option<StackSlot>,
}

impl Emitter<'_> {
    /// Makes the blocks and all that stands where the function begins: hidden and own parameters, addresses of buffers,
    /// the check of the depth.
    fn begin(&mut self, schedule: &Schedule) {
        let p = self.unit.program;
        self.blocks = self.f.blocks.iter().map(|_| self.b.create_block()).collect();
        let entry = self.blocks[0];
        self.b.append_block_params_for_function_params(entry);
        let mut given = self.b.block_params(entry).to_vec().into_iter();
        let mut hidden = |there: bool| if there { given.next() } else { None };
        self.entry = Hidden {
            bindings: hidden(self.shape.bindings),
            depth: hidden(self.shape.counted),
            area: hidden(self.shape.has_area()),
        };
        for param in &p.cont(self.f.cont).params {
            self.params[0].push(lanes(param.ty).filter_map(|_| given.next()).collect());
        }
        for (i, block) in self.f.blocks.iter().enumerate().skip(1) {
            if self.is_appended(i as u32) {
                continue;
            }
            for param in &p.cont(block.cont).params {
                let lanes = lanes(param.ty).map(|s| self.b.append_block_param(self.blocks[i], clif(s))).collect();
                self.params[i].push(lanes);
            }
        }
        let called = self.f.calls.iter().map(|c| &self.unit.shapes[c.callee as usize]);
        if let Some(words) = called.filter(|s| s.has_area()).map(|s| s.results.len()).max() {
            let data = StackSlotData::new(StackSlotKind::ExplicitSlot, words as u32 * 4, 4);
            self.area = Some(self.b.create_sized_stack_slot(data));
        }
        self.b.switch_to_block(entry);
        if let (true, Some(depth)) = (self.f.recursive, self.entry.depth) {
            let too_deep = self.b.ins().icmp_imm_u(IntCC::Equal, depth, 0);
            self.leave_if(too_deep);
        }
        if let Some(bindings) = self.entry.bindings {
            let used = memory::used_columns(p, self.f, schedule);
            self.buffers = Buffers::new(&mut self.b, p, &used, bindings);
        }
    }

    /// Is the block appended to its predecessor?
    fn is_appended(&self, block: u32) -> bool {
        match self.f.blocks[block as usize].preds[..] {
            [pred] => self.f.blocks[pred as usize].succs.len() == 1,
            _ => false,
        }
    }

    fn switch_to(&mut self, block: Block) {
        self.b.switch_to_block(block);
        self.literals.clear();
        self.buffers.begin_block();
    }

    /// Returns the status `Limit` if the value is not 0, else goes on.
    fn leave_if(&mut self, limit: Value) {
        let (leave, go_on) = (self.b.create_block(), self.b.create_block());
        self.b.set_cold_block(leave);
        self.b.ins().brif(limit, leave, &[], go_on, &[]);
        self.switch_to(leave);
        let mut results = vec![self.b.ins().iconst(types::I32, 1)];
        if !self.shape.has_area() {
            results.extend(self.shape.results.iter().map(|s| zero(&mut self.b, *s)));
        }
        self.b.ins().return_(&results);
        self.switch_to(go_on);
    }

    /// The value of one lane of a node that is in scope.
    fn lane(&mut self, x: NodeId, lane: usize) -> Value {
        match self.unit.program.node(x) {
            Node::Lit(lit) => *self.literals.entry(*lit).or_insert_with(|| literal(&mut self.b, *lit)),
            Node::Param { cont, index } => self.params[self.f.number[cont] as usize][*index as usize][lane],
            _ => self.made[self.first_lane[&x] + lane],
        }
    }

    fn scalar(&mut self, x: NodeId) -> Value {
        self.lane(x, 0)
    }

    /// The lanes of several nodes, one after the other.
    fn all_lanes(&mut self, nodes: &[NodeId]) -> Vec<Value> {
        let mut values = Vec::with_capacity(nodes.len());
        for x in nodes {
            let lanes = self.unit.program.ty(*x).lanes().map_or(0, |(_, n)| n);
            values.extend((0..lanes).map(|i| self.lane(*x, i)));
        }
        values
    }

    /// Computes a node.
    fn node(&mut self, id: NodeId) -> Result<(), String> {
        let p = self.unit.program;
        let values = match p.node(id) {
            Node::Prim { op, args } => self.prim(*op, &args[..op.arity()]),
            Node::Pack(elems) => elems.iter().map(|x| self.scalar(*x)).collect(),
            Node::Lane { vector, lane } => vec![self.lane(*vector, *lane as usize)],
            Node::Read { column, index } => {
                // A reference is stored as its index.
                let scalar = p.column(*column).ty.ty().as_scalar().unwrap_or(Scalar::U32);
                let lanes = p.ty(id).lanes().map_or(1, |(_, lanes)| lanes);
                let rows = self.rows(*index, lanes);
                let load = |row| {
                    let place = self.clamped(*column, row);
                    memory::load(&mut self.b, scalar, &place, MemFlagsData::trusted().with_readonly())
                };
                rows.into_iter().map(load).collect()
            }
            other => return Err(format!("it computes {other:?} at {}", p.locs[id.index()])),
        };
        self.first_lane.insert(id, self.made.len());
        self.made.extend(values);
        Ok(())
    }

    fn prim(&mut self, op: Op, args: &[NodeId]) -> Vec<Value> {
        let p = self.unit.program;
        // A shift is of its first operand's type, any other operation of its last one's.
        let main = if matches!(op, Op::Shl | Op::Shr) { args[0] } else { args[args.len() - 1] };
        let Some((scalar, lanes)) = p.ty(main).lanes() else { return Vec::new() };
        if matches!(op, Op::Any | Op::All | Op::Ballot) {
            let all = self.all_lanes(args);
            return vec![self.operation(op, scalar, &all)];
        }
        (0..lanes)
            .map(|lane| {
                let mut values = [Value::from_u32(0); 3];
                args.iter().zip(&mut values).for_each(|(x, v)| *v = self.lane(*x, lane));
                self.operation(op, scalar, &values[..args.len()])
            })
            .collect()
    }

    fn operation(&mut self, op: Op, scalar: Scalar, args: &[Value]) -> Value {
        let call = self.callees.fma;
        ops::scalar(&mut self.b, op, scalar, args, |b, args| match call {
            None => b.ins().fma(args[0], args[1], args[2]),
            Some(function) => {
                let call = b.ins().call(function, args);
                b.inst_results(call)[0]
            }
        })
    }

    /// Leaves a block.
    fn body(&mut self, block: u32) -> Result<(), String> {
        let p = self.unit.program;
        let cont = self.f.blocks[block as usize].cont;
        match Exit::of(p, cont).map_err(|e| e.why)? {
            Exit::Return(values) => {
                let values = self.all_lanes(values);
                self.give_back(&values);
            }
            Exit::Jump { block, args } => {
                let args = self.all_lanes(args);
                self.go_to(block, &args);
            }
            Exit::Call { callee, args, back } => self.call(callee, args, back),
            Exit::Arms => self.arms(&p.cont(cont).body)?,
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
                for (i, (value, scalar)) in values.iter().zip(&self.shape.results).enumerate() {
                    memory::store(&mut self.b, *scalar, &memory::nth_word(area, i), *value);
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
            params.iter().map(|p| args.by_ref().take(lanes(p.ty).count()).collect()).collect();
    }

    /// The block that an arm goes on in.
    fn target(&self, arm: NodeId) -> ContId {
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
        values.extend(self.all_lanes(args));
        if in_place {
            self.b.ins().return_call(function, &values);
            return;
        }
        let call = self.b.ins().call(function, &values);
        let mut results = self.b.inst_results(call).to_vec();
        if shape.counted {
            let status = results.remove(0);
            self.leave_if(status);
        }
        if let Some(area) = area {
            let word = |(i, s): (usize, &Scalar)| {
                memory::load(&mut self.b, *s, &memory::nth_word(area, i), MemFlagsData::trusted())
            };
            results = shape.results.iter().enumerate().map(word).collect();
        }
        match back {
            Some(back) => self.go_to(back, &results),
            None => self.give_back(&results),
        }
    }

    /// Leaves a block by a body that is no jump.
    fn arms(&mut self, body: &Body) -> Result<(), String> {
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
            Body::Load { mem, index, next } => {
                let values = self.load(mem, *index, *next)?;
                self.go_to(self.target(*next), &values);
            }
            Body::Store { mem, index, value, mask, next } => {
                self.store(mem, *index, *value, *mask)?;
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

    /// The lanes that a load gives.
    fn load(&mut self, mem: &Mem, index: NodeId, next: NodeId) -> Result<Vec<Value>, String> {
        let loaded = self.unit.program.loaded(next).and_then(|ty| ty.lanes());
        let (scalar, lanes) = loaded.ok_or("a load gives no data")?;
        self.rows(index, lanes).into_iter().map(|row| self.load_lane(mem, scalar, row)).collect()
    }

    fn load_lane(&mut self, mem: &Mem, scalar: Scalar, row: Row) -> Result<Value, String> {
        let mut flags = MemFlagsData::trusted();
        let place = match mem {
            Mem::Stream(column) => self.clamped(*column, row),
            Mem::Unchecked(column) => {
                flags = flags.with_readonly();
                let row = self.row(row);
                self.buffers.unchecked(&mut self.b, *column, row)
            }
            Mem::Local(x) => {
                let (local, row) = (self.local(*x)?, self.row(row));
                local.clamped(&mut self.b, row)
            }
        };
        Ok(memory::load(&mut self.b, scalar, &place, flags))
    }

    /// The row of each lane of an access: of a vector of indices its own, of a run the next one.
    fn rows(&mut self, index: NodeId, lanes: usize) -> Vec<Row> {
        let own = self.unit.program.ty(index).lanes().is_some_and(|(_, n)| n > 1);
        (0..lanes)
            .map(|lane| match lane {
                0 if self.unit.program.as_lit(index) == Some(Lit::U32(0)) => Row::First,
                _ if own => Row::At(self.lane(index, lane)),
                0 => Row::At(self.scalar(index)),
                _ => {
                    let first = self.scalar(index);
                    Row::At(self.b.ins().iadd_imm_u(first, lane as i64))
                }
            })
            .collect()
    }

    /// The number of a row.
    fn row(&mut self, row: Row) -> Value {
        match row {
            Row::First => self.b.ins().iconst(types::I32, 0),
            Row::At(row) => row,
        }
    }

    /// The word of a row, or of the last one.
    fn clamped(&mut self, column: Column, row: Row) -> Place {
        match row {
            Row::First => self.buffers.first(column),
            Row::At(row) => self.buffers.clamped(&mut self.b, column, row),
        }
    }

    /// Stores, unless the index is out of range; of a vector the lanes under the mask.
    fn store(&mut self, mem: &Mem, index: NodeId, value: NodeId, mask: NodeId) -> Result<(), String> {
        let (scalar, lanes) = self.unit.program.ty(value).lanes().ok_or("it stores what is no data")?;
        for (lane, row) in self.rows(index, lanes).into_iter().enumerate() {
            let (row, value) = (self.row(row), self.lane(value, lane));
            let rows = match mem {
                Mem::Stream(column) | Mem::Unchecked(column) => self.buffers.rows(column.buf),
                Mem::Local(x) => self.local(*x)?.len(&mut self.b),
            };
            let (inside, after) = (self.b.create_block(), self.b.create_block());
            let mut fits = self.b.ins().icmp(IntCC::UnsignedLessThan, row, rows);
            if mask != NodeId::NONE {
                let active = self.lane(mask, lane);
                fits = self.b.ins().band(fits, active);
            }
            self.b.ins().brif(fits, inside, &[], after, &[]);
            self.b.switch_to_block(inside);
            let place = match mem {
                Mem::Stream(column) | Mem::Unchecked(column) => self.buffers.unchecked(&mut self.b, *column, row),
                Mem::Local(x) => self.local(*x)?.unchecked(&mut self.b, row),
            };
            memory::store(&mut self.b, scalar, &place, value);
            self.b.ins().jump(after, &[]);
            self.b.switch_to_block(after);
        }
        Ok(())
    }

    /// The array that a parameter stands for.
    fn local(&self, x: NodeId) -> Result<Local, String> {
        let made = match self.unit.program.node(x) {
            Node::Param { cont, .. } => self.locals.get(&self.f.number[cont]),
            _ => None,
        };
        made.copied().ok_or_else(|| "its local array is no parameter of the block that follows its making".to_owned())
    }
}

fn literal(b: &mut FunctionBuilder, lit: Lit) -> Value {
    match lit {
        Lit::F32(bits) => b.ins().f32const(Ieee32::with_bits(bits)),
        _ => b.ins().iconst(clif(lit.scalar()), i64::from(lit.word())),
    }
}

fn zero(b: &mut FunctionBuilder, scalar: Scalar) -> Value {
    literal(b, Lit::from_word(scalar, 0))
}
