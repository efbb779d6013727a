//! Environments: a chain of frames along the nesting tree of the generic program.
//!
//! A frame is one activation of a continuation: its arguments, and a dense row of cells for the pure nodes that it owns,
//! filled when they are asked for. Frames are hash-consed on *(continuation, parent, arguments)*: the same activation
//! twice is one frame, so whatever was computed in it is shared, and "same frame" is equality of ids.
//!
//! The frame of an enclosing continuation is found by its level, in logarithmic time, by the jump pointers of Myers
//! ("An applicative random-access stack", Information Processing Letters 17, 1983): straight-line code nests as deep as
//! it is long.

use std::hash::{Hash, Hasher};

use jerboa_ir::{ContId, Scope};
use rustc_hash::{FxHashMap, FxHasher};

use crate::log::TrailId;
use crate::value::{FrameId, Value};

/// One activation.
struct Frame {
    cont: ContId,
    parent: FrameId,
    /// A frame further out, chosen so that any level is reached in O(log) steps.
    jump: FrameId,
    /// 0 for the root; one more than the level of `cont` else.
    level: u32,
    /// First argument in [`Frames::args`].
    args: u32,
    /// First cell in [`Frames::cells`].
    cells: u32,
    /// The calls that led here.
    trail: TrailId,
    /// Next frame with the same hash.
    next: Option<FrameId>,
}

/// All frames of one specialisation.
pub(crate) struct Frames {
    frames: Vec<Frame>,
    args: Vec<Value>,
    cells: Vec<Value>,
    /// First frame of each hash.
    index: FxHashMap<u64, FrameId>,
}

/// The frame of constants, around all others.
pub(crate) const ROOT: FrameId = FrameId(0);

impl Frames {
    /// The root frame alone.
    pub fn new(scope: &Scope) -> Frames {
        let none = ContId(u32::MAX);
        let root = Frame {
            cont: none,
            parent: ROOT,
            jump: ROOT,
            level: 0,
            args: 0,
            cells: 0,
            trail: TrailId::NONE,
            next: None,
        };
        let cells = vec![Value::Nothing; scope.constants as usize];
        Frames { frames: vec![root], args: Vec::new(), cells, index: FxHashMap::default() }
    }

    fn at(&self, f: FrameId) -> &Frame {
        &self.frames[f.0 as usize]
    }

    /// The frame of `cont` inside `parent` with these arguments.
    pub fn enter(&mut self, scope: &Scope, cont: ContId, parent: FrameId, args: &[Value], trail: TrailId) -> FrameId {
        let mut hasher = FxHasher::default();
        (cont, parent, args).hash(&mut hasher);
        let hash = hasher.finish();
        let first = self.index.get(&hash).copied();
        let mut at = first;
        while let Some(f) = at {
            let frame = self.at(f);
            let from = frame.args as usize;
            if frame.cont == cont && frame.parent == parent && &self.args[from..from + args.len()] == args {
                return f;
            }
            at = frame.next;
        }
        let id = FrameId(self.frames.len() as u32);
        let (up, level) = (self.at(parent), scope.level[cont.index()] + 1);
        let (near, far) = (self.at(up.jump), self.at(self.at(up.jump).jump));
        let jump = if up.level - near.level == near.level - far.level { near.jump } else { parent };
        let frame = Frame {
            cont,
            parent,
            jump,
            level,
            args: self.args.len() as u32,
            cells: self.cells.len() as u32,
            trail,
            next: first,
        };
        self.frames.push(frame);
        self.args.extend_from_slice(args);
        self.cells.resize(self.cells.len() + scope.slots[cont.index()] as usize, Value::Nothing);
        self.index.insert(hash, id);
        id
    }

    /// The frame at `level` on the chain that starts at `f`.
    pub fn ancestor(&self, mut f: FrameId, level: u32) -> FrameId {
        loop {
            let frame = self.at(f);
            if frame.level <= level {
                return f;
            }
            f = if self.at(frame.jump).level >= level { frame.jump } else { frame.parent };
        }
    }

    /// The continuation whose activation this is.
    pub fn cont(&self, f: FrameId) -> ContId {
        self.at(f).cont
    }

    /// The frame around.
    pub fn parent(&self, f: FrameId) -> FrameId {
        self.at(f).parent
    }

    /// The calls that led here.
    pub fn trail(&self, f: FrameId) -> TrailId {
        self.at(f).trail
    }

    /// An argument.
    pub fn arg(&self, f: FrameId, index: u32) -> Value {
        self.args[(self.at(f).args + index) as usize]
    }

    /// The cell of a node.
    pub fn cell(&self, f: FrameId, slot: u32) -> Value {
        self.cells[(self.at(f).cells + slot) as usize]
    }

    /// Fill the cell of a node.
    pub fn set(&mut self, f: FrameId, slot: u32, value: Value) {
        let at = self.at(f).cells + slot;
        self.cells[at as usize] = value;
    }

    /// Number of frames and cells made: the memory that environments take.
    pub fn size(&self) -> usize {
        self.cells.len() + self.args.len() + 4 * self.frames.len()
    }
}
