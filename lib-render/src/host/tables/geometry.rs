//! Triangles, vertices and their attributes, in world coordinates.

use std::collections::HashMap;

use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3, Vec4};
use jerboa_scenes::{Instance, Mesh, Scene};

use super::memory::{Memory, Table};
use super::plane::Plane;
use crate::host::bvh::Triangle;
use crate::schema::*;

/// The triangles of a scene as kernels see them, and what lights need to know of them.
pub struct Geometry {
    /// Subtracted from every world position before it is rounded (N14): zero, or the middle of a scene far from zero.
    pub origin: DVec3,
    /// Corners of each primitive, world less `origin`.
    pub triangles: Vec<Triangle>,
    /// Material of each primitive.
    pub materials: Vec<u32>,
    vertices: Table<Vertices>,
    corners: Vec<[u32; 3]>,
    geometry_of: Vec<u32>,
    geometries: Table<Geometries>,
    attributes: Attributes,
}

/// Vertex attributes; each list is empty until some mesh has it, then as long as the vertices.
#[derive(Default)]
struct Attributes {
    normals: Vec<Vec3>,
    uvs: Vec<[Vec2; 2]>,
    tangents: Vec<Vec4>,
}

/// Distance from zero, in radii of the scene, beyond which its middle is subtracted: at 16 radii a coordinate has lost
/// four bits of the detail it has near zero.
const FAR: f64 = 16.0;

impl Geometry {
    /// Lay out all instances.
    pub fn new(scene: &Scene) -> Geometry {
        let vertices = scene.instances.iter().map(|i| scene.meshes[i.mesh].positions.len()).sum();
        let mut g = Geometry {
            origin: origin(scene),
            triangles: Vec::new(),
            materials: Vec::new(),
            vertices: Table::with_rows(vertices),
            corners: Vec::new(),
            geometry_of: Vec::new(),
            geometries: Table::new(),
            attributes: Attributes::default(),
        };
        let mut rows = HashMap::new();
        let triangles = scene.instances.iter().map(|i| scene.meshes[i.mesh].triangles.len()).sum();
        g.triangles.reserve_exact(triangles);
        g.materials.reserve_exact(triangles);
        g.corners.reserve_exact(triangles);
        g.geometry_of.reserve_exact(triangles);
        for instance in &scene.instances {
            g.add(instance, &scene.meshes[instance.mesh], &mut rows);
        }
        g
    }

    /// One instance: its vertices, its triangles and the row that says what they have in common.
    fn add(&mut self, instance: &Instance, mesh: &Mesh, rows: &mut HashMap<[u32; 5], u32>) {
        let first = self.vertices.rows();
        let placed = Placed::new(instance, mesh, self.origin);
        for p in &placed.positions {
            self.vertices.push().set_all([Vertices::X, Vertices::Y, Vertices::Z], p.to_array());
        }
        self.attributes.add(mesh, placed.to_world.matrix3, first as usize);
        let geometry = self.geometry_row(mesh, rows);
        for corners in placed.corners(mesh) {
            self.triangles.push(placed.triangle(corners));
            self.corners.push(corners.map(|i| first + i));
            self.geometry_of.push(geometry);
            self.materials.push(mesh.material as u32);
        }
    }

    /// The row of meshes with these attributes and this material.
    fn geometry_row(&mut self, mesh: &Mesh, rows: &mut HashMap<[u32; 5], u32>) -> u32 {
        let has = [mesh.normals.is_some(), mesh.uvs[0].is_some(), mesh.uvs[1].is_some(), mesh.tangents.is_some()];
        let [n, u0, u1, t] = has;
        let key = [n as u32, u0 as u32, u1 as u32, t as u32, mesh.material as u32];
        let geometries = &mut self.geometries;
        *rows.entry(key).or_insert_with(|| {
            use Geometries as G;
            let row = geometries.rows();
            geometries
                .push()
                .set(G::HAS_NORMALS, n)
                .set(G::HAS_UV0, u0)
                .set(G::HAS_UV1, u1)
                .set(G::HAS_TANGENTS, t)
                .set(G::MATERIAL, key[4]);
            row
        })
    }

    /// Primitives; which of them are lights is [`super::lights::mark`]'s to say.
    pub fn primitives(&self) -> Memory {
        use Primitives as P;
        let mut table = Table::<P>::with_rows(self.corners.len());
        for (i, [a, b, c]) in self.corners.iter().enumerate() {
            let mut row = table.push();
            row.set(P::I0, *a).set(P::I1, *b).set(P::I2, *c);
            row.set(P::GEOMETRY, self.geometry_of[i]).set(P::LIGHT, NONE);
            for (column, x) in Plane::of(&self.triangles[i]).columns() {
                row.set(column, x);
            }
        }
        table.finish()
    }

