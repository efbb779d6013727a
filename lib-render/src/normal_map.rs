//! Normal maps: a shading normal per texel.

use jerboa_ir::lang::{Block, Bool, Col, F32, Row};

use crate::core::vec::{Vec3, vec3};
use crate::geometry::{Frame3, SurfaceElement};
use crate::schema::{Materials, Textures};
use crate::texture::look_up;

/// Where a material has a normal map: is there one, the map, and the scale of its x and y.
pub type NormalMap = (Col<Materials, Bool>, Col<Materials, Row<Textures>>, Col<Materials, F32>);

/// The map of the surface itself.
const OWN: NormalMap = (Materials::NORMAL_TEXTURED, Materials::NORMAL_TEXTURE, Materials::NORMAL_SCALE);

/// The surface with the normal that the material's map gives, if it has one.
pub fn apply_normal_map(b: &mut Block, row: Row<Materials>, surf: SurfaceElement) -> SurfaceElement {
    let normal = mapped_normal(b, row, OWN, surf);
    SurfaceElement { local: Frame3 { normal, ..surf.local }, ..surf }
}

/// The shading normal that a map gives, if there is one, on a surface whose normal no map has changed.
///
/// Source: glTF 2.0, section 3.9.3: n = 2 rgb − 1 in the frame of tangent, bitangent and interpolated normal, x and y
/// scaled. A map that leaves no direction at all leaves the normal as it is.
pub fn mapped_normal(b: &mut Block, row: Row<Materials>, (flag, map, scale): NormalMap, surf: SurfaceElement) -> Vec3 {
    b.if_(
        row.get(flag),
        |b| {
            let texel = look_up(b, row.get(map), surf.uv).color.map(|c| c * 2.0 - 1.0);
            let scale = row.get(scale);
            let n = surf.local.to_world(vec3(texel.r * scale, texel.g * scale, texel.b));
            n.length2().gt(1e-12).select(n.normalize(), surf.local.normal)
        },
        |_| surf.local.normal,
    )
}
