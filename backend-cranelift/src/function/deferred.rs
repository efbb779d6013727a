//! Runs that are loaded where they are first used, not where the program loads them: a program loads all it needs and then
//! computes, and there are not registers enough for all of it.

use jerboa_ir::cfg::Exit;
use jerboa_ir::{BufId, Mem, NodeId, Scalar};

use super::Emitter;
use super::run::Place;
use crate::abi::data;

/// A load that has not been made yet.
pub(super) struct Deferred {
    buf: BufId,
    column: u32,
    place: Place,
    scalar: Scalar,
    lanes: usize,
}

impl Emitter<'_> {
    /// Defers a load at the end of a block, if it is a run of a buffer and its value is a parameter of a block that is
    /// appended to this one. Says whether.
    pub(super) fn defer(&mut self, block: u32, mem: &Mem, index: NodeId, next: NodeId) -> Result<bool, String> {
        let p = self.unit.program;
        let (scalar, lanes) = p.loaded(next).map_or((Scalar::Bool, 0), data);
        let (Mem::Stream(column) | Mem::Unchecked(column)) = mem else { return Ok(false) };
        let target = self.f.number[&self.target(next)];
        let is_run = lanes > 1 && data(p.ty(index)).1 == 1 && self.is_whole(mem, lanes);
        if !is_run || !self.is_appended(target) {
            return Ok(false);
        }
        let place = self.place_of_load(block, mem, index, lanes)?;
        self.deferred.insert(target, Deferred { buf: column.buf, column: column.col, place, scalar, lanes });
        Ok(true)
    }

    /// Makes the load whose value is the parameter of this block, if that is still to do.
    pub(super) fn load_deferred(&mut self, block: u32) {
        if let Some(Deferred { column, place, scalar, lanes, .. }) = self.deferred.remove(&block) {
            self.params[block as usize] = vec![self.load_parts(place, column, scalar, lanes)];
        }
    }

    /// Makes the loads that a block's end would invalidate: those of a buffer that it stores to; if the block that follows
    /// is not appended, all of them.
    pub(super) fn settle(&mut self, exit: Exit, body: &jerboa_ir::Body) {
        use jerboa_ir::Body::*;
        let on = match (exit, body) {
            _ if self.deferred.is_empty() => return,
            // What is not returned is not used.
            (Exit::Return(_), _) => return,
            (Exit::Jump { block, .. }, _) => Some(block),
            (Exit::Arms, Load { next, .. } | Store { next, .. } | Local { next, .. }) => Some(self.target(*next)),
            _ => None,
        };
        let straight = on.is_some_and(|cont| self.is_appended(self.f.number[&cont]));
        let stored = match body {
            Store { mem: Mem::Stream(column), .. } => Some(column.buf),
            _ => None,
        };
        let all: Vec<u32> =
            self.deferred.iter().filter(|(_, d)| !straight || Some(d.buf) == stored).map(|d| *d.0).collect();
        all.into_iter().for_each(|block| self.load_deferred(block));
    }
}
