//! The heap of the interpreter: frames, vectors, tuples and local arrays, in one array of cells.
//!
//! An object is a head, which says how many cells follow, and these cells. Nothing is freed by hand: between two jumps the
//! machine copies what it still reaches and drops the rest (Cheney, CACM 1970). So loops run in bounded memory, and a
//! frame may hold a closure over itself.

use crate::lit::Lit;
use crate::program::ContId;

/// A place in the heap: an object's head.
pub(super) type At = u32;

/// What a cell holds.
#[derive(Clone, Copy, Debug)]
pub(super) enum Value {
    /// Not evaluated yet.
    Absent,
    /// A scalar; a row of a table is the `u32` of its index.
    Lit(Lit),
    /// A continuation and the frame around it.
    Closure { cont: ContId, frame: At },
    /// A vector, a tuple, a local array or a frame.
    Object(At),
    /// The head of an object of so many cells.
    Head(u32),
    /// The head of an object that the collector has copied, and where to.
    Moved(At),
}

/// All cells, and when to collect.
pub(super) struct Heap {
    cells: Vec<Value>,
    spare: Vec<Value>,
    collect_at: usize,
}

impl Heap {
    /// Cells before the first collection: 3 MiB, which stays in a core's cache.
    const FIRST: usize = 1 << 18;

    pub fn new() -> Heap {
        Heap { cells: Vec::new(), spare: Vec::new(), collect_at: Heap::FIRST }
    }

    /// A new object, every cell `fill`.
    pub fn filled(&mut self, len: usize, fill: Value) -> At {
        let at = self.cells.len();
        self.cells.push(Value::Head(len as u32));
        self.cells.resize(at + 1 + len, fill);
        at as At
    }

    /// A new object of these cells.
    pub fn object(&mut self, cells: impl Iterator<Item = Value>) -> At {
        let at = self.cells.len();
        self.cells.push(Value::Absent);
        self.cells.extend(cells);
        self.cells[at] = Value::Head((self.cells.len() - at - 1) as u32);
        at as At
    }

    pub fn get(&self, object: At, cell: usize) -> Value {
        self.cells[object as usize + 1 + cell]
    }

    pub fn set(&mut self, object: At, cell: usize, value: Value) {
        self.cells[object as usize + 1 + cell] = value;
    }

    pub fn cells(&self, object: At) -> &[Value] {
        let at = object as usize;
        match self.cells[at] {
            Value::Head(len) => &self.cells[at + 1..][..len as usize],
            _ => unreachable!("an object starts with its head"),
        }
    }

    /// Is it time to collect?
    pub fn is_due(&self) -> bool {
        self.cells.len() > self.collect_at
    }

    /// Keep what the roots reach, drop the rest; the number of cells that are left.
    pub fn collect(&mut self, roots: &mut [Value]) -> usize {
        let mut to = std::mem::take(&mut self.spare);
        to.clear();
        for root in roots {
            self.forward(&mut to, root);
        }
        let mut scanned = 0;
        while scanned < to.len() {
            let mut value = to[scanned];
            self.forward(&mut to, &mut value);
            to[scanned] = value;
            scanned += 1;
        }
        self.spare = std::mem::replace(&mut self.cells, to);
        self.collect_at = Heap::FIRST.max(2 * self.cells.len());
        self.cells.len()
    }

    /// Copy the object that a value points at, if it is not copied yet, and point at the copy.
    fn forward(&mut self, to: &mut Vec<Value>, value: &mut Value) {
        let (Value::Closure { frame: at, .. } | Value::Object(at)) = value else { return };
        let head = *at as usize;
        *at = match self.cells[head] {
            Value::Moved(copy) => copy,
            Value::Head(len) => {
                let copy = to.len() as At;
                to.extend_from_slice(&self.cells[head..=head + len as usize]);
                self.cells[head] = Value::Moved(copy);
                copy
            }
            _ => unreachable!("an object starts with its head"),
        };
    }
}
