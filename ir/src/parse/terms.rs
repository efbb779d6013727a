//! What stands in a line: jumps, expressions, operands and types.

use super::cursor::Cursor;
use super::lex::is_word;
use super::{Entity, Parser};
use crate::error::TextError;
use crate::lit::Lit;
use crate::op::Op;
use crate::program::*;
use crate::ty::{Scalar, Ty, TyKind};
use crate::typing::type_of;

/// Types with more parts or deeper nesting than this are refused: a tuple of tuples doubles with every line.
const MAX_TYPE: (u64, u64) = (1 << 16, 64);

impl Parser {
    /// The jump of a continuation.
    pub(super) fn body(&mut self, c: &mut Cursor, tree: Option<usize>) -> Result<Body, TextError> {
        let word = c.word()?;
        Ok(match word {
            "unset" => Body::Unset,
            "jump" => {
                let mode = match () {
                    () if c.skip("now") => Mode::Now,
                    () if c.skip("later") => Mode::Later,
                    () => Mode::Filter,
                };
                let callee = self.leaf(c, tree)?;
                Body::Jump { callee, args: self.args(c, tree)?, mode }
            }
            "branch" => {
                let (cond, then) = (self.leaf(c, tree)?, self.leaf(c, tree)?);
                Body::Branch { cond, then, other: self.leaf(c, tree)? }
            }
            "switch" => {
                let (index, mut arms) = (self.leaf(c, tree)?, Vec::new());
                while !c.skip("else") {
                    let number = c.number()?;
                    c.expect(":")?;
                    arms.push((number, self.leaf(c, tree)?));
                    c.expect(",")?;
                }
                Body::Switch { index, arms, default: self.leaf(c, tree)? }
            }
            "dispatch" => {
                let row = self.leaf(c, tree)?;
                Body::Dispatch { row, arm: self.next(c, tree)? }
            }
            "load" => {
                let (mem, index) = (self.mem(c, tree)?, self.leaf(c, tree)?);
                Body::Load { mem, index, next: self.next(c, tree)? }
            }
            "store" => {
                let (mem, index, value) = (self.mem(c, tree)?, self.leaf(c, tree)?, self.leaf(c, tree)?);
                let mask = if c.skip("when") { self.leaf(c, tree)? } else { NodeId::NONE };
                Body::Store { mem, index, value, mask, next: self.next(c, tree)? }
            }
            "vectorize" => {
                let width = c.number()?;
                let width = u8::try_from(width).map_err(|_| c.error_before(format!("{width} is no width")))?;
                let (lo, hi, body) = (self.leaf(c, tree)?, self.leaf(c, tree)?, self.leaf(c, tree)?);
                let args = self.args(c, tree)?;
                Body::Vectorize { width, lo, hi, body, args, next: self.next(c, tree)? }
            }
            "local" => {
                let word = c.word()?;
                let scalar = scalar(word).ok_or_else(|| c.error_before(format!("no scalar `{word}`")))?;
                let len = c.number()?;
                Body::Local { scalar, len, next: self.next(c, tree)? }
            }
            _ => return Err(c.error_before(format!("`{word}` is neither a jump nor a continuation's role"))),
        })
    }

    /// Arguments in parentheses.
    fn args(&mut self, c: &mut Cursor, tree: Option<usize>) -> Result<Vec<NodeId>, TextError> {
        c.expect("(")?;
        let mut args = Vec::new();
        while !c.skip(")") {
            if !args.is_empty() {
                c.expect(",")?;
            }
            args.push(self.leaf(c, tree)?);
        }
        Ok(args)
    }

    fn next(&mut self, c: &mut Cursor, tree: Option<usize>) -> Result<NodeId, TextError> {
        c.expect("->")?;
        self.leaf(c, tree)
    }

    fn mem(&mut self, c: &mut Cursor, tree: Option<usize>) -> Result<Mem, TextError> {
        if c.skip("unchecked") {
            return Ok(Mem::Unchecked(self.column_ref(c)?));
        }
        if c.peek(1) == "." {
            return Ok(Mem::Stream(self.column_ref(c)?));
        }
        Ok(Mem::Local(self.leaf(c, tree)?))
    }

    fn column_ref(&mut self, c: &mut Cursor) -> Result<Column, TextError> {
        let buf = self.buffer_ref(c)?;
        c.expect(".")?;
        let name = c.word()?;
        let col = self.columns.get(&(buf, name.to_owned())).copied();
        col.map(|col| Column { buf, col }).ok_or_else(|| c.error_before(format!("no column `{name}`")))
    }

    fn buffer_ref(&mut self, c: &mut Cursor) -> Result<BufId, TextError> {
        let name = c.word()?;
        self.buffers.get(name).copied().ok_or_else(|| c.error_before(format!("no buffer `{name}`")))
    }

    /// A word and its operands.
    pub(super) fn expression(&mut self, c: &mut Cursor, tree: Option<usize>) -> Result<NodeId, TextError> {
        self.expression_within(c, tree, 0)
    }