    /// The tables of geometries, vertices, normals, texture coordinates and tangents.
    pub fn finish(self) -> [Memory; 5] {
        let Attributes { normals, uvs, tangents } = self.attributes;
        let mut n = Table::<Normals>::with_rows(normals.len());
        for x in normals {
            n.push().set_all([Normals::X, Normals::Y, Normals::Z], x.to_array());
        }
        let mut u = Table::<Uvs>::with_rows(uvs.len());
        for [a, b] in uvs {
            u.push().set_all([Uvs::U0, Uvs::V0, Uvs::U1, Uvs::V1], [a.x, a.y, b.x, b.y]);
        }
        let mut t = Table::<Tangents>::with_rows(tangents.len());
        for x in tangents {
            t.push().set_all([Tangents::X, Tangents::Y, Tangents::Z, Tangents::SIGN], x.to_array());
        }
        [self.geometries.finish(), self.vertices.finish(), n.finish(), u.finish(), t.finish()]
    }
}

impl Attributes {
    /// Append the attributes of a mesh whose first vertex is `first`.
    fn add(&mut self, mesh: &Mesh, to_world: DMat3, first: usize) {
        // Normals transform by the cofactor matrix: the inverse transpose times the determinant, whose sign is taken out.
        let sign = to_world.determinant().signum();
        let cofactor = DMat3::from_cols(
            to_world.y_axis.cross(to_world.z_axis),
            to_world.z_axis.cross(to_world.x_axis),
            to_world.x_axis.cross(to_world.y_axis),
        ) * sign;
        if let Some(normals) = &mesh.normals {
            self.normals.resize(first, Vec3::ZERO);
            self.normals.extend(normals.iter().map(|n| (cofactor * n.as_dvec3()).normalize_or_zero().as_vec3()));
        }
        if mesh.uvs.iter().any(Option::is_some) {
            self.uvs.resize(first, [Vec2::ZERO; 2]);
            let at = |set: usize, i: usize| mesh.uvs[set].as_ref().map_or(Vec2::ZERO, |uv| uv[i]);
            self.uvs.extend((0..mesh.positions.len()).map(|i| [at(0, i), at(1, i)]));
        }
        if let Some(tangents) = &mesh.tangents {
            self.tangents.resize(first, Vec4::ZERO);
            let world =
                |t: &Vec4| (to_world * t.truncate().as_dvec3()).normalize_or_zero().as_vec3().extend(t.w * sign as f32);
            self.tangents.extend(tangents.iter().map(world));
        }
    }
}

/// A mesh in the world.
pub(super) struct Placed {
    to_world: DAffine3,
    /// Corners, world less the origin.
    positions: Vec<Vec3>,
}

impl Placed {
    /// Place a mesh; `origin` is subtracted from its positions.
    pub fn new(instance: &Instance, mesh: &Mesh, origin: DVec3) -> Placed {
        let to_world = DAffine3 { translation: instance.to_world.translation - origin, ..instance.to_world };
        let positions = mesh.positions.iter().map(|p| to_world.transform_point3(p.as_dvec3()).as_vec3()).collect();
        Placed { to_world, positions }
    }

    /// The corners of each triangle, in their order.
    pub fn corners(&self, mesh: &Mesh) -> impl Iterator<Item = [u32; 3]> {
        // A mirroring instance turns the winding round; swapping two corners keeps the front where it was.
        let mirrored = self.to_world.matrix3.determinant() < 0.0;
        mesh.triangles.iter().map(move |[a, b, c]| {
            let corners = if mirrored { [*a, *c, *b] } else { [*a, *b, *c] };
            longest_side_last(corners, &self.positions)
        })
    }

    /// Where these corners are.
    pub fn triangle(&self, corners: [u32; 3]) -> Triangle {
        corners.map(|i| self.positions[i as usize].to_array())
    }
}

/// The corners turned so that the first is opposite the longest side. Kernels take the product of the two edges that start
/// there: of the shortest pair, rounding is least (N16). Of a needle it would turn the normal by 2^-24 of its length over
/// its width if both edges were long.
fn longest_side_last(corners: [u32; 3], positions: &[Vec3]) -> [u32; 3] {
    let [a, b, c] = corners;
    let side = |i: u32, j: u32| positions[i as usize].as_dvec3().distance_squared(positions[j as usize].as_dvec3());
    let (ab, bc, ca) = (side(a, b), side(b, c), side(c, a));
    if ab > bc && ab >= ca {
        [c, a, b]
    } else if ca > bc {
        [b, c, a]
    } else {
        corners
    }
}

/// What is subtracted from every position.
fn origin(scene: &Scene) -> DVec3 {
    let Some((low, high)) = scene.bounds() else { return DVec3::ZERO };
    let (middle, radius) = ((low + high) / 2.0, (high - low).length() / 2.0);
    if middle.length() > FAR * radius { middle } else { DVec3::ZERO }
}
