//! One residual function as a naga function.

mod exit;
mod memory;
mod signature;
mod top;
mod value;

use jerboa_ir::cfg::{Cfg, Function};
use jerboa_ir::schedule::Schedule;
use jerboa_ir::{Body, BufId, ContId, Node, NodeId, Op, Program, Scalar, TyKind};
use naga::{Block, GlobalVariable, Handle, LocalVariable, Statement, SwitchCase, SwitchValue};
use rustc_hash::FxHashMap;

use crate::Grid;
use crate::code::{Code, Types, Value};
use crate::flow::{Leave, Piece};
use crate::launch::Launch;
use crate::uses::Uses;
use memory::Stores;
use top::Top;

/// What is known of a kernel before its functions are emitted.
pub(crate) struct Unit<'p> {
    pub program: &'p Program,
    pub cfg: Cfg,
    pub schedules: Vec<Schedule>,
    /// Pieces of each function.
    pub flows: Vec<Vec<Piece>>,
    pub grid: Grid,
    pub launch: Launch,
    /// Parameters that are used somewhere.
    pub params: FxHashMap<(ContId, u32), NodeId>,
    /// The storage buffer of the launch, of each buffer of the program, and of results.
    pub globals: Globals,
}

/// Storage buffers of the module.
pub(crate) struct Globals {
    pub launch: Handle<GlobalVariable>,
    pub buffers: Vec<Handle<GlobalVariable>>,
    pub results: Option<Handle<GlobalVariable>>,
}

/// What an emitted function costs.
#[derive(Clone, Copy, Default)]
pub(crate) struct Cost {
    /// Values that go through a local variable.
    pub spills: usize,
}

/// The scalars that a value of this type is made of.
pub(crate) fn scalars(types: impl IntoIterator<Item = jerboa_ir::Ty>) -> Vec<Scalar> {
    types.into_iter().filter_map(|ty| ty.lanes()).flat_map(|(s, n)| vec![s; n]).collect()
}

/// Emits a function; `callees` has those that it calls, by place in [`Cfg::functions`]. Function 0 is the entry.
pub(crate) fn emit(
    unit: &Unit,
    types: &mut Types,
    callees: &[Option<Handle<naga::Function>>],
    index: usize,
) -> (naga::Function, Cost) {
    let f = &unit.cfg.functions[index];
    let pieces = &unit.flows[index];
    let uses = Uses::new(unit.program, f, &unit.schedules[index], pieces);
    let mut e = Emitter {
        unit,
        types,
        callees,
        index,
        f,
        uses,
        code: Code::default(),
        at: 0,
        known: Vec::new(),
        far: FxHashMap::default(),
        params: FxHashMap::default(),
        arrays: FxHashMap::default(),
        tops: FxHashMap::default(),
        stores: None,
        exit: None,
    };
    e.begin();
    e.pieces(pieces);
    let cost = Cost { spills: e.far.values().map(Vec::len).sum() };
    (e.code.finish(), cost)
}

/// A value that is known in a naga block.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Known {
    /// A lane of a node.
    Lane(NodeId, usize),
    /// The row of a buffer for an index: the last one, if the index is beyond.
    Row(BufId, Value),
    /// An operation on these operands.
    Result(Op, [Option<Value>; 3]),
    /// Words from the first row of a buffer to this one.
    Distance(BufId, Value),
}

struct Emitter<'a> {
    unit: &'a Unit<'a>,
    types: &'a mut Types,
    callees: &'a [Option<Handle<naga::Function>>],
    index: usize,
    f: &'a Function,
    uses: Uses,
    code: Code,
    /// The block at hand.
    at: u32,
    /// What each open naga block knows, innermost last.
    known: Vec<FxHashMap<Known, Value>>,
    /// Places of the lanes of nodes that are used out of the naga block that computes them.
    far: FxHashMap<(NodeId, u32), Vec<Place>>,
    /// Places of the lanes of parameters of blocks that several go on in.
    params: FxHashMap<NodeId, Vec<Place>>,
    /// Local arrays, by the block whose parameter they are.
    arrays: FxHashMap<u32, Array>,
    /// What stands where the function begins.
    tops: FxHashMap<Top, Value>,
    /// Stores that are still to be made.
    stores: Option<Stores>,
    /// Which exit is under way.
    exit: Option<Handle<LocalVariable>>,
}

