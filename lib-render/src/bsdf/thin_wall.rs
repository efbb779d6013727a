//! A wall without an inside, as glTF has it where a material that transmits has no volume: light passes unbent.
//!
//! Source: KHR_materials_transmission, "Transmission BTDF"; Walter, Marschner, Li, Torrance 2007, section 5.1, for the lobe whose
//! mirror image it is.

use crate::core::vec::{Vec3, vec3};

/// Where a smooth wall lets light through that goes to `wo`.
pub fn straight(wo: Vec3) -> Vec3 {
    -wo
}

/// Behind a rough wall, where it passes the mirror image of what it reflects: the direction before it, and back again. Local.
pub fn behind(w: Vec3) -> Vec3 {
    vec3(w.x, w.y, -w.z)
}
