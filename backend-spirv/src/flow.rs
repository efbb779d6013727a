//! Control flow as naga has it: `break` leaves the innermost loop or switch, `continue` goes on in the innermost loop.
//!
//! The tree of [`mod@jerboa_ir::structure`] has named labels and loops, and exits from many at once. Here a label becomes a
//! switch of one case (unlike a loop of one round it lets `continue` through), and an exit becomes a chain of hops: it
//! notes where it goes in a variable, leaves the innermost frame, and behind each frame that it must leave too, a test
//! sends it on. Most exits need no hop:
//!
//! - what stands behind a frame is often just where the exit goes, so that to leave the frame is enough. A loop at the end of
//!   a label is left for what is behind the label, and the label itself is not needed;
//! - a label that exits only pass through, or that nobody leaves, is no frame. Whether it is one is found by lowering the
//!   tree, and doing so again without the labels that no exit stopped at.
//!
//! The code of a block that begins a label stands in front of the label, where all that follows sees its values.

use jerboa_ir::cfg::Function;
use jerboa_ir::structure::Step;
use jerboa_ir::{Body, Program};
use rustc_hash::FxHashSet;

/// A piece of a function.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum Piece {
    /// What a block computes, loads, stores, calls and passes on.
    Code(u32),
    /// One of the arms, by successor: an `if`, or a switch where there are more than two.
    Choice { block: u32, arms: Vec<Vec<Piece>> },
    /// A piece that can be left: a switch of one case.
    Label(Vec<Piece>),
    /// A piece that begins again at its end.
    Loop(Vec<Piece>),
    /// Leaves the innermost frame.
    Leave(Leave),
    /// Notes that the exit of this number is under way, and leaves the innermost frame.
    Far(u32),
    /// Notes that no exit is under way.
    Reset,
    /// Leaves, if the exit of this number is under way.
    Arrive(u32, Leave),
}

/// How the innermost frame is left.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Leave {
    /// Goes on behind the innermost loop or switch.
    Break,
    /// Begins the innermost loop again.
    Continue,
}

/// Where an exit goes.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
enum Exit {
    Join(u32),
    Header(u32),
}

impl Exit {
    /// Its number in the variable; 0 is none.
    fn number(self) -> u32 {
        match self {
            Exit::Join(block) => 2 * block + 1,
            Exit::Header(block) => 2 * block + 2,
        }
    }
}

/// Is the choice at the end of this block a switch? To leave the innermost frame is then to leave the switch.
pub(crate) fn is_switch(p: &Program, f: &Function, block: u32) -> bool {
    let block = &f.blocks[block as usize];
    block.succs.len() > 2 && matches!(p.cont(block.cont).body, Body::Switch { .. })
}

/// The pieces of a function.
pub(crate) fn pieces(p: &Program, f: &Function, steps: &[Step]) -> Vec<Piece> {
    let mut flat = FxHashSet::default();
    loop {
        let mut lower = Lower { p, f, flat: &flat, frames: Vec::new(), idle: Vec::new() };
        let pieces = lower.sequence(steps, None, None);
        if lower.idle.is_empty() {
            return pieces;
        }
        let idle = lower.idle;
        flat.extend(idle);
    }
}

/// What `break` leaves, and all around it.
struct Frame {
    /// The header, if it is a loop.
    header: Option<u32>,
    /// Where to leave it goes.
    behind: Option<Exit>,
    /// Exits that leave it on their way.
    passing: Vec<Exit>,
    /// Does an exit end behind it?
    is_end: bool,
}

struct Lower<'a> {
    p: &'a Program,
    f: &'a Function,
    /// Labels, by their joins, that are no frames.
    flat: &'a FxHashSet<u32>,
    /// Innermost last.
    frames: Vec<Frame>,
    /// Labels that no exit ends behind.
    idle: Vec<u32>,
}

