//! Reads the text that [`crate::print()`] writes; the grammar stands there.
//!
//! Nodes are made as they stand, without folding, so that a program comes back as it was. Names are resolved within the
//! function they stand in (a continuation at the margin and all below it, up to the next margin); nesting is ignored,
//! because scope follows from free variables. Every mistake is a [`TextError`]; no text makes this panic, and work and
//! stack are bounded by the length of the text.

use rustc_hash::FxHashMap;

use crate::error::TextError;
use crate::lex::{self, Line, is_word};
use crate::lit::Lit;
use crate::names::is_automatic;
use crate::op::Op;
use crate::parse_line::Cursor;
use crate::program::*;
use crate::ty::{Scalar, Ty, TyKind};
use crate::typing::type_of;
use crate::world::World;

/// Types with more parts or deeper nesting than this are refused: a tuple of tuples doubles with every line.
const MAX_TYPE: (u64, u64) = (1 << 16, 64);

/// The program that a text says, or its first mistake.
pub fn parse(text: &str) -> Result<Program, TextError> {
    let lines = lex::lines(text)?;
    let mut parser = Parser::default();
    parser.buffers(&lines)?;
    parser.heads(&lines)?;
    parser.bodies(&lines)?;
    parser.filters(&lines)?;
    parser.entries(&lines)?;
    Ok(parser.world.finish())
}

/// What a name stands for.
#[derive(Clone, Copy)]
enum Entity {
    Cont(ContId),
    Param(ContId, usize),
    Node(NodeId),
}

/// Names of one function, or those that all see.
type Names = FxHashMap<String, Entity>;

#[derive(Default)]
struct Parser {
    world: World,
    buffers: FxHashMap<String, BufId>,
    columns: FxHashMap<(BufId, String), u32>,
    /// Roots and shared lines.
    global: Names,
    /// Names in each function, by its number in the text.
    trees: Vec<Names>,
    /// Number of the function with this name.
    tree_of: FxHashMap<String, usize>,
    /// Parts and depth of tuple and continuation types.
    sizes: FxHashMap<Ty, (u64, u64)>,
}

/// What a line is, by its first words.
#[derive(PartialEq, Eq, Clone, Copy)]
enum Kind {
    Buffer,
    Column,
    Entry,
    Head(Role),
    Node,
    Body,
}

fn kind(line: &Line) -> Kind {
    let word = |i: usize| line.tokens.get(i).map_or("", |t| t.text);
    match (word(0), word(1)) {
        (_, "=") => Kind::Node,
        (_, ":") => Kind::Column,
        ("table" | "stream", _) => Kind::Buffer,
        ("entry", _) => Kind::Entry,
        (first, _) => Role::by_word(first).map_or(Kind::Body, Kind::Head),
    }
}

