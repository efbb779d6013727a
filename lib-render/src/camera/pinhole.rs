//! The pinhole, a perspective camera: all rays go through the eye.

use crate::camera::View;
use crate::core::vec::Vec3;

/// Origin and direction: from the eye along forward + p.
pub fn pinhole_ray(view: View) -> (Vec3, Vec3) {
    (view.eye, view.ahead().normalize())
}
