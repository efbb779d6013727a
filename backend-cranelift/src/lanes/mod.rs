//! Lanes: `vectorize` becomes vector code, in a pass from IR to IR.
//!
//! A processor's vector unit does one operation on 4, 8 or 16 numbers in the time of one. A loop whose iterations are
//! independent can use it: W iterations go through the same code at once, each in a *lane* of the vectors. Whole functions
//! are vectorised, as they stand, with all their branches, loops and calls (Karrenberg and Hack, *Whole-Function
//! Vectorization*, CGO 2011). The result is a program like any other: it prints, reads back, is verified and interpreted.
//!
//! ```
//! use jerboa_backend_cranelift::lanes::{Width, lanes};
//!
//! let scalar = jerboa_ir::parse(
//!     "jerboa-ir 1
//! stream s by columns
//!   x: f32 bulk
//! entry main = main
//! fun main(n: u32, a: f32, return: fn())
//!   vectorize 4 0u n each(a) -> done
//!   rest done()
//!   jump return()
//! fun each(a: f32, i: u32, return: fn())
//!   load s.x i -> loaded
//!   rest loaded(x: f32)
//!   positive = gt x 0.0
//!   branch positive scale leave
//!   arm scale()
//!     y = mul a x
//!     store s.x i y -> leave
//!   join leave()
//!     jump return()
//! ",
//! )?;
//! let vector = lanes(&scalar, Width::Hint)?;
//! # let text = jerboa_ir::print(&vector);
//! # let expected = "\
//! # fun each_x4(mask: boolx4, a: f32, i: u32, return: fn())
//! #   load s.x i -> loaded
//! #   rest loaded(x: f32x4)  ; free: mask, a, i, return
//! #   y1 = pack 0.0 0.0 0.0 0.0
//! #   positive = gt x y1
//! #   y2 = and mask positive
//! #   y3 = any y2
//! #   branch y3 some none
//! #   arm some()  ; free: mask, a, i, return, x
//! #     y4 = pack a a a a
//! #     y = mul y4 x
//! #     store s.x i y when y2 -> stored
//! #   arm none()  ; free: return
//! #     jump stored()
//! #   rest stored()  ; free: return
//! #   jump return()
//! # ";
//! # assert!(text.ends_with(expected), "{text}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The *lane version* of `each` in `vector` takes the lanes that are active first:
//!
//! ```text
//! fun each_x4(mask: boolx4, a: f32, i: u32, return: fn())
//!   load s.x i -> loaded
//!   rest loaded(x: f32x4)
//!   y1 = pack 0.0 0.0 0.0 0.0
//!   positive = gt x y1
//!   y2 = and mask positive
//!   y3 = any y2
//!   branch y3 some none
//!   arm some()
//!     y4 = pack a a a a
//!     y = mul y4 x
//!     store s.x i y when y2 -> stored
//!   arm none()
//!     jump stored()
//!   rest stored()
//!   jump return()
//! ```
//!
//! # Shapes
//! Not everything differs from lane to lane. A value is *uniform*, *consecutive* (that of lane l is that of lane 0 plus l: the
//! index of the iteration) or *varying*, and stays a scalar unless it is varying. Loads and stores at a consecutive index are
//! *runs* of rows, at a varying one gathers and scatters. A branch on a uniform value stays a branch. `plan.rs` finds the
//! shapes, the largest set of uniform values that holds; a function has a lane version for each list of shapes that it is
//! called with, and a call of uniform arguments calls the function itself.
//!
//! # Control flow
//! Where lanes disagree, they go one way after the other. The tree of a function ([`mod@jerboa_ir::structure`]) says where
//! they meet again:
//!
//! | tree | lane code |
//! |---|---|
//! | choice on a uniform value | a branch |
//! | choice on a varying value | the arms one after the other, cheap ones first, each under the mask of its lanes; the others skipped if they have none |
//! | exit from within an arm of such a choice | the lanes are noted in a mask, and go on where the exit leads when all others have come there |
//! | loop that all lanes leave together | a loop |
//! | loop that lanes leave in different rounds | a loop until no lane is left; a value that outlives it is kept as each lane leaves |
//! | values of a join | where lanes meet that went different ways a selection, else parameters |
//! | early return | an exit from the function |
//!
//! So only what is under a varying choice is linearised (*partial* control flow linearisation: Moll and Hack, PLDI 2018). Unlike
//! theirs, the pass works on the tree, not on blocks in a line: an exit past several loops is one mask, and a label that lanes
//! do not wait at is a jump.
//!
//! # Masks
//! Pure operations are total, so inactive lanes compute nonsense at no harm, without a mask. Stores take the mask, calls pass it
//! on. What takes no mask is never reached without an active lane: a call, a loop or an effect is behind a test wherever
//! lanes may all have left; a loop over uniform values of a callee would otherwise not be sure to end. Where every lane
//! that came in comes out (a choice whose arms do not leave, a label that only its own exits leave), the mask behind it is
//! the very one before; none is computed.
//!
//! # Why this form
//! The remaining iterations of a loop are lanes that are not active, not a second, scalar copy of the code. Widths of 8 and 16 are
//! vectors of 8 and 16 here; the back end makes values of 128 bits of them. Everything is decided before code
//! generation and can be read in the output: `jerboa dump --stage lanes`.
//!
//! Recursion works: the lane version calls itself while some lane does. A call in tail position under a varying choice is no tail
//! call in lanes, because other lanes wait, so it takes stack.
//!
//! The modules, in reading order: `shape.rs` (shapes), `flow.rs` (where lanes wait), `plan.rs` (the analysis), `value.rs`
//! and `path.rs` (what lane code is made of), `function.rs` (the walk over the tree), `place.rs`, `choice.rs`, `repeat.rs`
//! (labels, choices, loops), `effect.rs` (memory and calls), `copy.rs` (what stays scalar, and the loop over lanes).

