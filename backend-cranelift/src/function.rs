//! One residual function as CLIF: blocks become blocks, continuation parameters become block parameters.
//!
//! Blocks are filled in an order in which a block follows its dominators and is followed by all that it dominates, so the
//! latest value that was made for a node is the one that dominates. A block with one predecessor that goes nowhere else
//! is appended to it: a chain of loads is one block.

mod access;
mod deferred;
mod exit;
mod gather;
mod range;
mod rows;
mod run;
mod shortcut;
mod value;

use std::collections::BTreeMap;

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{Block, FuncRef, InstBuilder, StackSlot, StackSlotData, StackSlotKind, Type, Value, types};
use cranelift_codegen::isa::TargetFrontendConfig;
use cranelift_frontend::FunctionBuilder;
use jerboa_ir::cfg::{Cfg, Function};
use jerboa_ir::schedule::Schedule;
use jerboa_ir::{Lit, NodeId, Program};
use rustc_hash::FxHashMap;

use crate::abi::{LANES, Shape, parts};
use crate::buffers::{Buffers, Used};
use crate::memory::Local;
use crate::pack;
use crate::simd::Simd;

/// What is known of a kernel before its functions are emitted.
pub(crate) struct Unit<'p> {
    pub program: &'p Program,
    pub cfg: Cfg,
    pub schedules: Vec<Schedule>,
    pub shapes: Vec<Shape>,
    pub simd: Simd,
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
        first: FxHashMap::default(),
        made: Vec::new(),
        literals: FxHashMap::default(),
        constants: pack::Constants::default(),
        area: None,
        scratch: [None; 2],
        group: None,
        rows: None,
        deferred: BTreeMap::new(),
        addresses: FxHashMap::default(),
    };
    e.begin(&unit.schedules[index]);
    for &block in f.dom.preorder() {
        if block != 0 && !e.is_appended(block) {
            e.deferred.clear();
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
    /// Machine values of the parameters of each block, one list each.
    params: Vec<Vec<Vec<Value>>>,
    /// Local arrays, by the block whose parameter they are.
    locals: FxHashMap<u32, Local>,
    /// Where the machine values of a node begin in `made`.
    first: FxHashMap<NodeId, usize>,
    made: Vec<Value>,
    /// Literals of the block at hand.
    literals: FxHashMap<Lit, Value>,
    /// Parts of literals only, of the block at hand.
    constants: pack::Constants,
    /// Room for the results of any call that needs it; they are loaded right after the call.
    area: Option<StackSlot>,
    /// Room for the words of a vector that go to or come from memory one by one.
    scratch: [Option<StackSlot>; 2],
    /// The runs that are under way.
    group: Option<run::Group>,
    /// The stores of rows that are under way.
    rows: Option<rows::Rows>,
    /// Loads of runs that nobody has used yet, by the block whose parameter they are.
    deferred: BTreeMap<u32, deferred::Deferred>,
    /// Addresses in local arrays, by the index that they are of, of the block at hand.
    addresses: FxHashMap<(NodeId, Option<NodeId>), Value>,
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
            self.params[0].push(parts(param.ty).filter_map(|_| given.next()).collect());
        }
        for (i, block) in self.f.blocks.iter().enumerate().skip(1) {
            if self.is_appended(i as u32) {
                continue;
            }
            for param in &p.cont(block.cont).params {
                let values = parts(param.ty).map(|ty| self.b.append_block_param(self.blocks[i], ty)).collect();
                self.params[i].push(values);
            }
        }
        let called = self.f.calls.iter().map(|c| &self.unit.shapes[c.callee as usize]);
        if let Some(bytes) = called.filter(|s| s.has_area()).map(|s| s.area_bytes()).max() {
            let data = StackSlotData::new(StackSlotKind::ExplicitSlot, bytes, 4);
            self.area = Some(self.b.create_sized_stack_slot(data));
        }
        self.b.switch_to_block(entry);
        if let (true, Some(depth)) = (self.f.recursive, self.entry.depth) {
            let too_deep = self.b.ins().icmp_imm_u(IntCC::Equal, depth, 0);
            self.leave_if(too_deep);
        }
        if let Some(bindings) = self.entry.bindings {
            let used = Used::by(p, self.f, schedule);
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
        self.constants.clear();
        self.addresses.clear();
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
            results.extend(self.shape.results().map(|ty| zero(&mut self.b, ty)));
        }
        self.b.ins().return_(&results);
        self.switch_to(go_on);
    }
}

fn zero(b: &mut FunctionBuilder, ty: Type) -> Value {
    if ty.is_vector() {
        return pack::constant(b, ty, [0; LANES]);
    }
    if ty == types::F32 { b.ins().f32const(0.0) } else { b.ins().iconst(ty, 0) }
}
