//! The environment machine: runs the generic program and emits what it cannot run.
//!
//! A *path* is a residual block under construction and a continuation that is evaluated into it. A path goes on through
//! calls that unfold and through the taken sides of decided branches; it ends in a jump that stays. Blocks that are
//! still empty wait in a worklist, so the machine never recurses.

use jerboa_ir::*;
use rustc_hash::FxHashMap;

use crate::Options;
use crate::budget::Event;
use crate::error::{Error, Place};
use crate::facts::{Facts, Fold, Used};
use crate::frame::Frames;
use crate::log::{Call, Decision, Reason, TrailId, Trails};
use crate::report::Report;
use crate::value::{FrameId, NO_CLASS, Tuples, Value};

/// What a path does next.
pub(crate) enum Step {
    /// Evaluate the body of a continuation in its frame.
    Enter(ContId, FrameId),
    /// Call a closure or an exit.
    Call(Value, Vec<Value>, Mode),
    /// The block is closed.
    Done,
}

/// A block that waits for its body.
struct Task {
    at: ContId,
    function: ContId,
    trail: TrailId,
    step: Step,
}

/// One specialisation.
pub(crate) struct Machine<'a> {
    pub(crate) p: &'a Program,
    pub(crate) scope: &'a Scope,
    pub(crate) facts: &'a Facts,
    pub(crate) options: &'a Options,
    /// The residual.
    pub(crate) world: World,
    pub(crate) frames: Frames,
    pub(crate) tuples: Tuples,
    pub(crate) used: Used,
    /// Scratch of [`Machine::eval`].
    pub(crate) stack: Vec<(NodeId, FrameId)>,
    pub(crate) evaluations: u64,
    /// The residual block that is written, and the residual function it belongs to.
    pub(crate) at: ContId,
    pub(crate) function: ContId,
    /// Calls that led here.
    pub(crate) trail: TrailId,
    pub(crate) trails: Trails,
    work: Vec<Task>,
    /// Residual blocks by function, continuation, environment and known arguments.
    pub(crate) blocks: FxHashMap<Box<[u32]>, ContId>,
    /// Residual functions by continuation, content of the environment and known arguments.
    pub(crate) functions: FxHashMap<Box<[u32]>, ContId>,
    /// Copies that stay, by continuation and environment.
    pub(crate) copies: FxHashMap<(ContId, FrameId), Vec<crate::copies::Copy>>,
    /// The block in which each residual continuation was made.
    pub(crate) made_in: Vec<ContId>,
    /// How often each generic continuation was unfolded.
    pub(crate) unfolded: Vec<u32>,
    /// How often any was.
    pub(crate) unfoldings: u64,
    /// How many residual continuations each generic continuation became.
    pub(crate) residuals: Vec<u32>,
    /// Those that became several. (There are many continuations, and few are in a residual at all.)
    pub(crate) several: Vec<ContId>,
    /// Continuations with so many copies that classes and `keep` no longer count.
    pub(crate) generalised: Vec<bool>,
    pub(crate) events: Vec<Event>,
    pub(crate) calls: Vec<Call>,
    chaos: Option<u64>,
}