mod choice;
mod copy;
mod effect;
mod flow;
mod function;
mod nodes;
mod path;
mod place;
mod plan;
mod repeat;
mod shape;
mod value;

use std::fmt;
use std::rc::Rc;
use std::sync::Arc;

use jerboa_ir::cfg::{Cfg, Function, NotFirstOrder};
use jerboa_ir::structure::{Unstructured, structure};
use jerboa_ir::*;
use rustc_hash::FxHashMap;

use copy::Copies;
use function::Writing;
use nodes::Params;
use plan::{Analysis, Plan};
use shape::Shape;
use value::{Writer, parts};

/// How many iterations of a `vectorize` run at once.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Width {
    /// As many as it says.
    #[default]
    Hint,
    /// So many, whatever it says: 4, 8 or 16.
    Lanes(u8),
}

/// Why a program has no lane version.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Fault {
    /// It is no residual: a fault of whoever made it.
    NotFirstOrder(Box<NotFirstOrder>),
    /// The control flow of a function has no structure.
    Unstructured(Box<Unstructured>),
    /// There is a `vectorize` within one.
    Nested {
        /// The inner one's block.
        name: Arc<str>,
        /// Where the author wrote it.
        loc: Loc,
    },
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Fault::NotFirstOrder(why) => write!(f, "{why}"),
            Fault::Unstructured(why) => write!(f, "{why}"),
            Fault::Nested { name, loc } => {
                write!(
                    f,
                    "`{name}` has a `vectorize` within a `vectorize`; lanes have no lanes: make the inner one a loop"
                )?;
                if *loc != Loc::NONE { write!(f, " ({loc})") } else { Ok(()) }
            }
        }
    }
}

impl From<NotFirstOrder> for Fault {
    fn from(why: NotFirstOrder) -> Fault {
        Fault::NotFirstOrder(Box::new(why))
    }
}

impl std::error::Error for Fault {}

/// The program with a loop over lanes for each `vectorize`. See the module's page.
///
/// # Errors
/// If it is no residual, or a function that runs in lanes has no structure or a `vectorize` of its own.
///
/// # Panics
/// If the width is none of 4, 8 and 16.
pub fn lanes(p: &Program, width: Width) -> Result<Program, Fault> {
    of_entries(p, &p.entries, width)
}

/// Of some entries only.
pub(crate) fn of_entries(p: &Program, entries: &[(Arc<str>, ContId)], width: Width) -> Result<Program, Fault> {
    assert!(matches!(width, Width::Hint | Width::Lanes(4 | 8 | 16)), "a width is 4, 8 or 16 lanes");
    let conts: Vec<ContId> = entries.iter().map(|(_, entry)| *entry).collect();
    let cfg = Cfg::new(p, &conts)?;
    let mut world = World::new();
    p.buffers.iter().for_each(|b| _ = world.buffer(b.clone()));
    let mut lanes = Lanes {
        p,
        cfg: &cfg,
        params: &Params::new(p),
        width,
        writer: Writer { w: world, width: 0, loc: Loc::NONE },
        copies: Copies::default(),
        to_copy: Vec::new(),
        plans: FxHashMap::default(),
        versions: FxHashMap::default(),
        to_write: Vec::new(),
        fault: None,
    };
    for (name, entry) in entries {
        let copy = lanes.scalar(*entry);
        lanes.writer.w.entry(name.clone(), copy);
    }
    lanes.write_all()?;
    Ok(lanes.writer.w.finish())
}

/// Does a program have a `vectorize`? If not, [`lanes`] has nothing to do.
pub fn vectorizes(p: &Program) -> bool {
    p.entries.iter().any(|(_, entry)| entry_vectorizes(p, *entry))
}

