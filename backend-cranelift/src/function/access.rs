//! Loads and stores: of a scalar here, of a vector at a vector of indices in `gather.rs`, of a run of rows in `run.rs`.

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{InstBuilder, MemFlagsData, Value};
use jerboa_ir::{Column, Lit, Mem, Node, NodeId, Op, Scalar};

use super::Emitter;
use super::range::most;
use crate::abi::data;
use crate::memory::{self, Local, Place, Words};

impl Emitter<'_> {
    /// What a table holds in a column.
    pub(super) fn read(&mut self, column: Column, index: NodeId, lanes: usize) -> Vec<Value> {
        // A reference is stored as its index.
        let scalar = self.unit.program.column(column).ty.ty().as_scalar().unwrap_or(Scalar::U32);
        let flags = MemFlagsData::trusted().with_readonly();
        if lanes == 1 {
            return vec![self.load_clamped(column, scalar, index, flags)];
        }
        if let Some(index) = self.splatted(index) {
            let x = self.load_clamped(column, scalar, index, flags);
            return self.splat(scalar, x, lanes);
        }
        let (words, rows) = (self.buffers.words(&mut self.b, self.unit.program, column), self.values(index));
        self.gather(words, false, scalar, &rows, lanes, flags)
    }

    /// Loads, at the end of this block.
    pub(super) fn load(&mut self, block: u32, mem: &Mem, index: NodeId, next: NodeId) -> Result<Vec<Value>, String> {
        let p = self.unit.program;
        let loaded = p.loaded(next).and_then(|ty| ty.lanes());
        let (scalar, lanes) = loaded.ok_or("a load gives no data")?;
        if lanes > 1 && data(p.ty(index)).1 == 1 {
            return self.load_run(block, mem, index, (scalar, lanes));
        }
        if let (1, Mem::Local(x)) = (lanes, mem)
            && let Some(place) = self.elements(*x, index, 1)?
        {
            return Ok(vec![memory::load(&mut self.b, scalar, &place, MemFlagsData::trusted())]);
        }
        let words = self.words(mem)?;
        let unchecked = matches!(mem, Mem::Unchecked(_));
        let flags = MemFlagsData::trusted();
        let flags = if unchecked { flags.with_readonly() } else { flags };
        if lanes > 1 {
            let rows = self.values(index);
            return Ok(self.gather(words, unchecked, scalar, &rows, lanes, flags));
        }
        if let Mem::Stream(column) = mem {
            return Ok(vec![self.load_clamped(*column, scalar, index, flags)]);
        }
        let index = self.scalar(index);
        let place = if unchecked { words.row(&mut self.b, index) } else { words.clamped(&mut self.b, index) };
        Ok(vec![memory::load(&mut self.b, scalar, &place, flags)])
    }

    /// Loads the word of a row, or of the last one.
    fn load_clamped(&mut self, column: Column, scalar: Scalar, index: NodeId, flags: MemFlagsData) -> Value {
        let place = if self.unit.program.as_lit(index) == Some(Lit::U32(0)) {
            self.buffers.words(&mut self.b, self.unit.program, column).first()
        } else {
            let index = self.scalar(index);
            self.buffers.clamped(&mut self.b, self.unit.program, column, index)
        };
        memory::load(&mut self.b, scalar, &place, flags)
    }

    /// Stores, at the end of this block, unless the index is out of range; of a vector the lanes under the mask.
    pub(super) fn store(
        &mut self,
        block: u32,
        mem: &Mem,
        index: NodeId,
        value: NodeId,
        mask: NodeId,
    ) -> Result<(), String> {
        let p = self.unit.program;
        let (scalar, lanes) = p.ty(value).lanes().ok_or("it stores what is no data")?;
        self.buffers.changed();
        if lanes > 1 && data(p.ty(index)).1 == 1 {
            return self.store_run(block, mem, index, value, mask);
        }
        if let (1, Mem::Local(x)) = (lanes, mem)
            && let Some(place) = self.elements(*x, index, 1)?
        {
            let value = self.scalar(value);
            memory::store(&mut self.b, scalar, &place, value);
            return Ok(());
        }
        let words = self.words(mem)?;
        if lanes > 1 {
            let rows = self.values(index);
            self.scatter(words, &rows, value, mask);
            return Ok(());
        }
        let (index, value) = (self.scalar(index), self.scalar(value));
        let (inside, after) = (self.b.create_block(), self.b.create_block());
        let fits = self.b.ins().icmp(IntCC::UnsignedLessThan, index, words.rows);
        self.b.ins().brif(fits, inside, &[], after, &[]);
        self.b.switch_to_block(inside);
        let place = words.row(&mut self.b, index);
        memory::store(&mut self.b, scalar, &place, value);
        self.b.ins().jump(after, &[]);
        self.b.switch_to_block(after);
        Ok(())
    }

    /// So many elements of a local array from an index on, if all of them are surely there. Indices that differ by a
    /// literal share an address in a block.
    pub(super) fn elements(&mut self, array: NodeId, index: NodeId, lanes: usize) -> Result<Option<Place>, String> {
        let (p, local) = (self.unit.program, self.local(array)?);
        if most(p, index).is_none_or(|most| u64::from(most) + lanes as u64 > u64::from(local.len())) {
            return Ok(None);
        }
        let (row, distance) = match (p.node(index), p.as_lit(index)) {
            (_, Some(lit)) => (None, lit.word()),
            (Node::Prim { op: Op::Add, args }, _) => match p.as_lit(args[1]) {
                Some(lit) => (Some(args[0]), lit.word()),
                None => (Some(index), 0),
            },
            _ => (Some(index), 0),
        };
        let address = match self.addresses.get(&(array, row)) {
            Some(address) => *address,
            None => {
                let words = local.words(&mut self.b);
                let address = match row {
                    None => words.base,
                    Some(row) => {
                        let row = self.scalar(row);
                        words.row(&mut self.b, row).address
                    }
                };
                self.addresses.insert((array, row), address);
                address
            }
        };
        Ok(Some(Place { address, offset: distance as i32 * 4 }))
    }

    pub(super) fn words(&mut self, mem: &Mem) -> Result<Words, String> {
        Ok(match mem {
            Mem::Stream(column) | Mem::Unchecked(column) => self.buffers.words(&mut self.b, self.unit.program, *column),
            Mem::Local(x) => self.local(*x)?.words(&mut self.b),
        })
    }

    /// The array that a parameter stands for.
    pub(super) fn local(&self, x: NodeId) -> Result<Local, String> {
        let made = match self.unit.program.node(x) {
            Node::Param { cont, .. } => self.locals.get(&self.f.number[cont]),
            _ => None,
        };
        made.copied().ok_or_else(|| "its local array is no parameter of the block that follows its making".to_owned())
    }
}
