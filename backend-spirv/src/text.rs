//! A kernel as structured text: the tree of each function, with what each block computes, in the words of
//! [`mod@jerboa_ir::print`].
//!
//! ```text
//! fun find(x: f32, n: u32) -> u32
//!   find:
//!     head(0u)                                what a block passes on
//!   label leave                               left by `break leave`
//!     loop head                               begun again by `continue head`, or at its end
//!       head(i):                              a block and its parameters
//!         inside = lt i n                     a node
//!       unless inside                         a choice; an arm without anything is left out
//!         break leave
//!       look:
//!         y = load rows.x i
//! ```

use std::fmt::Write;

use jerboa_ir::cfg::{Cfg, Exit, Function};
use jerboa_ir::schedule::Schedule;
use jerboa_ir::structure::Step;
use jerboa_ir::{Body, Column, ContId, Mem, Node, NodeId, Program};
use rustc_hash::{FxHashMap, FxHashSet};

/// The functions of a kernel.
pub(crate) fn structured(p: &Program, cfg: &Cfg, schedules: &[Schedule], trees: &[Vec<Step>]) -> String {
    let mut out = String::new();
    let mut functions = Names::default();
    let functions: FxHashMap<ContId, String> =
        cfg.functions.iter().map(|f| (f.cont, functions.fresh(&p.cont(f.cont).name))).collect();
    for ((f, schedule), tree) in cfg.functions.iter().zip(schedules).zip(trees) {
        let mut printer = Printer::new(p, f, schedule, &functions);
        printer.head();
        printer.steps(1, tree);
        out += &printer.out;
        out.push('\n');
    }
    out
}

/// Names that are taken in a function.
#[derive(Default)]
struct Names {
    taken: FxHashSet<String>,
    values: usize,
}

impl Names {
    /// The hint, with a number behind it where it is taken.
    fn fresh(&mut self, hint: &str) -> String {
        let numbered = |i: usize| if i == 1 { hint.to_owned() } else { format!("{hint}_{i}") };
        let name = (1..).map(numbered).find(|name| !self.taken.contains(name)).expect("there is always another");
        self.taken.insert(name.clone());
        name
    }

    /// The name of a value: its hint, or the next number.
    fn value(&mut self, hint: Option<&str>) -> String {
        match hint {
            Some(hint) => self.fresh(hint),
            None => {
                self.values += 1;
                self.fresh(&format!("y{}", self.values))
            }
        }
    }
}

struct Printer<'a> {
    p: &'a Program,
    f: &'a Function,
    schedule: &'a Schedule,
    functions: &'a FxHashMap<ContId, String>,
    blocks: Vec<String>,
    params: FxHashMap<(ContId, u32), String>,
    nodes: FxHashMap<NodeId, String>,
    out: String,
}

