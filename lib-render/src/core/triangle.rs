//! The warp of uniform numbers to triangles.

use crate::core::vec::{Vec2, vec2};

/// Barycentric weights of the second and the third corner, uniform over a triangle.
///
/// Source: Heitz 2019, "A low-distortion map between triangle and square", listing 3.
pub fn uniform_triangle(u: Vec2) -> Vec2 {
    let low = u.y.gt(u.x);
    let x = low.select(u.x * 0.5, u.x - u.y * 0.5);
    let y = low.select(u.y - u.x * 0.5, u.y * 0.5);
    vec2(x, y)
}
