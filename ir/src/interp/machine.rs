//! One run: jump after jump.

use super::heap::{At, Heap, Value};
use super::vectorize::Touched;
use super::*;
use crate::ty::{Scalar, Ty, TyKind};

/// The continuation that ends the run.
const RETURN: ContId = ContId(u32::MAX);

/// The continuation that ends an iteration of a `vectorize`; its frame is the loop's state.
pub(super) const ITERATE: ContId = ContId(u32::MAX - 1);

/// Cell of a frame that holds the frame around it; the nodes' cells follow.
const AROUND: usize = 0;
pub(super) const FIRST_SLOT: usize = 1;

/// State of a run.
pub(super) struct Machine<'a, O> {
    pub(super) code: &'a Interp<'a>,
    pub(super) memory: &'a mut [Memory],
    limits: Limits,
    pub(super) observer: &'a mut O,
    pub(super) heap: Heap,
    /// The frames around the current point, by level; the last is the current one, the first holds the constants.
    pub(super) display: Vec<At>,
    /// Arguments of the jump under way.
    pub(super) args: Vec<Value>,
    /// The loops of independent iterations around the current point.
    pub(super) loops: Vec<Touched>,
    /// Nodes being evaluated, each waiting for the next one.
    pub(super) pending: Vec<NodeId>,
}

impl<'a, O: Observer> Machine<'a, O> {
    pub fn new(code: &'a Interp<'a>, memory: &'a mut [Memory], limits: Limits, observer: &'a mut O) -> Self {
        let constants = code.places.iter().filter(|p| p.level == 0).count();
        let mut heap = Heap::new();
        let display = vec![heap.filled(FIRST_SLOT + constants, Value::Absent)];
        let (args, loops, pending) = (Vec::new(), Vec::new(), Vec::new());
        Machine { code, memory, limits, observer, heap, display, args, loops, pending }
    }

    pub fn run(mut self, entry: ContId, args: &[Lit]) -> Result<Vec<Lit>, Stop> {
        self.pass_arguments(entry, args)?;
        let mut cont = entry;
        let mut around = self.display[0];
        loop {
            if self.limits.fuel == 0 {
                return Err(Stop::Fuel);
            }
            self.limits.fuel -= 1;
            around = self.collect_if_due(around)?;
            self.enter(cont, around);
            let mut to = self.jump(cont)?;
            while let Value::Closure { cont: ITERATE, frame } = to {
                to = self.iterate(frame)?;
            }
            match to {
                Value::Closure { cont: RETURN, .. } => break,
                Value::Closure { cont: next, frame } => (cont, around) = (next, frame),
                other => unreachable!("jump to {other:?}"),
            }
        }
        let mut results = Vec::new();
        self.args.iter().for_each(|v| self.scalars(*v, &mut results));
        Ok(results)
    }

    /// The run's arguments, and the return at the end.
    fn pass_arguments(&mut self, entry: ContId, args: &[Lit]) -> Result<(), Stop> {
        let cont = self.code.program.cont(entry);
        let wrong = |why: String| fault(cont.loc, format!("`{}` cannot be run: {why}", cont.name));
        let Some((_, params)) = cont.params.split_last().filter(|(last, _)| last.ty.params().is_some()) else {
            return wrong("its last parameter is no return".to_string());
        };
        let mut rest = args.iter().copied();
        for param in params {
            match self.argument(param.ty, &mut rest) {
                Some(value) => self.args.push(value),
                None => return wrong(format!("the arguments do not fit a parameter of type {}", param.ty)),
            }
        }
        if rest.next().is_some() {
            return wrong(format!("{} arguments are too many", args.len()));
        }
        self.args.push(Value::Closure { cont: RETURN, frame: self.display[0] });
        Ok(())
    }

    /// A value of this type made of the next scalars.
    fn argument(&mut self, ty: Ty, scalars: &mut dyn Iterator<Item = Lit>) -> Option<Value> {
        let mut list = |machine: &mut Self, types: &[Ty]| {
            let values = types.iter().map(|t| machine.argument(*t, scalars)).collect::<Option<Vec<_>>>()?;
            Some(Value::Object(machine.heap.object(values.into_iter())))
        };
        match ty.kind() {
            TyKind::Scalar(s) => scalars.next().filter(|l| l.scalar() == *s).map(Value::Lit),
            TyKind::Row(_) => scalars.next().filter(|l| l.scalar() == Scalar::U32).map(Value::Lit),
            TyKind::Vector(s, n) => list(self, &vec![Ty::scalar(*s); *n as usize]),
            TyKind::Tuple(elems) => list(self, elems),
            TyKind::Fn(_) | TyKind::Local(..) => None,
        }
    }

