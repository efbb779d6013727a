//! A hit triangle: its corners, and what is interpolated between them.

use jerboa_ir::lang::{Block, Buf, Col, F32, Row, U32};

use crate::core::color::{Color, color, white};
use crate::core::onb::onb;
use crate::core::vec::{Vec2, Vec3, vec2, vec3};
use crate::geometry::Frame3;
use crate::geometry::place::Place;
use crate::geometry::plane::Plane;
use crate::ray::Hit;
use crate::schema::{Colors, Geometries, Normals, Primitives, Tangents, Uvs, Vertices};

/// Bound on the relative error of seven roundings in a row (Higham 2002, Lemma 3.1): 7 · 2^-24 / (1 − 7 · 2^-24).
pub const GAMMA_7: f32 = 7.0 / (16_777_216.0 - 7.0);
/// How far from the sides rays start, in barycentric weights: 2^-19, 32 of the triangle's own roundings. On a side shared
/// with another wall a rounded point lies beyond that wall as often as not, and would see what is behind it.
const INWARD: f32 = 1.0 / 524_288.0;
/// Below this length a sum of unit vectors is rounding noise: 2^-20, against errors of 2^-23.
const NOISE: f32 = 1.0 / 1_048_576.0;

/// A triangle and a point of it.
#[derive(Clone, Copy)]
pub struct Triangle {
    /// Where it is.
    place: Place,
    /// Rows of the corners.
    index: [U32; 3],
    /// Barycentric weights of the point.
    weights: [F32; 3],
}

impl Triangle {
    /// The triangle of a hit, and the point hit.
    pub fn of(b: &mut Block, hit: Hit) -> Triangle {
        let place = Place::of(b, hit.primitive);
        let [i, j, k] = [Primitives::I0, Primitives::I1, Primitives::I2].map(|i| place.row.get(i));
        // A mirror turns the winding round; swapping two corners keeps the front where it was.
        let [(j, u), (k, v)] = place.is_mirrored().select([(k, hit.v), (j, hit.u)], [(j, hit.u), (k, hit.v)]);
        Triangle { place, index: [i, j, k], weights: [1.0 - hit.u - hit.v, u, v] }
    }

    /// What it has in common with others.
    pub fn geometry(self) -> Row<Geometries> {
        Row::at(self.place.row.get(Primitives::GEOMETRY))
    }

    /// The light that it is, a row of `Lights`, or `NONE`.
    pub fn light(self) -> U32 {
        self.place.row.get(Primitives::LIGHT)
    }

    /// A vector attribute at each corner.
    fn corners<T: Buf>(self, columns: [Col<T, F32>; 3]) -> [Vec3; 3] {
        self.index.map(|i| {
            let [x, y, z] = columns.map(|column| Row::<T>::at(i).get(column));
            vec3(x, y, z)
        })
    }

    /// The corners, world.
    fn positions(self) -> [Vec3; 3] {
        self.corners([Vertices::X, Vertices::Y, Vertices::Z]).map(|p| self.place.point(p))
    }

    /// Its plane, world. That of a triangle in the world is computed at load.
    pub fn plane(self) -> Plane {
        let row = self.place.row;
        let [x, y, z] = [Primitives::NORMAL_X, Primitives::NORMAL_Y, Primitives::NORMAL_Z].map(|n| row.get(n));
        let error = row.get(Primitives::PLANE_ERROR);
        let known = Plane { normal: vec3(x, y, z), size: row.get(Primitives::SIZE), error: vec3(error, error, error) };
        // A ray finds an instance's triangle in its frame, one of the world's in the same place here.
        let corners = self.positions();
        let here = Plane::of(corners);
        let there = self.place.spread(error).zip(here.error, F32::max);
        let rounding = self.place.rounding(self.blend(corners));
        self.place.is_placed().select(Plane { error: there.map(|e| e + rounding), ..here }, known)
    }

    /// The weighted sum of an attribute.
    fn blend(self, at: [Vec3; 3]) -> Vec3 {
        let [p, q, r] = std::array::from_fn(|i| at[i] * self.weights[i]);
        p + q + r
    }

    /// The point, and a bound on the absolute error of each coordinate: γ7 Σ |w p| for the point itself (pbrt, 4th ed.,
    /// 6.8.5), and [`Plane::error`] for how well a ray that starts there can tell where this plane is. Then
    /// where rays leave it: the point, moved towards the centroid until it is inside of all three sides whatever was
    /// rounded, by `INWARD` of the triangle and a quarter of γ7 Σ |w p|, which is some roundings.
    pub fn point(self) -> (Vec3, Vec3, Vec3) {
        let at = self.positions();
        let point = self.blend(at);
        let [p, q, r] = std::array::from_fn(|i| (at[i] * self.weights[i]).abs());
        let error = (p + q + r).map(|e| e * GAMMA_7);
        let plane = self.plane();
        let inward = (error.max_element() / plane.size * 0.25 + INWARD).min(1.0 / 3.0);
        let to_corners = (at[0] - point) + (at[1] - point) + (at[2] - point);
        (point, error.zip(plane.error, |e, f| e + f), point + to_corners * inward)
    }

