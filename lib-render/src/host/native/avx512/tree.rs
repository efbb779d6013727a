//! The tree of the native walk: nodes of eight boxes and leaves of eight triangles, each a few whole lines of the cache.

use crate::host::bvh::collapse::Cuts;
use crate::host::bvh::pages::with_room;
use crate::host::bvh::prefilter::Usable;
use crate::host::bvh::tree::{NodeId, Tree};
use crate::host::bvh::{Bounds, Triangle, first_that_fits};
use crate::schema::NONE;

/// Children of a node, and triangles of a leaf.
pub(super) const WIDTH: usize = 8;
/// Marks a reference to a leaf.
pub(super) const LEAF: u32 = 1 << 31;
/// Most children that wait while a walk is anywhere in a tree. Median splits, of 24 levels, need no more.
pub(super) const MAX_WAITING: usize = 24 * (WIDTH - 1);

/// A line of the cache: two rows of eight words.
#[repr(align(64))]
#[derive(Clone, Copy)]
pub(super) struct Line(pub [[u32; WIDTH]; 2]);

/// Eight rows: for each axis the least, then the largest coordinates of eight boxes; then references to the children; then
/// nothing. A missing child has the box of nothing, which no ray enters.
pub(super) type Node = [Line; 4];

/// Ten rows: x, y, z of the first corners, of the second, of the third; then the primitives' numbers. A missing triangle has
/// NaN for coordinates.
pub(super) type Leaf = [Line; 5];

/// A row of a node or leaf.
#[inline]
pub(super) fn row<const N: usize>(lines: &[Line; N], row: usize) -> &[u32; WIDTH] {
    &lines[row / 2].0[row % 2]
}

/// The row of a node that has the references.
pub(super) const CHILDREN: usize = 6;
/// The row of a leaf that has the numbers.
pub(super) const PRIMITIVES: usize = 9;

/// The leaf without triangles, the first.
pub(super) const NOTHING: u32 = LEAF;

/// Where the root is: behind the leaf without triangles.
pub(super) const ROOT: u32 = 5;

/// The tree. A reference to a child says at which line it begins; that of a leaf has [`LEAF`].
pub(in crate::host::native) struct WideTree {
    /// The leaf without triangles; then depth first a node, its leaves, the nodes below it, the larger first.
    lines: Vec<Line>,
    /// Around all triangles of the scene.
    pub bounds: Bounds,
    /// Children that wait at most while a walk is anywhere in the tree; at most [`MAX_WAITING`].
    waiting: usize,
}

impl WideTree {
    /// The tree over the usable ones of triangles. The rest of the scene lies in a box.
    pub fn new(triangles: &[Triangle], usable: &Usable, others: Bounds) -> WideTree {
        let lay_out = |tree: &Tree| Writer::write(tree, &usable.numbers, triangles, others);
        first_that_fits(&usable.bounds, lay_out, |tree| tree.waiting <= MAX_WAITING)
    }

    /// The node of a reference.
    #[inline]
    pub(super) fn node(&self, reference: u32) -> &Node {
        self.lines[reference as usize..].first_chunk().expect("references lead to nodes")
    }

    /// The leaf of a reference.
    #[inline]
    pub(super) fn leaf(&self, reference: u32) -> &Leaf {
        self.lines[(reference & !LEAF) as usize..].first_chunk().expect("references lead to leaves")
    }

    /// Where a child is in memory.
    #[inline]
    pub(super) fn address(&self, reference: u32) -> *const Line {
        self.lines.as_ptr().wrapping_add((reference & !LEAF) as usize)
    }
}

struct Writer<'a> {
    tree: &'a Tree,
    cuts: Cuts<'a, WIDTH>,
    /// Of each box, the number of its triangle.
    numbers: &'a [u32],
    triangles: &'a [Triangle],
    out: WideTree,
}

impl Writer<'_> {
    fn write(tree: &Tree, numbers: &[u32], triangles: &[Triangle], others: Bounds) -> WideTree {
        let out = WideTree { lines: Vec::new(), bounds: tree.bounds().union(&others), waiting: 0 };
        let mut writer = Writer { tree, cuts: Cuts::new(tree), numbers, triangles, out };
        writer.leaf(&[]);
        writer.node(tree.root(), 0);
        let written = std::mem::take(&mut writer.out.lines);
        writer.out.lines = with_room(written.len());
        writer.out.lines.extend(written);
        writer.out
    }

    /// Writes a node in place of a binary subtree, while so many children wait; the recursion is as deep as the tree, which is
    /// bounded.
    fn node(&mut self, top: NodeId, waiting: usize) -> u32 {
        let children = self.cuts.children(top);
        let waiting = waiting + children.len().saturating_sub(1);
        self.out.waiting = self.out.waiting.max(waiting);
        let start = self.out.lines.len();
        self.out.lines.extend([Line([[0; WIDTH]; 2]); 4]);
        let mut references = [NOTHING; WIDTH];
        for (reference, child) in references.iter_mut().zip(&children) {
            if self.cuts.is_leaf(*child) {
                let mut members = Vec::new();
                self.tree.members(*child, &mut members);
                *reference = self.leaf(&members);
            }
        }
        for (reference, child) in references.iter_mut().zip(&children) {
            if !self.cuts.is_leaf(*child) {
                *reference = self.node(*child, waiting);
            }
        }
        let bounds = |lane: usize| children.get(lane).map_or(Bounds::EMPTY, |child| self.tree.bounds_of(*child));
        let plane = |row: usize, lane: usize| match row % 2 {
            0 => bounds(lane).lo[row / 2].to_bits(),
            _ => bounds(lane).hi[row / 2].to_bits(),
        };
        let planes = |row: usize| std::array::from_fn(|lane| plane(row, lane));
        let rows = |row: usize| if row == CHILDREN { references } else { [0; WIDTH] };
        for row in 0..8 {
            self.out.lines[start + row / 2].0[row % 2] = if row < CHILDREN { planes(row) } else { rows(row) };
        }
        start as u32
    }

    /// Writes a leaf.
    fn leaf(&mut self, members: &[u32]) -> u32 {
        let number = |lane: usize| members.get(lane).map(|member| self.numbers[*member as usize]);
        let coordinate = |row: usize, lane: usize| {
            number(lane).map_or(f32::NAN, |number| self.triangles[number as usize][row / 3][row % 3]).to_bits()
        };
        let word = |row: usize, lane: usize| {
            if row == PRIMITIVES { number(lane).unwrap_or(NONE) } else { coordinate(row, lane) }
        };
        let start = self.out.lines.len() as u32;
        let row = |row: usize| std::array::from_fn(|lane| word(row, lane));
        self.out.lines.extend((0..5).map(|line| Line([row(2 * line), row(2 * line + 1)])));
        LEAF | start
    }
}