/// Does an entry reach one?
pub(crate) fn entry_vectorizes(p: &Program, entry: ContId) -> bool {
    let reach = Reach::new(p, [entry]);
    reach.conts.iter().any(|c| matches!(p.cont(*c).body, Body::Vectorize { .. }))
}

/// Functions of the new program, made as they are called.
struct Lanes<'p> {
    p: &'p Program,
    cfg: &'p Cfg,
    params: &'p Params,
    width: Width,
    writer: Writer,
    copies: Copies,
    to_copy: Vec<&'p Function>,
    /// The analysis of a function for the shapes of its parameters; none while it is under way.
    plans: FxHashMap<(ContId, Vec<Shape>), Option<Rc<Plan>>>,
    /// Lane versions, by function, shapes of its parameters and number of lanes.
    versions: FxHashMap<(ContId, Vec<Shape>, usize), ContId>,
    to_write: Vec<(ContId, Vec<Shape>, usize)>,
    /// What went wrong first.
    fault: Option<Fault>,
}

impl<'p> Lanes<'p> {
    fn write_all(&mut self) -> Result<(), Fault> {
        loop {
            if let Some(f) = self.to_copy.pop() {
                self.copy(f);
            } else if let Some((function, shapes, width)) = self.to_write.pop() {
                self.write(function, shapes, width)?;
            } else {
                return Ok(());
            }
            if let Some(fault) = self.fault.take() {
                return Err(fault);
            }
        }
    }

    fn function(&self, function: ContId) -> &'p Function {
        self.cfg.function(function).expect("what is called is a function")
    }

    /// The analysis of a function; none while it is under way, for it is recursive, and if there is a fault.
    fn plan(&mut self, function: ContId, shapes: &[Shape]) -> Option<Rc<Plan>> {
        let key = (function, shapes.to_vec());
        if let Some(plan) = self.plans.get(&key) {
            return plan.clone();
        }
        self.plans.insert(key.clone(), None);
        let (p, f) = (self.p, self.function(function));
        let tree = match structure(p, f) {
            Ok(tree) => tree,
            Err(why) => {
                self.fault.get_or_insert(Fault::Unstructured(Box::new(why)));
                return None;
            }
        };
        let analysis = Analysis::new(p, f, tree, self.params, shapes);
        let plan = Rc::new(analysis.run(&mut |callee, shapes| self.results(callee, &shapes)));
        self.plans.insert(key, Some(plan.clone()));
        Some(plan)
    }

    /// The shapes of a call's results.
    fn results(&mut self, callee: ContId, shapes: &[Shape]) -> Vec<Shape> {
        let count = self.p.cont(callee).params.last().and_then(|ret| ret.ty.params()).map_or(0, <[Ty]>::len);
        if shapes.iter().all(|s| *s == Shape::Uniform) {
            return vec![Shape::Uniform; count];
        }
        self.plan(callee, shapes).map_or(vec![Shape::Varying; count], |plan| plan.results.clone())
    }

    /// The lane version of a function for parameters of these shapes, and the shapes of its results. Its body is written
    /// later.
    fn version(&mut self, function: ContId, shapes: &[Shape]) -> (ContId, Vec<Shape>) {
        let results = self.results(function, shapes);
        let key = (function, shapes.to_vec(), self.writer.width);
        if let Some(version) = self.versions.get(&key) {
            return (*version, results);
        }
        let Cont { name, params, loc, .. } = self.p.cont(function);
        let (ret, own) = params.split_last().expect("a function has a return");
        let width = self.writer.width;
        let mut all = vec![Param { ty: Ty::vector(Scalar::Bool, width), name: Some("mask".into()), keep: false }];
        for (param, shape) in own.iter().zip(shapes) {
            let part = |ty| Param { ty, name: param.name.clone(), keep: false };
            all.extend(parts(param.ty, *shape, width).into_iter().map(part));
        }
        let returned = ret.ty.params().unwrap_or_default().iter().zip(&results);
        let returned: Vec<Ty> = returned.flat_map(|(ty, shape)| parts(*ty, *shape, width)).collect();
        all.push(Param { ty: Ty::func(&returned), name: Some("return".into()), keep: false });
        let version = self.writer.w.cont(format!("{name}_x{width}"), Role::Fun, all, *loc);
        let filter = self.writer.w.lit(Lit::Bool(false));
        self.writer.w.cont_mut(version).filter = filter;
        self.versions.insert(key.clone(), version);
        self.to_write.push(key);
        (version, results)
    }

    /// Write the body of a lane version.
    fn write(&mut self, function: ContId, shapes: Vec<Shape>, width: usize) -> Result<(), Fault> {
        let Some(plan) = self.plan(function, &shapes) else { return Ok(()) };
        let version = self.versions[&(function, shapes.clone(), width)];
        self.writer.width = width;
        let f = self.function(function);
        Writing::run(self, f, plan, &shapes, version)
    }
}
