//! From one entry of a residual to machine code that is not linked yet: analysis, schedule, CLIF, code.

use std::time::{Duration, Instant};

use cranelift_codegen::Context;
use cranelift_codegen::control::ControlPlane;
use cranelift_codegen::ir::{
    AbiParam, ExtFuncData, ExternalName, FuncRef, Function, InstBuilder, MemFlagsData, Signature, StackSlotData,
    StackSlotKind, UserExternalName, UserFuncName, Value, types,
};
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};
use cranelift_module::{FuncId, ModuleReloc};
use jerboa_ir::cfg::Cfg;
use jerboa_ir::schedule::Scheduler;
use jerboa_ir::{Body, ContId, Program};

use crate::abi::{POINTER, Shape, data, parts, shapes};
use crate::function::{Callees, Unit, emit};
use crate::lanes;
use crate::memory::{self, Local, nth_word};
use crate::pack;
use crate::simd::Simd;
use crate::target::{Options, Target};
use crate::{DEPTH_LIMIT, Error, MIN_DEPTH, STACK_LIMIT};

/// Namespace of a reference to the kernel's function of that index.
pub(crate) const FUNCTIONS: u32 = 0;
/// Namespace of references to functions of the host; index 0 is the fused multiply-add.
pub(crate) const HOST: u32 = 1;

/// A function's code, with references that the linker resolves.
pub(crate) struct Machine {
    pub name: String,
    pub signature: Signature,
    pub bytes: Vec<u8>,
    pub alignment: u64,
    pub relocs: Vec<ModuleReloc>,
    /// Bytes of its frame on the stack.
    frame: u64,
    instructions: usize,
    clif: String,
    asm: String,
}

/// A kernel's code: its functions and, last, the one that the host calls.
pub(crate) struct Unlinked {
    pub name: String,
    pub functions: Vec<Machine>,
    /// Bindings that it takes: all of the program's, if it touches any.
    pub bindings: usize,
    pub args: usize,
    pub results: usize,
    pub report: KernelReport,
    /// CLIF and disassembly, if they were asked for.
    pub dumps: Option<(String, String)>,
}

/// What one kernel cost.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct KernelReport {
    /// Its name.
    pub name: String,
    /// From residual to machine code, on one thread.
    pub codegen: Duration,
    /// Functions, the one that the host calls included.
    pub functions: usize,
    /// CLIF instructions.
    pub instructions: usize,
    /// Bytes of machine code, constants included.
    pub code_bytes: usize,
    /// Bytes of stack that its deepest chain of calls can take.
    pub stack_bytes: u64,
    /// So many frames of recursive functions may exist at once.
    pub depth: u32,
}

/// Makes the code of one kernel.
pub(crate) fn kernel(
    target: &Target,
    options: &Options,
    program: &Program,
    name: &str,
    entry: ContId,
) -> Result<Unlinked, Error> {
    let start = Instant::now();
    let in_lanes = match options.lanes.filter(|_| lanes::entry_vectorizes(program, entry)) {
        Some(width) => Some(
            lanes::of_entries(program, &[(name.into(), entry)], width)
                .map_err(|fault| Error::Lanes { kernel: name.to_owned(), fault })?,
        ),
        None => None,
    };
    let (program, entry) = in_lanes.as_ref().map_or((program, entry), |p| (p, p.entries[0].1));
    let unit = Unit::new(program, name, entry, target.simd)?;
    let mut compiler = Compiler { target, options, kernel: name, reused: FunctionBuilderContext::new() };
    let mut functions = Vec::with_capacity(unit.cfg.functions.len() + 1);
    for index in 0..unit.cfg.functions.len() {
        functions.push(compiler.function(&unit, index)?);
    }
    let (depth, stack_bytes) = stack(&unit, &functions, name)?;
    functions.push(compiler.entry(&unit.shapes[0], depth)?);
    let sum = |f: fn(&Machine) -> usize| functions.iter().map(f).sum();
    let report = KernelReport {
        name: name.to_owned(),
        codegen: start.elapsed(),
        functions: functions.len(),
        instructions: sum(|f| f.instructions),
        code_bytes: sum(|f| f.bytes.len()),
        stack_bytes,
        depth,
    };
    let text = |f: fn(&Machine) -> &str| functions.iter().map(f).collect::<Vec<_>>().join("\n");
    let dumps = options.dumps.then(|| (text(|f| &f.clif), text(|f| &f.asm)));
    let Shape { params, results, bindings, .. } = &unit.shapes[0];
    Ok(Unlinked {
        name: name.to_owned(),
        bindings: if *bindings { program.buffers.len() } else { 0 },
        args: params.iter().map(|ty| data(*ty).1).sum(),
        results: results.iter().map(|ty| data(*ty).1).sum(),
        report,
        dumps,
        functions,
    })
}

