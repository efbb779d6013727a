//! Shapes of which the built-in scenes are made. Closed shapes share their vertices, so that they are watertight to the bit.

use crate::{Camera, Instance, Material, Mesh, Scene};
use glam::{DAffine3, DVec3, Vec2, Vec3};

/// A rectangle from `corner` along the edges `u` and `v`; its front is the side of `u × v`. Texture coordinates run from
/// 0 to 1 along each edge.
pub(super) fn quad(corner: Vec3, u: Vec3, v: Vec3) -> Mesh {
    Mesh {
        positions: vec![corner, corner + u, corner + u + v, corner + v],
        uvs: [Some(vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y]), None],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// The surface of a parallelepiped from `corner` along three edges, right-handed so that the front is outside; flat.
pub(super) fn solid(corner: Vec3, [u, v, w]: [Vec3; 3]) -> Mesh {
    let along = |bit: u32, edge: Vec3| if bit & 1 == 1 { edge } else { Vec3::ZERO };
    let positions = (0..8)
        .map(|i| corner + along(i, u) + along(i >> 1, v) + along(i >> 2, w))
        .collect();
    let face = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    Mesh {
        positions,
        triangles: faces.into_iter().flat_map(face).collect(),
        ..Mesh::default()
    }
}

impl Scene {
    /// Adds a material.
    pub(super) fn paint(&mut self, material: Material) -> usize {
        self.materials.push(material);
        self.materials.len() - 1
    }

    /// Adds a mesh of a material, placed in the world as modelled.
    pub(super) fn place(&mut self, mesh: Mesh, material: usize) {
        let name = self.materials[material].name.clone();
        self.meshes.push(Mesh {
            material,
            name,
            ..mesh
        });
        self.instances.push(Instance {
            mesh: self.meshes.len() - 1,
            to_world: DAffine3::IDENTITY,
        });
    }

    /// Adds a camera with a film of its own.
    pub(super) fn view(&mut self, eye: [f64; 3], target: [f64; 3], yfov: f64, film: (u32, u32)) {
        let camera = Camera::look_at("camera", DVec3::from(eye), DVec3::from(target), yfov);
        let aspect = Some(f64::from(film.0) / f64::from(film.1));
        self.cameras.push(Camera {
            film: Some(film),
            aspect,
            ..camera
        });
    }
}
