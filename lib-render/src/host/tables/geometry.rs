//! Triangles, vertices and their attributes, in world coordinates or in the frames that instances share.

use std::collections::HashMap;

use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3};
use jerboa_ir::lang::Buf;
use jerboa_scenes::{Instance, Mesh, Scene};

use super::memory::{Memory, Table};
use super::plane::Plane;
use super::sharing::{Sharing, in_frame};
use crate::host::bvh::Triangle;
use crate::schema::*;

/// Distance from zero, in radii of the scene, beyond which its middle is subtracted: at 16 radii a coordinate has lost
/// four bits of the detail it has near zero.
const FAR: f64 = 16.0;

/// What is subtracted from every world position before it is rounded (N14): zero, or the middle of a scene far from zero.
pub fn origin(scene: &Scene) -> DVec3 {
    let Some((low, high)) = scene.bounds() else { return DVec3::ZERO };
    let (middle, radius) = ((low + high) / 2.0, (high - low).length() / 2.0);
    if middle.length() > FAR * radius { middle } else { DVec3::ZERO }
}

/// Corners of each primitive, world less the origin.
pub fn triangles(scene: &Scene, origin: DVec3) -> Vec<Triangle> {
    let count = scene.instances.iter().map(|i| scene.meshes[i.mesh].triangles.len()).sum();
    let mut triangles = Vec::with_capacity(count);
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        let placed = Placed::new(instance, mesh, origin);
        triangles.extend(placed.corners(mesh).map(|corners| placed.triangle(corners)));
    }
    triangles
}

/// Tables of all instances. Those of attributes are empty until some mesh has them, then as long as the vertices so far.
#[derive(Default)]
pub struct Geometry {
    primitives: Table<Primitives>,
    geometries: Table<Geometries>,
    vertices: Table<Vertices>,
    normals: Table<Normals>,
    uvs: Table<Uvs>,
    tangents: Table<Tangents>,
    colors: Table<Colors>,
    instances: Table<Instances>,
}

impl Geometry {
    /// Lay out all instances, once those that share. Which primitives are lights is [`super::lights::mark`]'s to say.
    pub fn new(scene: &Scene, origin: DVec3, sharing: &Sharing) -> Geometry {
        use Instances as I;
        let mut geometry = Geometry::default();
        let (mut rows, mut shared) = (HashMap::new(), HashMap::new());
        let has_instances = sharing.iter().any(Option::is_some);
        let (mut first, mut is_world_last) = (0_u32, false);
        for (instance, placing) in scene.instances.iter().zip(sharing) {
            let mesh = &scene.meshes[instance.mesh];
            let next = geometry.primitives.rows();
            if let Some(placing) = placing {
                let row = *shared.entry(instance.mesh).or_insert_with(|| {
                    geometry.add(&in_frame(instance.mesh, mesh), mesh, DVec3::ZERO, &mut rows);
                    next
                });
                let mut run = geometry.instances.push();
                run.set(I::FIRST, first).set(I::TO_ROW, row.wrapping_sub(first));
                placing.set(&mut run);
            } else {
                if has_instances && !is_world_last {
                    geometry.instances.push().set(I::FIRST, first).set(I::TO_ROW, next.wrapping_sub(first));
                }
                geometry.add(instance, mesh, origin, &mut rows);
            }
            is_world_last = placing.is_none();
            first += mesh.triangles.len() as u32;
        }
        geometry
    }

    /// Rows of [`Instances`].
    pub fn instance_count(&self) -> u32 {
        self.instances.rows()
    }

    /// One instance: its vertices, its triangles and the row that says what they have in common.
    fn add(&mut self, instance: &Instance, mesh: &Mesh, origin: DVec3, rows: &mut HashMap<[u32; 6], u32>) {
        use Primitives as P;
        let first = self.vertices.rows();
        let placed = Placed::new(instance, mesh, origin);
        for p in &placed.positions {
            self.vertices.push().set_all([Vertices::X, Vertices::Y, Vertices::Z], p.to_array());
        }
        self.attributes(mesh, placed.to_world.matrix3, first);
        let geometry = self.geometry_row(mesh, rows);
        for corners in placed.corners(mesh) {
            let [a, b, c] = corners.map(|i| first + i);
            let mut row = self.primitives.push();
            row.set(P::I0, a).set(P::I1, b).set(P::I2, c).set(P::GEOMETRY, geometry).set(P::LIGHT, NONE);
            for (column, x) in Plane::of(&placed.triangle(corners)).columns() {
                row.set(column, x);
            }
        }
    }