impl<'p> Unit<'p> {
    fn new(program: &'p Program, kernel: &str, entry: ContId, simd: Simd) -> Result<Unit<'p>, Error> {
        let cfg =
            Cfg::new(program, &[entry]).map_err(|fault| Error::NotFirstOrder { kernel: kernel.to_owned(), fault })?;
        let mut scheduler = Scheduler::new(program);
        let schedules: Vec<_> = cfg.functions.iter().map(|f| scheduler.function(f)).collect();
        let shapes = shapes(program, &cfg, &schedules);
        let unit = Unit { program, cfg, schedules, shapes, simd };
        // Before Cranelift sees a frame that it cannot lay out.
        for f in &unit.cfg.functions {
            let arrays = f.blocks.iter().map(|b| match program.cont(b.cont).body {
                Body::Local { len, .. } => Local::bytes(len),
                _ => 0,
            });
            let bytes = arrays.sum();
            if bytes > STACK_LIMIT {
                let function = program.cont(f.cont).name.to_string();
                return Err(Error::Stack { kernel: kernel.to_owned(), function, bytes });
            }
        }
        Ok(unit)
    }
}

/// How deep recursion may go, and how many bytes of stack the deepest chain of calls can then take.
///
/// Functions that do not recurse stand in a chain at most once each, so the hungriest chain of them is a longest path in
/// an acyclic graph; what is left is divided by the largest frame of a recursive function.
fn stack(unit: &Unit, functions: &[Machine], kernel: &str) -> Result<(u32, u64), Error> {
    let all = &unit.cfg.functions;
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by_key(|f| all[*f].component);
    let component = |f: u32| all[f as usize].component as usize;
    let mut once = vec![0; all.len()];
    for &i in &order {
        let own = if all[i].recursive { 0 } else { functions[i].frame };
        // Within a component that only tail calls hold together one frame replaces the other.
        let others = all[i].calls.iter().map(|c| component(c.callee)).filter(|c| *c != component(i as u32));
        let below = others.map(|c| once[c]).max().unwrap_or(0);
        let here = &mut once[component(i as u32)];
        *here = (*here).max(below + own);
    }
    let frames = (0..all.len()).map(|i| (functions[i].frame, i));
    let (frame, _) = frames.clone().filter(|(_, i)| all[*i].recursive).max().unwrap_or((1, 0));
    let once = once[component(0)];
    let depth = (STACK_LIMIT.saturating_sub(once) / frame).min(u64::from(DEPTH_LIMIT));
    let recursive = all.iter().any(|f| f.recursive);
    let bytes = once + if recursive { depth * frame } else { 0 };
    if bytes > STACK_LIMIT || depth < u64::from(MIN_DEPTH) {
        let largest = frames.max().map_or(0, |(_, i)| i);
        let function = unit.program.cont(all[largest].cont).name.to_string();
        return Err(Error::Stack { kernel: kernel.to_owned(), function, bytes: once + frame * u64::from(MIN_DEPTH) });
    }
    Ok((depth as u32, bytes))
}

/// Makes machine code of one function after the other.
struct Compiler<'a> {
    target: &'a Target,
    options: &'a Options,
    kernel: &'a str,
    reused: FunctionBuilderContext,
}

