//! What lies around a point: paths that start at a camera or a light must know what absorbs there, since they have not seen
//! the surface that it lies behind.
//!
//! A ray from the point counts the surfaces of solids that it crosses: one that it leaves without having entered it lies
//! around the point. Solids are closed, as KHR_materials_volume wants them; one may lie within another.

use glam::{DVec3, Vec3};
use jerboa_scenes::Scene;

use super::geometry::Placed;
use super::materials::inside;
use crate::host::bvh::{Bounds, Triangle};

/// Absorption coefficients, 1/m.
pub type Absorption = [f32; 3];

/// Where the rays go: along no edge or diagonal that a modeller would draw.
const DIRECTION: DVec3 = DVec3::new(0.437_016_9, 0.764_842_2, 0.473_276_1);

/// The solids of a scene, if any of them absorbs.
#[derive(Default)]
pub struct Media {
    /// By material, as [`inside`] tells.
    inside: Vec<Option<Absorption>>,
    solids: Vec<Solid>,
}

/// An instance of a mesh that has an inside.
struct Solid {
    instance: usize,
    absorption: Absorption,
    bounds: Bounds,
    /// World less the origin.
    triangles: Vec<Triangle>,
}

impl Media {
    /// Those of a scene; `origin` is subtracted from positions.
    pub fn new(scene: &Scene, origin: DVec3) -> Media {
        let inside = of_materials(scene);
        let mut solids = Vec::new();
        if inside.iter().flatten().flatten().any(|sigma| *sigma > 0.0) {
            for (instance, placing) in scene.instances.iter().enumerate() {
                let mesh = &scene.meshes[placing.mesh];
                let Some(absorption) = inside[mesh.material] else { continue };
                let placed = Placed::new(placing, mesh, origin);
                let triangles: Vec<Triangle> = placed.corners(mesh).map(|corners| placed.triangle(corners)).collect();
                solids.push(Solid { instance, absorption, bounds: Bounds::of(triangles.as_flattened()), triangles });
            }
        }
        Media { inside, solids }
    }

    /// Are they those of this scene too, whose materials may have changed?
    pub fn are_of(&self, scene: &Scene) -> bool {
        self.inside == of_materials(scene)
    }

    /// What absorbs at a point (world less the origin). One on the outside of an instance lies in none of its own.
    pub fn at(&self, point: DVec3, outside: Option<usize>) -> Absorption {
        let around = |solid: &&Solid| Some(solid.instance) != outside && solid.may_hold(point);
        let mut crossings: Vec<(f64, bool, Absorption)> = Vec::new();
        for solid in self.solids.iter().filter(around) {
            let found = solid.triangles.iter().filter_map(|t| crossing(t, point));
            crossings.extend(found.map(|(distance, leaves)| (distance, leaves, solid.absorption)));
        }
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut entered = 0_u32;
        for (_, leaves, absorption) in crossings {
            match (leaves, entered) {
                (false, _) => entered += 1,
                (true, 0) => return absorption,
                (true, _) => entered -= 1,
            }
        }
        [0.0; 3]
    }
}

impl Solid {
    /// Does its box hold the point? One that does not is entered before it is left.
    fn may_hold(&self, point: DVec3) -> bool {
        let [lo, hi] = [self.bounds.lo, self.bounds.hi].map(|corner| Vec3::from(corner).as_dvec3());
        point.cmpge(lo).all() && point.cmple(hi).all()
    }
}

fn of_materials(scene: &Scene) -> Vec<Option<Absorption>> {
    scene.materials.iter().map(inside).collect()
}

/// Distance at which the ray from a point crosses a triangle (Möller, Trumbore 1997), and whether from its back.
fn crossing(triangle: &Triangle, point: DVec3) -> Option<(f64, bool)> {
    let [a, b, c] = triangle.map(|p| Vec3::from(p).as_dvec3());
    let (e1, e2, from) = (b - a, c - a, point - a);
    let (p, q) = (DIRECTION.cross(e2), from.cross(e1));
    let det = e1.dot(p);
    let (u, v, distance) = (from.dot(p) / det, DIRECTION.dot(q) / det, e2.dot(q) / det);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some((distance, det < 0.0))
}
