//! Gathers and scatters: each lane has a row of its own.

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{Block, InstBuilder, MemFlagsData, StackSlotData, StackSlotKind, Value, types};
use jerboa_ir::{NodeId, Op, Scalar};

use super::Emitter;
use crate::abi::{LANES, POINTER, data, part};
use crate::memory::{Distance, Place, Words};
use crate::{pack, vector};

impl Emitter<'_> {
    /// Loads a word for each lane, of the row at its index or of the last one; `unchecked` indices are in range.
    pub(super) fn gather(
        &mut self,
        words: Words,
        unchecked: bool,
        scalar: Scalar,
        indices: &[Value],
        lanes: usize,
        flags: MemFlagsData,
    ) -> Vec<Value> {
        let one = |(at, indices): (usize, &Value)| {
            let there = LANES.min(lanes - at * LANES);
            // A lane that is not there may have any index.
            if words.stride >= 16 && (there == LANES || !unchecked) {
                let gathered = self.buffers.window(&mut self.b, &words, *indices, unchecked, flags);
                let gathered = pack::cast(&mut self.b, part(scalar), gathered);
                return vector::of_words(&mut self.b, scalar, gathered);
            }
            let distances = self.buffers.distances(&mut self.b, &words, *indices, unchecked);
            let places: Vec<Place> = distances[..there].iter().map(|d| words.at(&mut self.b, *d)).collect();
            let gathered = pack::loaded(&mut self.b, part(scalar), flags, &places);
            vector::of_words(&mut self.b, scalar, gathered)
        };
        indices.iter().enumerate().map(one).collect()
    }

    /// Stores each lane under the mask at the row of its index, in ascending order, unless that is out of range.
    pub(super) fn scatter(&mut self, words: Words, indices: &[Value], value: NodeId, mask: NodeId) {
        let (scalar, lanes) = data(self.unit.program.ty(value));
        let (values, masks) = (self.values(value), self.values(mask));
        let values: Vec<Value> = values.iter().map(|x| vector::to_words(&mut self.b, scalar, *x)).collect();
        let active = self.active(words, indices, &masks, lanes);
        let all = self.b.ins().icmp_imm_u(IntCC::Equal, active, (1i64 << lanes) - 1);
        let [looping] = self.cold_blocks();
        let (straight, done) = (self.b.create_block(), self.b.create_block());
        self.b.ins().brif(all, straight, &[], looping, &[]);
        self.b.switch_to_block(straight);
        for (at, (index, value)) in indices.iter().zip(&values).enumerate() {
            let distances = Distance::of_lanes(&mut self.b, *index, words.stride);
            for (lane, distance) in distances.into_iter().enumerate().take(lanes - at * LANES) {
                let to = words.at(&mut self.b, distance);
                let word = self.b.ins().extractlane(*value, lane as u8);
                self.b.ins().store(MemFlagsData::trusted(), word, to.address, to.offset);
            }
        }
        self.b.ins().jump(done, &[]);
        self.b.switch_to_block(looping);
        self.store_active(words, indices, &values, active);
        self.b.ins().jump(done, &[]);
        self.b.switch_to_block(done);
    }

    /// The lanes under the mask whose row exists, as bits.
    pub(super) fn active(&mut self, words: Words, indices: &[Value], masks: &[Value], lanes: usize) -> Value {
        let rows = self.b.ins().splat(types::I32X4, words.rows);
        let inside = |(index, mask): (&Value, &Value)| {
            let fits = self.b.ins().icmp(IntCC::UnsignedLessThan, *index, rows);
            self.b.ins().band(fits, *mask)
        };
        let active: Vec<Value> = indices.iter().zip(masks).map(inside).collect();
        vector::over_lanes(&mut self.b, self.unit.simd, Op::Ballot, &active, lanes)
    }

    /// Stores the words of these lanes one by one: a loop over the bits.
    fn store_active(&mut self, words: Words, indices: &[Value], values: &[Value], active: Value) {
        let [index_slot, value_slot] = [0, 1].map(|i| self.scratch(i));
        for (at, (index, value)) in indices.iter().zip(values).enumerate() {
            self.b.ins().store(MemFlagsData::trusted(), *index, index_slot, at as i32 * 16);
            self.b.ins().store(MemFlagsData::trusted(), *value, value_slot, at as i32 * 16);
        }
        let [body, done] = self.cold_blocks();
        let rest = self.b.append_block_param(body, types::I32);
        self.b.ins().brif(active, body, &[active.into()], done, &[]);
        self.b.switch_to_block(body);
        let b = &mut self.b;
        let lane = b.ins().ctz(rest);
        let lane = b.ins().uextend(POINTER, lane);
        let bytes = b.ins().ishl_imm_u(lane, 2);
        let from = b.ins().iadd(index_slot, bytes);
        let row = b.ins().load(types::I32, MemFlagsData::trusted(), from, 0);
        let from = b.ins().iadd(value_slot, bytes);
        let word = b.ins().load(types::I32, MemFlagsData::trusted(), from, 0);
        let to = words.row(b, row);
        b.ins().store(MemFlagsData::trusted(), word, to.address, to.offset);
        let less = b.ins().iadd_imm_s(rest, -1);
        let rest = b.ins().band(rest, less);
        b.ins().brif(rest, body, &[rest.into()], done, &[]);
        b.switch_to_block(done);
    }

    /// Blocks out of line.
    pub(super) fn cold_blocks<const N: usize>(&mut self) -> [Block; N] {
        let block = |_| {
            let block = self.b.create_block();
            self.b.set_cold_block(block);
            block
        };
        std::array::from_fn(block)
    }

    /// The address of room for the words of a vector.
    fn scratch(&mut self, which: usize) -> Value {
        let b = &mut self.b;
        let slot = *self.scratch[which]
            .get_or_insert_with(|| b.create_sized_stack_slot(StackSlotData::new(StackSlotKind::ExplicitSlot, 64, 4)));
        b.ins().stack_addr(POINTER, slot, 0)
    }
}
