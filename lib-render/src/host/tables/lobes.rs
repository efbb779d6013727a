//! The lobes that glTF's extensions add to a material.

use jerboa_scenes::{Anisotropy, Clearcoat, DiffuseTransmission, Iridescence, Material, Sheen};

use super::materials::{Row, smoothness};
use super::textures::{Encoding, Textures};
use crate::lobes::Lobe;
use crate::schema::{Materials as M, SMOOTH_NEVER};

/// Has the material this lobe? A texture only takes away from a factor.
pub(super) fn has(m: &Material, lobe: Lobe) -> bool {
    match lobe {
        Lobe::Coat => m.clearcoat.as_ref().is_some_and(|coat| coat.factor > 0.0),
        Lobe::Sheen => m.sheen.as_ref().is_some_and(|sheen| sheen.color.iter().any(|c| *c > 0.0)),
        Lobe::Anisotropy => m.anisotropy.as_ref().is_some_and(|lobe| lobe.strength > 0.0),
        Lobe::DiffuseTransmission => m.diffuse_transmission.as_ref().is_some_and(|lobe| lobe.factor > 0.0),
        Lobe::Film => m.iridescence.as_ref().is_some_and(|film| film.factor > 0.0),
    }
}

/// Fills the columns of the lobes that the material has; those of the others are 0.
pub(super) fn extensions(row: &mut Row, m: &Material, textures: &mut Textures) {
    if let Some(lobe) = m.anisotropy.as_ref().filter(|_| has(m, Lobe::Anisotropy)) {
        anisotropy(row, lobe, textures);
    }
    if let Some(lobe) = m.diffuse_transmission.as_ref().filter(|_| has(m, Lobe::DiffuseTransmission)) {
        diffuse_transmission(row, lobe, textures);
    }
    if let Some(film) = m.iridescence.as_ref().filter(|_| has(m, Lobe::Film)) {
        iridescence(row, film, textures);
    }
    if let Some(layer) = m.sheen.as_ref().filter(|_| has(m, Lobe::Sheen)) {
        sheen(row, layer, textures);
    }
    if let Some(coat) = m.clearcoat.as_ref().filter(|_| has(m, Lobe::Coat)) {
        clearcoat(row, coat, textures);
    }
}

fn anisotropy(row: &mut Row, lobe: &Anisotropy, textures: &mut Textures) {
    let (sin, cos) = lobe.rotation.sin_cos();
    row.set(M::HAS_ANISOTROPY, true).set(M::ANISOTROPY, lobe.strength);
    row.set(M::ANISOTROPY_X, cos).set(M::ANISOTROPY_Y, sin).set(M::SMOOTH, SMOOTH_NEVER);
    row.set(M::ANISOTROPY_TEXTURED, lobe.texture.is_some());
    row.set(M::ANISOTROPY_TEXTURE, textures.row(lobe.texture.as_ref(), Encoding::Linear));
}

fn diffuse_transmission(row: &mut Row, lobe: &DiffuseTransmission, textures: &mut Textures) {
    row.set(M::HAS_DIFFUSE_TRANSMISSION, true).set(M::DIFFUSE_TRANSMISSION, lobe.factor);
    row.set_all([M::DIFFUSE_TRANSMISSION_R, M::DIFFUSE_TRANSMISSION_G, M::DIFFUSE_TRANSMISSION_B], lobe.color);
    row.set(M::DIFFUSE_TRANSMISSION_TEXTURED, lobe.texture.is_some());
    row.set(M::DIFFUSE_TRANSMISSION_TEXTURE, textures.row(lobe.texture.as_ref(), Encoding::Linear));
    row.set(M::DIFFUSE_TRANSMISSION_COLOR_TEXTURED, lobe.color_texture.is_some());
    row.set(M::DIFFUSE_TRANSMISSION_COLOR_TEXTURE, textures.row(lobe.color_texture.as_ref(), Encoding::Srgb));
}

fn iridescence(row: &mut Row, film: &Iridescence, textures: &mut Textures) {
    row.set(M::HAS_FILM, true).set(M::FILM, film.factor).set(M::FILM_IOR, film.ior);
    row.set(M::FILM_THINNEST, film.thinnest).set(M::FILM_THICKEST, film.thickest);
    row.set(M::FILM_TEXTURED, film.texture.is_some());
    row.set(M::FILM_TEXTURE, textures.row(film.texture.as_ref(), Encoding::Linear));
    row.set(M::FILM_THICKNESS_TEXTURED, film.thickness_texture.is_some());
    row.set(M::FILM_THICKNESS_TEXTURE, textures.row(film.thickness_texture.as_ref(), Encoding::Linear));
}

fn sheen(row: &mut Row, layer: &Sheen, textures: &mut Textures) {
    row.set(M::HAS_SHEEN, true).set(M::SHEEN_ROUGHNESS, layer.roughness);
    row.set_all([M::SHEEN_R, M::SHEEN_G, M::SHEEN_B], layer.color);
    row.set(M::SHEEN_COLOR_TEXTURED, layer.color_texture.is_some());
    row.set(M::SHEEN_COLOR_TEXTURE, textures.row(layer.color_texture.as_ref(), Encoding::Srgb));
    row.set(M::SHEEN_ROUGHNESS_TEXTURED, layer.roughness_texture.is_some());
    row.set(M::SHEEN_ROUGHNESS_TEXTURE, textures.row(layer.roughness_texture.as_ref(), Encoding::Linear));
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
