//! Runs: lane l has the row index + l. The whole run is one access for every four lanes where all of it is in range; where
//! it is not, the lanes go one by one, out of line.

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{Block, InstBuilder, MemFlagsData, Value, types};
use jerboa_ir::{Lit, NodeId, Op, Scalar};

use super::Emitter;
use crate::abi::{LANES, POINTER, data, part};
use crate::memory::{Place, Words};
use crate::{pack, vector};

/// A vector in memory need not be aligned to its size.
fn unaligned() -> MemFlagsData {
    MemFlagsData::new().with_notrap()
}

impl Emitter<'_> {
    /// Loads a run, each lane of its row or of the last one.
    pub(super) fn load_run(
        &mut self,
        words: Words,
        unchecked: bool,
        scalar: Scalar,
        index: NodeId,
        lanes: usize,
    ) -> Vec<Value> {
        let row = self.scalar(index);
        let loaded = if unchecked || self.is_inside(words, index, lanes) {
            self.load_inside(words, scalar, row, lanes)
        } else {
            let (inside, across, done) = self.split(words, row, lanes);
            self.b.switch_to_block(inside);
            let values = self.load_inside(words, scalar, row, lanes);
            self.join(done, &values);
            self.b.switch_to_block(across);
            let values = self.load_across(words, scalar, row, lanes);
            self.join(done, &values);
            self.b.switch_to_block(done);
            let ty = part(scalar);
            (0..values.len()).map(|_| self.b.append_block_param(done, ty)).collect()
        };
        loaded.into_iter().map(|words| vector::of_words(&mut self.b, scalar, words)).collect()
    }

    /// Is it known that the whole run is in range?
    fn is_inside(&self, words: Words, index: NodeId, lanes: usize) -> bool {
        match (words.known_rows, self.unit.program.as_lit(index)) {
            (Some(rows), Some(Lit::U32(first))) => u64::from(first) + lanes as u64 <= u64::from(rows),
            _ => false,
        }
    }

    /// Goes on in the first block if the whole run is in range, else in the second; both meet in the third.
    fn split(&mut self, words: Words, row: Value, lanes: usize) -> (Block, Block, Block) {
        let [across] = self.cold_blocks();
        let b = &mut self.b;
        let (inside, done) = (b.create_block(), b.create_block());
        let (row, rows) = (b.ins().uextend(types::I64, row), b.ins().uextend(types::I64, words.rows));
        let end = b.ins().iadd_imm_u(row, lanes as i64);
        let fits = b.ins().icmp(IntCC::UnsignedLessThanOrEqual, end, rows);
        b.ins().brif(fits, inside, &[], across, &[]);
        (inside, across, done)
    }

    fn join(&mut self, done: Block, values: &[Value]) {
        let values: Vec<_> = values.iter().map(|v| (*v).into()).collect();
        self.b.ins().jump(done, &values);
    }

    /// The words of a run that is in range.
    fn load_inside(&mut self, words: Words, scalar: Scalar, row: Value, lanes: usize) -> Vec<Value> {
        let first = words.row(&mut self.b, row);
        let word = |lane: usize| Place { offset: first.offset + (lane as u32 * words.stride) as i32, ..first };
        let ty = part(scalar);
        let one = |start: usize| {
            let there = LANES.min(lanes - start);
            if words.stride == 4 && there == LANES {
                return self.b.ins().load(ty, unaligned(), first.address, word(start).offset);
            }
            let places: Vec<Place> = (start..start + there).map(word).collect();
            pack::loaded(&mut self.b, ty, MemFlagsData::trusted(), &places)
        };
        (0..lanes).step_by(LANES).map(one).collect()
    }

    /// The words of a run that may leave the range: a loop.
    fn load_across(&mut self, words: Words, scalar: Scalar, row: Value, lanes: usize) -> Vec<Value> {
        let slot = self.scratch(0);
        let [body, done] = self.cold_blocks();
        let b = &mut self.b;
        let lane = b.append_block_param(body, types::I32);
        let zero = b.ins().iconst(types::I32, 0);
        b.ins().jump(body, &[zero.into()]);
        b.switch_to_block(body);
        let row = b.ins().iadd(row, lane);
        let from = words.clamped(b, row);
        let word = b.ins().load(types::I32, MemFlagsData::trusted(), from.address, from.offset);
        let to = b.ins().uextend(POINTER, lane);
        let to = b.ins().ishl_imm_u(to, 2);
        let to = b.ins().iadd(slot, to);
        b.ins().store(MemFlagsData::trusted(), word, to, 0);
        let next = b.ins().iadd_imm_u(lane, 1);
        let more = b.ins().icmp_imm_u(IntCC::UnsignedLessThan, next, lanes as i64);
        b.ins().brif(more, body, &[next.into()], done, &[]);
        b.switch_to_block(done);
        let flags = MemFlagsData::trusted();
        (0..lanes.div_ceil(LANES)).map(|at| b.ins().load(part(scalar), flags, slot, at as i32 * 16)).collect()
    }

    /// Stores a run: lanes under the mask whose row exists. Only in memory that is the function's `own` may a lane that is
    /// not under the mask be stored again as it was; elsewhere another thread might write there.
    pub(super) fn store_run(&mut self, words: Words, own: bool, index: NodeId, value: NodeId, mask: NodeId) {
        let (scalar, lanes) = data(self.unit.program.ty(value));
        let (values, masks) = (self.values(value), self.values(mask));
        let values: Vec<Value> = values.iter().map(|x| vector::to_words(&mut self.b, scalar, *x)).collect();
        let row = self.scalar(index);
        let always = self.is_always(mask);
        let blend = own && words.stride == 4;
        if self.is_inside(words, index, lanes) && (always || blend) {
            self.store_inside(words, row, &values, (!always).then_some(&masks), lanes);
            return;
        }
        let (inside, across, done) = self.split(words, row, lanes);
        self.b.switch_to_block(inside);
        if !always && !blend {
            let whole = self.b.create_block();
            let all = vector::over_lanes(&mut self.b, self.unit.simd, Op::All, &masks, lanes);
            self.b.ins().brif(all, whole, &[], across, &[]);
            self.b.switch_to_block(whole);
        }
        self.store_inside(words, row, &values, (!always && blend).then_some(&masks), lanes);
        self.b.ins().jump(done, &[]);
        self.b.switch_to_block(across);
        let rows = self.rows_from(row, lanes);
        let active = self.active(words, &rows, &masks, lanes);
        self.store_active(words, &rows, &values, active);
        self.b.ins().jump(done, &[]);
        self.b.switch_to_block(done);
    }

    /// Stores a run that is in range; lanes that are not under the masks keep what is there.
    fn store_inside(&mut self, words: Words, row: Value, values: &[Value], masks: Option<&Vec<Value>>, lanes: usize) {
        let first = words.row(&mut self.b, row);
        for (at, value) in values.iter().enumerate() {
            let there = LANES.min(lanes - at * LANES);
            let offset = first.offset + (at * LANES) as i32 * words.stride as i32;
            if words.stride == 4 && there == LANES {
                let value = match masks {
                    None => *value,
                    Some(masks) => {
                        let ty = self.b.func.dfg.value_type(*value);
                        let old = self.b.ins().load(ty, unaligned(), first.address, offset);
                        self.unit.simd.select(&mut self.b, masks[at], *value, old)
                    }
                };
                self.b.ins().store(unaligned(), value, first.address, offset);
                continue;
            }
            for lane in 0..there {
                let offset = offset + lane as i32 * words.stride as i32;
                let flags = MemFlagsData::trusted();
                let mut word = self.b.ins().extractlane(*value, lane as u8);
                if let Some(masks) = masks {
                    let ty = self.b.func.dfg.value_type(word);
                    let old = self.b.ins().load(ty, flags, first.address, offset);
                    let active = pack::lane(&mut self.b, Scalar::Bool, masks, at * LANES + lane);
                    word = self.b.ins().select(active, word, old);
                }
                self.b.ins().store(flags, word, first.address, offset);
            }
        }
    }

    /// The rows of a run.
    fn rows_from(&mut self, row: Value, lanes: usize) -> Vec<Value> {
        let first = self.b.ins().splat(types::I32X4, row);
        let part = |start: usize| {
            let lanes = pack::constant(&mut self.b, types::I32X4, std::array::from_fn(|l| (start + l) as u32));
            self.b.ins().iadd(first, lanes)
        };
        (0..lanes).step_by(LANES).map(part).collect()
    }

    /// Is this mask all true, as far as is known?
    fn is_always(&self, mask: NodeId) -> bool {
        match self.splatted(mask) {
            Some(x) => self.unit.program.as_lit(x) == Some(Lit::Bool(true)),
            None => false,
        }
    }
}
