//! Triangle meshes and where they stand.

use glam::{DAffine3, Vec2, Vec3, Vec4};

/// Triangles of one material in a local frame: one per glTF primitive.
///
/// Every number is finite and every index in range. Triangles may still be degenerate (zero area).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The author's name, for messages.
    pub name: String,
    /// Vertex positions, local frame.
    pub positions: Vec<Vec3>,
    /// Shading normals, one per vertex, unit length up to the file's rounding; a zero vector means "none at this
    /// vertex: take the geometric normal". `None` means flat shading.
    pub normals: Option<Vec<Vec3>>,
    /// Tangents (xyz along +u, w = ±1 the sign of the bitangent w·(n × t)), only beside normals. Without them a normal
    /// map's frame follows from positions and texture coordinates.
    pub tangents: Option<Vec<Vec4>>,
    /// Texture coordinates of sets 0 and 1; v = 0 is the top row of an image.
    pub uvs: [Option<Vec<Vec2>>; 2],
    /// Linear RGBA in 0..=1 that multiplies the base colour, interpolated over the triangle.
    pub colors: Option<Vec<Vec4>>,
    /// Vertex indices, counter-clockwise seen from the front: the geometric normal is (p1 − p0) × (p2 − p0).
    pub triangles: Vec<[u32; 3]>,
    /// Index into [`Scene::materials`](crate::Scene::materials).
    pub material: usize,
}

/// A mesh placed in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// Index into [`Scene::meshes`](crate::Scene::meshes).
    pub mesh: usize,
    /// Local to world, composed in double precision down the node tree, so that a scene far from the origin keeps its
    /// detail once the camera's position is subtracted. Finite and invertible. A negative determinant mirrors the mesh: the
    /// front stays the side it was in the local frame, so (p1 − p0) × (p2 − p0) of the *world* positions must be negated.
    pub to_world: DAffine3,
}

impl Mesh {
    /// The corners of the box around all vertices, local frame; the origin when there are none.
    pub(crate) fn bounds(&self) -> (Vec3, Vec3) {
        let corners = self.positions.iter().map(|&p| (p, p));
        corners.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or_default()
    }
}
