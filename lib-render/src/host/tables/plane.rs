//! The planes of triangles: what every hit needs of its triangle and does not depend on where it was hit.

use jerboa_ir::lang::{Col, F32};

use crate::geometry::plane::{HIT_ERROR, MOST_THIN};
use crate::host::bvh::Triangle;
use crate::schema::Primitives;

/// A triangle's plane. Rounded step by step in f32, so that a table scaled by a power of two gives the same bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Unit normal, on the side where the corners run counter-clockwise; NaN where they lie on one line.
    pub normal: [f32; 3],
    /// Largest difference of a coordinate between the first corner and another, m.
    pub size: f32,
    /// How far off the plane a ray that starts on it may find it, m.
    pub error: f32,
}

impl Plane {
    /// The plane of a triangle.
    pub fn of([p0, p1, p2]: &Triangle) -> Plane {
        let [e1, e2] = [p1, p2].map(|p| [0, 1, 2].map(|k| p[k] - p0[k]));
        let size = largest(e1).max(largest(e2));
        // Edges of size 1: products neither overflow nor vanish.
        let [e1, e2] = [e1, e2].map(|e| e.map(|x| x / size));
        let n = [e1[1] * e2[2] - e1[2] * e2[1], e1[2] * e2[0] - e1[0] * e2[2], e1[0] * e2[1] - e1[1] * e2[0]];
        let thin = (1.0 / largest(n)).min(MOST_THIN);
        Plane { normal: unit(n), size, error: size * thin * HIT_ERROR }
    }

    /// What a row of [`Primitives`] holds of it.
    pub fn columns(&self) -> [(Col<Primitives, F32>, f32); 5] {
        use Primitives as P;
        let [x, y, z] = self.normal;
        [(P::NORMAL_X, x), (P::NORMAL_Y, y), (P::NORMAL_Z, z), (P::SIZE, self.size), (P::PLANE_ERROR, self.error)]
    }
}

/// The unit vector in this direction; divides by the largest coordinate first.
fn unit(v: [f32; 3]) -> [f32; 3] {
    let most = largest(v);
    let [x, y, z] = v.map(|x| x / most);
    let length = (x * x + y * y + z * z).sqrt();
    [x, y, z].map(|x| x / length)
}

/// Absolute value of the largest coordinate.
fn largest(v: [f32; 3]) -> f32 {
    v[0].abs().max(v[1].abs()).max(v[2].abs())
}
