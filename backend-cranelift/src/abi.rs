//! How values travel: types, signatures, and what a kernel is given.
//!
//! A vector is one value of 128 bits, a *part*, for every four lanes; what the lanes that are left over in the last part
//! hold means nothing. A residual function has Cranelift's `tail` convention, so that a tail call takes no stack, and the
//! parameters
//! 1. the bindings, if it or a callee touches a buffer,
//! 2. the depth that is left, if it or a callee recurses,
//! 3. an area for the results, if they do not fit in registers,
//! 4. its own.
//!
//! It returns a status, if it or a callee recurses, and its results: in registers if they fit, else in the caller's area.

use cranelift_codegen::ir::{AbiParam, Signature, Type, types};
use cranelift_codegen::isa::CallConv;
use jerboa_ir::cfg::{Cfg, Function};
use jerboa_ir::schedule::Schedule;
use jerboa_ir::{Body, Mem, Node, Program, Scalar, Ty};

/// Memory of one buffer, as a kernel is given it: an array of these, indexed by binding number.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Binding {
    /// The first word; 4-byte aligned. A buffer of no rows may have any pointer here.
    pub words: *mut u32,
    /// Number of rows; there are as many words as rows times columns.
    pub rows: u32,
}

// SAFETY: a binding is an address and a number; whoever calls a kernel with it answers for the memory ([`crate::Kernel`]).
unsafe impl Send for Binding {}
// SAFETY: as above; it has no interior mutability.
unsafe impl Sync for Binding {}

impl Binding {
    /// Binds words that hold `rows` rows.
    pub fn new(words: &mut [u32], rows: u32) -> Binding {
        Binding { words: words.as_mut_ptr(), rows }
    }
}

/// How a kernel ended.
#[must_use]
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Status {
    /// It ran to its end.
    Done,
    /// Its recursion got deeper than [`crate::KernelReport::depth`]. Buffers may be half written, results are not.
    Limit,
}

/// The type of an address.
pub(crate) const POINTER: Type = types::I64;

/// Results of each register class that a function returns in registers; both x86-64 and AArch64 have that many.
const RESULT_REGISTERS: usize = 8;

/// Lanes of a part.
pub(crate) const LANES: usize = 4;

/// The machine type of a scalar. A bool is the byte 0 or 1.
pub(crate) fn clif(scalar: Scalar) -> Type {
    match scalar {
        Scalar::Bool => types::I8,
        Scalar::I32 | Scalar::U32 => types::I32,
        Scalar::F32 => types::F32,
    }
}

/// The machine type of a part. A bool is the lane 0 or −1.
pub(crate) fn part(scalar: Scalar) -> Type {
    match scalar {
        Scalar::Bool | Scalar::I32 | Scalar::U32 => types::I32X4,
        Scalar::F32 => types::F32X4,
    }
}

/// Scalar and lanes of data; nothing else has a value at run time.
pub(crate) fn data(ty: Ty) -> (Scalar, usize) {
    ty.lanes().unwrap_or((Scalar::Bool, 0))
}

/// The machine types of data: of a scalar one, of a vector one for each part.
pub(crate) fn parts(ty: Ty) -> impl Iterator<Item = Type> {
    let (scalar, lanes) = data(ty);
    let ty = if lanes == 1 { clif(scalar) } else { part(scalar) };
    std::iter::repeat_n(ty, lanes.div_ceil(LANES))
}

/// How a function is called.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    /// Its own parameters.
    pub params: Vec<Ty>,
    /// Its results.
    pub results: Vec<Ty>,
    /// Does it take the bindings?
    pub bindings: bool,
    /// Does it take the depth and return a status?
    pub counted: bool,
}

impl Shape {
    /// The machine types of the results.
    pub fn results(&self) -> impl Iterator<Item = Type> {
        self.results.iter().flat_map(|ty| parts(*ty))
    }

    /// Do the results go through memory?
    pub fn has_area(&self) -> bool {
        let (ints, floats): (Vec<Type>, Vec<Type>) = self.results().partition(|ty| ty.is_int());
        floats.len() > RESULT_REGISTERS || ints.len() + self.counted as usize > RESULT_REGISTERS
    }

    /// Where each machine value of the results is in the area, in bytes.
    pub fn places(&self) -> impl Iterator<Item = (Type, i32)> {
        self.results().scan(0, |end, ty| {
            let at = u32::next_multiple_of(*end, ty.bytes());
            *end = at + ty.bytes();
            Some((ty, at as i32))
        })
    }

    /// Bytes of the area.
    pub fn area_bytes(&self) -> u32 {
        self.places().last().map_or(0, |(ty, at)| at as u32 + ty.bytes())
    }

    /// The signature.
    pub fn signature(&self) -> Signature {
        let mut s = Signature::new(CallConv::Tail);
        let hidden = [(self.bindings, POINTER), (self.counted, types::I32), (self.has_area(), POINTER)];
        let hidden = hidden.into_iter().filter(|(there, _)| *there).map(|(_, ty)| ty);
        s.params = hidden.chain(self.params.iter().flat_map(|ty| parts(*ty))).map(AbiParam::new).collect();
        let status = self.counted.then_some(types::I32);
        let results = self.results().filter(|_| !self.has_area());
        s.returns = status.into_iter().chain(results).map(AbiParam::new).collect();
        s
    }
}

/// The shapes of all functions.
pub(crate) fn shapes(p: &Program, cfg: &Cfg, schedules: &[Schedule]) -> Vec<Shape> {
    let components = cfg.functions.iter().map(|f| f.component as usize + 1).max().unwrap_or(0);
    let (mut bindings, mut counted) = (vec![false; components], vec![false; components]);
    let mut order: Vec<usize> = (0..cfg.functions.len()).collect();
    order.sort_by_key(|f| cfg.functions[*f].component);
    for &i in &order {
        let f = &cfg.functions[i];
        let own = f.component as usize;
        let callees = || f.calls.iter().map(|c| cfg.functions[c.callee as usize].component as usize);
        bindings[own] |= touches_buffers(p, f, &schedules[i]) || callees().any(|c| bindings[c]);
        counted[own] |= f.recursive || callees().any(|c| counted[c]);
    }
    let shape = |f: &Function| {
        let params = &p.cont(f.cont).params;
        let (ret, own) = params.split_last().expect("a function has a return");
        Shape {
            params: own.iter().map(|x| x.ty).collect(),
            results: ret.ty.params().unwrap_or_default().to_vec(),
            bindings: bindings[f.component as usize],
            counted: counted[f.component as usize],
        }
    };
    cfg.functions.iter().map(shape).collect()
}

/// Does the function itself read, load or store in a buffer?
fn touches_buffers(p: &Program, f: &Function, schedule: &Schedule) -> bool {
    let placed = |body: &Body| match body {
        Body::Load { mem, .. } | Body::Store { mem, .. } => !matches!(mem, Mem::Local(_)),
        _ => false,
    };
    f.blocks.iter().any(|b| placed(&p.cont(b.cont).body))
        || schedule.blocks.iter().flatten().any(|n| matches!(p.node(*n), Node::Read { .. }))
}
