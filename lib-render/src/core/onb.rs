//! A frame around one direction.

use jerboa_ir::lang::F32;

use crate::core::vec::{Vec3, vec3};

/// Two unit vectors that complete a unit vector n to a right-handed frame.
///
/// Source: Duff, Burgess, Christensen, Hery, Kensler, Liani, Villemin 2017, "Building an orthonormal basis, revisited",
/// JCGT 6(1), listing 3. No branch, and accurate for every n, −z included (N7).
pub fn onb(n: Vec3) -> (Vec3, Vec3) {
    let sign = F32::from(1.0).copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (vec3(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), vec3(b, sign + n.y * n.y * a, -n.y))
}
