//! Geometry: what is known of a surface at a hit (paper, section 4.4).

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, F32, Fun, Row, U32};

use crate::core::color::Color;
use crate::core::vec::{Vec2, Vec3};
use crate::ray::{Hit, Ray};
use crate::schema::Geometries;
use crate::shader::Shader;

pub mod offset;
mod place;
pub mod plane;
pub mod triangle;

use triangle::Triangle;

/// A right-handed frame of unit vectors, world.
#[derive(Clone, Copy)]
pub struct Frame3 {
    /// First axis.
    pub tangent: Vec3,
    /// Second axis.
    pub bitangent: Vec3,
    /// Third axis: the shading normal.
    pub normal: Vec3,
}
impl_staged!(Frame3 { tangent, bitangent, normal });

/// A point of a surface. All in world coordinates.
#[derive(Clone, Copy)]
pub struct SurfaceElement {
    /// The point, from barycentric weights.
    pub point: Vec3,
    /// Bound on the absolute error of each coordinate of `point` (N1).
    pub error: Vec3,
    /// Unit normal of the plane, on the side where the corners run counter-clockwise.
    pub face_normal: Vec3,
    /// Shading frame: interpolated normal and the tangent of the first texture coordinates where there are any. The
    /// normal is never turned towards the viewer.
    pub local: Frame3,
    /// Texture coordinates, set 0 and set 1.
    pub uv: [Vec2; 2],
    /// Colour of the vertices, a factor of the base colour; white where they have none.
    pub color: Color,
    /// The primitive.
    pub primitive: U32,
    /// The light that this primitive is, a row of `Lights`, or `NONE`.
    pub light: U32,
    /// Where rays leave: the point, a little inside of the triangle's sides, so that no ray starts beyond a wall that
    /// meets this one there.
    pub start: Vec3,
}
impl_staged!(SurfaceElement { point, error, face_normal, local, uv, color, primitive, light, start });

impl SurfaceElement {
    /// Cosine between a direction and the face normal.
    pub fn face_cos(self, w: Vec3) -> F32 {
        self.face_normal.dot(w)
    }

    /// Does a direction point behind the face?
    pub fn is_behind(self, w: Vec3) -> Bool {
        self.face_cos(w).lt(0.0)
    }
}

/// Geometry: how to get at the surface, and what shades it.
#[derive(Clone, Copy)]
pub struct Geometry {
    /// (ray, hit) → the surface there.
    pub surface_element: Fun<(Ray, Hit), SurfaceElement>,
    /// Its shader.
    pub shader: Shader,
}
impl_staged!(Geometry { surface_element, shader });

/// Geometry of triangles: what the row says its vertices have is interpolated, the rest derived.
pub fn make_geometry(row: Row<Geometries>, shader: Shader) -> Geometry {
    let surface_element = Fun::lam(move |b: &mut Block, (_, hit): (Ray, Hit)| {
        let triangle = Triangle::of(b, hit);
        let (point, error, start) = triangle.point();
        let face_normal = triangle.plane().normal;
        let uv = triangle.uv(b, row);
        let normal = triangle.shading_normal(b, row, face_normal);
        SurfaceElement {
            point,
            error,
            face_normal,
            local: triangle.frame(b, row, normal),
            uv,
            color: triangle.color(b, row),
            primitive: hit.primitive,
            light: triangle.light(),
            start,
        }
    });
    Geometry { surface_element, shader }
}
