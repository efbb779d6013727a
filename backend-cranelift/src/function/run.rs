//! Runs: lane l has the row index + l. Where all of a run is in range it is one access for every four lanes.
//!
//! Consecutive runs of one buffer at the same index are one *group* with one test. If it fails, the group goes through
//! memory in the frame: loads from a copy that was made lane by lane before, stores to a copy that is taken from lane by
//! lane after. So a group leaves the straight line of the code once, and all it needs on the way is the address of the
//! first run and the distance from a column to the next.

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{Block, InstBuilder, MemFlagsData, StackSlotData, StackSlotKind, Value, types};
use jerboa_ir::{Body, Layout, Lit, Mem, NodeId, Op, Scalar};

use super::Emitter;
use crate::abi::{LANES, POINTER, data, part};
use crate::memory::{self, Words};
use crate::{pack, vector};

/// The columns of a group are at most so far apart: their copies take 2 KiB of the frame.
const GROUP: u32 = 32;

/// Bytes from the copy of a run to that of the next column.
const COPY: i64 = 64;

/// Where the runs of a group are.
#[derive(Clone, Copy)]
pub(super) struct Place {
    /// Of the first column's.
    address: Value,
    /// Bytes from there to the run.
    offset: i32,
    /// Bytes from a column to the next.
    step: Value,
    first: u32,
}

impl From<memory::Place> for Place {
    /// The one column of this place is its first.
    fn from(place: memory::Place) -> Place {
        Place { address: place.address, offset: place.offset, step: place.address, first: 0 }
    }
}

/// A group whose runs are not all made yet.
pub(super) struct Group {
    place: Place,
    /// How many are to come.
    left: usize,
    /// Of stores: what is to do after the last one.
    copy: Option<Copy>,
}

/// Lanes that are stored from the copies.
struct Copy {
    runs: Vec<Mem>,
    row: Value,
    /// As bits; none where the stores went to their place.
    active: Value,
}

/// A vector in memory need not be aligned to its size.
fn unaligned() -> MemFlagsData {
    MemFlagsData::new().with_notrap()
}

/// The number of a column, or of a local array, which is a group alone.
pub(super) fn number(mem: &Mem) -> u32 {
    match mem {
        Mem::Stream(column) | Mem::Unchecked(column) => column.col,
        Mem::Local(_) => 0,
    }
}