    /// The row of meshes with these attributes and this material.
    fn geometry_row(&mut self, mesh: &Mesh, rows: &mut HashMap<[u32; 6], u32>) -> u32 {
        let [n, t, c] = [mesh.normals.is_some(), mesh.tangents.is_some(), mesh.colors.is_some()];
        let [u0, u1] = [mesh.uvs[0].is_some(), mesh.uvs[1].is_some()];
        let key = [n as u32, u0 as u32, u1 as u32, t as u32, c as u32, mesh.material as u32];
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
                .set(G::HAS_COLORS, c)
                .set(G::MATERIAL, key[5]);
            row
        })
    }

    /// The attributes of a mesh whose first vertex is `first`.
    fn attributes(&mut self, mesh: &Mesh, to_world: DMat3, first: u32) {
        // Normals transform by the cofactor matrix: the inverse transpose times the determinant, whose sign is taken out.
        let sign = to_world.determinant().signum();
        let cofactor = DMat3::from_cols(
            to_world.y_axis.cross(to_world.z_axis),
            to_world.z_axis.cross(to_world.x_axis),
            to_world.x_axis.cross(to_world.y_axis),
        ) * sign;
        if let Some(normals) = &mesh.normals {
            self.normals.pad(first);
            for n in normals {
                let n = (cofactor * n.as_dvec3()).normalize_or_zero().as_vec3();
                self.normals.push().set_all([Normals::X, Normals::Y, Normals::Z], n.to_array());
            }
        }
        if mesh.uvs.iter().any(Option::is_some) {
            self.uvs.pad(first);
            let at = |set: usize, i: usize| mesh.uvs[set].as_ref().map_or(Vec2::ZERO, |uv| uv[i]);
            for i in 0..mesh.positions.len() {
                let (a, b) = (at(0, i), at(1, i));
                self.uvs.push().set_all([Uvs::U0, Uvs::V0, Uvs::U1, Uvs::V1], [a.x, a.y, b.x, b.y]);
            }
        }
        if let Some(tangents) = &mesh.tangents {
            self.tangents.pad(first);
            for t in tangents {
                let [x, y, z] = (to_world * t.truncate().as_dvec3()).normalize_or_zero().as_vec3().to_array();
                let columns = [Tangents::X, Tangents::Y, Tangents::Z, Tangents::SIGN];
                self.tangents.push().set_all(columns, [x, y, z, t.w * sign as f32]);
            }
        }
        if let Some(colors) = &mesh.colors {
            self.colors.pad(first);
            for color in colors {
                self.colors.push().set_all([Colors::R, Colors::G, Colors::B, Colors::A], color.to_array());
            }
        }
    }

    /// The tables of primitives, geometries, vertices, normals, texture coordinates, tangents, colours and instances.
    pub fn finish(self) -> [Memory; 8] {
        [
            self.primitives.finish(),
            self.geometries.finish(),
            self.vertices.finish(),
            self.normals.finish(),
            self.uvs.finish(),
            self.tangents.finish(),
            self.colors.finish(),
            self.instances.finish(),
        ]
    }
}

/// Makes rows of [`Primitives`] of the numbers in pairs, by the table of [`Instances`].
pub fn to_rows(instances: &Memory, pairs: &mut [(u32, u32)]) {
    let runs = instances.words.chunks_exact(Instances::COLUMNS.len());
    let runs: Vec<[u32; 2]> = runs.map(|r| [Instances::FIRST.0, Instances::TO_ROW.0].map(|c| r[c as usize])).collect();
    for (number, _) in pairs {
        let run = runs.partition_point(|[first, _]| first <= number) - 1;
        *number = number.wrapping_add(runs[run][1]);
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
