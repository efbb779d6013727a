//! Copies of a continuation that stay: what must not meet (Law 4), and what must not grow (Law 5).

use jerboa_ir::*;

use crate::error::{Error, Place};
use crate::machine::Machine;
use crate::value::{FrameId, Value};

/// A copy of a continuation that stays: the block or function, and the function values among its arguments.
pub(crate) struct Copy {
    /// The residual continuation.
    pub block: ContId,
    /// Closures, exits and local arrays, by place among the arguments.
    pub closures: Vec<(u32, Value)>,
}

impl Machine<'_> {
    /// Law 4 and Law 5 on a new copy: different closures must not meet at a join, and copies must not grow for ever.
    pub(crate) fn check_copies(&mut self, c: ContId, env: FrameId, args: &[Value], block: ContId) -> Result<(), Error> {
        let mut closures = Vec::new();
        args.iter().enumerate().for_each(|(i, a)| self.closures_of(*a, i as u32, &mut closures));
        let copies = self.copies.get(&(c, env)).map_or(&[][..], |v| &v[..]);
        if self.p.cont(c).role == Role::Join && self.p.as_lit(self.p.cont(c).filter) != Some(Lit::Bool(true)) {
            for copy in copies {
                if copy.closures != closures && !self.comes_through(copy.block) {
                    return Err(self.closures_meet(c, &copy.closures, &closures));
                }
            }
        }
        let count = copies.len() as u32 + 1;
        if count > self.options.budget.copies {
            let last = copies.last().map_or(&[][..], |copy| &copy.closures[..]);
            let growing = closures.iter().zip(last).find(|(a, b)| a != b).map(|(a, _)| a.0 as usize);
            let name = growing.and_then(|i| self.p.cont(c).params[i].name.clone());
            let argument = match (name, growing) {
                (Some(name), _) => format!("its argument `{name}`"),
                (None, Some(i)) => format!("its argument {i}"),
                (None, None) => "its environment".into(),
            };
            return Err(Error::Budget { function: self.place(c), argument, chain: self.chain(), copies: count });
        }
        self.copies.entry((c, env)).or_default().push(Copy { block, closures });
        Ok(())
    }

    fn closures_of(&self, arg: Value, place: u32, out: &mut Vec<(u32, Value)>) {
        match arg {
            Value::Tuple(id) => self.tuples.elems(id).iter().for_each(|x| self.closures_of(*x, place, out)),
            Value::Closure(..) | Value::Exit(_) | Value::Local(_) => out.push((place, arg)),
            _ => {}
        }
    }

    /// Does the current path come through this block? Then the block is an earlier round of a loop, not another arm.
    fn comes_through(&self, block: ContId) -> bool {
        let mut at = self.at;
        while at != block {
            let up = self.made_in[at.index()];
            if up == at {
                return false;
            }
            at = up;
        }
        true
    }

    fn closures_meet(&self, join: ContId, first: &[(u32, Value)], second: &[(u32, Value)]) -> Error {
        let (a, b) = first.iter().zip(second).find(|(a, b)| a != b).expect("they differ");
        let place = |v: Value| match v {
            Value::Closure(c, _) => self.place(c),
            _ => Place { name: "return".into(), loc: Loc::NONE },
        };
        Error::ClosuresMeet { join: self.place(join), first: place(a.1), second: place(b.1) }
    }
}
