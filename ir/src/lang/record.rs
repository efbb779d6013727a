//! Records in streams: a staged value takes consecutive columns, one for each of its scalars.

use crate::lang::block::Block;
use crate::lang::buffer::{Buf, Col};
use crate::lang::here;
use crate::lang::staged::Staged;
use crate::lang::value::{Bool, F32, I32, U32};
use crate::program::Loc;
use crate::ty::{Scalar, Ty, TyKind};

impl Block {
    /// Load a record whose scalars lie in this column of a stream and those after it, in order.
    ///
    /// # Panics
    /// When the columns do not have the types of the record.
    #[track_caller]
    pub fn load_record<B: Buf, C, T: Staged>(&mut self, first: Col<B, C>, index: impl Into<U32>) -> T {
        let (index, loc) = (index.into(), here());
        let mut nodes = Vec::new();
        for (col, scalar) in columns::<B, C, T>(first, loc) {
            nodes.push(match scalar {
                Scalar::Bool => self.load::<B, Bool>(Col::new(col), index).node(),
                Scalar::I32 => self.load::<B, I32>(Col::new(col), index).node(),
                Scalar::U32 => self.load::<B, U32>(Col::new(col), index).node(),
                Scalar::F32 => self.load::<B, F32>(Col::new(col), index).node(),
            });
        }
        T::unflatten(&mut nodes.into_iter())
    }

    /// Store a record to this column of a stream and those after it.
    ///
    /// # Panics
    /// When the columns do not have the types of the record.
    #[track_caller]
    pub fn store_record<B: Buf, C, T: Staged>(&mut self, first: Col<B, C>, index: impl Into<U32>, record: T) {
        let (index, loc) = (index.into(), here());
        for ((col, scalar), node) in columns::<B, C, T>(first, loc).into_iter().zip(record.nodes()) {
            match scalar {
                Scalar::Bool => self.store(Col::<B, Bool>::new(col), index, Bool::from_node(node)),
                Scalar::I32 => self.store(Col::<B, I32>::new(col), index, I32::from_node(node)),
                Scalar::U32 => self.store(Col::<B, U32>::new(col), index, U32::from_node(node)),
                Scalar::F32 => self.store(Col::<B, F32>::new(col), index, F32::from_node(node)),
            }
        }
    }
}

/// Number and type of each column of a record.
fn columns<B: Buf, C, T: Staged>(first: Col<B, C>, loc: Loc) -> Vec<(u32, Scalar)> {
    let column = |(i, ty): (usize, &Ty)| {
        let col = first.0 + i as u32;
        let found = B::COLUMNS.get(col as usize).map(|c| c.ty);
        match ty.kind() {
            TyKind::Scalar(s) if found == Some(crate::lang::SpecTy::Scalar(*s)) => (col, *s),
            _ => panic!("{loc}: column {col} of {} is no {ty}, as the record has it", B::NAME),
        }
    };
    T::types().iter().enumerate().map(column).collect()
}
