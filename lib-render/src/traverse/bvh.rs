//! Boxes: the nodes of the tree and the slab test.
//!
//! The test is Kay and Kajiya's (1986) in the form (b − o)·(1/d), planes ordered by the sign of 1/d, so that NaN (a ray
//! within the plane of a side) drops out. Instead of widening the exit by ulps (Ize 2013), which measures errors by the
//! distance of the box alone, boxes grow by a length that covers every error of the triangle test: its sheared corners
//! are off by at most 8 · 2^-24 of their distance from the origin of the ray. That length is one number per ray, so it is
//! added to the origin, costs nothing per box, and keeps entry and exit monotone in the box.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, F32, Row, U32};

use crate::core::vec::{Vec3, vec3};
use crate::ray::Ray;
use crate::schema::Nodes;

/// Bits of a word that name a slot; see `host::bvh`.
const SLOT_BITS: u32 = 27;
/// Marks a leaf.
const LEAF: u32 = 1 << 31;

/// Growth of boxes, in parts of the farthest corner of the scene's box: 16 · 2^-24, twice the bound of the triangle test.
const GROWTH: f32 = 1.0 / 1_048_576.0;
/// And in parts of the origin's coordinate, so that the sum is never rounded back: 2^-23.
const ULP: f32 = 1.0 / 8_388_608.0;

/// A box, world.
#[derive(Clone, Copy)]
pub struct Bounds {
    /// Smallest coordinates.
    pub lo: Vec3,
    /// Largest coordinates.
    pub hi: Vec3,
}
impl_staged!(Bounds { lo, hi });

/// A child of a node: an inner node, or a run of triangles.
#[derive(Clone, Copy)]
pub struct Child {
    /// As `host::bvh` encodes it: bit 31 marks a leaf, whose count stands in bits 27 to 30 and its first slot below; else
    /// the row of the node.
    pub word: U32,
}
impl_staged!(Child { word });

impl Child {
    /// The root.
    pub fn root() -> Child {
        Child { word: 0.into() }
    }

    /// A leaf without triangles.
    pub fn nothing() -> Child {
        Child { word: LEAF.into() }
    }

    /// Is it [`Child::nothing`]?
    pub fn is_nothing(self) -> Bool {
        self.word.eq(LEAF)
    }

    /// Is it a leaf?
    pub fn is_leaf(self) -> Bool {
        self.word.ge(LEAF)
    }

    /// A leaf's first slot, and the one after its last.
    pub fn slots(self) -> (U32, U32) {
        let first = self.word & ((1 << SLOT_BITS) - 1);
        (first, first + ((self.word & !LEAF) >> SLOT_BITS))
    }
}

/// Both children of an inner node.
pub fn read_children(b: &mut Block, node: Child) -> [(Bounds, Child); 2] {
    let mut read = |columns: [_; 6], child| {
        let [lo_x, lo_y, lo_z, hi_x, hi_y, hi_z] = columns.map(|column| b.read_unchecked::<_, F32>(column, node.word));
        let bounds = Bounds { lo: vec3(lo_x, lo_y, lo_z), hi: vec3(hi_x, hi_y, hi_z) };
        (bounds, Child { word: b.read_unchecked(child, node.word) })
    };
    use Nodes as N;
    [
        read([N::LO0_X, N::LO0_Y, N::LO0_Z, N::HI0_X, N::HI0_Y, N::HI0_Z], N::CHILD0),
        read([N::LO1_X, N::LO1_Y, N::LO1_Z, N::HI1_X, N::HI1_Y, N::HI1_Z], N::CHILD1),
    ]
}

/// The box of all triangles; where there are none, `lo` is +infinity.
pub fn scene_bounds() -> Bounds {
    use Nodes as N;
    let root = Row::<Nodes>::at(0u32);
    let corner = |x, y, z| vec3(root.get(x), root.get(y), root.get(z));
    let lo = corner(N::LO0_X, N::LO0_Y, N::LO0_Z).zip(corner(N::LO1_X, N::LO1_Y, N::LO1_Z), F32::min);
    let hi = corner(N::HI0_X, N::HI0_Y, N::HI0_Z).zip(corner(N::HI1_X, N::HI1_Y, N::HI1_Z), F32::max);
    Bounds { lo, hi }
}

/// The part of a ray within a box, in units of its direction.
#[derive(Clone, Copy)]
pub struct Span {
    /// No later than any hit in the box; at least 0.
    pub entry: F32,
    /// No earlier than any hit in the box. The box is missed where it lies before the entry.
    pub exit: F32,
}

/// A ray made ready for boxes.
#[derive(Clone, Copy)]
pub struct Slabs {
    /// 1/d.
    inv: Vec3,
    /// The origin, moved forward by the growth of boxes: for planes where the ray enters.
    org_entry: Vec3,
    /// And moved backward: for planes where it leaves.
    org_exit: Vec3,
}
impl_staged!(Slabs { inv, org_entry, org_exit });

impl Slabs {
    /// Make a ray ready.
    pub fn new(ray: Ray) -> Slabs {
        let scene = scene_bounds();
        let reach = (scene.lo - ray.org).abs().zip((scene.hi - ray.org).abs(), F32::max).max_element();
        let growth = ray.org.map(|o| reach * GROWTH + o.abs() * ULP);
        let inv = ray.dir.map(|d| 1.0 / d);
        let forward = growth.zip(inv, F32::copysign);
        Slabs { inv, org_entry: ray.org + forward, org_exit: ray.org - forward }
    }

    /// Where the ray enters and leaves a box. Monotone: a larger box is entered no later and left no earlier.
    pub fn span(self, bounds: Bounds) -> Span {
        let backward = [self.inv.x.lt(0.0), self.inv.y.lt(0.0), self.inv.z.lt(0.0)];
        let planes = |positive: Vec3, negative: Vec3, org: Vec3| {
            let plane = vec3(
                backward[0].select(negative.x, positive.x),
                backward[1].select(negative.y, positive.y),
                backward[2].select(negative.z, positive.z),
            );
            (plane - org).zip(self.inv, |distance, inv| distance * inv)
        };
        let entry = planes(bounds.lo, bounds.hi, self.org_entry);
        let exit = planes(bounds.hi, bounds.lo, self.org_exit);
        // The accumulator comes second: NaN gives it.
        Span {
            entry: entry.z.max(entry.y.max(entry.x.max(0.0))),
            exit: exit.z.min(exit.y.min(exit.x.min(f32::INFINITY))),
        }
    }
}
