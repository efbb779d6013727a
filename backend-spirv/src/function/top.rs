//! What stands where a function begins, because it is the same in all of it: arguments of the launch, places of buffers,
//! floats that naga or drivers do not take as literals.
//!
//! Drivers rewrite `x·0`, `x + 0` and `0 − x`, even where they are told not to contract. So a literal zero, wherever it
//! could become an operand of arithmetic, is read from the launch, where no driver can know it. A choice between a one and a
//! zero they make a conversion of the condition, which has another sign where the zero or the one has; in integers of these
//! bits too (lavapipe 22.3). There the ones are hidden. naga takes no literal NaN or infinity; they are made of their bits.

use jerboa_ir::{BufId, BufKind, Column, Layout, Lit, Scalar};
use naga::BinaryOperator as B;

use super::Emitter;
use crate::code::Value;

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Top {
    /// A word of the launch.
    Word(u32),
    /// An argument of the launch.
    Argument(u32, Scalar),
    /// The number of the invocation.
    Invocation,
    /// The last row of a buffer; of a stream without rows 0.
    Last(BufId),
    /// Has a stream no rows?
    IsEmpty(BufId),
    /// The word of a column in row 0.
    Base(Column),
    /// A float that no literal says, by its bits.
    Float(u32),
    /// An integer that has the bits of the float 1 or −1.
    One(u32),
}

impl Emitter<'_> {
    pub(super) fn top(&mut self, top: Top) -> Value {
        if let Some(value) = self.tops.get(&top) {
            return *value;
        }
        let value = self.make_top(top);
        self.tops.insert(top, value);
        value
    }

    /// Operands are made before `at_top` begins.
    fn make_top(&mut self, top: Top) -> Value {
        let launch = self.unit.launch;
        match top {
            Top::Word(word) => {
                let global = self.code.global(self.unit.globals.launch);
                self.code.at_top(|c| {
                    let pointer = c.component(global, word);
                    c.load(pointer)
                })
            }
            Top::Argument(word, scalar) => {
                let word = self.top(Top::Word(word));
                self.code.at_top(|c| super::memory::decode(c, scalar, word))
            }
            Top::Invocation => self.code.at_top(|c| {
                let (group, groups, local) = (c.argument(0), c.argument(1), c.argument(2));
                let (x, y, across) = (c.component(group, 0), c.component(group, 1), c.component(groups, 0));
                let size = c.u32(crate::WORKGROUP);
                let rows = c.binary(B::Multiply, y, across);
                let group = c.binary(B::Add, rows, x);
                let first = c.binary(B::Multiply, group, size);
                c.binary(B::Add, first, local)
            }),
            Top::Last(buf) => {
                let rows = self.rows(buf);
                let is_table = matches!(self.unit.program.buffer(buf).kind, BufKind::Table { .. });
                self.code.at_top(|c| {
                    let one = c.u32(1);
                    let some = if is_table { one } else { c.umin(rows, one) };
                    c.binary(B::Subtract, rows, some)
                })
            }
            Top::IsEmpty(buf) => {
                let rows = self.rows(buf);
                self.code.at_top(|c| {
                    let none = c.u32(0);
                    c.binary(B::Equal, rows, none)
                })
            }
            Top::Base(Column { buf, col }) => {
                let start = self.top(Top::Word(launch.start(buf)));
                let columns = self.unit.program.buffer(buf).layout == Layout::Columns;
                match col {
                    0 => start,
                    _ if columns => {
                        let rows = self.rows(buf);
                        self.code.at_top(|c| {
                            let col = c.u32(col);
                            let words = c.binary(B::Multiply, rows, col);
                            c.binary(B::Add, start, words)
                        })
                    }
                    _ => self.code.at_top(|c| {
                        let col = c.u32(col);
                        c.binary(B::Add, start, col)
                    }),
                }
            }
            Top::Float(bits) if bits << 1 == 0 => {
                let zero = self.top(Top::Word(launch.zero()));
                self.code.at_top(|c| {
                    let sign = c.u32(bits);
                    let bits = if bits == 0 { zero } else { c.binary(B::InclusiveOr, zero, sign) };
                    c.cast(bits, Scalar::F32)
                })
            }
            Top::One(word) => {
                let zero = self.top(Top::Word(launch.zero()));
                self.code.at_top(|c| {
                    let word = c.u32(word);
                    c.binary(B::InclusiveOr, zero, word)
                })
            }
            Top::Float(bits) => self.code.at_top(|c| {
                let bits = c.u32(bits);
                c.cast(bits, Scalar::F32)
            }),
        }
    }

    /// The number of rows of a buffer.
    pub(super) fn rows(&mut self, buf: BufId) -> Value {
        self.top(Top::Word(self.unit.launch.rows(buf)))
    }

    /// The float +0.
    pub(super) fn zero(&mut self) -> Value {
        self.top(Top::Float(0))
    }

    /// A literal as an operand of arithmetic.
    pub(super) fn literal(&mut self, lit: Lit) -> Value {
        match lit {
            Lit::F32(bits) if bits << 1 == 0 || !f32::from_bits(bits).is_finite() => self.top(Top::Float(bits)),
            Lit::U32(word) if is_one(word) => self.top(Top::One(word)),
            Lit::I32(word) if is_one(word as u32) => {
                let word = self.top(Top::One(word as u32));
                self.code.cast(word, Scalar::I32)
            }
            _ => self.code.literal(lit),
        }
    }
}

/// Are these the bits of the float 1 or −1?
fn is_one(word: u32) -> bool {
    word & 0x7fff_ffff == 0x3f80_0000
}
