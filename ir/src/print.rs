//! The text of a program, `jerboa-ir 1`: canonical, so that equal programs have equal text, and read back by
//! [`crate::parse()`] to the same program.
//!
//! ```text
//! jerboa-ir 1  ; nodes 5  floats 2  conts 4  calls 1  …    the format's version; counters of what follows
//! table materials by rows classed                          a buffer and its columns: name, type, binding time
//!   class: u32 structure
//! entry cube = main                                        an entry
//!
//! fun pow(x: f32, n: i32, return: fn(f32)) @(known n)      role, name, parameters, filter
//!   y1 = eq n 0i                                           a pure node that the body needs
//!   branch y1 zero more                                    the one jump
//!   arm zero() @                                           a continuation that stands within the one above
//!     jump return(1.0)
//! ```
//!
//! A loop of independent iterations names its width, its bounds and its body: `vectorize 8 lo hi each(a) -> next`.
//! A store of a vector has its mask behind `when`: `store s.x i v when m -> next`.
//! A filter `true` is `@`, `false` is nothing. Names are the authors' hints, made unique within a function; lines without
//! a hint are numbered in print order, per function. Nesting shows scope and means nothing by itself: the parser reads
//! names only. A node stands in the innermost continuation around its users, whatever engine computes it where.
//! The lines of a `rest` or `join` stand at its own height, so that what runs in sequence reads in sequence.

mod layout;
mod names;

use std::fmt::Write;

use crate::lit::Lit;
use crate::program::*;
use crate::stats::Stats;
use crate::ty::{Ty, TyKind};
use names::Names;
pub(crate) use names::is_automatic;

/// The first words of every text: the format's version.
pub(crate) const HEADER: &str = "jerboa-ir 1";

/// Whether the text tells where each continuation was written.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum SourceLines {
    /// No: the same text wherever the sources lie.
    #[default]
    Hidden,
    /// As a comment behind each continuation.
    Shown,
}

/// The text of what the program's entries reach (or of everything where it has none).
pub fn print(p: &Program) -> String {
    print_with(p, SourceLines::Hidden)
}

/// The same, with or without source lines.
pub fn print_with(p: &Program, source: SourceLines) -> String {
    let layout = layout::Layout::new(p);
    let names = Names::new(p, &layout);
    let mut printer = Printer { p, layout: &layout, names, source, out: String::new() };
    printer.header();
    printer.shared();
    for root in &layout.roots {
        printer.tree(*root);
    }
    printer.out
}

struct Printer<'a> {
    p: &'a Program,
    layout: &'a layout::Layout,
    names: Names,
    source: SourceLines,
    out: String,
}

