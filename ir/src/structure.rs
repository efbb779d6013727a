//! The control flow of a function as a tree: sequences, choices, loops, and exits from them.
//!
//! Lanes and GPUs have no `goto`. What they have is structure: a piece of program with one place behind it, where those who
//! went different ways meet. This analysis finds it in a *reducible* graph, one in which every loop is entered at its
//! header, without copying a block or inventing a variable (Ramsey, *Beyond Relooper: Recursive Translation of Unstructured
//! Control Flow to Structured Control Flow*, ICFP 2022). A [`Function`]'s blocks become a sequence of [`Step`]s, in which
//! each block stands exactly once.
//!
//! # Theory
//! The tree is the dominator tree. A block stands within the piece of its immediate dominator, and how it is reached
//! depends on who goes on in it:
//!
//! - *One* block does, its dominator: the block stands in the dominator's arm.
//! - *Several* do, so it is a *join*. It stands behind the arms of its dominator, all of which lie in a [`Step::Label`]; to
//!   go on there is to leave the label ([`Step::Break`]). Several joins of one dominator nest, in reverse postorder.
//! - A later block goes *back* to it, so it is a header: [`Step::Loop`] holds it, and to go back is [`Step::Continue`].
//! - It lies *outside of the loop* of its dominator. Ramsey leaves such a block where it is, in the loop's text. Here it is
//!   a join behind the loop: lanes that leave a loop in different rounds meet there and go on together.
//!
//! In a reducible graph all other edges go from a smaller to a larger number in reverse postorder, so whoever goes on in a
//! join stands in its label. Reaching the end of an arm, of a label's body or of a loop's body goes on behind the choice,
//! behind the label, or in the loop's header; an exit that would do only that is left out, and so is a label that nobody
//! breaks to. Where all other arms of a choice leave, the largest one stands behind the choice, not in it; so a long chain
//! of tests is a long sequence and not a deep tree.
//!
//! # Example
//! A search in `n` rows: it returns the first row that holds `x`, or `n`.
//!
//! ```
//! use jerboa_ir::{cfg::Cfg, structure::{Step, structure}};
//!
//! let program = jerboa_ir::parse(
//!     "jerboa-ir 1
//! stream rows by columns
//!   x: f32 bulk
//! entry find = find
//! fun find(x: f32, n: u32, return: fn(u32))
//!   jump head(0u)
//!   loop head(i: u32)
//!     inside = lt i n
//!     branch inside look leave
//!   arm look()
//!     load rows.x i -> compare
//!   rest compare(y: f32)
//!     same = eq x y
//!     branch same leave step
//!   arm step()
//!     j = add i 1u
//!     jump head(j)
//!   label leave()
//!     jump return(i)
//! ",
//! )?;
//! let cfg = Cfg::new(&program, &[program.entry("find").unwrap()])?;
//! let find = &cfg.functions[0];
//! let block = |name: &str| find.blocks.iter().position(|b| &*program.cont(b.cont).name == name).unwrap() as u32;
//! let (head, look, compare, step, leave) = (block("head"), block("look"), block("compare"), block("step"), block("leave"));
//! let search = Step::Loop {
//!     header: head,
//!     body: vec![
//!         Step::Choice { block: head, arms: vec![vec![], vec![Step::Break(leave)]] },
//!         Step::Block(look),
//!         Step::Choice { block: compare, arms: vec![vec![Step::Break(leave)], vec![]] },
//!         Step::Block(step),
//!     ],
//! };
//! let expected = [Step::Block(0), Step::Label { join: leave, body: vec![search] }, Step::Block(leave)];
//! assert_eq!(structure(&program, find)?, expected);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::fmt;
use std::sync::Arc;

use crate::cfg::Function;
use crate::program::{Cont, ContId, Loc, Program};

/// A tree may be so deep: choices, labels and loops within one another. Who walks it may do so by recursion.
pub const NESTING: usize = 256;

