//! Runs: lane l has the row index + l. Where all of a run is in range it is one access for every four lanes.
//!
//! Consecutive runs of one buffer at the same index are one *group* with one test. If it fails, the group goes through
//! memory in the frame: loads from a copy that was made lane by lane before, stores to a copy that is taken from lane by
//! lane after. So a group leaves the straight line of the code once, and each access stays where the program has it.

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{Block, InstBuilder, MemFlagsData, StackSlotData, StackSlotKind, Value, types};
use jerboa_ir::{Body, Lit, Mem, NodeId, Op, Scalar};

use super::Emitter;
use crate::abi::{LANES, POINTER, data, part};
use crate::memory::Words;
use crate::{pack, vector};

/// At most so many runs are one group: their copies take 2 KiB of the frame.
const GROUP: usize = 32;

/// Bytes of a run's copy.
const COPY: i32 = 64;

/// The rest of a group: where the runs are that are still to come.
pub(super) struct Group {
    /// The last one first.
    addresses: Vec<Value>,
    /// Of stores: what is to do after the last one.
    copy: Option<Copy>,
}

/// Lanes that are stored from the copies.
struct Copy {
    words: Vec<Words>,
    row: Value,
    /// As bits; none where the stores went to their place.
    active: Value,
}

/// A vector in memory need not be aligned to its size.
fn unaligned() -> MemFlagsData {
    MemFlagsData::new().with_notrap()
}

