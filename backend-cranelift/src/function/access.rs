//! Loads and stores.

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{InstBuilder, MemFlagsData, Value, types};
use jerboa_ir::{Column, Lit, Mem, Node, NodeId, Scalar};

use super::Emitter;
use crate::abi::data;
use crate::memory::{self, Local, Place};
use crate::pack;

/// A row of a buffer or an element of a local array, as an index gives it.
#[derive(Clone, Copy)]
enum Row {
    /// Row 0.
    First,
    /// Any.
    At(Value),
}

impl Emitter<'_> {
    /// What a table holds in a column.
    pub(super) fn read(&mut self, column: Column, index: NodeId, lanes: usize) -> Vec<Value> {
        // A reference is stored as its index.
        let scalar = self.unit.program.column(column).ty.ty().as_scalar().unwrap_or(Scalar::U32);
        let rows = self.rows(index, lanes);
        let load = |row| {
            let place = self.clamped(column, row);
            memory::load(&mut self.b, scalar, &place, MemFlagsData::trusted().with_readonly())
        };
        let values: Vec<Value> = rows.into_iter().map(load).collect();
        self.of_lanes(scalar, values)
    }

    pub(super) fn load(&mut self, mem: &Mem, index: NodeId, next: NodeId) -> Result<Vec<Value>, String> {
        let loaded = self.unit.program.loaded(next).and_then(|ty| ty.lanes());
        let (scalar, lanes) = loaded.ok_or("a load gives no data")?;
        let rows = self.rows(index, lanes).into_iter();
        let values = rows.map(|row| self.load_lane(mem, scalar, row)).collect::<Result<_, _>>()?;
        Ok(self.of_lanes(scalar, values))
    }

    /// The machine values of data with these lanes.
    fn of_lanes(&mut self, scalar: Scalar, lanes: Vec<Value>) -> Vec<Value> {
        if lanes.len() == 1 { lanes } else { pack::pack(&mut self.b, scalar, &lanes) }
    }

    fn load_lane(&mut self, mem: &Mem, scalar: Scalar, row: Row) -> Result<Value, String> {
        let mut flags = MemFlagsData::trusted();
        let place = match mem {
            Mem::Stream(column) => self.clamped(*column, row),
            Mem::Unchecked(column) => {
                flags = flags.with_readonly();
                let row = self.row(row);
                self.buffers.unchecked(&mut self.b, *column, row)
            }
            Mem::Local(x) => {
                let (local, row) = (self.local(*x)?, self.row(row));
                local.clamped(&mut self.b, row)
            }
        };
        Ok(memory::load(&mut self.b, scalar, &place, flags))
    }

    /// The row of each lane of an access: of a vector of indices its own, of a run the next one.
    fn rows(&mut self, index: NodeId, lanes: usize) -> Vec<Row> {
        let (_, own) = data(self.unit.program.ty(index));
        if own > 1 {
            let parts = self.values(index);
            return (0..lanes).map(|lane| Row::At(pack::lane(&mut self.b, Scalar::U32, &parts, lane))).collect();
        }
        let first = self.scalar(index);
        let is_zero = self.unit.program.as_lit(index) == Some(Lit::U32(0));
        let row = |lane| match lane {
            0 if is_zero => Row::First,
            0 => Row::At(first),
            _ => Row::At(self.b.ins().iadd_imm_u(first, lane as i64)),
        };
        (0..lanes).map(row).collect()
    }

    /// The number of a row.
    fn row(&mut self, row: Row) -> Value {
        match row {
            Row::First => self.b.ins().iconst(types::I32, 0),
            Row::At(row) => row,
        }
    }

    /// The word of a row, or of the last one.
    fn clamped(&mut self, column: Column, row: Row) -> Place {
        match row {
            Row::First => self.buffers.first(column),
            Row::At(row) => self.buffers.clamped(&mut self.b, column, row),
        }
    }

    /// Stores, unless the index is out of range; of a vector the lanes under the mask.
    pub(super) fn store(&mut self, mem: &Mem, index: NodeId, value: NodeId, mask: NodeId) -> Result<(), String> {
        let (scalar, lanes) = self.unit.program.ty(value).lanes().ok_or("it stores what is no data")?;
        let values = self.values(value);
        let masks = if mask == NodeId::NONE { Vec::new() } else { self.values(mask) };
        for (lane, row) in self.rows(index, lanes).into_iter().enumerate() {
            let row = self.row(row);
            let value = if lanes == 1 { values[0] } else { pack::lane(&mut self.b, scalar, &values, lane) };
            let rows = match mem {
                Mem::Stream(column) | Mem::Unchecked(column) => self.buffers.rows(column.buf),
                Mem::Local(x) => self.local(*x)?.len(&mut self.b),
            };
            let (inside, after) = (self.b.create_block(), self.b.create_block());
            let mut fits = self.b.ins().icmp(IntCC::UnsignedLessThan, row, rows);
            if !masks.is_empty() {
                let active = pack::lane(&mut self.b, Scalar::Bool, &masks, lane);
                fits = self.b.ins().band(fits, active);
            }
            self.b.ins().brif(fits, inside, &[], after, &[]);
            self.b.switch_to_block(inside);
            let place = match mem {
                Mem::Stream(column) | Mem::Unchecked(column) => self.buffers.unchecked(&mut self.b, *column, row),
                Mem::Local(x) => self.local(*x)?.unchecked(&mut self.b, row),
            };
            memory::store(&mut self.b, scalar, &place, value);
            self.b.ins().jump(after, &[]);
            self.b.switch_to_block(after);
        }
        Ok(())
    }

    /// The array that a parameter stands for.
    fn local(&self, x: NodeId) -> Result<Local, String> {
        let made = match self.unit.program.node(x) {
            Node::Param { cont, .. } => self.locals.get(&self.f.number[cont]),
            _ => None,
        };
        made.copied().ok_or_else(|| "its local array is no parameter of the block that follows its making".to_owned())
    }
}