/// An arm of more blocks stands behind its choice where the other arms are only exits, even those that the end of the arm
/// would do. Smaller arms stay in the choice, without a label.
const LARGE: u32 = 64;

/// A piece of a function. Blocks are numbers in [`Function::blocks`].
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Step {
    /// A block that returns, or goes on in one block.
    Block(u32),
    /// A block that goes on in one of several.
    Choice {
        /// The block.
        block: u32,
        /// One for each of its successors, in their order ([`crate::cfg::Block::succs`]).
        arms: Vec<Vec<Step>>,
    },
    /// A piece with exits to what stands behind it.
    Label {
        /// The block behind it: where its [`Step::Break`]s go on.
        join: u32,
        /// The piece.
        body: Vec<Step>,
    },
    /// A piece that is repeated until something leaves it.
    Loop {
        /// Its first block.
        header: u32,
        /// The piece; at its end it begins again.
        body: Vec<Step>,
    },
    /// Go on behind the label of this join.
    Break(u32),
    /// Go on in the header of this loop, which is around.
    Continue(u32),
}

/// Does a sequence that ends like this go on behind itself?
pub fn falls_through(f: &Function, steps: &[Step]) -> bool {
    match steps.last() {
        None | Some(Step::Label { .. }) => true,
        Some(Step::Block(block)) => !f.blocks[*block as usize].succs.is_empty(),
        Some(Step::Choice { arms, .. }) => arms.iter().any(|arm| falls_through(f, arm)),
        Some(Step::Loop { .. } | Step::Break(_) | Step::Continue(_)) => false,
    }
}

/// The tree of a function.
///
/// # Errors
/// If a loop has two entries, or the tree would be deeper than [`NESTING`].
pub fn structure(p: &Program, f: &Function) -> Result<Vec<Step>, Unstructured> {
    let place = |block: u32| Place::new(p, f.blocks[block as usize].cont);
    if let Some((from, to)) = f.loops.irreducible() {
        return Err(Unstructured::TwoEntries {
            function: place(0),
            first: place(to),
            second: place(other_entry(f, from, to)),
        });
    }
    Builder::new(f).region(0, None).map_err(|Deep| Unstructured::Deep { function: place(0) })
}

/// Where the end of a sequence goes on.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Behind {
    /// In the join behind the label, for the body of a label and all that stands at its end.
    Join(u32),
    /// In the header of the loop, for its body.
    Header(u32),
}

/// The tree is deeper than [`NESTING`].
struct Deep;

struct Builder<'f> {
    f: &'f Function,
    /// Number of blocks that each block dominates.
    weight: Vec<u32>,
    /// Joins behind the arms of each block, ascending.
    joins: Vec<Vec<u32>>,
    /// Joins behind the loop of each header, ascending.
    exits: Vec<Vec<u32>>,
    /// Is the block one of these?
    is_join: Vec<bool>,
    /// Is there a break to it?
    is_broken_to: Vec<bool>,
    /// Pieces around the current one.
    nesting: usize,
}