/// Where a scalar lies that its naga block does not show to all who use it.
#[derive(Clone, Copy)]
struct Place {
    variable: Handle<LocalVariable>,
    scalar: Scalar,
    /// Is it in memory, see [`Uses::is_kept`]? Then it is an element of an array; which one, no driver knows.
    kept: bool,
}

/// Elements of the array of a scalar that is kept. Of one alone a driver would know which.
const KEPT: u32 = 2;

/// A local array.
#[derive(Clone, Copy)]
struct Array {
    variable: Handle<LocalVariable>,
    scalar: Scalar,
    len: u32,
}

impl Emitter<'_> {
    /// Arguments and variables.
    fn begin(&mut self) {
        let p = self.unit.program;
        self.signature();
        for (node, def) in self.uses.far.clone() {
            let places = self.places(node, "far");
            self.far.insert((node, def), places);
        }
        for (number, block) in self.f.blocks.iter().enumerate().skip(1) {
            let params = 0..p.cont(block.cont).params.len() as u32;
            for param in params.filter_map(|i| self.unit.params.get(&(block.cont, i)).copied()) {
                match p.ty(param).kind() {
                    TyKind::Local(scalar, len) => {
                        let variable = self.array_variable("array", *scalar, *len);
                        self.arrays.insert(number as u32, Array { variable, scalar: *scalar, len: *len });
                    }
                    _ if block.preds.len() > 1 && self.uses.is_used(param) => {
                        let places = self.places(param, &p.cont(block.cont).name);
                        self.params.insert(param, places);
                    }
                    _ => {}
                }
            }
        }
    }

    /// A place for each lane of a value.
    fn places(&mut self, x: NodeId, name: &str) -> Vec<Place> {
        let p = self.unit.program;
        let hint = match p.node(x) {
            Node::Param { cont, index } => p.cont(*cont).params[*index as usize].name.as_deref(),
            _ => p.names.get(&x).map(|n| &**n),
        };
        let name = hint.map_or(name.to_owned(), |hint| format!("{name}_{hint}"));
        let kept = self.uses.is_kept(x);
        let place = |scalar: Scalar| {
            let variable = if kept { self.array_variable(&name, scalar, KEPT) } else { self.variable(&name, scalar) };
            Place { variable, scalar, kept }
        };
        scalars([p.ty(x)]).into_iter().map(place).collect()
    }

    /// An array. A `bool` in memory is a word.
    fn array_variable(&mut self, name: &str, scalar: Scalar, len: u32) -> Handle<LocalVariable> {
        let element = if scalar == Scalar::Bool { Scalar::U32 } else { scalar };
        let ty = self.types.array(element, Some(len));
        self.code.variable(name, ty)
    }

    fn variable(&mut self, name: &str, scalar: Scalar) -> Handle<LocalVariable> {
        let ty = self.types.scalar(scalar);
        self.code.variable(name, ty)
    }

    /// A naga block of these pieces.
    fn block(&mut self, pieces: &[Piece]) -> Block {
        self.open();
        self.pieces_inside(pieces);
        self.close()
    }

    fn open(&mut self) {
        self.code.open();
        self.known.push(FxHashMap::default());
    }

    fn close(&mut self) -> Block {
        self.make_stores();
        self.known.pop();
        self.code.close()
    }

    /// The whole function.
    fn pieces(&mut self, pieces: &[Piece]) {
        self.open();
        self.pieces_inside(pieces);
        self.make_stores();
    }

    fn pieces_inside(&mut self, pieces: &[Piece]) {
        for piece in pieces {
            match piece {
                Piece::Code(block) => self.block_code(*block),
                _ => {
                    self.make_stores();
                    self.control(piece);
                }
            }
        }
    }

    fn control(&mut self, piece: &Piece) {
        match piece {
            Piece::Code(_) => unreachable!("code is no control"),
            Piece::Choice { block, arms } => self.choice(*block, arms),
            Piece::Label(body) => {
                let selector = self.code.u32(0);
                let body = self.block(body);
                let cases = vec![SwitchCase { value: SwitchValue::Default, body, fall_through: false }];
                self.code.push(Statement::Switch { selector, cases });
            }
            Piece::Loop(body) => {
                let body = self.block(body);
                self.code.repeat(body);
            }
            Piece::Leave(leave) => self.leave(*leave),
            Piece::Far(number) => {
                self.set_exit(*number);
                self.leave(Leave::Break);
            }
            Piece::Reset => self.set_exit(0),
            Piece::Arrive(number, leave) => {
                let exit = self.exit_variable();
                let under_way = self.code.get(exit);
                let number = self.code.u32(*number);
                let arrived = self.code.binary(naga::BinaryOperator::Equal, under_way, number);
                self.open();
                self.leave(*leave);
                let accept = self.close();
                self.code.branch(arrived, accept, Block::new());
            }
        }
    }

    fn leave(&mut self, leave: Leave) {
        self.code.push(match leave {
            Leave::Break => Statement::Break,
            Leave::Continue => Statement::Continue,
        });
    }

    fn exit_variable(&mut self) -> Handle<LocalVariable> {
        match self.exit {
            Some(exit) => exit,
            None => {
                let exit = self.variable("exit", Scalar::U32);
                *self.exit.insert(exit)
            }
        }
    }

    fn set_exit(&mut self, number: u32) {
        let exit = self.exit_variable();
        let number = self.code.u32(number);
        self.code.set(exit, number);
    }

    /// Which arm a block goes on in: an `if`, or a switch where there are more than two.
    fn choice(&mut self, block: u32, arms: &[Vec<Piece>]) {
        self.at = block;
        match &self.unit.program.cont(self.f.blocks[block as usize].cont).body {
            Body::Branch { cond, .. } => {
                let cond = self.lane(*cond, 0);
                let (accept, reject) = (self.block(&arms[0]), self.block(&arms[1]));
                self.code.branch(cond, accept, reject);
            }
            Body::Switch { index, arms: numbers, default } => {
                let index = self.lane(*index, 0);
                let succ = |arm: NodeId| self.succ(block, arm);
                let default = succ(*default);
                let numbers: Vec<(u32, usize)> = numbers.iter().map(|(n, arm)| (*n, succ(*arm))).collect();
                match arms {
                    [_, _] => self.two_way(index, &numbers, default, arms),
                    _ => self.many_way(index, &numbers, default, arms),
                }
            }
            _ => unreachable!("only these two have arms"),
        }
    }

    /// A switch between two arms is a comparison.
    fn two_way(&mut self, index: Value, numbers: &[(u32, usize)], default: usize, arms: &[Vec<Piece>]) {
        let c = &mut self.code;
        let other = numbers.iter().filter(|(_, arm)| *arm != default).map(|(n, _)| *n);
        let is = other.map(|n| {
            let n = c.u32(n);
            c.binary(naga::BinaryOperator::Equal, index, n)
        });
        let is: Vec<Value> = is.collect();
        let any = is.into_iter().reduce(|a, b| c.binary(naga::BinaryOperator::LogicalOr, a, b));
        let any = any.expect("there are two successors");
        let (accept, reject) = (self.block(&arms[1 - default]), self.block(&arms[default]));
        self.code.branch(any, accept, reject);
    }

    fn many_way(&mut self, selector: Value, numbers: &[(u32, usize)], default: usize, arms: &[Vec<Piece>]) {
        let mut cases = Vec::new();
        for (arm, pieces) in arms.iter().enumerate() {
            let mut values: Vec<SwitchValue> =
                numbers.iter().filter(|(_, to)| *to == arm).map(|(n, _)| SwitchValue::U32(*n)).collect();
            if arm == default {
                values = vec![SwitchValue::Default];
            }
            let last = values.pop().expect("a successor has a number");
            let through = |value| SwitchCase { value, body: Block::new(), fall_through: true };
            cases.extend(values.into_iter().map(through));
            cases.push(SwitchCase { value: last, body: self.block(pieces), fall_through: false });
        }
        self.code.push(Statement::Switch { selector, cases });
    }

    /// Place of an arm's block among the successors of a block.
    fn succ(&self, block: u32, arm: NodeId) -> usize {
        let number = self.f.number[&self.target(arm)];
        let succs = &self.f.blocks[block as usize].succs;
        succs.iter().position(|s| *s == number).expect("an arm is a successor")
    }

    /// The block that an arm goes on in.
    fn target(&self, arm: NodeId) -> ContId {
        match self.unit.program.node(arm) {
            Node::Cont(cont) => *cont,
            _ => unreachable!("the analysis of control flow found a block here"),
        }
    }
}