impl<'a> Printer<'a> {
    fn new(
        p: &'a Program,
        f: &'a Function,
        schedule: &'a Schedule,
        functions: &'a FxHashMap<ContId, String>,
    ) -> Printer<'a> {
        let mut names = Names::default();
        let blocks = f.blocks.iter().map(|b| names.fresh(&p.cont(b.cont).name)).collect();
        let (mut params, mut nodes) = (FxHashMap::default(), FxHashMap::default());
        for (block, computed) in f.blocks.iter().zip(&schedule.blocks) {
            for (i, param) in p.cont(block.cont).params.iter().enumerate() {
                params.insert((block.cont, i as u32), names.value(param.name.as_deref()));
            }
            for x in computed {
                // A node that several blocks compute has one name.
                nodes.entry(*x).or_insert_with(|| names.value(p.names.get(x).map(|n| &**n)));
            }
        }
        Printer { p, f, schedule, functions, blocks, params, nodes, out: String::new() }
    }

    fn line(&mut self, indent: usize, text: &str) {
        writeln!(self.out, "{:1$}{text}", "", 2 * indent).expect("writing to a string");
    }

    fn head(&mut self) {
        let cont = self.p.cont(self.f.cont);
        let (ret, params) = cont.params.split_last().expect("a function has a return");
        let param = |(i, x): (usize, &jerboa_ir::Param)| format!("{}: {}", self.params[&(self.f.cont, i as u32)], x.ty);
        let params: Vec<String> = params.iter().enumerate().map(param).collect();
        let results: Vec<String> = ret.ty.params().unwrap_or_default().iter().map(|ty| ty.to_string()).collect();
        let results = if results.is_empty() { String::new() } else { format!(" -> {}", results.join(", ")) };
        let text = format!("fun {}({}){results}", self.functions[&self.f.cont], params.join(", "));
        self.line(0, &text);
    }

    fn steps(&mut self, indent: usize, steps: &[Step]) {
        for step in steps {
            match step {
                Step::Block(block) => self.block(indent, *block),
                Step::Choice { block, arms } => {
                    self.block(indent, *block);
                    self.choice(indent, *block, arms);
                }
                Step::Label { join, body } => self.piece(indent, "label", *join, body),
                Step::Loop { header, body } => self.piece(indent, "loop", *header, body),
                Step::Break(join) => self.line(indent, &format!("break {}", self.blocks[*join as usize])),
                Step::Continue(header) => self.line(indent, &format!("continue {}", self.blocks[*header as usize])),
            }
        }
    }

    fn piece(&mut self, indent: usize, word: &str, block: u32, body: &[Step]) {
        let text = format!("{word} {}", self.blocks[block as usize]);
        self.line(indent, &text);
        self.steps(indent + 1, body);
    }

    fn block(&mut self, indent: usize, block: u32) {
        let cont = self.f.blocks[block as usize].cont;
        let name = &self.blocks[block as usize];
        let head = match block {
            0 => format!("{name}:"),
            _ => match self.params_of(cont)[..] {
                [] => format!("{name}:"),
                ref params => format!("{name}({}):", params.join(", ")),
            },
        };
        self.line(indent, &head);
        for x in &self.schedule.blocks[block as usize] {
            let text = format!("{} = {}", self.nodes[x], self.expression(*x));
            self.line(indent + 1, &text);
        }
        if let Some(text) = self.exit(cont) {
            self.line(indent + 1, &text);
        }
    }

    /// What the jump of a block does, but for a choice.
    fn exit(&self, cont: ContId) -> Option<String> {
        let list = |xs: &[NodeId]| xs.iter().map(|x| self.operand(*x)).collect::<Vec<_>>().join(", ");
        match Exit::of(self.p, cont).ok()? {
            Exit::Return([]) => Some("return".into()),
            Exit::Return(values) => Some(format!("return {}", list(values))),
            Exit::Jump { args: [], .. } => None,
            Exit::Jump { block, args } => Some(format!("{}({})", self.name_of(block), list(args))),
            Exit::Call { callee, args, back } => {
                let call = format!("call {}({})", self.functions[&callee], list(args));
                Some(match back {
                    Some(back) => self.bound(back, call),
                    None => format!("return {call}"),
                })
            }
            Exit::Arms => self.effect(&self.p.cont(cont).body),
        }
    }

    fn effect(&self, body: &Body) -> Option<String> {
        let op = |x: &NodeId| self.operand(*x);
        let mem = |m: &Mem| match m {
            Mem::Stream(column) => self.column(*column),
            Mem::Unchecked(column) => format!("unchecked {}", self.column(*column)),
            Mem::Local(array) => op(array),
        };
        Some(match body {
            Body::Load { mem: m, index, next } => {
                self.bound(self.target(*next)?, format!("load {} {}", mem(m), op(index)))
            }
            Body::Store { mem: m, index, value, mask, .. } => {
                let when = if *mask == NodeId::NONE { String::new() } else { format!(" when {}", op(mask)) };
                format!("store {} {} {}{when}", mem(m), op(index), op(value))
            }
            Body::Vectorize { lo, hi, body, args, .. } => {
                let args = args.iter().map(op).collect::<Vec<_>>().join(", ");
                format!("vectorize {} {} {}({args})", op(lo), op(hi), self.functions[&self.target(*body)?])
            }
            Body::Local { scalar, len, next } => {
                self.bound(self.target(*next)?, format!("local {} {len}", scalar.name()))
            }
            Body::Unset | Body::Jump { .. } | Body::Branch { .. } | Body::Switch { .. } | Body::Dispatch { .. } => {
                return None;
            }
        })
    }

    /// What goes to the parameters of a block.
    fn bound(&self, block: ContId, text: String) -> String {
        match self.params_of(block)[..] {
            [] => text,
            ref params => format!("{} = {text}", params.join(", ")),
        }
    }

    fn choice(&mut self, indent: usize, block: u32, arms: &[Vec<Step>]) {
        let f = self.f;
        let succs = &f.blocks[block as usize].succs;
        match &self.p.cont(f.blocks[block as usize].cont).body {
            Body::Branch { cond, .. } => {
                let cond = self.operand(*cond);
                match (&arms[0][..], &arms[1][..]) {
                    ([], other) => {
                        self.line(indent, &format!("unless {cond}"));
                        self.steps(indent + 1, other);
                    }
                    (then, other) => {
                        self.line(indent, &format!("if {cond}"));
                        self.steps(indent + 1, then);
                        if !other.is_empty() {
                            self.line(indent, "else");
                            self.steps(indent + 1, other);
                        }
                    }
                }
            }
            Body::Switch { index, arms: numbers, default } => {
                self.line(indent, &format!("switch {}", self.operand(*index)));
                for (succ, steps) in succs.iter().zip(arms) {
                    let is = |arm: NodeId| self.target(arm) == Some(f.blocks[*succ as usize].cont);
                    let mut cases: Vec<String> =
                        numbers.iter().filter(|(_, arm)| is(*arm)).map(|(n, _)| n.to_string()).collect();
                    cases.extend(is(*default).then(|| "else".to_owned()));
                    self.line(indent + 1, &format!("{}:", cases.join(", ")));
                    self.steps(indent + 2, steps);
                }
            }
            _ => {}
        }
    }

    fn expression(&self, x: NodeId) -> String {
        let list =
            |word: &str, xs: &[NodeId]| xs.iter().fold(word.to_owned(), |text, x| text + " " + &self.operand(*x));
        match self.p.node(x) {
            Node::Prim { op, args } => list(op.name(), &args[..op.arity()]),
            Node::Pack(elems) => list("pack", elems),
            Node::Lane { vector, lane } => format!("lane {} {lane}", self.operand(*vector)),
            Node::Read { column, index } => format!("read {} {}", self.column(*column), self.operand(*index)),
            other => format!("{other:?}"),
        }
    }

    fn operand(&self, x: NodeId) -> String {
        match self.p.node(x) {
            Node::Lit(lit) => lit.to_string(),
            Node::Param { cont, index } => self.params[&(*cont, *index)].clone(),
            _ => self.nodes[&x].clone(),
        }
    }

    fn params_of(&self, cont: ContId) -> Vec<&str> {
        (0..self.p.cont(cont).params.len() as u32).map(|i| &*self.params[&(cont, i)]).collect()
    }

    fn name_of(&self, cont: ContId) -> &str {
        &self.blocks[self.f.number[&cont] as usize]
    }

    fn target(&self, x: NodeId) -> Option<ContId> {
        match self.p.node(x) {
            Node::Cont(cont) => Some(*cont),
            _ => None,
        }
    }

    fn column(&self, c: Column) -> String {
        format!("{}.{}", self.p.buffer(c.buf).name, self.p.column(c).name)
    }
}