impl Printer<'_> {
    fn header(&mut self) {
        let stats = Stats::new(self.p, &self.layout.reach);
        self.out = format!("{HEADER}  ; {stats}\n");
        for (b, buffer) in self.p.buffers.iter().enumerate() {
            let kind = match buffer.kind {
                BufKind::Table { .. } => "table",
                BufKind::Stream => "stream",
            };
            let layout = match buffer.layout {
                Layout::Rows => "rows",
                Layout::Columns => "columns",
            };
            let classed = if buffer.kind == (BufKind::Table { classed: true }) { " classed" } else { "" };
            self.line(0, format!("{kind} {} by {layout}{classed}", self.names.buffers[b]));
            for (c, column) in buffer.columns.iter().enumerate() {
                let time = match column.time {
                    Time::Structure => "structure",
                    Time::Value => "value",
                    Time::Bulk => "bulk",
                };
                self.line(1, format!("{}: {} {time}", self.names.columns[b][c], self.ty(column.ty.ty())));
            }
        }
        for (name, cont) in &self.p.entries {
            self.line(0, format!("entry {} = {}", names::word(name), self.names.conts[cont.index()]));
        }
    }

    fn shared(&mut self) {
        if !self.layout.shared.is_empty() {
            self.out.push('\n');
        }
        for id in &self.layout.shared {
            self.line(0, format!("{} = {}", self.names.nodes[id], self.expression(*id, At::default())));
        }
    }

    /// A root and what it contains. No recursion: a long function nests deep.
    fn tree(&mut self, root: ContId) {
        self.out.push('\n');
        let mut stack = vec![(root, 0)];
        while let Some((c, indent)) = stack.pop() {
            self.line(indent, self.head(c));
            let flat = c != root && matches!(self.p.cont(c).role, Role::Rest | Role::Join);
            let inner = if flat { indent } else { indent + 1 };
            for id in &self.layout.lines[c.index()] {
                let text = format!(
                    "{} = {}",
                    self.names.nodes[id],
                    self.expression(*id, At { root: Some(root), filter: None })
                );
                self.line(inner, text);
            }
            self.line(inner, self.body(&self.p.cont(c).body, root));
            stack.extend(self.layout.children[c.index()].iter().rev().map(|child| (*child, inner)));
        }
    }

    fn line(&mut self, indent: usize, text: String) {
        writeln!(self.out, "{:1$}{text}", "", 2 * indent).expect("writing to a string");
    }

    fn head(&self, c: ContId) -> String {
        let cont = self.p.cont(c);
        let root = self.layout.tree[c.index()];
        let params: Vec<String> = (cont.params.iter().zip(&self.names.params[c.index()]))
            .map(|(x, name)| format!("{}{name}: {}", if x.keep { "keep " } else { "" }, self.ty(x.ty)))
            .collect();
        let mut text = format!("{} {}({})", cont.role.word(), self.names.conts[c.index()], params.join(", "));
        match self.p.node(cont.filter) {
            Node::Lit(Lit::Bool(true)) => text += " @",
            Node::Lit(Lit::Bool(false)) => {}
            _ => text += &format!(" @{}", self.operand(cont.filter, At { root, filter: Some(c) })),
        }
        let free = &self.layout.free[c.index()];
        let shown = self.source == SourceLines::Shown && cont.loc != Loc::NONE;
        if !free.is_empty() || shown {
            text += "  ;";
        }
        if !free.is_empty() {
            let free: Vec<String> = free.iter().map(|x| self.operand(*x, At { root, filter: None })).collect();
            text += &format!(" free: {}", free.join(", "));
        }
        if shown {
            text += &format!(" at {}", cont.loc);
        }
        text
    }

    /// The jump.
    fn body(&self, body: &Body, root: ContId) -> String {
        let op = |x: &NodeId| self.operand(*x, At { root: Some(root), filter: None });
        let mem = |m: &Mem| match m {
            Mem::Stream(column) => self.column(*column),
            Mem::Unchecked(column) => format!("unchecked {}", self.column(*column)),
            Mem::Local(array) => op(array),
        };
        match body {
            Body::Unset => "unset".to_owned(),
            Body::Jump { callee, args, mode } => {
                let mode = match mode {
                    Mode::Filter => "",
                    Mode::Now => "now ",
                    Mode::Later => "later ",
                };
                format!("jump {mode}{}({})", op(callee), args.iter().map(op).collect::<Vec<_>>().join(", "))
            }
            Body::Branch { cond, then, other } => format!("branch {} {} {}", op(cond), op(then), op(other)),
            Body::Switch { index, arms, default } => {
                let arms: String = arms.iter().map(|(number, arm)| format!("{number}: {}, ", op(arm))).collect();
                format!("switch {} {arm}else {}", op(index), op(default), arm = arms)
            }
            Body::Dispatch { row, arm } => format!("dispatch {} -> {}", op(row), op(arm)),
            Body::Load { mem: m, index, next } => format!("load {} {} -> {}", mem(m), op(index), op(next)),
            Body::Store { mem: m, index, value, mask, next } => {
                let when = if *mask == NodeId::NONE { String::new() } else { format!(" when {}", op(mask)) };
                format!("store {} {} {}{when} -> {}", mem(m), op(index), op(value), op(next))
            }
            Body::Vectorize { width, lo, hi, body, args, next } => {
                let args = args.iter().map(op).collect::<Vec<_>>().join(", ");
                format!("vectorize {width} {} {} {}({args}) -> {}", op(lo), op(hi), op(body), op(next))
            }
            Body::Local { scalar, len, next } => format!("local {} {len} -> {}", scalar.name(), op(next)),
        }
    }

    /// Word and operands of a node that computes.
    fn expression(&self, id: NodeId, at: At) -> String {
        let operand = |x: NodeId| self.operand(x, at);
        let list = |word: &str, xs: &[NodeId]| xs.iter().fold(word.to_owned(), |text, x| text + " " + &operand(*x));
        match self.p.node(id) {
            Node::Prim { op, args } => list(op.name(), &args[..op.arity()]),
            Node::Pack(elems) => list("pack", elems),
            Node::Tuple(elems) => list("tuple", elems),
            Node::Lane { vector, lane } => format!("lane {} {lane}", operand(*vector)),
            Node::Extract { tuple, index } => format!("extract {} {index}", operand(*tuple)),
            Node::Read { column, index } => format!("read {} {}", self.column(*column), operand(*index)),
            Node::Row { table, index } => format!("row {} {}", self.names.buffers[table.index()], operand(*index)),
            Node::Sibling { row, index } => format!("sibling {} {}", operand(*row), operand(*index)),
            Node::RowIndex(row) => format!("row_index {}", operand(*row)),
            Node::Known(x) => format!("known {}", operand(*x)),
            Node::Lit(_) | Node::Param { .. } | Node::Cont(_) => operand(id),
        }
    }

    /// A literal, a name, or (in filters) an expression.
    fn operand(&self, id: NodeId, at: At) -> String {
        match self.p.node(id) {
            Node::Lit(lit) => lit.to_string(),
            Node::Param { cont, index } => {
                self.name(&self.names.params[cont.index()][*index as usize], self.layout.tree[cont.index()], at)
            }
            Node::Cont(cont) => {
                let tree = self.layout.tree[cont.index()].filter(|tree| tree != cont);
                self.name(&self.names.conts[cont.index()], tree, at)
            }
            _ => {
                let named = at.filter.is_none_or(|c| self.layout.filter_names(c, id));
                match self.names.nodes.get(&id) {
                    Some(name) if named => {
                        let tree = self.layout.line_at[&id].and_then(|c| self.layout.tree[c.index()]);
                        self.name(name, tree, at)
                    }
                    _ => format!("({})", self.expression(id, at)),
                }
            }
        }
    }

    /// A name as seen from `at`. One of another function is qualified; that is a scope fault.
    fn name(&self, name: &str, tree: Option<ContId>, at: At) -> String {
        match tree {
            Some(tree) if at.root != Some(tree) => format!("{}::{name}", self.names.conts[tree.index()]),
            _ => name.to_owned(),
        }
    }

    fn column(&self, c: Column) -> String {
        format!("{}.{}", self.names.buffers[c.buf.index()], self.names.columns[c.buf.index()][c.col as usize])
    }

    /// As [`Ty`] displays, with the names of tables.
    fn ty(&self, ty: Ty) -> String {
        let list = |types: &[Ty]| types.iter().map(|t| self.ty(*t)).collect::<Vec<_>>().join(", ");
        match ty.kind() {
            TyKind::Tuple(elems) => format!("({})", list(elems)),
            TyKind::Fn(params) => format!("fn({})", list(params)),
            TyKind::Row(table) => format!("row({})", self.names.buffers[table.index()]),
            TyKind::Scalar(_) | TyKind::Vector(..) | TyKind::Local(..) => ty.to_string(),
        }
    }
}

/// From where an operand is seen: the root around it, and the continuation whose filter it stands in.
#[derive(Clone, Copy, Default)]
struct At {
    root: Option<ContId>,
    filter: Option<ContId>,
}
