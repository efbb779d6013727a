//! From one entry of a residual to a module: analysis, structure, naga functions, SPIR-V.

use jerboa_ir::cfg::{Cfg, Exit};
use jerboa_ir::schedule::Scheduler;
use jerboa_ir::structure::{Step, structure};
use jerboa_ir::{BufKind, ContId, Node, Op, Program, Scalar};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{AddressSpace, EntryPoint, GlobalVariable, Handle, MemoryDecorations, ResourceBinding, Span, StorageAccess};
use rustc_hash::FxHashMap;

use crate::code::Types;
use crate::flow::pieces;
use crate::function::{Cost, Globals, Unit, emit as function, scalars};
use crate::launch::{Binding, Launch};
use crate::module::{Array, Module, Report};
use crate::{Error, Grid, Options, WORKGROUP, spirv, text};

/// Emits one entry of a residual.
///
/// # Errors
/// See [`Error`]: the program or the options are wrong, the kernel recurses, uses what GPUs do not have, or is too large.
pub fn emit(program: &Program, entry: &str, options: &Options) -> Result<Module, Error> {
    let kernel = || entry.to_owned();
    let cont = program.entry(entry).ok_or_else(|| Error::NoEntry {
        kernel: kernel(),
        entries: program.entries.iter().map(|(name, _)| format!("`{name}`")).collect(),
    })?;
    let cfg = Cfg::new(program, &[cont]).map_err(|fault| Error::NotFirstOrder { kernel: kernel(), fault })?;
    let (arguments, results) =
        shape(program, cont, options.grid).map_err(|why| Error::Shape { kernel: kernel(), why })?;
    no_recursion(program, &cfg).map_err(|chain| Error::Recursion { kernel: kernel(), chain })?;
    let groups = options.packing.groups(entry, program)?;
    let bindings = Binding::all(program, &cfg, groups, results);
    if bindings.len() > crate::STORAGE_BUFFERS {
        let why = format!("with the launch and the results there are {} storage buffers, not 8", bindings.len());
        return Err(Error::Packing { kernel: kernel(), why });
    }

    let trees = cfg.functions.iter().map(|f| structure(program, f)).collect::<Result<Vec<Vec<Step>>, _>>();
    let trees = trees.map_err(|fault| Error::Unstructured { kernel: kernel(), fault: Box::new(fault) })?;
    let mut scheduler = Scheduler::new(program);
    let schedules: Vec<_> = cfg.functions.iter().map(|f| scheduler.function(f)).collect();
    let structured = text::structured(program, &cfg, &schedules, &trees);
    let flows = cfg.functions.iter().zip(&trees).map(|(f, steps)| pieces(program, f, steps)).collect();

    let mut module = naga::Module::default();
    let mut types = Types::default();
    let globals = globals(&mut module, &mut types, program, &bindings);
    let launch = Launch { arguments, buffers: program.buffers.len() as u32 };
    let unit = Unit { program, cfg, schedules, flows, grid: options.grid, launch, params: params(program), globals };
    unit.check().map_err(|why| Error::Unsupported { kernel: kernel(), why })?;
    let spills = functions(&mut module, &mut types, &unit, entry);
    module.types = types.0;

    let refused = |why: String| Error::Naga { kernel: kernel(), why };
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|e| refused(e.emit_to_string("")))?;
    let words = spirv::write(&module, &info).map_err(|e| refused(e.to_string()))?;
    let report = report(&unit, &module, words.len(), spills);
    if words.len() > options.budget.words {
        let (words, blocks, budget) = (words.len(), report.blocks, options.budget.words);
        return Err(Error::Budget { kernel: kernel(), words, blocks, budget });
    }
    Ok(Module {
        name: kernel(),
        grid: options.grid,
        naga: module,
        info,
        words,
        structured,
        report,
        arguments,
        results,
        bindings,
    })
}

/// Words of arguments and results.
fn shape(p: &Program, entry: ContId, grid: Grid) -> Result<(u32, u32), String> {
    let (ret, params) = p.cont(entry).params.split_last().ok_or("an entry has a return")?;
    let results = ret.ty.params().unwrap_or_default();
    let params = match grid {
        Grid::Single => params,
        Grid::Items => match params.split_first() {
            Some((first, rest)) if first.ty.as_scalar() == Some(Scalar::U32) => rest,
            _ => return Err("its first parameter is not the number of the invocation, a `u32`".into()),
        },
    };
    if grid == Grid::Items && !results.is_empty() {
        return Err("it returns values; many invocations have no one to return them to, so store them".into());
    }
    let words = |types: &mut dyn Iterator<Item = jerboa_ir::Ty>| scalars(types).len() as u32;
    Ok((words(&mut params.iter().map(|x| x.ty)), words(&mut results.iter().copied())))
}

/// No function calls itself, not even by way of others or as its last act; otherwise the chain of calls.
fn no_recursion(p: &Program, cfg: &Cfg) -> Result<(), Vec<String>> {
    let component = |f: u32| cfg.functions[f as usize].component;
    let inner = |f: u32| {
        let calls = cfg.functions[f as usize].calls.iter();
        calls.map(|c| c.callee).filter(move |callee| component(*callee) == component(f))
    };
    let Some(start) = (0..cfg.functions.len() as u32).find(|f| inner(*f).next().is_some()) else { return Ok(()) };
    let mut chain = vec![start];
    let again = loop {
        let next = inner(chain[chain.len() - 1]).next().expect("each of a component calls one of it");
        match chain.iter().position(|f| *f == next) {
            Some(at) => break at,
            None => chain.push(next),
        }
    };
    let mut chain = chain.split_off(again);
    chain.push(chain[0]);
    Err(chain.iter().map(|f| format!("`{}`", p.cont(cfg.functions[*f as usize].cont).name)).collect())
}

