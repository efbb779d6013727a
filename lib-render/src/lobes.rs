//! The layers that glTF's extensions put over its material, read from their columns.

use jerboa_ir::lang::{Block, Row};

use crate::bsdf::Bsdf;
use crate::bsdf::coat::{CoatValues, make_coat};
use crate::bsdf::gltf::GltfValues;
use crate::bsdf::layer::make_layered_bsdf;
use crate::bsdf::models::Site;
use crate::geometry::SurfaceElement;
use crate::material::is_smooth;
use crate::normal_map::{NormalMap, mapped_normal};
use crate::schema::Materials;
use crate::texture::look_up;

/// The normal map of the coat.
const COAT_NORMALS: NormalMap =
    (Materials::COAT_NORMAL_TEXTURED, Materials::COAT_NORMAL_TEXTURE, Materials::COAT_NORMAL_SCALE);

/// `base`, which has these values, under the layers of its material.
pub fn make_layers(b: &mut Block, site: Site, values: GltfValues, base: Bsdf) -> Bsdf {
    let coat = coat_values(b, site.row, site.plain, values);
    make_layered_bsdf(site.surf, make_coat(site.surf, 0, coat), base)
}

/// The coat over a material with these values.
fn coat_values(b: &mut Block, row: Row<Materials>, plain: SurfaceElement, under: GltfValues) -> CoatValues {
    let get = |column| row.get(column);
    let uv = plain.uv;
    let strength = b.if_(
        row.get(Materials::COAT_TEXTURED),
        |b| get(Materials::COAT) * look_up(b, row.get(Materials::COAT_TEXTURE), uv).color.r,
        |_| get(Materials::COAT),
    );
    let roughness = b.if_(
        row.get(Materials::COAT_ROUGHNESS_TEXTURED),
        |b| get(Materials::COAT_ROUGHNESS) * look_up(b, row.get(Materials::COAT_ROUGHNESS_TEXTURE), uv).color.g,
        |_| get(Materials::COAT_ROUGHNESS),
    );
    let alpha = roughness * roughness;
    CoatValues {
        present: row.get(Materials::HAS_COAT),
        smooth: is_smooth(row.get(Materials::COAT_SMOOTH), alpha),
        tilted: row.get(Materials::NORMAL_TEXTURED) | row.get(Materials::COAT_NORMAL_TEXTURED),
        solid: under.is_solid(),
        strength,
        alpha,
        normal: mapped_normal(b, row, COAT_NORMALS, plain),
        under: under.base.max_channel().max(0.04),
    }
}
