//! Runs that are stored to a stream by rows: four columns of four lanes are transposed, and each lane stores its row of them
//! at once.
//!
//! Consecutive stores at the same index are one *group*: all columns are there before the first is stored. A lane that is not
//! under the mask, or has no row, stores to a row of the frame instead, so that there is nothing to branch on.

use std::collections::BTreeMap;

use cranelift_codegen::ir::{InstBuilder, MemFlagsData, StackSlotData, StackSlotKind, Value};
use jerboa_ir::{Mem, NodeId, Scalar};

use super::Emitter;
use crate::abi::{LANES, POINTER, data, part};
use crate::memory::Distance;
use crate::{pack, vector};

/// A group whose columns are not all there yet.
pub(super) struct Rows {
    /// The parts of each column, as words.
    columns: BTreeMap<u32, Vec<Value>>,
    /// How many stores are to come.
    left: usize,
}

impl Emitter<'_> {
    /// Stores a run to a column of a stream by rows: lanes under the mask whose row exists.
    pub(super) fn store_rows(
        &mut self,
        block: u32,
        mem: &Mem,
        index: NodeId,
        value: NodeId,
        mask: NodeId,
    ) -> Result<(), String> {
        let Mem::Stream(column) = mem else { return Err("it stores to a table".to_owned()) };
        let (scalar, lanes) = data(self.unit.program.ty(value));
        let mut group = match self.rows.take() {
            Some(group) => group,
            None => Rows { columns: BTreeMap::new(), left: self.group_of(block, mem).len() },
        };
        let values = self.values(value);
        let word = |x: Value| {
            let words = vector::to_words(&mut self.b, scalar, x);
            pack::cast(&mut self.b, part(Scalar::F32), words)
        };
        group.columns.insert(column.col, values.into_iter().map(word).collect());
        group.left -= 1;
        if group.left > 0 {
            self.rows = Some(group);
            return Ok(());
        }
        let (words, row, masks) = (self.words(mem)?, self.scalar(index), self.values(mask));
        let rows = self.rows_from(row, lanes);
        let active = self.active(words, &rows, &masks, lanes);
        let spare = StackSlotData::new(StackSlotKind::ExplicitSlot, words.stride, 4);
        let spare = self.b.create_sized_stack_slot(spare);
        let spare = self.b.ins().stack_addr(POINTER, spare, 0);
        for (at, rows) in rows.iter().enumerate() {
            let distances = Distance::of_lanes(&mut self.b, *rows, words.stride);
            let mut lane = at * LANES;
            let rows = distances.map(|distance| {
                let there = words.at(&mut self.b, distance).address;
                let is_active = self.b.ins().band_imm_u(active, 1 << lane);
                lane += 1;
                self.b.ins().select(is_active, there, spare)
            });
            self.store_part(&group.columns, at, rows);
        }
        Ok(())
    }

    /// Stores one part of all columns, at these addresses of the rows.
    fn store_part(&mut self, columns: &BTreeMap<u32, Vec<Value>>, at: usize, rows: [Value; LANES]) {
        let flags = MemFlagsData::new().with_notrap();
        for Span { first, count } in spans(columns.keys().copied()) {
            let own = |column: u32| columns[&column][at];
            if count == 1 {
                for (lane, row) in rows.into_iter().enumerate() {
                    let word = self.b.ins().extractlane(own(first), lane as u8);
                    self.b.ins().store(flags, word, row, first as i32 * 4);
                }
                continue;
            }
            let four = std::array::from_fn(|i| own(first + i as u32));
            for (words, row) in pack::transposed(&mut self.b, four).into_iter().zip(rows) {
                self.b.ins().store(flags, words, row, first as i32 * 4);
            }
        }
    }
}

/// Columns that are stored together: one or four.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Span {
    first: u32,
    count: u32,
}

/// Ascending columns as spans of four, of which the last may overlap the one before, and single ones.
fn spans(columns: impl Iterator<Item = u32>) -> Vec<Span> {
    let mut neighbours: Vec<Span> = Vec::new();
    for column in columns {
        match neighbours.last_mut() {
            Some(span) if span.first + span.count == column => span.count += 1,
            _ => neighbours.push(Span { first: column, count: 1 }),
        }
    }
    let four = LANES as u32;
    let cut = |Span { first, count }: Span| -> Vec<Span> {
        if count < four {
            return (first..first + count).map(|first| Span { first, count: 1 }).collect();
        }
        let span = |i: u32| Span { first: first + (i * four).min(count - four), count: four };
        (0..count.div_ceil(four)).map(span).collect()
    };
    neighbours.into_iter().flat_map(cut).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_cover_the_columns() {
        let of =
            |columns: &[u32]| spans(columns.iter().copied()).iter().map(|s| (s.first, s.count)).collect::<Vec<_>>();
        assert_eq!(of(&[0, 1, 2, 3, 4, 5]), [(0, 4), (2, 4)]);
        assert_eq!(of(&[1, 3, 4, 6, 7, 8, 9]), [(1, 1), (3, 1), (4, 1), (6, 4)]);
        assert_eq!(of(&[]), []);
    }
}