/// The storage buffers.
fn globals(module: &mut naga::Module, types: &mut Types, p: &Program, bindings: &[Binding]) -> Globals {
    let ty = types.array(Scalar::U32, None);
    let mut add = |number: usize, binding: &Binding, name: &str| {
        let access =
            if binding.is_written() { StorageAccess::LOAD | StorageAccess::STORE } else { StorageAccess::LOAD };
        let variable = GlobalVariable {
            name: Some(name.to_owned()),
            space: AddressSpace::Storage { access },
            binding: Some(ResourceBinding { group: 0, binding: number as u32 }),
            ty,
            init: None,
            memory_decorations: MemoryDecorations::empty(),
        };
        module.global_variables.append(variable, Span::UNDEFINED)
    };
    let launch = add(0, &Binding::Launch, "launch");
    let mut globals = Globals { launch, buffers: vec![launch; p.buffers.len()], results: None };
    for (number, binding) in bindings.iter().enumerate().skip(1) {
        match binding {
            Binding::Launch => {}
            Binding::Results => globals.results = Some(add(number, binding, "results")),
            Binding::Tables(group) | Binding::Streams(group) => {
                let kind = if p.buffer(group[0]).kind == BufKind::Stream { "streams" } else { "tables" };
                let name = if let [one] = group[..] { &*p.buffer(one).name } else { kind };
                let variable = add(number, binding, name);
                group.iter().for_each(|buf| globals.buffers[buf.index()] = variable);
            }
        }
    }
    globals
}

/// The node of each parameter that has one.
fn params(p: &Program) -> FxHashMap<(ContId, u32), jerboa_ir::NodeId> {
    let param = |(i, node): (usize, &Node)| match node {
        Node::Param { cont, index } => Some(((*cont, *index), jerboa_ir::NodeId(i as u32))),
        _ => None,
    };
    p.nodes.iter().enumerate().filter_map(param).collect()
}

/// Emits all functions, callees first, and the entry; how many values go through a variable.
fn functions(module: &mut naga::Module, types: &mut Types, unit: &Unit, entry: &str) -> usize {
    let mut order: Vec<usize> = (0..unit.cfg.functions.len()).collect();
    order.sort_by_key(|f| unit.cfg.functions[*f].component);
    let mut made: Vec<Option<Handle<naga::Function>>> = vec![None; order.len()];
    let mut spills = 0;
    for index in order {
        let (naga, Cost { spills: more }) = function(unit, types, &made, index);
        spills += more;
        if index != 0 {
            made[index] = Some(module.functions.append(naga, Span::UNDEFINED));
            continue;
        }
        module.entry_points.push(EntryPoint {
            name: entry.to_owned(),
            stage: naga::ShaderStage::Compute,
            early_depth_test: None,
            workgroup_size: [if unit.grid == Grid::Items { WORKGROUP } else { 1 }, 1, 1],
            workgroup_size_overrides: None,
            function: naga,
            mesh_info: None,
            task_payload: None,
            incoming_ray_payload: None,
        });
    }
    spills
}

impl Unit<'_> {
    /// What no GPU has.
    fn check(&self) -> Result<(), String> {
        let p = self.program;
        for (f, schedule) in self.cfg.functions.iter().zip(&self.schedules) {
            let cont = p.cont(f.cont);
            if let Some(param) = cont.params.iter().rev().skip(1).find(|x| !x.ty.is_data()) {
                return Err(format!("function `{}` takes a {}; only data may be passed", cont.name, param.ty));
            }
            for x in schedule.blocks.iter().flatten() {
                let at = format!("function `{}` ({})", cont.name, p.locs[x.index()]);
                match p.node(*x) {
                    Node::Prim { op: Op::Fma, .. } => {
                        return Err(format!(
                            "{at} has an `fma`, which SPIR-V does not promise to round once; write the product and the \
                             sum, or take a CPU device"
                        ));
                    }
                    Node::Prim { .. } | Node::Pack(_) | Node::Lane { .. } | Node::Read { .. } => {}
                    other => return Err(format!("{at} computes {other:?}, which is in no residual")),
                }
            }
        }
        Ok(())
    }
}

fn report(unit: &Unit, module: &naga::Module, words: usize, spills: usize) -> Report {
    let p = unit.program;
    let expressions = |f: &naga::Function| f.expressions.len();
    let mut arrays = Vec::new();
    for f in &unit.cfg.functions {
        for block in &f.blocks {
            if let jerboa_ir::Body::Local { scalar, len, .. } = p.cont(block.cont).body {
                arrays.push(Array { function: p.cont(f.cont).name.to_string(), scalar, len });
            }
        }
    }
    let calls = |f: &jerboa_ir::cfg::Function| {
        f.blocks.iter().filter(|b| matches!(Exit::of(p, b.cont), Ok(Exit::Call { .. }))).count()
    };
    Report {
        functions: unit.cfg.functions.len(),
        calls: unit.cfg.functions.iter().map(calls).sum(),
        blocks: unit.cfg.functions.iter().map(|f| f.blocks.len()).sum(),
        expressions: module
            .functions
            .iter()
            .map(|(_, f)| f)
            .chain(module.entry_points.iter().map(|e| &e.function))
            .map(expressions)
            .sum(),
        words,
        spills,
        arrays,
    }
}