impl Parser {
    /// Buffers with their columns; a column may refer to a later table, so their names come first.
    fn buffers(&mut self, lines: &[Line]) -> Result<(), TextError> {
        for line in lines.iter().filter(|l| kind(l) == Kind::Buffer) {
            let mut c = Cursor::new(line);
            let stream = c.word()? == "stream";
            let name = c.word()?;
            if self.buffers.insert(name.to_owned(), BufId(self.buffers.len() as u32)).is_some() {
                return Err(c.error_at(1, format!("a second buffer `{name}`")));
            }
            c.expect("by")?;
            let layout = match c.word()? {
                "rows" => Layout::Rows,
                "columns" => Layout::Columns,
                other => return Err(c.error_before(format!("`rows` or `columns`, not `{other}`"))),
            };
            let classed = !stream && c.skip("classed");
            c.end()?;
            let kind = if stream { BufKind::Stream } else { BufKind::Table { classed } };
            self.world.buffer(Buffer { name: name.into(), kind, layout, columns: Vec::new() });
        }
        let mut buffer = None;
        for line in lines {
            match kind(line) {
                Kind::Buffer => buffer = Some(buffer.map_or(0, |b: u32| b + 1)),
                Kind::Column => {
                    let buffer = buffer.ok_or_else(|| Cursor::new(line).error("a column of no buffer".to_owned()))?;
                    self.column(BufId(buffer), Cursor::new(line))?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn column(&mut self, buffer: BufId, mut c: Cursor) -> Result<(), TextError> {
        let name = c.word()?;
        c.expect(":")?;
        let ty = match *self.ty(&mut c, 0)?.kind() {
            TyKind::Scalar(s) => ColTy::Scalar(s),
            TyKind::Row(table) => ColTy::Ref(table),
            _ => return Err(c.error_before("a column holds scalars or rows".to_owned())),
        };
        let time = match c.word()? {
            "structure" => Time::Structure,
            "value" => Time::Value,
            "bulk" => Time::Bulk,
            other => return Err(c.error_before(format!("`structure`, `value` or `bulk`, not `{other}`"))),
        };
        c.end()?;
        let columns = &mut self.world.buffer_mut(buffer).columns;
        if self.columns.insert((buffer, name.to_owned()), columns.len() as u32).is_some() {
            return Err(c.error_at(0, format!("a second column `{name}`")));
        }
        columns.push(ColumnDecl { name: name.into(), ty, time });
        Ok(())
    }

    /// Continuations with their parameters; filters wait until all lines are known.
    fn heads(&mut self, lines: &[Line]) -> Result<(), TextError> {
        for line in lines {
            let Kind::Head(role) = kind(line) else { continue };
            let mut c = Cursor::new(line);
            c.word()?;
            let name = c.word()?;
            c.expect("(")?;
            let mut params = Vec::new();
            while !c.skip(")") {
                if !params.is_empty() {
                    c.expect(",")?;
                }
                let keep = c.skip("keep");
                let name = c.word()?;
                c.expect(":")?;
                params.push((name, keep, self.ty(&mut c, 0)?));
            }
            let hint = |name: &str| (!is_automatic(name)).then(|| name.into());
            let list = params.iter().map(|(name, keep, ty)| Param { ty: *ty, name: hint(name), keep: *keep });
            let cont = self.world.cont(name, role, list.collect(), Loc::NONE);
            if line.at_margin() {
                self.tree_of.insert(name.to_owned(), self.trees.len());
                self.trees.push(Names::default());
            }
            let Some(tree) = self.trees.last_mut() else {
                return Err(c.error_at(0, "the first continuation stands at the margin".to_owned()));
            };
            let names = if line.at_margin() { &mut self.global } else { &mut *tree };
            if names.insert(name.to_owned(), Entity::Cont(cont)).is_some() {
                return Err(c.error_at(1, format!("a second `{name}`")));
            }
            for (i, (name, ..)) in params.iter().enumerate() {
                if tree.insert((*name).to_owned(), Entity::Param(cont, i)).is_some() {
                    return Err(c.error_at(1, format!("a second `{name}` among the parameters and names here")));
                }
            }
        }
        Ok(())
    }

    /// Lines and jumps, in the order of the text: what a line uses stands above it.
    fn bodies(&mut self, lines: &[Line]) -> Result<(), TextError> {
        // Number of continuations and functions so far; the head's line of the one that has no jump yet.
        let (mut conts, mut trees, mut open) = (0, 0, None);
        for line in lines {
            let mut c = Cursor::new(line);
            match kind(line) {
                Kind::Head(_) => {
                    if let Some(head) = open.replace(line) {
                        return Err(Cursor::new(head).error("this continuation has no jump".to_owned()));
                    }
                    conts += 1;
                    trees += line.at_margin() as usize;
                }
                Kind::Node => {
                    let name = c.word()?;
                    c.expect("=")?;
                    let tree = if line.at_margin() { None } else { trees.checked_sub(1) };
                    let node = self.expression(&mut c, tree)?;
                    c.end()?;
                    if !is_automatic(name) {
                        self.world.name(node, name);
                    }
                    let names = tree.map_or(&mut self.global, |t| &mut self.trees[t]);
                    if names.insert(name.to_owned(), Entity::Node(node)).is_some() {
                        return Err(c.error_at(0, format!("a second `{name}`")));
                    }
                }
                Kind::Body => {
                    if open.take().is_none() {
                        return Err(c.error("no continuation waits for a jump here".to_owned()));
                    }
                    let body = self.body(&mut c, trees.checked_sub(1))?;
                    c.end()?;
                    self.world.cont_mut(ContId(conts - 1)).body = body;
                }
                Kind::Buffer | Kind::Column | Kind::Entry => {}
            }
        }
        open.map_or(Ok(()), |head| Err(Cursor::new(head).error("this continuation has no jump".to_owned())))
    }

    fn filters(&mut self, lines: &[Line]) -> Result<(), TextError> {
        let (mut conts, mut trees) = (0, 0);
        for line in lines.iter().filter(|l| matches!(kind(l), Kind::Head(_))) {
            trees += line.at_margin() as usize;
            let mut c = Cursor::new(line);
            c.skip_parentheses();
            let filter = match c.skip("@") {
                false => self.world.lit(Lit::Bool(false)),
                true if c.at_end() => self.world.lit(Lit::Bool(true)),
                true => self.operand(&mut c, trees.checked_sub(1), 0)?,
            };
            c.end()?;
            self.world.cont_mut(ContId(conts)).filter = filter;
            conts += 1;
        }
        Ok(())
    }

    fn entries(&mut self, lines: &[Line]) -> Result<(), TextError> {
        for line in lines.iter().filter(|l| kind(l) == Kind::Entry) {
            let mut c = Cursor::new(line);
            c.word()?;
            let name = c.word()?;
            c.expect("=")?;
            let target = c.word()?;
            c.end()?;
            match self.global.get(target) {
                Some(Entity::Cont(cont)) => self.world.entry(name, *cont),
                _ => return Err(c.error_before(format!("no continuation `{target}` stands at the margin"))),
            }
        }
        Ok(())
    }

    fn body(&mut self, c: &mut Cursor, tree: Option<usize>) -> Result<Body, TextError> {
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
                c.expect("(")?;
                let mut args = Vec::new();
                while !c.skip(")") {
                    if !args.is_empty() {
                        c.expect(",")?;
                    }
                    args.push(self.leaf(c, tree)?);
                }
                Body::Jump { callee, args, mode }
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
                Body::Store { mem, index, value, next: self.next(c, tree)? }
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
    fn expression(&mut self, c: &mut Cursor, tree: Option<usize>) -> Result<NodeId, TextError> {
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
    fn operand(&mut self, c: &mut Cursor, tree: Option<usize>, depth: u32) -> Result<NodeId, TextError> {
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

    fn ty(&mut self, c: &mut Cursor, depth: u64) -> Result<Ty, TextError> {
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
