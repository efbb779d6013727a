//! Runs, and elements of local arrays, that are loaded where they are first used, not where the program loads them: a program
//! loads all it needs and then computes, and there are not registers enough for all of it. And what uses a load at once can
//! often take it straight from memory.

use cranelift_codegen::ir::MemFlagsData;
use jerboa_ir::cfg::Exit;
use jerboa_ir::{Mem, NodeId, Scalar};

use super::Emitter;
use super::run;
use crate::abi::data;
use crate::memory;

/// A load that has not been made yet.
pub(super) struct Deferred {
    mem: Mem,
    scalar: Scalar,
    from: From,
}

/// Where it is from.
enum From {
    /// A run of so many lanes.
    Run(run::Place, usize),
    /// An element of a local array.
    Element(memory::Place),
}

impl Emitter<'_> {
    /// Defers a load at the end of a block, if it is a run of a buffer or a scalar that is surely in a local array, and its
    /// value is a parameter of a block that is appended to this one. Says whether.
    pub(super) fn defer(&mut self, block: u32, mem: &Mem, index: NodeId, next: NodeId) -> Result<bool, String> {
        let p = self.unit.program;
        let (scalar, lanes) = p.loaded(next).map_or((Scalar::Bool, 0), data);
        let target = self.f.number[&self.target(next)];
        if !self.is_appended(target) {
            return Ok(false);
        }
        let is_run = lanes > 1 && data(p.ty(index)).1 == 1 && self.is_whole(mem, lanes);
        let from = match mem {
            Mem::Stream(_) | Mem::Unchecked(_) if is_run => {
                From::Run(self.place_of_load(block, mem, index, lanes)?, lanes)
            }
            Mem::Local(x) if lanes == 1 => match self.elements(*x, index, lanes)? {
                Some(place) => From::Element(place),
                None => return Ok(false),
            },
            Mem::Local(x) if is_run => match self.elements(*x, index, lanes)? {
                Some(place) => From::Run(place.into(), lanes),
                None => return Ok(false),
            },
            _ => return Ok(false),
        };
        self.deferred.insert(target, Deferred { mem: *mem, scalar, from });
        Ok(true)
    }

    /// Makes the load whose value is the parameter of this block, if that is still to do.
    pub(super) fn load_deferred(&mut self, block: u32) {
        if let Some(Deferred { mem, scalar, from }) = self.deferred.remove(&block) {
            let values = match from {
                From::Run(place, lanes) => self.load_parts(place, run::number(&mem), scalar, lanes),
                From::Element(place) => vec![memory::load(&mut self.b, scalar, &place, MemFlagsData::trusted())],
            };
            self.params[block as usize] = vec![values];
        }
    }

    /// Makes the loads that a block's end would invalidate: those of memory that it stores to; if the block that follows
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
        let is_stored = |mem: &Mem| match (body, mem) {
            (Store { mem: Mem::Stream(to), .. }, Mem::Stream(from) | Mem::Unchecked(from)) => to.buf == from.buf,
            (Store { mem: Mem::Local(to), .. }, Mem::Local(from)) => to == from,
            _ => false,
        };
        let all: Vec<u32> =
            self.deferred.iter().filter(|(_, d)| !straight || is_stored(&d.mem)).map(|d| *d.0).collect();
        all.into_iter().for_each(|block| self.load_deferred(block));
    }
}