    /// The edges from the first corner, each divided by one length, so that products neither overflow nor vanish.
    fn edges(self) -> [Vec3; 2] {
        let [p0, p1, p2] = self.positions();
        let edges = [p1 - p0, p2 - p0];
        let scale = edges[0].abs().max_element().max(edges[1].abs().max_element());
        edges.map(|e| e / scale)
    }

    /// Texture coordinates of both sets; 0 where there are none.
    pub fn uv(self, b: &mut Block, row: Row<Geometries>) -> [Vec2; 2] {
        let none = |_: &mut Block| vec2(0.0, 0.0);
        [
            b.if_(row.get(Geometries::HAS_UV0), |_| self.uv_of(Uvs::U0, Uvs::V0), none),
            b.if_(row.get(Geometries::HAS_UV1), |_| self.uv_of(Uvs::U1, Uvs::V1), none),
        ]
    }

    fn uv_of(self, u: Col<Uvs, F32>, v: Col<Uvs, F32>) -> Vec2 {
        let [p, q, r] = self.uv_corners(u, v);
        p * self.weights[0] + q * self.weights[1] + r * self.weights[2]
    }

    fn uv_corners(self, u: Col<Uvs, F32>, v: Col<Uvs, F32>) -> [Vec2; 3] {
        self.index.map(|i| vec2(Row::at(i).get(u), Row::at(i).get(v)))
    }

    /// The interpolated colour of the vertices; white where they have none.
    pub fn color(self, b: &mut Block, row: Row<Geometries>) -> Color {
        let interpolated = |_: &mut Block| {
            let Vec3 { x, y, z } = self.blend(self.corners([Colors::R, Colors::G, Colors::B]));
            color(x, y, z)
        };
        b.if_(row.get(Geometries::HAS_COLORS), interpolated, |_| white())
    }

    /// The interpolated alpha of the vertices; 1 where they have no colours.
    pub fn alpha(self, b: &mut Block, row: Row<Geometries>) -> F32 {
        let interpolated = |_: &mut Block| {
            let [p, q, r] = std::array::from_fn(|i| Row::at(self.index[i]).get(Colors::A) * self.weights[i]);
            p + q + r
        };
        b.if_(row.get(Geometries::HAS_COLORS), interpolated, |_| F32::from(1.0))
    }

    /// The interpolated normal; the face's where there is none or where it cancels.
    pub fn shading_normal(self, b: &mut Block, row: Row<Geometries>, face: Vec3) -> Vec3 {
        let interpolated = |_: &mut Block| {
            let n = self.blend(self.corners([Normals::X, Normals::Y, Normals::Z]).map(|n| self.place.normal(n)));
            let length = n.length();
            length.gt(NOISE).select(n / length, face)
        };
        b.if_(row.get(Geometries::HAS_NORMALS), interpolated, |_| face)
    }

    /// The shading frame around this unit normal: by the vertices' tangents, else by the first texture coordinates, else
    /// by [`onb`].
    pub fn frame(self, b: &mut Block, row: Row<Geometries>, normal: Vec3) -> Frame3 {
        let given = |_: &mut Block| {
            let tangents = self.corners([Tangents::X, Tangents::Y, Tangents::Z]).map(|t| self.place.tangent(t));
            let sign = Row::at(self.index[0]).get(Tangents::SIGN);
            let sign = self.place.is_mirrored().select(-sign, sign);
            frame_along(normal, self.blend(tangents), sign)
        };
        let derived =
            |b: &mut Block| b.if_(row.get(Geometries::HAS_UV0), |_| self.frame_by_uv(normal), |_| frame_around(normal));
        b.if_(row.get(Geometries::HAS_TANGENTS), given, derived)
    }

    /// The frame whose tangent is the direction of growing u. The bitangent is the direction in which v falls, since a
    /// normal map's y points up (glTF 2.0, 3.9.3) and v points down.
    fn frame_by_uv(self, normal: Vec3) -> Frame3 {
        let [e1, e2] = self.edges();
        let [p, q, r] = self.uv_corners(Uvs::U0, Uvs::V0);
        let (d1, d2) = (q - p, r - p);
        let det = d1.x * d2.y - d1.y * d2.x;
        let mirrored = det.gt(0.0);
        let tangent = e1 * d2.y - e2 * d1.y;
        frame_along(normal, det.lt(0.0).select(-tangent, tangent), mirrored.select(F32::from(-1.0), 1.0.into()))
    }
}

/// The frame whose tangent is the part of `tangent` across the normal, and whose bitangent is sign · normal × tangent.
/// [`onb`] where there is no such part.
fn frame_along(normal: Vec3, tangent: Vec3, sign: F32) -> Frame3 {
    let along = tangent.normalize_scaled();
    let across = along - normal * normal.dot(along);
    let length = across.length();
    let tangent = across / length;
    let frame = Frame3 { tangent, bitangent: normal.cross(tangent) * sign, normal };
    // Not where it is NaN: then the tangent was zero.
    length.gt(NOISE).select(frame, frame_around(normal))
}

/// Any frame around a unit normal.
fn frame_around(normal: Vec3) -> Frame3 {
    let (tangent, bitangent) = onb(normal);
    Frame3 { tangent, bitangent, normal }
}
