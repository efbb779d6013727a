//! `vectorize`: one iteration after the other.
//!
//! The state of a loop is an object on the heap: the place in the order, the bounds, the body, where to go on, and the
//! arguments. The end of an iteration is a closure over it.
//!
//! One thing that a program's text cannot show is looked for while a loop runs: a load beyond the last row gives the last
//! row. Where another iteration stores to that, what is found there depends on the order.

use super::heap::{At, Value};
use super::machine::{ITERATE, Machine};
use super::*;

/// Cells of a loop's state; the arguments follow.
const PLACE: usize = 0;
const LO: usize = 1;
const HI: usize = 2;
const BODY: usize = 3;
const NEXT: usize = 4;
const ARGS: usize = 5;

/// What the iterations of a loop have done to streams so far.
#[derive(Default)]
pub(super) struct Touched {
    /// Columns whose last row was stored.
    stored: Vec<Column>,
    /// Columns that were loaded from beyond their last row, and by whom.
    beyond: Vec<(Column, Loc)>,
}

impl Touched {
    pub fn store_last(&mut self, column: Column) {
        if !self.stored.contains(&column) {
            self.stored.push(column);
        }
    }

    pub fn load_beyond(&mut self, column: Column, loc: Loc) {
        if !self.beyond.iter().any(|(seen, _)| *seen == column) {
            self.beyond.push((column, loc));
        }
    }
}

impl<O: Observer> Machine<'_, O> {
    /// Begin the loop.
    pub(super) fn vectorize(&mut self, lo: NodeId, hi: NodeId, body: NodeId, args: &[NodeId], next: NodeId) -> Value {
        self.loops.push(Touched::default());
        let mut state = vec![Value::Lit(Lit::U32(0))];
        state.extend([lo, hi, body, next].map(|x| self.eval(x)));
        state.extend(args.iter().map(|x| self.eval(*x)));
        Value::Closure { cont: ITERATE, frame: self.heap.object(state.into_iter()) }
    }

    /// Where the loop goes: to its body with the next index, or on.
    pub(super) fn iterate(&mut self, state: At) -> Result<Value, Stop> {
        let [place, lo, hi] = [PLACE, LO, HI].map(|cell| match self.heap.get(state, cell) {
            Value::Lit(Lit::U32(x)) => x,
            other => unreachable!("{other:?} is no bound"),
        });
        let count = hi.saturating_sub(lo);
        if place == count {
            self.end_loop()?;
            return Ok(self.heap.get(state, NEXT));
        }
        self.heap.set(state, PLACE, Value::Lit(Lit::U32(place + 1)));
        let index = lo + self.code.order.map_or(place, |order| shuffled(place, count, order));
        self.args.extend_from_slice(&self.heap.cells(state)[ARGS..]);
        self.args.extend([Value::Lit(Lit::U32(index)), Value::Closure { cont: ITERATE, frame: state }]);
        Ok(self.heap.get(state, BODY))
    }

    /// Did an iteration load what another one stores?
    fn end_loop(&mut self) -> Result<(), Stop> {
        let Some(Touched { stored, beyond }) = self.loops.pop() else { return Ok(()) };
        for (column, loc) in beyond {
            if stored.contains(&column) {
                let buffer = self.code.program.buffer(column.buf);
                let name = format!("{}.{}", buffer.name, self.code.program.column(column).name);
                let what = "an iteration loads from beyond the last row of";
                return fault(loc, format!("{what} `{name}`, and so the last one, which another iteration stores to"));
            }
        }
        Ok(())
    }
}

/// A permutation of the numbers below `count`, chosen by `order`: an affine map modulo `count`.
fn shuffled(place: u32, count: u32, order: u64) -> u32 {
    let count = u64::from(count);
    let coprime = |step: &u64| {
        let (mut a, mut b) = (*step, count);
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a == 1
    };
    let start = 1 + order % count;
    let step = (start..).find(coprime).expect("count + 1 is coprime to count");
    ((u64::from(place) * step + (order >> 32)) % count) as u32
}

#[cfg(test)]
mod tests {
    use super::shuffled;

    #[test]
    fn each_order_is_a_permutation() {
        for count in 1..40 {
            for order in [0, 1, 7, 1 << 40 | 12, u64::MAX] {
                let mut places: Vec<u32> = (0..count).map(|place| shuffled(place, count, order)).collect();
                places.sort_unstable();
                assert_eq!(places, (0..count).collect::<Vec<_>>());
            }
        }
        assert_ne!(shuffled(0, 10, 3 << 32 | 2), 0);
    }
}
