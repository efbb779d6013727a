//! The orthographic camera: all rays are parallel.

use crate::camera::View;
use crate::core::vec::Vec3;

/// Origin and direction: from eye + p along forward.
pub fn orthographic_ray(view: View) -> (Vec3, Vec3) {
    (view.eye + view.across - view.down, view.forward)
}
