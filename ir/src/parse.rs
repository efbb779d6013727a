//! Reads the text that [`crate::print()`] writes; the grammar stands there.
//!
//! Nodes are made as they stand, without folding, so that a program comes back as it was. Names are resolved within the
//! function they stand in (a continuation at the margin and all below it, up to the next margin); nesting is ignored,
//! because scope follows from free variables. Every mistake is a [`TextError`]; no text makes this panic, and work and
//! stack are bounded by the length of the text.

mod cursor;
mod lex;
mod terms;

use rustc_hash::FxHashMap;

use crate::error::TextError;
use crate::lit::Lit;
use crate::print::is_automatic;
use crate::program::*;
use crate::ty::{Ty, TyKind};
use crate::world::World;
use cursor::Cursor;
use lex::Line;

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
}
