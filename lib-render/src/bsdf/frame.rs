//! One place for what shading normals do to scattering (N25).
//!
//! With `Settings::CONSISTENT_NORMALS`, the side of a direction, hence the kind of an event, is judged by the geometric
//! normal, and only cosines use the shading normal (Veach 1997, section 5.3): a closed mesh lets nothing through. Without
//! it ("free") the shading normal decides both.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Bool, F32, Row};

use crate::core::onb::onb;
use crate::core::vec::Vec3;
use crate::geometry::{Frame3, SurfaceElement};
use crate::schema::Settings;

/// A surface seen from the side of wo. World.
#[derive(Clone, Copy)]
pub struct Side {
    /// Unit shading normal on this side.
    pub normal: Vec3,
    /// Unit normal that tells the sides apart, on this side: geometric, or the shading normal where that is free.
    pub judge: Vec3,
    /// Is this the outer side, where the normal of the surface points?
    pub outside: Bool,
}
impl_staged!(Side { normal, judge, outside });

/// Does the geometric normal judge?
pub(super) fn is_consistent() -> Bool {
    Row::<Settings>::at(0u32).get(Settings::CONSISTENT_NORMALS)
}

fn flip_unless(keep: Bool, n: Vec3) -> Vec3 {
    keep.select(n, -n)
}

impl Side {
    /// The side of `surf` on which wo lies.
    pub fn new(surf: SurfaceElement, wo: Vec3) -> Side {
        let (shading, face) = (surf.local.normal, surf.face_normal);
        let outside = is_consistent().select(face, shading).dot(wo).gt(0.0);
        let face = flip_unless(outside, face);
        // An interpolated normal can lie on the wrong side of its own triangle.
        let consistent = flip_unless(shading.dot(face).ge(0.0), shading);
        let normal = is_consistent().select(consistent, flip_unless(outside, shading));
        Side { normal, judge: is_consistent().select(face, normal), outside }
    }

    /// Is wi on this side: reflected light?
    pub fn reflects(self, wi: Vec3) -> Bool {
        self.judge.dot(wi).gt(0.0)
    }

    /// Is wi on the other side: transmitted light?
    pub fn transmits(self, wi: Vec3) -> Bool {
        self.judge.dot(wi).lt(0.0)
    }
}

/// A frame around a unit normal whose tangent is the part of `along` across it; any tangent where that is nearly nothing.
pub fn frame_along(normal: Vec3, along: Vec3) -> Frame3 {
    let across_of = |w: Vec3| w - normal * normal.dot(w);
    let across = across_of(along);
    // What rounding left along the normal is large beside a short difference: it is taken away once more.
    let tangent = across_of(across / across.length()).normalize();
    let frame = Frame3 { tangent, bitangent: normal.cross(tangent), normal };
    across.length2().gt(1e-12).select(frame, Frame3::around(normal))
}

/// Cosine between a direction and a normal.
pub fn cos_between(w: Vec3, n: Vec3) -> F32 {
    w.dot(n)
}

/// The mirror image of w about n, both pointing away.
pub fn reflect(w: Vec3, n: Vec3) -> Vec3 {
    n * (2.0 * cos_between(w, n)) - w
}

impl Frame3 {
    /// A frame around a unit normal.
    pub fn around(normal: Vec3) -> Frame3 {
        let (tangent, bitangent) = onb(normal);
        Frame3 { tangent, bitangent, normal }
    }

    /// World to local.
    pub fn to_local(self, w: Vec3) -> Vec3 {
        Vec3 { x: self.tangent.dot(w), y: self.bitangent.dot(w), z: self.normal.dot(w) }
    }

    /// Local to world.
    pub fn to_world(self, w: Vec3) -> Vec3 {
        self.tangent * w.x + self.bitangent * w.y + self.normal * w.z
    }
}

/// |cosine| of a direction to the shading normal of the surface: the factor that goes with f.
pub fn shading_cos(surf: SurfaceElement, wi: Vec3) -> F32 {
    surf.local.normal.dot(wi).abs()
}