impl<'a> Machine<'a> {
    pub fn new(p: &'a Program, scope: &'a Scope, facts: &'a Facts, options: &'a Options) -> Machine<'a> {
        let mut world = World::new();
        for buffer in &p.buffers {
            world.buffer(crate::emit::residual_buffer(buffer));
        }
        Machine {
            p,
            scope,
            facts,
            options,
            world,
            frames: Frames::new(scope),
            tuples: Tuples::default(),
            used: Used::default(),
            stack: Vec::new(),
            evaluations: 0,
            at: ContId(0),
            function: ContId(0),
            trail: TrailId::NONE,
            trails: Trails::default(),
            work: Vec::new(),
            blocks: FxHashMap::default(),
            functions: FxHashMap::default(),
            copies: FxHashMap::default(),
            made_in: Vec::new(),
            unfolded: vec![0; p.conts.len()],
            unfoldings: 0,
            residuals: vec![0; p.conts.len()],
            several: Vec::new(),
            generalised: vec![false; p.conts.len()],
            events: Vec::new(),
            calls: Vec::new(),
            chaos: options.chaos,
        }
    }

    /// Run until no block waits.
    pub fn run(&mut self) -> Result<(), Error> {
        while let Some(task) = self.work.pop() {
            (self.at, self.function, self.trail) = (task.at, task.function, task.trail);
            let mut step = task.step;
            loop {
                step = match step {
                    Step::Enter(cont, frame) => self.body(cont, frame)?,
                    Step::Call(callee, args, mode) => self.call(callee, args, mode)?,
                    Step::Done => break,
                };
            }
        }
        Ok(())
    }

    /// Evaluate a body.
    fn body(&mut self, cont: ContId, f: FrameId) -> Result<Step, Error> {
        let p = self.p;
        let loc = p.cont(cont).loc;
        match &p.cont(cont).body {
            Body::Unset => unreachable!("the verifier lets only finished continuations through"),
            Body::Jump { callee, args, mode } => {
                let callee = self.eval(*callee, f);
                let args = args.iter().map(|a| self.eval(*a, f)).collect();
                Ok(Step::Call(callee, args, *mode))
            }
            Body::Branch { cond, then, other } => {
                let cond = self.data(*cond, f);
                if let Some(Lit::Bool(c)) = self.lit(cond) {
                    return Ok(self.go(if c { *then } else { *other }, f));
                }
                let (then, other) = (self.arm(*then, f, vec![]), self.arm(*other, f, vec![]));
                Ok(self.leave(Body::Branch { cond, then, other }, loc))
            }
            Body::Switch { index, arms, default } => {
                let index = self.data(*index, f);
                if let Some(Lit::U32(i)) = self.lit(index) {
                    let arm = arms.iter().find(|(n, _)| *n == i).map_or(*default, |(_, arm)| *arm);
                    return Ok(self.go(arm, f));
                }
                let arms = arms.iter().map(|(n, arm)| (*n, self.arm(*arm, f, vec![]))).collect();
                let default = self.arm(*default, f, vec![]);
                Ok(self.leave(Body::Switch { index, arms, default }, loc))
            }
            Body::Dispatch { row, arm } => {
                let row = self.eval(*row, f);
                Ok(self.dispatch(row, *arm, f, loc))
            }
            Body::Load { mem, index, next } => {
                let (mem, index) = (self.mem(*mem, f), self.data(*index, f));
                let next_value = self.eval(*next, f);
                let ty = p.loaded(*next).expect("the verifier lets only a load with one value through here");
                let (rest, value) = self.rest(next_value, ty, loc);
                self.leave(Body::Load { mem, index, next: rest.1 }, loc);
                self.at = rest.0;
                Ok(Step::Call(next_value, vec![value], Mode::Filter))
            }
            Body::Store { mem, index, value, mask, next } => {
                let (mem, index) = (self.mem(*mem, f), self.data(*index, f));
                let value = self.data(*value, f);
                let mask = if *mask == NodeId::NONE { *mask } else { self.data(*mask, f) };
                let next_value = self.eval(*next, f);
                let rest = self.block(next_value, Role::Rest, vec![], loc);
                self.leave(Body::Store { mem, index, value, mask, next: rest.1 }, loc);
                self.at = rest.0;
                Ok(Step::Call(next_value, vec![], Mode::Filter))
            }
            Body::Vectorize { width, lo, hi, body, args, next } => {
                let (lo, hi) = (self.data(*lo, f), self.data(*hi, f));
                let (body, next) = (self.eval(*body, f), self.eval(*next, f));
                let args: Vec<Value> = args.iter().map(|a| self.eval(*a, f)).collect();
                self.vectorize(*width, (lo, hi), body, args, next, loc)
            }
            Body::Local { scalar, len, next } => {
                let next_value = self.eval(*next, f);
                let (rest, value) = self.rest(next_value, Ty::local(*scalar, *len), loc);
                self.leave(Body::Local { scalar: *scalar, len: *len, next: rest.1 }, loc);
                self.at = rest.0;
                Ok(Step::Call(next_value, vec![value], Mode::Filter))
            }
        }
    }

    /// Go on in a continuation without parameters.
    fn go(&mut self, to: NodeId, f: FrameId) -> Step {
        Step::Call(self.eval(to, f), vec![], Mode::Filter)
    }

    /// "Do it with this row": once per class, if the class is unknown and there are few.
    fn dispatch(&mut self, row: Value, arm: NodeId, f: FrameId, loc: Loc) -> Step {
        let Value::Row { table, class, index } = row else { unreachable!("the verifier lets only rows through here") };
        let classes = self.facts.classes(table);
        let classed = matches!(self.p.buffer(table).kind, BufKind::Table { classed: true });
        if classes > self.options.budget.classes {
            self.events.push(Event::Classes(self.p.buffer(table).name.to_string(), classes));
        }
        let one_by_one = classed && classes <= self.options.budget.classes && !self.chance();
        if class != NO_CLASS || !one_by_one {
            return Step::Call(self.eval(arm, f), vec![row], Mode::Filter);
        }
        self.used.add(Fold::Classes(table));
        if let Value::Closure(c, _) = self.eval(arm, f) {
            self.log(c, Reason::Filter(true), Decision::Classes(classes), &[row]);
        }
        let of_class = self.world.read(Column { buf: table, col: 0 }, index, loc);
        let mut arms: Vec<(u32, NodeId)> =
            (0..classes).map(|class| (class, self.arm(arm, f, vec![Value::Row { table, class, index }]))).collect();
        let (_, default) = arms.pop().expect("a table has a class");
        self.leave(Body::Switch { index: of_class, arms, default }, loc)
    }

    /// Let a block wait for its body.
    pub(crate) fn wait(&mut self, at: ContId, function: ContId, step: Step) {
        self.work.push(Task { at, function, trail: self.trail, step });
    }

    fn mem(&mut self, mem: Mem, f: FrameId) -> Mem {
        match mem {
            Mem::Local(x) => match self.eval(x, f) {
                Value::Local(node) => Mem::Local(node),
                other => unreachable!("the verifier lets only local arrays through here, not {other:?}"),
            },
            other => other,
        }
    }

    /// A generic continuation as an error names it.
    pub(crate) fn place(&self, c: ContId) -> Place {
        let c = self.p.cont(c);
        Place { name: c.name.clone(), loc: c.loc }
    }

    /// The calls that led here.
    pub(crate) fn chain(&self) -> Vec<Place> {
        self.trails.last(self.trail, 12).into_iter().map(|c| self.place(c)).collect()
    }

    /// What was done; times and sizes of passes are added by the caller.
    pub(crate) fn report(&self) -> Report {
        let copies = |c: &ContId| (self.p.cont(*c).name.to_string(), self.residuals[c.index()]);
        let mut copies: Vec<(String, u32)> = self.several.iter().map(copies).collect();
        copies.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
        Report {
            generic_nodes: self.p.nodes.len(),
            evaluations: self.evaluations,
            unfoldings: self.unfoldings,
            functions: self.functions.len(),
            copies,
            events: self.events.clone(),
            ..Report::default()
        }
    }

    /// In chaos, true one time in eight (splitmix64 of Steele, Lea, Flood, OOPSLA 2014); else never.
    pub(crate) fn chance(&mut self) -> bool {
        let Some(state) = &mut self.chaos else { return false };
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = *state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)).is_multiple_of(8)
    }
}