impl Compiler<'_> {
    /// A function of the residual.
    fn function(&mut self, unit: &Unit, index: usize) -> Result<Machine, Error> {
        let function = &unit.cfg.functions[index];
        let name = format!("{}/{}", self.kernel, unit.program.cont(function.cont).name);
        let signature = unit.shapes[index].signature();
        let mut clif = Function::with_name_signature(UserFuncName::user(FUNCTIONS, index as u32), signature);
        let call = |clif: &mut Function, callee: u32| {
            import(clif, FUNCTIONS, callee, unit.shapes[callee as usize].signature())
        };
        let callees = Callees {
            functions: function.calls.iter().map(|c| (c.callee, call(&mut clif, c.callee))).collect(),
            fma: (!self.target.simd.fma).then(|| import(&mut clif, HOST, 0, self.fma_signature())),
        };
        let builder = FunctionBuilder::new(&mut clif, &mut self.reused);
        emit(unit, index, callees, builder, self.target.isa.frontend_config())
            .map_err(|why| self.fault(&name, &why))?;
        self.machine(name, clif)
    }

    /// The function that the host calls: `extern "C" fn(bindings, args, results) -> status`.
    fn entry(&mut self, shape: &Shape, depth: u32) -> Result<Machine, Error> {
        let mut signature = Signature::new(self.target.isa.default_call_conv());
        signature.params = [POINTER; 3].map(AbiParam::new).to_vec();
        signature.returns = vec![AbiParam::new(types::I32)];
        let mut clif = Function::with_name_signature(UserFuncName::user(FUNCTIONS, u32::MAX), signature);
        let callee = import(&mut clif, FUNCTIONS, 0, shape.signature());
        let mut b = FunctionBuilder::new(&mut clif, &mut self.reused);
        let block = b.create_block();
        b.append_block_params_for_function_params(block);
        b.switch_to_block(block);
        let &[bindings, args, results] = b.block_params(block) else { unreachable!("three were just made") };
        let mut values = Vec::new();
        if shape.bindings {
            values.push(bindings);
        }
        if shape.counted {
            values.push(b.ins().iconst(types::I32, i64::from(depth)));
        }
        let area = shape.has_area().then(|| {
            let slot = StackSlotData::new(StackSlotKind::ExplicitSlot, shape.area_bytes(), 4);
            let slot = b.create_sized_stack_slot(slot);
            b.ins().stack_addr(POINTER, slot, 0)
        });
        values.extend(area);
        let flags = MemFlagsData::trusted();
        let mut word = 0;
        for ty in &shape.params {
            let (scalar, lanes) = data(*ty);
            let lanes: Vec<Value> =
                (word..word + lanes).map(|i| memory::load(&mut b, scalar, &nth_word(args, i), flags)).collect();
            word += lanes.len();
            values.extend(if lanes.len() == 1 { lanes } else { pack::pack(&mut b, scalar, &lanes) });
        }
        let call = b.ins().call(callee, &values);
        let mut returned = b.inst_results(call).to_vec();
        let status = if shape.counted { returned.remove(0) } else { b.ins().iconst(types::I32, 0) };
        if let Some(area) = area {
            returned = shape.places().map(|(ty, at)| b.ins().load(ty, flags, area, at)).collect();
        }
        let mut word = 0;
        for ty in &shape.results {
            let (scalar, lanes) = data(*ty);
            let values: Vec<Value> = returned.drain(..parts(*ty).count()).collect();
            for i in 0..lanes {
                let x = if lanes == 1 { values[0] } else { pack::lane(&mut b, scalar, &values, i) };
                memory::store(&mut b, scalar, &nth_word(results, word + i), x);
            }
            word += lanes;
        }
        b.ins().return_(&[status]);
        b.seal_all_blocks();
        b.finalize(self.target.isa.frontend_config());
        self.machine(self.kernel.to_owned(), clif)
    }

    /// Code of a function.
    fn machine(&self, name: String, clif: Function) -> Result<Machine, Error> {
        let signature = clif.signature.clone();
        let instructions = clif.dfg.num_insts();
        let text = if self.options.dumps { format!("; {name}\n{}", clif.display()) } else { String::new() };
        let isa = &*self.target.isa;
        let mut context = Context::for_function(clif);
        if let Err(e) = context.compile(isa, &mut ControlPlane::default()) {
            return Err(self.fault(&name, &format!("{:?}", e.inner)));
        }
        let code = context.take_compiled_code().ok_or_else(|| self.fault(&name, "there is no code"))?;
        let reloc = |r| ModuleReloc::from_mach_reloc(r, &context.func, FuncId::from_u32(0));
        let mut asm = String::new();
        if self.options.dumps {
            let capstone = isa.to_capstone().map_err(|e| self.fault(&name, &e.to_string()))?;
            let lines = code.disassemble(Some(&context.func.params), &capstone);
            asm = format!("; {name}\n{}", lines.map_err(|e| self.fault(&name, &e.to_string()))?);
        }
        // Frame pointer and return address lie above the frame.
        let frame = code.buffer.frame_layout().map_or(0, |f| u64::from(f.frame_to_fp_offset)) + 16;
        Ok(Machine {
            name,
            signature,
            bytes: code.buffer.data().to_vec(),
            alignment: u64::from(code.buffer.alignment),
            relocs: code.buffer.relocs().iter().map(reloc).collect(),
            frame,
            instructions,
            clif: text,
            asm,
        })
    }

    fn fma_signature(&self) -> Signature {
        let mut signature = Signature::new(self.target.isa.default_call_conv());
        signature.params = [types::F32; 3].map(AbiParam::new).to_vec();
        signature.returns = vec![AbiParam::new(types::F32)];
        signature
    }

    fn fault(&self, function: &str, why: &str) -> Error {
        Error::Codegen { kernel: self.kernel.to_owned(), function: function.to_owned(), why: why.to_owned() }
    }
}

/// Makes a function callable.
fn import(clif: &mut Function, namespace: u32, index: u32, signature: Signature) -> FuncRef {
    let name = clif.declare_imported_user_function(UserExternalName::new(namespace, index));
    let signature = clif.import_signature(signature);
    let colocated = namespace == FUNCTIONS;
    clif.import_function(ExtFuncData { name: ExternalName::User(name), signature, colocated, patchable: false })
}
