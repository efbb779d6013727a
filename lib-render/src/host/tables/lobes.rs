//! The lobes that glTF's extensions add to a material.

use jerboa_scenes::{Clearcoat, Material};

use super::materials::{Row, smoothness};
use super::textures::{Encoding, Textures};
use crate::schema::Materials as M;

/// Fills the columns of the lobes that the material has; those of the others are 0.
pub(super) fn extensions(row: &mut Row, m: &Material, textures: &mut Textures) {
    // A texture only takes away from a factor.
    if let Some(coat) = m.clearcoat.as_ref().filter(|coat| coat.factor > 0.0) {
        clearcoat(row, coat, textures);
    }
}

fn clearcoat(row: &mut Row, coat: &Clearcoat, textures: &mut Textures) {
    row.set(M::HAS_COAT, true).set(M::COAT, coat.factor).set(M::COAT_ROUGHNESS, coat.roughness);
    row.set(M::COAT_SMOOTH, smoothness(coat.roughness, coat.roughness_texture.is_some()));
    row.set(M::COAT_TEXTURED, coat.texture.is_some());
    row.set(M::COAT_TEXTURE, textures.row(coat.texture.as_ref(), Encoding::Linear));
    row.set(M::COAT_ROUGHNESS_TEXTURED, coat.roughness_texture.is_some());
    row.set(M::COAT_ROUGHNESS_TEXTURE, textures.row(coat.roughness_texture.as_ref(), Encoding::Linear));
    row.set(M::COAT_NORMAL_TEXTURED, coat.normal_texture.is_some()).set(M::COAT_NORMAL_SCALE, coat.normal_scale);
    row.set(M::COAT_NORMAL_TEXTURE, textures.row(coat.normal_texture.as_ref(), Encoding::Linear));
}
