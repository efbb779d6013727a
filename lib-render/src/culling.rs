//! Back faces, where a render culls them: rays pass through a surface that they meet from behind.

use jerboa_ir::lang::{Block, Bool, Row};

use crate::geometry::triangle::Triangle;
use crate::ray::Ray;
use crate::schema::Materials;

/// Does the ray pass through this triangle of the material?
pub fn is_culled(b: &mut Block, material: Row<Materials>, triangle: Triangle, ray: Ray) -> Bool {
    let is_behind = |_: &mut Block| triangle.plane().normal.dot(ray.dir).gt(0.0);
    b.if_(material.get(Materials::CULLED), is_behind, |_| Bool::from(false))
}
