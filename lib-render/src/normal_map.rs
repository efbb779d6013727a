//! Normal maps: a shading normal per texel.

use jerboa_ir::lang::{Block, Row};

use crate::core::vec::vec3;
use crate::geometry::{Frame3, SurfaceElement};
use crate::schema::Materials;
use crate::texture::look_up;

/// The surface with the normal that the material's map gives, if it has one.
///
/// Source: glTF 2.0, section 3.9.3: n = 2 rgb − 1 in the frame of tangent, bitangent and interpolated normal, x and y
/// scaled. A map that leaves no direction at all leaves the normal as it is.
pub fn apply_normal_map(b: &mut Block, row: Row<Materials>, surf: SurfaceElement) -> SurfaceElement {
    let normal = b.if_(
        row.get(Materials::NORMAL_TEXTURED),
        |b| {
            let texel = look_up(b, row.get(Materials::NORMAL_TEXTURE), surf.uv).color.map(|c| c * 2.0 - 1.0);
            let scale = row.get(Materials::NORMAL_SCALE);
            let n = surf.local.to_world(vec3(texel.r * scale, texel.g * scale, texel.b));
            n.length2().gt(1e-12).select(n.normalize(), surf.local.normal)
        },
        |_| surf.local.normal,
    );
    SurfaceElement { local: Frame3 { normal, ..surf.local }, ..surf }
}