    fn expression_within(&mut self, c: &mut Cursor, tree: Option<usize>, depth: u32) -> Result<NodeId, TextError> {
        let start = c.place();
        let word = c.word()?;
        let many = |parser: &mut Parser, c: &mut Cursor| {
            let mut xs = Vec::new();
            while !c.at_end() && c.peek(0) != ")" {
                xs.push(parser.operand(c, tree, depth)?);
            }
            Ok::<_, TextError>(xs)
        };
        let node = match word {
            "pack" => Node::Pack(many(self, c)?.into()),
            "tuple" => Node::Tuple(many(self, c)?.into()),
            "lane" => {
                let vector = self.operand(c, tree, depth)?;
                let lane = c.number()?;
                Node::Lane { vector, lane: u8::try_from(lane).unwrap_or(u8::MAX) }
            }
            "extract" => Node::Extract { tuple: self.operand(c, tree, depth)?, index: c.number()? },
            "read" => Node::Read { column: self.column_ref(c)?, index: self.operand(c, tree, depth)? },
            "row" => Node::Row { table: self.buffer_ref(c)?, index: self.operand(c, tree, depth)? },
            "sibling" => Node::Sibling { row: self.operand(c, tree, depth)?, index: self.operand(c, tree, depth)? },
            "row_index" => Node::RowIndex(self.operand(c, tree, depth)?),
            "known" => Node::Known(self.operand(c, tree, depth)?),
            _ => {
                let op = Op::by_name(word).ok_or_else(|| c.error_before(format!("no operation `{word}`")))?;
                let mut args = [NodeId::NONE; 3];
                for arg in &mut args[..op.arity()] {
                    *arg = self.operand(c, tree, depth)?;
                }
                Node::Prim { op, args }
            }
        };
        let fault = |what: String| TextError { what, ..start.clone() };
        let ty = type_of(self.world.program(), &node).map_err(fault)?;
        let (parts, deep) = self.size(ty);
        if parts > MAX_TYPE.0 || deep > MAX_TYPE.1 {
            return Err(fault(format!("a type of {parts} parts, {deep} deep, is too large")));
        }
        Ok(self.world.node(node, ty, Loc::NONE))
    }

    /// A literal, a name, or an expression in parentheses.
    pub(super) fn operand(&mut self, c: &mut Cursor, tree: Option<usize>, depth: u32) -> Result<NodeId, TextError> {
        if !c.skip("(") {
            return self.leaf(c, tree);
        }
        if depth as u64 >= MAX_TYPE.1 {
            return Err(c.error("nested too deep".to_owned()));
        }
        let node = self.expression_within(c, tree, depth + 1)?;
        c.expect(")")?;
        Ok(node)
    }

    /// A literal or a name.
    fn leaf(&mut self, c: &mut Cursor, tree: Option<usize>) -> Result<NodeId, TextError> {
        let text = c.token()?;
        if let Some(lit) = Lit::parse(text) {
            return Ok(self.world.lit(lit));
        }
        if !text.starts_with(|ch: char| is_word(ch) && !ch.is_ascii_digit()) {
            return Err(c.error_before(format!("`{text}` is neither a name nor a literal (`2i`, `2u`, `2.0`)")));
        }
        let found = if c.skip("::") {
            let name = c.word()?;
            self.tree_of.get(text).and_then(|t| self.trees[*t].get(name))
        } else {
            tree.and_then(|t| self.trees[t].get(text)).or_else(|| self.global.get(text))
        };
        match found.copied() {
            Some(Entity::Cont(cont)) => Ok(self.world.cont_value(cont)),
            Some(Entity::Param(cont, index)) => Ok(self.world.param(cont, index)),
            Some(Entity::Node(node)) => Ok(node),
            None => Err(c.error_before("this name is not known here".to_owned())),
        }
    }

    /// A type.
    pub(super) fn ty(&mut self, c: &mut Cursor, depth: u64) -> Result<Ty, TextError> {
        if depth > MAX_TYPE.1 {
            return Err(c.error("a type nested too deep".to_owned()));
        }
        if c.skip("(") {
            return Ok(Ty::tuple(&self.types(c, depth)?));
        }
        let word = c.word()?;
        let wrong = || c.error_before(format!("`{word}` is no type"));
        if let Some(s) = scalar(word) {
            return Ok(Ty::scalar(s));
        }
        if let Some((s, lanes)) = word.split_once('x') {
            let lanes = lanes.parse::<usize>().ok().filter(|n| (2..=16).contains(n));
            return Ok(Ty::vector(scalar(s).ok_or_else(wrong)?, lanes.ok_or_else(wrong)?));
        }
        if !matches!(word, "fn" | "row" | "local") {
            return Err(wrong());
        }
        c.expect("(")?;
        let ty = match word {
            "fn" => return Ok(Ty::func(&self.types(c, depth)?)),
            "row" => Ty::row(self.buffer_ref(c)?),
            _ => {
                let word = c.word()?;
                let scalar = scalar(word).ok_or_else(|| c.error_before(format!("no scalar `{word}`")))?;
                Ty::local(scalar, c.number()?)
            }
        };
        c.expect(")")?;
        Ok(ty)
    }

    /// Types up to `)`.
    fn types(&mut self, c: &mut Cursor, depth: u64) -> Result<Vec<Ty>, TextError> {
        let mut types = Vec::new();
        while !c.skip(")") {
            if !types.is_empty() {
                c.expect(",")?;
            }
            types.push(self.ty(c, depth + 1)?);
        }
        Ok(types)
    }

    /// Parts and depth of a type.
    fn size(&mut self, ty: Ty) -> (u64, u64) {
        let elems = match ty.kind() {
            TyKind::Tuple(elems) | TyKind::Fn(elems) => elems,
            _ => return (1, 1),
        };
        if let Some(known) = self.sizes.get(&ty) {
            return *known;
        }
        let (mut parts, mut depth) = (1, 1);
        for elem in elems {
            let (p, d) = self.size(*elem);
            (parts, depth) = (p.saturating_add(parts), depth.max(d + 1));
        }
        self.sizes.insert(ty, (parts, depth));
        (parts, depth)
    }
}

/// The scalar of this name.
fn scalar(word: &str) -> Option<Scalar> {
    Scalar::ALL.into_iter().find(|s| s.name() == word)
}
