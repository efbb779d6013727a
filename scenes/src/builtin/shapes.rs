//! Shapes of which the built-in scenes are made. Closed shapes share their vertices, so that they are watertight to the bit.

use crate::{Camera, Environment, Instance, Material, Mesh, Scene};
use glam::{DAffine3, DVec3, Vec2, Vec3, vec3};
use std::collections::HashMap;
use std::f32::consts::{PI, TAU};

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
    let positions = (0..8).map(|i| corner + along(i, u) + along(i >> 1, v) + along(i >> 2, w)).collect();
    let face = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Mesh { positions, triangles: faces.into_iter().flat_map(face).collect(), ..Mesh::default() }
}

/// The same surface with its front inside.
pub(super) fn inside_out(mut mesh: Mesh) -> Mesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh.normals.iter_mut().flatten().for_each(|n| *n = -*n);
    mesh
}

/// A sphere of 20·4^`level` triangles: an icosahedron, each triangle split in four `level` times, its vertices moved to the
/// sphere. With smooth normals.
pub(super) fn sphere(centre: Vec3, radius: f32, level: u32) -> Mesh {
    let golden = (1.0 + 5f32.sqrt()) / 2.0;
    // Three golden rectangles, one per plane of axes.
    let mut normals = Vec::new();
    for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        normals.extend([vec3(a, b, 0.0), vec3(0.0, a, b), vec3(b, 0.0, a)].map(Vec3::normalize));
    }
    let mut triangles = hull_triangles(&normals);
    for _ in 0..level {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                normals.push((normals[a as usize] + normals[b as usize]).normalize());
                normals.len() as u32 - 1
            })
        };
        let quarter = |[a, b, c]: [u32; 3]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        triangles = triangles.into_iter().flat_map(quarter).collect();
    }
    let positions = normals.iter().map(|n| centre + radius * n).collect();
    Mesh { positions, normals: Some(normals), triangles, ..Mesh::default() }
}

/// The faces of the icosahedron on twelve unit vectors: all triples at edge length, counter-clockwise from outside.
fn hull_triangles(vertices: &[Vec3]) -> Vec<[u32; 3]> {
    // Neighbours are 63.4 degrees apart (cosine 1/sqrt 5), the next vertices 116.6.
    let near = |a: usize, b: usize| vertices[a].dot(vertices[b]) > 0.0;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in (a + 1..12).filter(|&b| near(a, b)) {
            for c in (b + 1..12).filter(|&c| near(a, c) && near(b, c)) {
                let outward = (vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]).dot(vertices[a]) > 0.0;
                let [b, c] = if outward { [b, c] } else { [c, b] };
                triangles.push([a, b, c].map(|i| i as u32));
            }
        }
    }
    triangles
}

/// A level rectangle about `centre`, its front up.
pub(super) fn floor(centre: Vec3, width: f32, depth: f32) -> Mesh {
    quad(centre - vec3(width, 0.0, depth) / 2.0, Vec3::Z * depth, Vec3::X * width)
}

/// A level rectangle about `centre`, its front down.
pub(super) fn panel(centre: Vec3, width: f32, depth: f32) -> Mesh {
    quad(centre - vec3(width, 0.0, depth) / 2.0, Vec3::X * width, Vec3::Z * depth)
}

/// A sky given by its radiance for a unit direction, `width` by `width / 2` texels.
pub(super) fn sky(width: u32, radiance: impl Fn(Vec3) -> [f32; 3]) -> Environment {
    let height = width / 2;
    let texel = |i: u32| {
        let (u, v) = ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
        let (phi, theta) = ((u / width as f32 - 0.5) * TAU, v / height as f32 * PI);
        radiance(vec3(theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos()))
    };
    let radiance = (0..width * height).map(texel).collect();
    Environment { width, height, radiance, intensity: 1.0, rotation_deg: 0.0 }
}

/// The same number in 0..1 for the same `n`: variety without randomness (the fractions of multiples of the golden ratio).
pub(super) fn varied(n: u32) -> f32 {
    (f64::from(n) * 0.618_033_988_749_894_9).fract() as f32
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
        self.meshes.push(Mesh { material, name, ..mesh });
        self.instances.push(Instance { mesh: self.meshes.len() - 1, to_world: DAffine3::IDENTITY });
    }

    /// Sets the one camera, with a film of its own.
    pub(super) fn view(&mut self, eye: [f64; 3], target: [f64; 3], yfov: f64, film: (u32, u32)) {
        let camera = Camera::look_at("camera", DVec3::from(eye), DVec3::from(target), yfov);
        let aspect = Some(f64::from(film.0) / f64::from(film.1));
        self.cameras = vec![Camera { film: Some(film), aspect, ..camera }];
    }
}