impl Lower<'_> {
    /// A sequence whose end goes on in `end`. The code of the block `made` stands already.
    fn sequence(&mut self, steps: &[Step], end: Option<Exit>, made: Option<u32>) -> Vec<Piece> {
        let mut pieces = Vec::new();
        let code = |block: u32| (Some(block) != made).then_some(Piece::Code(block));
        for (i, step) in steps.iter().enumerate() {
            let end = end.filter(|_| i + 1 == steps.len());
            match step {
                Step::Block(block) => pieces.extend(code(*block)),
                Step::Choice { block, arms } => {
                    pieces.extend(code(*block));
                    let arms = |l: &mut Self| arms.iter().map(|arm| l.sequence(arm, end, None)).collect();
                    if is_switch(self.p, self.f, *block) {
                        let make = |l: &mut Self| Piece::Choice { block: *block, arms: arms(l) };
                        self.framed(None, end, &mut pieces, make);
                    } else {
                        pieces.push(Piece::Choice { block: *block, arms: arms(self) });
                    }
                }
                Step::Label { join, body } => {
                    let first = first_block(body);
                    pieces.extend(first.and_then(code));
                    let exit = Some(Exit::Join(*join));
                    if self.flat.contains(join) {
                        pieces.extend(self.sequence(body, exit, first));
                        continue;
                    }
                    let is_end = self.framed(None, exit, &mut pieces, |l| Piece::Label(l.sequence(body, exit, first)));
                    self.idle.extend((!is_end).then_some(*join));
                }
                Step::Loop { header, body } => {
                    let again = Some(Exit::Header(*header));
                    self.framed(Some(*header), end, &mut pieces, |l| Piece::Loop(l.sequence(body, again, None)));
                }
                Step::Break(join) => pieces.extend(self.leave(Exit::Join(*join), end)),
                Step::Continue(header) => pieces.extend(self.leave(Exit::Header(*header), end)),
            }
        }
        pieces
    }

    /// A frame, and the tests behind it. Does an exit end behind it?
    fn framed(
        &mut self,
        header: Option<u32>,
        behind: Option<Exit>,
        pieces: &mut Vec<Piece>,
        make: impl FnOnce(&mut Self) -> Piece,
    ) -> bool {
        self.frames.push(Frame { header, behind, passing: Vec::new(), is_end: false });
        let piece = make(self);
        let frame = self.frames.pop().expect("it was pushed");
        if frame.passing.is_empty() {
            pieces.push(piece);
            return frame.is_end;
        }
        pieces.extend([Piece::Reset, piece]);
        for exit in frame.passing {
            let depth = self.frames.len();
            // What does not end here hops on.
            let leave = self.ends(exit, depth).unwrap_or(Leave::Break);
            pieces.push(Piece::Arrive(exit.number(), leave));
        }
        frame.is_end
    }

    /// An exit; nothing where the end of the sequence goes there.
    fn leave(&mut self, exit: Exit, end: Option<Exit>) -> Option<Piece> {
        if end == Some(exit) {
            return None;
        }
        let all = self.frames.len();
        let depth = (1..=all).rev().find(|depth| self.ends(exit, *depth).is_some());
        let depth = depth.expect("the label or the loop is around its exit");
        let leave = self.ends(exit, depth);
        self.frames[depth - 1].is_end |= leave == Some(Leave::Break);
        if let (Some(leave), true) = (leave, depth == all) {
            return Some(Piece::Leave(leave));
        }
        for frame in &mut self.frames[depth..] {
            if !frame.passing.contains(&exit) {
                frame.passing.push(exit);
            }
        }
        Some(Piece::Far(exit.number()))
    }

    /// Within so many frames, which way out of the innermost one is this exit, if it is one?
    fn ends(&self, exit: Exit, depth: usize) -> Option<Leave> {
        let innermost = self.frames[..depth].iter().rev().find_map(|frame| frame.header);
        match exit {
            Exit::Header(header) if innermost == Some(header) => Some(Leave::Continue),
            _ if depth > 0 && self.frames[depth - 1].behind == Some(exit) => Some(Leave::Break),
            _ => None,
        }
    }
}

/// The block that a sequence begins with, unless it begins with a loop.
fn first_block(steps: &[Step]) -> Option<u32> {
    match steps.first()? {
        Step::Block(block) | Step::Choice { block, .. } => Some(*block),
        Step::Label { body, .. } => first_block(body),
        Step::Loop { .. } | Step::Break(_) | Step::Continue(_) => None,
    }
}