impl<'f> Builder<'f> {
    fn new(f: &'f Function) -> Builder<'f> {
        let n = f.blocks.len();
        let (none, no) = (vec![Vec::new(); n], vec![false; n]);
        let (joins, exits, is_join, is_broken_to) = (none.clone(), none, no.clone(), no);
        let mut b = Builder { f, weight: vec![1; n], joins, exits, is_join, is_broken_to, nesting: 0 };
        for block in 1..n as u32 {
            let above = f.dom.idom(block).unwrap_or(0);
            let forward = f.blocks[block as usize].preds.iter().filter(|p| **p < block).count();
            match left_loop(f, above, block) {
                Some(header) => b.exits[header as usize].push(block),
                None if forward > 1 => b.joins[above as usize].push(block),
                None => continue,
            }
            b.is_join[block as usize] = true;
        }
        for block in (1..n as u32).rev() {
            b.weight[f.dom.idom(block).unwrap_or(0) as usize] += b.weight[block as usize];
        }
        b
    }

    /// The sequence that begins with a block.
    fn region(&mut self, start: u32, behind: Option<Behind>) -> Result<Vec<Step>, Deep> {
        self.enter(1)?;
        let mut steps = Vec::new();
        let mut next = Some(start);
        while let Some(block) = next {
            next = match self.f.loops.is_header(block) {
                true => self.repeated(block, &mut steps)?,
                false => self.once(block, behind, &mut steps)?,
            };
        }
        self.nesting -= 1;
        Ok(steps)
    }

    /// A loop, with the joins behind it. Gives the block that the sequence goes on with.
    fn repeated(&mut self, header: u32, steps: &mut Vec<Step>) -> Result<Option<u32>, Deep> {
        let exits = std::mem::take(&mut self.exits[header as usize]);
        self.enter(exits.len() + 1)?;
        let again = Some(Behind::Header(header));
        let mut body = Vec::new();
        if let Some(next) = self.once(header, again, &mut body)? {
            body.extend(self.region(next, again)?);
        }
        let next = self.labelled(vec![Step::Loop { header, body }], None, &exits, steps)?;
        self.nesting -= exits.len() + 1;
        Ok(next)
    }

    /// A block, its arms, and the joins behind them. Gives the block that the sequence goes on with.
    fn once(&mut self, block: u32, behind: Option<Behind>, steps: &mut Vec<Step>) -> Result<Option<u32>, Deep> {
        let joins = std::mem::take(&mut self.joins[block as usize]);
        self.enter(joins.len())?;
        let mut body = Vec::new();
        let behind_arms = joins.first().map(|join| Behind::Join(*join)).or(behind);
        let next = self.arms(block, behind_arms, &mut body)?;
        let next = self.labelled(body, next, &joins, steps)?;
        self.nesting -= joins.len();
        Ok(next)
    }

    /// A piece that goes on in `next`, in a label for each of these joins, and all joins but the last.
    fn labelled(
        &mut self,
        mut body: Vec<Step>,
        mut next: Option<u32>,
        joins: &[u32],
        steps: &mut Vec<Step>,
    ) -> Result<Option<u32>, Deep> {
        for join in joins {
            if let Some(next) = next {
                body.extend(self.region(next, Some(Behind::Join(*join)))?);
            }
            if self.is_broken_to[*join as usize] {
                body = vec![Step::Label { join: *join, body }];
            }
            next = Some(*join);
        }
        steps.extend(body);
        Ok(next)
    }

    /// A block and its arms. Gives the block that stands behind them in the same sequence, if one does.
    fn arms(&mut self, block: u32, behind: Option<Behind>, steps: &mut Vec<Step>) -> Result<Option<u32>, Deep> {
        let f = self.f;
        let succs = &f.blocks[block as usize].succs;
        let inside: Vec<bool> = succs.iter().map(|s| *s > block && !self.is_join[*s as usize]).collect();
        if let [] | [_] = succs[..] {
            steps.push(Step::Block(block));
            let next = succs.first().copied().filter(|_| inside[0]);
            steps.extend(succs.iter().filter(|_| !inside[0]).filter_map(|s| self.leave(block, *s, behind)));
            return Ok(next);
        }
        let largest = (0..succs.len()).filter(|i| inside[*i]).max_by_key(|i| self.weight[succs[*i] as usize]);
        // Exits are written out where the largest arm is to stand behind the choice.
        let falling = behind.filter(|_| largest.is_none_or(|i| self.weight[succs[i] as usize] <= LARGE));
        let mut arms = Vec::with_capacity(succs.len());
        for (i, succ) in succs.iter().enumerate() {
            arms.push(match inside[i] {
                true if Some(i) == largest => Vec::new(),
                true => self.region(*succ, behind)?,
                false => self.leave(block, *succ, falling).into_iter().collect(),
            });
        }
        let others_leave = arms.iter().enumerate().all(|(i, arm)| Some(i) == largest || !falls_through(f, arm));
        let next = largest.filter(|_| others_leave).map(|i| succs[i]);
        if let Some(i) = largest.filter(|_| !others_leave) {
            arms[i] = self.region(succs[i], behind)?;
        }
        steps.push(Step::Choice { block, arms });
        Ok(next)
    }

    /// The exit from one block to another that is not inside of it; none where the end of the sequence goes there.
    fn leave(&mut self, from: u32, to: u32, behind: Option<Behind>) -> Option<Step> {
        let is_back = to <= from;
        if behind == Some(if is_back { Behind::Header(to) } else { Behind::Join(to) }) {
            return None;
        }
        self.is_broken_to[to as usize] |= !is_back;
        Some(if is_back { Step::Continue(to) } else { Step::Break(to) })
    }

    fn enter(&mut self, levels: usize) -> Result<(), Deep> {
        self.nesting += levels;
        if self.nesting > NESTING { Err(Deep) } else { Ok(()) }
    }
}

/// The header of the outermost loop that is around `from` and not around `to`.
fn left_loop(f: &Function, from: u32, to: u32) -> Option<u32> {
    let around = |block: u32| std::iter::successors(f.loops.header(block), |h| f.loops.outer(*h));
    around(from).take_while(|h| around(to).all(|other| other != *h)).last()
}

/// Where else a loop is entered that has the edge from `from` back to `to`, which does not dominate it.
///
/// The search that numbered the blocks went from `to` to `from` by blocks of larger numbers. These and all others that
/// close a cycle with them are the loop; a block of it that is reached from outside, other than `to`, is the answer.
fn other_entry(f: &Function, from: u32, to: u32) -> u32 {
    let reach = |start: u32, back: bool| {
        let mut seen = vec![false; f.blocks.len()];
        let mut work = vec![start];
        while let Some(block) = work.pop() {
            if block >= to && !std::mem::replace(&mut seen[block as usize], true) {
                let b = &f.blocks[block as usize];
                work.extend(if back { &b.preds } else { &b.succs });
            }
        }
        seen
    };
    let (below, above) = (reach(to, false), reach(from, true));
    let in_loop = |block: u32| below[block as usize] && above[block as usize];
    let is_entry = |b: &u32| in_loop(*b) && f.blocks[*b as usize].preds.iter().any(|p| !in_loop(*p));
    (to + 1..f.blocks.len() as u32).find(is_entry).unwrap_or(from)
}

/// A continuation, for messages.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Place {
    /// Its name.
    pub name: Arc<str>,
    /// Where the author wrote it.
    pub loc: Loc,
}

impl Place {
    fn new(p: &Program, cont: ContId) -> Place {
        let Cont { name, loc, .. } = p.cont(cont);
        Place { name: name.clone(), loc: *loc }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}`", self.name)?;
        if self.loc != Loc::NONE { write!(f, " ({})", self.loc) } else { Ok(()) }
    }
}

/// Why a function has no tree. What `ir::lang` builds always has one; continuations that jump into each other's middle
/// need not.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Unstructured {
    /// A loop can be entered at two blocks.
    TwoEntries {
        /// The function.
        function: Place,
        /// One entry.
        first: Place,
        /// Another.
        second: Place,
    },
    /// The tree would be deeper than [`NESTING`].
    Deep {
        /// The function.
        function: Place,
    },
}

impl fmt::Display for Unstructured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Unstructured::TwoEntries { function, first, second } => write!(
                f,
                "function {function} has a loop with two entries, {first} and {second}; let one of them go through the \
                 other, or make two loops of it"
            ),
            Unstructured::Deep { function } => write!(
                f,
                "function {function} nests choices, joins and loops more than {NESTING} deep; move a part of it to a \
                 function of its own"
            ),
        }
    }
}

impl std::error::Error for Unstructured {}

#[cfg(test)]
mod tests;
