//! The plane of a triangle, as `host::tables::plane` has it for triangles in the world.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::F32;

use crate::core::vec::Vec3;

/// The triangle test finds a plane through the origin of its ray within 8 · 2^-24 of the triangle's size, if that is well
/// shaped; without this part a surface in a coordinate plane, whose points have no error there, would meet its coincident
/// twin. A thin triangle's plane is found less well, by its size over its altitude; but no more than eight times is granted,
/// so that the whole stays below 1e-5 of the size (accuracy.md, T10).
pub const HIT_ERROR: f32 = 1.0 / 2_097_152.0;
/// See [`HIT_ERROR`].
pub const MOST_THIN: f32 = 8.0;

/// A triangle's plane, world.
#[derive(Clone, Copy)]
pub struct Plane {
    /// Unit normal, on the side where the corners run counter-clockwise.
    pub normal: Vec3,
    /// Largest difference of a coordinate between the first corner and another, m.
    pub size: F32,
    /// How far off the plane a ray that starts on it may find it, by coordinate, m.
    pub error: Vec3,
}
impl_staged!(Plane { normal, size, error });

impl Plane {
    /// The plane of these corners, by the very roundings of the host.
    pub fn of([p, q, r]: [Vec3; 3]) -> Plane {
        let edges = [q - p, r - p];
        let size = edges[0].abs().max_element().max(edges[1].abs().max_element());
        let [e, f] = edges.map(|edge| edge / size);
        let n = e.cross(f);
        let thin = (1.0 / n.abs().max_element()).min(MOST_THIN);
        let error = size * thin * HIT_ERROR;
        Plane { normal: n.normalize_scaled(), size, error: Vec3 { x: error, y: error, z: error } }
    }
}
