//! Rays and hits.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Bool, F32, U32};

use crate::core::vec::Vec3;
use crate::schema::NONE;

/// A ray: the points `org + t · dir` with `0 < t < tmax`, world.
#[derive(Clone, Copy)]
pub struct Ray {
    /// Origin, m.
    pub org: Vec3,
    /// Direction; unit unless said otherwise.
    pub dir: Vec3,
    /// End of the range, in units of `dir`; infinity for none.
    pub tmax: F32,
    /// A primitive the ray does not hit (the one it starts on), or `NONE`.
    pub skip: U32,
    /// A second one (the light a shadow ray ends on), or `NONE`.
    pub skip1: U32,
    /// A third one (the other half of a quad), or `NONE`.
    pub skip2: U32,
}
impl_staged!(Ray { org, dir, tmax, skip, skip1, skip2 });

/// The nearest primitive on a ray.
#[derive(Clone, Copy)]
pub struct Hit {
    /// Its number, a row of `Primitives`; `NONE` for a miss.
    pub primitive: U32,
    /// Distance in units of the ray's direction.
    pub t: F32,
    /// Barycentric weight of the second corner.
    pub u: F32,
    /// Barycentric weight of the third corner.
    pub v: F32,
}
impl_staged!(Hit { primitive, t, u, v });

impl Hit {
    /// Nothing hit within `tmax`.
    pub fn miss(tmax: F32) -> Hit {
        Hit { primitive: NONE.into(), t: tmax, u: 0.0.into(), v: 0.0.into() }
    }

    /// Was anything hit?
    pub fn is_hit(self) -> Bool {
        self.primitive.ne(NONE)
    }
}