    /// The scalars that a value is made of.
    fn scalars(&self, value: Value, out: &mut Vec<Lit>) {
        match value {
            Value::Lit(lit) => out.push(lit),
            Value::Object(at) => self.heap.cells(at).iter().for_each(|v| self.scalars(*v, out)),
            other => unreachable!("{other:?} is no data"),
        }
    }

    /// Between two jumps only the constants, the next frame's surroundings and the arguments are alive.
    fn collect_if_due(&mut self, around: At) -> Result<At, Stop> {
        if !self.heap.is_due() {
            return Ok(around);
        }
        self.args.extend([Value::Object(self.display[0]), Value::Object(around)]);
        let alive = self.heap.collect(&mut self.args);
        let (Some(Value::Object(around)), Some(Value::Object(constants))) = (self.args.pop(), self.args.pop()) else {
            unreachable!("pushed just now")
        };
        self.display = vec![constants];
        if alive > self.limits.cells { Err(Stop::Limit) } else { Ok(around) }
    }

    /// Make the frame of a continuation, and the display right for it.
    fn enter(&mut self, cont: ContId, around: At) {
        let code = self.code;
        let shape = &code.shapes[cont.index()];
        let frame = self.heap.filled(FIRST_SLOT + shape.slots as usize, Value::Absent);
        self.heap.set(frame, AROUND, Value::Object(around));
        // What is left of the old display is a chain of frames, so the first frame that fits ends the walk.
        let level = shape.level as usize;
        self.display.truncate(level);
        let known = self.display.len();
        self.display.resize(level, At::MAX);
        let mut at = around;
        for l in (0..level).rev() {
            if l < known && self.display[l] == at {
                break;
            }
            self.display[l] = at;
            if let Value::Object(next) = self.heap.get(at, AROUND) {
                at = next;
            }
        }
        self.display.push(frame);
        self.observer.enter(cont);
        for (i, param) in shape.params.iter().enumerate() {
            if let Some(node) = param {
                self.put(*node, self.args[i]);
            }
        }
        self.args.clear();
    }

    /// Evaluate the jump of the current continuation: the callee, with its arguments in `args`.
    fn jump(&mut self, cont: ContId) -> Result<Value, Stop> {
        let code = self.code;
        Ok(match &code.program.cont(cont).body {
            Body::Unset => return fault(code.program.cont(cont).loc, "this continuation has no body"),
            Body::Jump { callee, args, .. } => {
                for arg in args {
                    let value = self.eval(*arg);
                    self.args.push(value);
                }
                self.eval(*callee)
            }
            Body::Branch { cond, then, other } => {
                let taken = self.lit(*cond).as_bool().expect("a branch takes a bool");
                self.eval(if taken { *then } else { *other })
            }
            Body::Switch { index, arms, default } => {
                let index = self.index(*index);
                let arm = arms.iter().find(|(number, _)| *number == index);
                self.eval(arm.map_or(*default, |(_, arm)| *arm))
            }
            Body::Dispatch { row, arm } => {
                let row = self.eval(*row);
                self.args.push(row);
                self.eval(*arm)
            }
            Body::Load { mem, index, next } => {
                let loaded = self.load(*mem, *index, *next)?;
                self.args.push(loaded);
                self.eval(*next)
            }
            Body::Store { mem, index, value, mask, next } => {
                self.store(*mem, *index, *value, *mask);
                self.eval(*next)
            }
            Body::Vectorize { lo, hi, body, args, next, .. } => self.vectorize(*lo, *hi, *body, args, *next),
            Body::Local { scalar, len, next } => {
                if *len as usize > self.limits.cells {
                    return Err(Stop::Limit);
                }
                let zero = Value::Lit(Lit::from_word(*scalar, 0));
                let local = self.heap.filled(*len as usize, zero);
                self.args.push(Value::Object(local));
                self.eval(*next)
            }
        })
    }
}