impl Emitter<'_> {
    /// Does a run of so many lanes fill whole parts, side by side?
    pub(super) fn is_whole(&self, mem: &Mem, lanes: usize) -> bool {
        let side_by_side = match mem {
            Mem::Stream(column) | Mem::Unchecked(column) => {
                let buffer = self.unit.program.buffer(column.buf);
                buffer.layout == Layout::Columns || buffer.columns.len() == 1
            }
            Mem::Local(_) => true,
        };
        side_by_side && lanes.is_multiple_of(LANES)
    }

    /// Loads a run, each lane of its row or of the last one.
    pub(super) fn load_run(
        &mut self,
        block: u32,
        mem: &Mem,
        index: NodeId,
        (scalar, lanes): (Scalar, usize),
    ) -> Result<Vec<Value>, String> {
        if !self.is_whole(mem, lanes) {
            let (words, row) = (self.words(mem)?, self.scalar(index));
            let rows = self.rows_from(row, lanes);
            let unchecked = matches!(mem, Mem::Unchecked(_));
            return Ok(self.gather(words, unchecked, scalar, &rows, lanes, MemFlagsData::trusted()));
        }
        let place = self.place_of_load(block, mem, index, lanes)?;
        Ok(self.load_parts(place, number(mem), scalar, lanes))
    }

    /// Where a load finds its run.
    pub(super) fn place_of_load(
        &mut self,
        block: u32,
        mem: &Mem,
        index: NodeId,
        lanes: usize,
    ) -> Result<Place, String> {
        if let Some(place) = self.place_inside(mem, index, lanes)? {
            return Ok(place);
        }
        if self.group.is_none() {
            let runs = self.group_of(block, mem);
            self.open_loads(&runs, index, lanes)?;
        }
        let group = self.group.as_mut().expect("it was opened");
        let place = group.place;
        group.left -= 1;
        if group.left == 0 {
            self.group = None;
        }
        Ok(place)
    }

    /// The parts of a run.
    pub(super) fn load_parts(&mut self, place: Place, column: u32, scalar: Scalar, lanes: usize) -> Vec<Value> {
        let address = self.address(place, column);
        let one = |at: usize| {
            let words = self.b.ins().load(part(scalar), unaligned(), address, place.offset + at as i32 * 16);
            vector::of_words(&mut self.b, scalar, words)
        };
        (0..lanes / LANES).map(one).collect()
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
        if !self.is_whole(mem, lanes) {
            if lanes.is_multiple_of(LANES) {
                return self.store_rows(block, mem, index, value, mask);
            }
            let (words, row) = (self.words(mem)?, self.scalar(index));
            let rows = self.rows_from(row, lanes);
            self.scatter(words, &rows, value, mask);
            return Ok(());
        }
        let (values, masks) = (self.values(value), self.values(mask));
        let always = self.is_always(mask);
        // Memory of its own takes what is there again in lanes that are not under the mask; elsewhere another thread might
        // write to them.
        let blend = !always && matches!(mem, Mem::Local(_));
        let whole = always || blend;
        let inside = if whole { self.place_inside(mem, index, lanes)? } else { None };
        let place = if let Some(place) = inside {
            place
        } else {
            if self.group.is_none() {
                let runs = self.group_of(block, mem);
                self.open_stores(runs, index, &masks, lanes, whole)?;
            }
            let group = self.group.as_mut().expect("it was opened");
            group.left -= 1;
            group.place
        };
        let address = self.address(place, number(mem));
        for (at, (value, mask)) in values.iter().zip(&masks).enumerate() {
            let mut words = vector::to_words(&mut self.b, scalar, *value);
            let at = place.offset + at as i32 * 16;
            if blend {
                let old = self.b.ins().load(part(scalar), unaligned(), address, at);
                words = self.unit.simd.select(&mut self.b, *mask, words, old);
            }
            self.b.ins().store(unaligned(), words, address, at);
        }
        if self.group.as_ref().is_some_and(|group| group.left == 0) {
            self.close_group()?;
        }
        Ok(())
    }

    /// The place of a run of which it is known that it is in range.
    fn place_inside(&mut self, mem: &Mem, index: NodeId, lanes: usize) -> Result<Option<Place>, String> {
        match mem {
            Mem::Local(x) => Ok(self.elements(*x, index, lanes)?.map(Place::from)),
            Mem::Unchecked(_) => {
                let (words, row) = (self.words(mem)?, self.scalar(index));
                let address = words.row(&mut self.b, row).address;
                Ok(Some(Place { first: number(mem), ..memory::Place { address, offset: 0 }.into() }))
            }
            Mem::Stream(_) => Ok(None),
        }
    }

    /// The address of a column's run.
    fn address(&mut self, place: Place, column: u32) -> Value {
        let n = i64::from(column - place.first);
        let b = &mut self.b;
        let distance = match n {
            0 => return place.address,
            1 | 2 | 4 | 8 => b.ins().ishl_imm_u(place.step, i64::from(n.trailing_zeros())),
            _ => b.ins().imul_imm_u(place.step, n),
        };
        b.ins().iadd(place.address, distance)
    }

    /// Is this mask all true, as far as is known?
    fn is_always(&self, mask: NodeId) -> bool {
        match self.splatted(mask) {
            Some(x) => self.unit.program.as_lit(x) == Some(Lit::Bool(true)),
            None => false,
        }
    }

    /// The run that leaves this block and those that follow it, alike but for column and value.
    pub(super) fn group_of(&self, block: u32, first: &Mem) -> Vec<Mem> {
        let p = self.unit.program;
        let Mem::Stream(column) = first else { return vec![*first] };
        let body = |block: u32| &p.cont(self.f.blocks[block as usize].cont).body;
        let alike = |other: &Body| match (body(block), other) {
            (Body::Load { index: i, next: n, .. }, Body::Load { index, next, .. }) => {
                i == index && p.loaded(*n).map(|ty| data(ty).1) == p.loaded(*next).map(|ty| data(ty).1)
            }
            (Body::Store { index: i, mask: m, .. }, Body::Store { index, mask, .. }) => i == index && m == mask,
            _ => false,
        };
        let mut group = Vec::new();
        let (mut low, mut high, mut at) = (column.col, column.col, block);
        while let Body::Load { mem: mem @ Mem::Stream(c), next, .. }
        | Body::Store { mem: mem @ Mem::Stream(c), next, .. } = body(at)
        {
            (low, high) = (low.min(c.col), high.max(c.col));
            if c.buf != column.buf || !alike(body(at)) || high - low >= GROUP {
                break;
            }
            group.push(*mem);
            at = self.f.number[&self.target(*next)];
            if !self.is_appended(at) {
                break;
            }
        }
        group
    }

    /// Makes the test of a group of loads.
    fn open_loads(&mut self, runs: &[Mem], index: NodeId, lanes: usize) -> Result<(), String> {
        let (words, row) = (self.words(&runs[0])?, self.scalar(index));
        let done = self.b.create_block();
        let [across, each, copied] = self.cold_blocks();
        let place = self.place(runs, row)?;
        let fits = self.fits(words, row, lanes);
        let on = [place.address, place.step].map(Into::into);
        self.b.ins().brif(fits, done, &on, across, &[]);

        self.b.switch_to_block(across);
        let (copies, step) = self.copies(runs);
        let columns = runs.iter().map(|run| self.words(run)).collect::<Result<Vec<_>, _>>()?;
        let zero = self.b.ins().iconst(types::I32, 0);
        self.b.ins().jump(each, &[zero.into()]);
        let lane = self.b.append_block_param(each, types::I32);
        self.b.switch_to_block(each);
        let b = &mut self.b;
        let own = b.ins().iadd(row, lane);
        let offset = b.ins().uextend(POINTER, lane);
        let offset = b.ins().ishl_imm_u(offset, 2);
        let to = b.ins().iadd(copies, offset);
        for (run, words) in runs.iter().zip(&columns) {
            let from = words.clamped(b, own);
            let word = b.ins().load(types::I32, MemFlagsData::trusted(), from.address, from.offset);
            let at = (number(run) - place.first) as i32 * COPY as i32;
            b.ins().store(MemFlagsData::trusted(), word, to, at);
        }
        let next = b.ins().iadd_imm_u(lane, 1);
        let more = b.ins().icmp_imm_u(IntCC::UnsignedLessThan, next, lanes as i64);
        b.ins().brif(more, each, &[next.into()], copied, &[]);
        b.switch_to_block(copied);
        b.ins().jump(done, &[copies.into(), step.into()]);
        let place = self.enter(done, place.first);
        self.group = Some(Group { place, left: runs.len(), copy: None });
        Ok(())
    }

    /// Makes the test of a group of stores. `whole`: it does not matter which lanes are under the mask.
    fn open_stores(
        &mut self,
        runs: Vec<Mem>,
        index: NodeId,
        masks: &[Value],
        lanes: usize,
        whole: bool,
    ) -> Result<(), String> {
        let (words, row) = (self.words(&runs[0])?, self.scalar(index));
        let done = self.b.create_block();
        let [across] = self.cold_blocks();
        let none = self.b.ins().iconst(types::I32, 0);
        let place = self.place(&runs, row)?;
        if !whole {
            let all = vector::over_lanes(&mut self.b, self.unit.simd, Op::All, masks, lanes);
            let inside = self.b.create_block();
            self.b.ins().brif(all, inside, &[], across, &[]);
            self.b.switch_to_block(inside);
        }
        let fits = self.fits(words, row, lanes);
        let on = [place.address, place.step, none].map(Into::into);
        self.b.ins().brif(fits, done, &on, across, &[]);

        self.b.switch_to_block(across);
        let rows = self.rows_from(row, lanes);
        let some = self.active(words, &rows, masks, lanes);
        let (copies, step) = self.copies(&runs);
        self.b.ins().jump(done, &[copies.into(), step.into(), some.into()]);
        let place = self.enter(done, place.first);
        let active = self.b.append_block_param(done, types::I32);
        self.group = Some(Group { place, left: runs.len(), copy: Some(Copy { runs, row, active }) });
        Ok(())
    }

    /// After the last store of a group: what went to the copies goes to its place, lane by lane under the mask.
    fn close_group(&mut self) -> Result<(), String> {
        let Some(Group { place, copy: Some(Copy { runs, row, active }), .. }) = self.group.take() else {
            return Ok(());
        };
        let done = self.b.create_block();
        let [across, each] = self.cold_blocks();
        self.b.ins().brif(active, across, &[], done, &[]);
        self.b.switch_to_block(across);
        let columns = runs.iter().map(|run| self.words(run)).collect::<Result<Vec<_>, _>>()?;
        let b = &mut self.b;
        b.ins().jump(each, &[active.into()]);
        let rest = b.append_block_param(each, types::I32);
        b.switch_to_block(each);
        let lane = b.ins().ctz(rest);
        let own = b.ins().iadd(row, lane);
        let offset = b.ins().uextend(POINTER, lane);
        let offset = b.ins().ishl_imm_u(offset, 2);
        let from = b.ins().iadd(place.address, offset);
        for (run, words) in runs.iter().zip(&columns) {
            let at = (number(run) - place.first) as i32 * COPY as i32;
            let word = b.ins().load(types::I32, MemFlagsData::trusted(), from, at);
            let to = words.row(b, own);
            b.ins().store(MemFlagsData::trusted(), word, to.address, to.offset);
        }
        let less = b.ins().iadd_imm_s(rest, -1);
        let rest = b.ins().band(rest, less);
        b.ins().brif(rest, each, &[rest.into()], done, &[]);
        b.switch_to_block(done);
        Ok(())
    }

    /// Where the runs of a group are if they are in range.
    fn place(&mut self, runs: &[Mem], row: Value) -> Result<Place, String> {
        let first = runs.iter().min_by_key(|run| number(run)).expect("a group has runs");
        let address = self.words(first)?.row(&mut self.b, row).address;
        let step = match first {
            Mem::Stream(column) | Mem::Unchecked(column) => {
                self.buffers.step(&mut self.b, self.unit.program, column.buf)
            }
            Mem::Local(_) => address,
        };
        Ok(Place { address, offset: 0, step, first: number(first) })
    }

    /// Is the whole run in range?
    fn fits(&mut self, words: Words, row: Value, lanes: usize) -> Value {
        let b = &mut self.b;
        let (row, rows) = (b.ins().uextend(types::I64, row), b.ins().uextend(types::I64, words.rows));
        let end = b.ins().iadd_imm_u(row, lanes as i64);
        b.ins().icmp(IntCC::UnsignedLessThanOrEqual, end, rows)
    }

    /// Begins the block after the test of a group.
    fn enter(&mut self, block: Block, first: u32) -> Place {
        let [address, step] = [(); 2].map(|()| self.b.append_block_param(block, POINTER));
        self.b.switch_to_block(block);
        Place { address, offset: 0, step, first }
    }

    /// Room for the copies of a group: its address, and bytes from a column to the next. Each group has its own, because
    /// loads may be made long after their group.
    fn copies(&mut self, runs: &[Mem]) -> (Value, Value) {
        let numbers = || runs.iter().map(number);
        let columns = numbers().max().unwrap_or(0) - numbers().min().unwrap_or(0) + 1;
        let data = StackSlotData::new(StackSlotKind::ExplicitSlot, columns * COPY as u32, 4);
        let slot = self.b.create_sized_stack_slot(data);
        (self.b.ins().stack_addr(POINTER, slot, 0), self.b.ins().iconst(POINTER, COPY))
    }

    /// The rows of a run.
    pub(super) fn rows_from(&mut self, row: Value, lanes: usize) -> Vec<Value> {
        let first = self.b.ins().splat(types::I32X4, row);
        let one = |start: usize| {
            let lanes = pack::constant(&mut self.b, types::I32X4, std::array::from_fn(|l| (start + l) as u32));
            self.b.ins().iadd(first, lanes)
        };
        (0..lanes).step_by(LANES).map(one).collect()
    }
}