impl Emitter<'_> {
    /// Loads a run, each lane of its row or of the last one.
    pub(super) fn load_run(
        &mut self,
        block: u32,
        mem: &Mem,
        index: NodeId,
        ty: (Scalar, usize),
    ) -> Result<Vec<Value>, String> {
        let (scalar, lanes) = ty;
        let words = self.words(mem)?;
        let row = self.scalar(index);
        let unchecked = matches!(mem, Mem::Unchecked(_));
        if !words.holds_runs(lanes) {
            let rows = self.rows_from(row, lanes);
            return Ok(self.gather(words, unchecked, scalar, &rows, lanes, MemFlagsData::trusted()));
        }
        let address = if unchecked || self.is_inside(words, index, lanes) {
            words.row(&mut self.b, row).address
        } else {
            if self.group.is_none() {
                let all = self.group_of(block, mem, words);
                self.open_loads(all, row, lanes);
            }
            self.next_of_group()
        };
        let parts = (0..lanes / LANES).map(|at| {
            let words = self.b.ins().load(part(scalar), unaligned(), address, at as i32 * 16);
            vector::of_words(&mut self.b, scalar, words)
        });
        Ok(parts.collect())
    }

    /// Stores a run: lanes under the mask whose row exists.
    pub(super) fn store_run(
        &mut self,
        block: u32,
        mem: &Mem,
        index: NodeId,
        value: NodeId,
        mask: NodeId,
    ) -> Result<(), String> {
        let (scalar, lanes) = data(self.unit.program.ty(value));
        let words = self.words(mem)?;
        let row = self.scalar(index);
        if !words.holds_runs(lanes) {
            let rows = self.rows_from(row, lanes);
            self.scatter(words, &rows, value, mask);
            return Ok(());
        }
        let (values, masks) = (self.values(value), self.values(mask));
        let always = self.is_always(mask);
        // Memory of its own takes what is there again in lanes that are not under the mask; elsewhere another thread might
        // write to them.
        let blend = !always && matches!(mem, Mem::Local(_));
        let address = if (always || blend) && self.is_inside(words, index, lanes) {
            words.row(&mut self.b, row).address
        } else {
            if self.group.is_none() {
                let all = self.group_of(block, mem, words);
                self.open_stores(all, row, &masks, lanes, always || blend);
            }
            self.next_of_group()
        };
        for (at, (value, mask)) in values.iter().zip(&masks).enumerate() {
            let mut words = vector::to_words(&mut self.b, scalar, *value);
            let at = at as i32 * 16;
            if blend {
                let old = self.b.ins().load(part(scalar), unaligned(), address, at);
                words = self.unit.simd.select(&mut self.b, *mask, words, old);
            }
            self.b.ins().store(unaligned(), words, address, at);
        }
        if self.group.as_ref().is_some_and(|group| group.addresses.is_empty()) {
            self.close_group();
        }
        Ok(())
    }

    /// Is it known that the whole run is in range?
    fn is_inside(&self, words: Words, index: NodeId, lanes: usize) -> bool {
        match (words.known_rows, self.unit.program.as_lit(index)) {
            (Some(rows), Some(Lit::U32(first))) => u64::from(first) + lanes as u64 <= u64::from(rows),
            _ => false,
        }
    }

    /// Is this mask all true, as far as is known?
    fn is_always(&self, mask: NodeId) -> bool {
        match self.splatted(mask) {
            Some(x) => self.unit.program.as_lit(x) == Some(Lit::Bool(true)),
            None => false,
        }
    }

    /// The run that leaves this block and those that follow it: of other columns or the same, else alike.
    fn group_of(&self, block: u32, mem: &Mem, first: Words) -> Vec<Words> {
        let p = self.unit.program;
        let Mem::Stream(column) = mem else { return vec![first] };
        // All that a run's column and value do not say.
        let kind = |body: &Body| match body {
            Body::Load { mem: Mem::Stream(c), index, next } => {
                let ty = p.loaded(*next).map_or((Scalar::Bool, 0), data);
                Some((*c, *index, ty.1, None, *next))
            }
            Body::Store { mem: Mem::Stream(c), index, value, mask, next } => {
                Some((*c, *index, data(p.ty(*value)).1, Some(*mask), *next))
            }
            _ => None,
        };
        let mut group = Vec::new();
        let mut at = block;
        let own = kind(&p.cont(self.f.blocks[block as usize].cont).body);
        while let Some((c, index, lanes, mask, next)) = kind(&p.cont(self.f.blocks[at as usize].cont).body) {
            let alike = own.is_some_and(|own| (own.1, own.2, own.3) == (index, lanes, mask));
            if c.buf != column.buf || !alike || group.len() == GROUP || (!group.is_empty() && !self.is_appended(at)) {
                break;
            }
            group.push(self.buffers.words(c));
            at = self.f.number[&self.target(next)];
        }
        group
    }

    /// Where the next run of the group is.
    fn next_of_group(&mut self) -> Value {
        let group = self.group.as_mut().expect("it was opened");
        let address = group.addresses.pop().expect("a group ends with its last run");
        if group.addresses.is_empty() && group.copy.is_none() {
            self.group = None;
        }
        address
    }

    /// Makes the test of a group of loads.
    fn open_loads(&mut self, words: Vec<Words>, row: Value, lanes: usize) {
        let done = self.b.create_block();
        let [across, each, copied] = self.cold_blocks();
        let places: Vec<Value> = words.iter().map(|words| words.row(&mut self.b, row).address).collect();
        let fits = self.fits(words[0], row, lanes);
        self.leave_to(fits, done, &places, across);

        self.b.switch_to_block(across);
        let copies = self.copies(words.len());
        let zero = self.b.ins().iconst(types::I32, 0);
        self.b.ins().jump(each, &[zero.into()]);
        let lane = self.b.append_block_param(each, types::I32);
        self.b.switch_to_block(each);
        let b = &mut self.b;
        let own = b.ins().iadd(row, lane);
        let offset = b.ins().uextend(POINTER, lane);
        let offset = b.ins().ishl_imm_u(offset, 2);
        let to = b.ins().iadd(copies, offset);
        for (i, words) in words.iter().enumerate() {
            let from = words.clamped(b, own);
            let word = b.ins().load(types::I32, MemFlagsData::trusted(), from.address, from.offset);
            b.ins().store(MemFlagsData::trusted(), word, to, i as i32 * COPY);
        }
        let next = b.ins().iadd_imm_u(lane, 1);
        let more = b.ins().icmp_imm_u(IntCC::UnsignedLessThan, next, lanes as i64);
        b.ins().brif(more, each, &[next.into()], copied, &[]);
        b.switch_to_block(copied);
        let places: Vec<Value> =
            (0..words.len()).map(|i| b.ins().iadd_imm_u(copies, i as i64 * i64::from(COPY))).collect();
        self.go_with(done, &places);
        let addresses = self.enter(done, words.len());
        self.group = Some(Group { addresses, copy: None });
    }

    /// Makes the test of a group of stores. `whole`: it does not matter which lanes are under the mask.
    fn open_stores(&mut self, words: Vec<Words>, row: Value, masks: &[Value], lanes: usize, whole: bool) {
        let done = self.b.create_block();
        let [across] = self.cold_blocks();
        let none = self.b.ins().iconst(types::I32, 0);
        let active = self.b.append_block_param(done, types::I32);
        let mut places = vec![none];
        places.extend(words.iter().map(|words| words.row(&mut self.b, row).address));
        if !whole {
            let all = vector::over_lanes(&mut self.b, self.unit.simd, Op::All, masks, lanes);
            let inside = self.b.create_block();
            self.leave_to(all, inside, &[], across);
            self.b.switch_to_block(inside);
        }
        let fits = self.fits(words[0], row, lanes);
        self.leave_to(fits, done, &places, across);

        self.b.switch_to_block(across);
        let rows = self.rows_from(row, lanes);
        let mut places = vec![self.active(words[0], &rows, masks, lanes)];
        let copies = self.copies(words.len());
        places.extend((0..words.len()).map(|i| self.b.ins().iadd_imm_u(copies, i as i64 * i64::from(COPY))));
        self.go_with(done, &places);
        let addresses = self.enter(done, words.len());
        self.group = Some(Group { addresses, copy: Some(Copy { words, row, active }) });
    }

    /// After the last store of a group: what went to the copies goes to its place, lane by lane under the mask.
    fn close_group(&mut self) {
        let Some(Group { copy: Some(Copy { words, row, active }), .. }) = self.group.take() else { return };
        let done = self.b.create_block();
        let [across, each] = self.cold_blocks();
        self.b.ins().brif(active, across, &[], done, &[]);
        self.b.switch_to_block(across);
        let copies = self.copies(words.len());
        self.b.ins().jump(each, &[active.into()]);
        let rest = self.b.append_block_param(each, types::I32);
        self.b.switch_to_block(each);
        let b = &mut self.b;
        let lane = b.ins().ctz(rest);
        let own = b.ins().iadd(row, lane);
        let offset = b.ins().uextend(POINTER, lane);
        let offset = b.ins().ishl_imm_u(offset, 2);
        let from = b.ins().iadd(copies, offset);
        for (i, words) in words.iter().enumerate() {
            let word = b.ins().load(types::I32, MemFlagsData::trusted(), from, i as i32 * COPY);
            let to = words.row(b, own);
            b.ins().store(MemFlagsData::trusted(), word, to.address, to.offset);
        }
        let less = b.ins().iadd_imm_s(rest, -1);
        let rest = b.ins().band(rest, less);
        b.ins().brif(rest, each, &[rest.into()], done, &[]);
        b.switch_to_block(done);
    }

    /// Is the whole run in range?
    fn fits(&mut self, words: Words, row: Value, lanes: usize) -> Value {
        let b = &mut self.b;
        let (row, rows) = (b.ins().uextend(types::I64, row), b.ins().uextend(types::I64, words.rows));
        let end = b.ins().iadd_imm_u(row, lanes as i64);
        b.ins().icmp(IntCC::UnsignedLessThanOrEqual, end, rows)
    }

    /// Goes on with these values if the test holds, else out of line.
    fn leave_to(&mut self, holds: Value, on: Block, values: &[Value], across: Block) {
        let values: Vec<_> = values.iter().map(|v| (*v).into()).collect();
        self.b.ins().brif(holds, on, &values, across, &[]);
    }

    fn go_with(&mut self, block: Block, values: &[Value]) {
        let values: Vec<_> = values.iter().map(|v| (*v).into()).collect();
        self.b.ins().jump(block, &values);
    }

    /// Begins the block of a group: its addresses, the last one first.
    fn enter(&mut self, block: Block, runs: usize) -> Vec<Value> {
        let mut addresses: Vec<Value> = (0..runs).map(|_| self.b.append_block_param(block, POINTER)).collect();
        self.b.switch_to_block(block);
        addresses.reverse();
        addresses
    }

    /// The address of room for so many copies.
    fn copies(&mut self, runs: usize) -> Value {
        let bytes = runs as u32 * COPY as u32;
        let b = &mut self.b;
        let slot = *self.copies.get_or_insert_with(|| {
            b.create_sized_stack_slot(StackSlotData::new(StackSlotKind::ExplicitSlot, bytes, 4))
        });
        let size = &mut b.func.sized_stack_slots[slot].size;
        *size = bytes.max(*size);
        b.ins().stack_addr(POINTER, slot, 0)
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
}
