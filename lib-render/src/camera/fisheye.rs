//! The fisheye: angles to the viewing direction are distances from the film's centre.

use crate::camera::View;
use crate::core::math::sincos;
use crate::core::vec::Vec3;

/// Origin and direction: from the eye, at the angle θ = |p| from forward towards p, at most π.
pub fn fisheye_ray(view: View) -> (Vec3, Vec3) {
    (view.eye, bent(view.forward, view.across - view.down))
}

/// The direction at the angle |p| from `forward` towards p, which is across it.
fn bent(forward: Vec3, p: Vec3) -> Vec3 {
    let length = p.length();
    let (sin, cos) = sincos(length.min(std::f32::consts::PI));
    // sin θ / θ → 1.
    let share = length.gt(0.0).select(sin / length, 1.0.into());
    forward * cos + p * share
}
