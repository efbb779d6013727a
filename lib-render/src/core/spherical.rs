//! A triangle as a point sees it: its solid angle, and points of it drawn uniformly by solid angle.
//!
//! The angle is van Oosterom's and Strackee's ("The solid angle of a plane triangle", 1983), tan(Ω/2) = N / D, with N the
//! volume that the corners span and D = abc + (p0·p1) c + (p1·p2) a + (p2·p0) b. N is taken from the edges, not from
//! differences of corners, so a small triangle keeps its digits (accuracy.md, N9: 2e-6 down to 6e-9 sr, where the sum of its
//! angles, Girard's, is a third of a per cent off at 6e-5 sr and often negative at 6e-9).
//!
//! Drawing is Arvo's ("Stratified sampling of spherical triangles", 1995) in the form of Peters ("BRDF importance sampling for
//! polygonal lights", 2021, section 3.3), which needs no inverse of a cosine: a share of Ω cuts the triangle from its second
//! corner to a point of the opposite edge, and that cut is divided so that its cone is. Here both places come out as weights
//! of corners, sums of what is not negative, and all of 1 ± cos that is small comes from a sine. So there is no solid angle too
//! small to draw from, and no smaller one below which something else is done.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::F32;

use super::math::{atan2, sincos};
use super::vec::{Vec2, Vec3, vec2};

/// A triangle, seen from the origin. Lengths are in any unit in which their products neither overflow nor vanish.
#[derive(Clone, Copy)]
pub struct SeenTriangle {
    /// From the origin to the first corner.
    corner: Vec3,
    /// Edges from the first corner to the second and the third.
    e1: Vec3,
    e2: Vec3,
    /// Distances of the corners.
    a: F32,
    b: F32,
    c: F32,
    /// N and D, tan(Ω/2) = N / D.
    volume: F32,
    denominator: F32,
    /// Ω, sr. In [0, 2π]; 0 or 2π from the triangle's plane, outside and inside of the triangle.
    pub solid_angle: F32,
}
impl_staged!(SeenTriangle { corner, e1, e2, a, b, c, volume, denominator, solid_angle });

impl SeenTriangle {
    /// From the first corner, as seen from the origin, and the edges from there to the second and the third.
    pub fn new(corner: Vec3, e1: Vec3, e2: Vec3) -> SeenTriangle {
        let (p1, p2) = (corner + e1, corner + e2);
        let [a, b, c] = [corner, p1, p2].map(Vec3::length);
        let volume = corner.dot(e1.cross(e2)).abs();
        let denominator = a * b * c + corner.dot(p1) * c + p1.dot(p2) * a + p2.dot(corner) * b;
        let solid_angle = atan2(volume, denominator) * 2.0;
        SeenTriangle { corner, e1, e2, a, b, c, volume, denominator, solid_angle }
    }

    /// Weights of both edges: a point of the triangle whose direction has density 1 / [`SeenTriangle::solid_angle`], from the
    /// unit square. NaN where the solid angle is 0.
    pub fn sample(self, u: Vec2) -> Vec2 {
        let (p1, p2) = (self.corner + self.e1, self.corner + self.e2);
        // The part of the triangle between the first edge and a point of the second has the share u.x. Peters' reflected
        // vector is α p0/a + β p2/c; with 1 = α the scale, the point is ((α² − β²) p0/a + 2β (α + β cos) p2/c).
        let (sin, cos) = sincos(self.solid_angle * 0.5 * u.x);
        let (_, apart01) = versines(self.corner, p1, self.corner.cross(self.e1), self.a * self.b);
        let (_, apart02) = versines(self.corner, p2, self.corner.cross(self.e2), self.a * self.c);
        let difference = (self.volume * cos - self.denominator * sin).max(0.0);
        let beta = apart01 * (self.a * self.b * self.c) * sin;
        let alpha = difference + beta;
        let (difference, beta) = (difference / alpha, beta / alpha);
        let near = difference * (1.0 + beta) * self.c;
        let far = 2.0 * beta * (difference + beta * apart02) * self.a;
        let along = far / (near + far);
        // From the second corner towards that point, by a share u.y of 1 − cos of the way.
        let cut = self.e2 * along - self.e1;
        let end = p1 + cut;
        let length = end.length();
        let (whole, rest) = versines(p1, end, p1.cross(cut), self.b * length);
        let to_end = (u.y * (2.0 - u.y * whole) / rest).sqrt();
        let to_second = ((1.0 - to_end) + whole * (to_end - u.y)).max(0.0) * length;
        let second = to_second / (to_second + to_end * self.b);
        vec2(second, (1.0 - second) * along)
    }
}

/// 1 − cos and 1 + cos of the angle between two vectors, from their vector product and the product of their lengths. The smaller
/// one is sin² over the other, so it has as many digits as the vector product has.
fn versines(p: Vec3, q: Vec3, cross: Vec3, lengths: F32) -> (F32, F32) {
    let cos = p.dot(q) / lengths;
    let large = 1.0 + cos.abs();
    let small = (cross / lengths).length2() / large;
    let is_acute = cos.gt(0.0);
    (is_acute.select(small, large), is_acute.select(large, small))
}
