//! Materials, and the facts derived from them: which lobes can be present at all.

use jerboa_scenes::{AlphaMode, Material, Scene};

use super::lobes;
use super::memory::{Memory, Table};
use super::models::resolve;
use super::textures::{Encoding, Textures};
use crate::bsdf::models::Model;
use crate::schema::Materials as M;
use crate::schema::*;

/// What stands for "F0 = 1" (glTF's ior 0): exact Fresnel at this index reflects all but 4e-6.
const IOR_OF_MIRROR: f32 = 1e6;

/// One row for each material of the scene, in its order; a scene without materials has one row that nothing uses. Their models
/// are of this list; one that [`super::models::check_models`] refuses is glTF's. `culls`: do rays pass through back faces?
pub fn materials(scene: &Scene, textures: &mut Textures, models: &[Model], culls: bool) -> Memory {
    let mut table = Table::<M>::new();
    for m in &scene.materials {
        let rows = [
            textures.row(m.base_color_texture.as_ref(), Encoding::Srgb),
            textures.row(m.metallic_roughness_texture.as_ref(), Encoding::Linear),
            textures.row(m.normal_texture.as_ref(), Encoding::Linear),
            textures.row(m.emissive_texture.as_ref(), Encoding::Srgb),
            textures.row(m.specular_texture.as_ref(), Encoding::Linear),
            textures.row(m.specular_color_texture.as_ref(), Encoding::Srgb),
            textures.row(m.transmission_texture.as_ref(), Encoding::Linear),
        ];
        let mut row = table.push();
        row.set(M::BASE_TEXTURED, m.base_color_texture.is_some()).set(M::BASE_TEXTURE, rows[0]);
        row.set(M::METALLIC_ROUGHNESS_TEXTURED, m.metallic_roughness_texture.is_some());
        row.set(M::METALLIC_ROUGHNESS_TEXTURE, rows[1]);
        row.set(M::NORMAL_TEXTURED, m.normal_texture.is_some()).set(M::NORMAL_TEXTURE, rows[2]);
        row.set(M::EMISSION_TEXTURED, m.emissive_texture.is_some()).set(M::EMISSION_TEXTURE, rows[3]);
        row.set(M::SPECULAR_TEXTURED, m.specular_texture.is_some()).set(M::SPECULAR_TEXTURE, rows[4]);
        row.set(M::SPECULAR_COLOR_TEXTURED, m.specular_color_texture.is_some()).set(M::SPECULAR_COLOR_TEXTURE, rows[5]);
        row.set(M::TRANSMISSION_TEXTURED, m.transmission_texture.is_some()).set(M::TRANSMISSION_TEXTURE, rows[6]);
        surface(&mut row, m);
        row.set(M::CULLED, culls && can_be_culled(m));
        let (model, own) = resolve(m, models).unwrap_or_default();
        row.set(M::MODEL, model).set(M::NUMBERS, textures.numbers.place(&own));
        let parts = m.model.as_ref().and_then(|model| model.parts).filter(|_| model != 0);
        let [first, second] = parts.unwrap_or_default().map(|part| part.min(scene.materials.len() - 1) as u32);
        row.set(M::FIRST, first).set(M::SECOND, second);
        match model {
            0 => {
                lobes(&mut row, m);
                lobes::extensions(&mut row, m, textures);
            }
            _ => _ = row.set(M::SMOOTH, smoothness(m.roughness, m.metallic_roughness_texture.is_some())),
        }
    }
    table.finish()
}

/// A row being filled.
pub(super) type Row<'a> = super::memory::RowMut<'a, M>;

/// Kind of surface and its numbers.
fn surface(row: &mut Row, m: &Material) {
    let (mode, cutoff) = match m.alpha_mode {
        AlphaMode::Opaque => (ALPHA_OPAQUE, 0.0),
        AlphaMode::Mask(cutoff) => (ALPHA_MASK, cutoff),
        AlphaMode::Blend => (ALPHA_BLEND, 0.0),
    };
    row.set(M::UNLIT, m.unlit).set(M::EMISSIVE, m.is_emissive()).set(M::DOUBLE_SIDED, m.double_sided);
    row.set(M::ALPHA_MODE, mode).set(M::ALPHA_CUTOFF, cutoff);
    row.set_all([M::BASE_R, M::BASE_G, M::BASE_B, M::BASE_A], m.base_color);
    row.set(M::METALLIC, m.metallic).set(M::ROUGHNESS, m.roughness).set(M::NORMAL_SCALE, m.normal_scale);
    row.set_all([M::EMISSION_R, M::EMISSION_G, M::EMISSION_B], m.emissive);
    row.set(M::IOR, if m.ior == 0.0 { IOR_OF_MIRROR } else { m.ior });
    row.set(M::SPECULAR, m.specular).set(M::TRANSMISSION, m.transmission);
    row.set_all([M::SPECULAR_R, M::SPECULAR_G, M::SPECULAR_B], m.specular_color);
    row.set_all([M::ABSORPTION_R, M::ABSORPTION_G, M::ABSORPTION_B], absorption(m)).set(M::HAS_ABSORPTION, absorbs(m));
}

/// Which lobes can be present, and whether they are perfectly smooth.
fn lobes(row: &mut Row, m: &Material) {
    let textured = m.metallic_roughness_texture.is_some();
    let all_metal = m.metallic == 1.0 && !textured;
    let metal = m.metallic > 0.0;
    let transmission = !all_metal && m.transmission > 0.0;
    let all_transmission = m.transmission == 1.0 && m.transmission_texture.is_none();
    let black = m.base_color[..3].iter().all(|c| *c == 0.0);
    let specular = !all_metal && m.specular > 0.0 && m.specular_color.iter().any(|c| *c > 0.0) && m.ior != 1.0;
    row.set(M::HAS_METAL, metal).set(M::HAS_SPECULAR, specular).set(M::HAS_TRANSMISSION, transmission);
    row.set(M::HAS_DIFFUSE, !all_metal && !all_transmission && (!black || comes_through(m))).set(M::THIN, !is_thick(m));
    let any_lobe = metal || specular || transmission;
    row.set(M::SMOOTH, if any_lobe { smoothness(m.roughness, textured) } else { SMOOTH_NEVER });
}

/// `SMOOTH_*` of a microfacet lobe of this roughness.
pub(super) fn smoothness(roughness: f32, textured: bool) -> u32 {
    match (roughness * roughness < SMOOTH_ALPHA, textured) {
        (true, _) => SMOOTH_ALWAYS,
        (false, true) => SMOOTH_PER_HIT,
        (false, false) => SMOOTH_NEVER,
    }
}

/// Does diffuse light come through?
fn comes_through(m: &Material) -> bool {
    m.diffuse_transmission.is_some_and(|lobe| lobe.factor > 0.0 && lobe.color.iter().any(|c| *c > 0.0))
}

/// Has the surface an inside?
fn is_thick(m: &Material) -> bool {
    m.volume.as_ref().is_some_and(|v| v.thickness > 0.0)
}

/// Absorption coefficients, 1/m. KHR_materials_volume: `attenuation_color` is what is left of white light after
/// `attenuation_distance`.
fn absorption(m: &Material) -> [f32; 3] {
    let Some(v) = &m.volume else { return [0.0; 3] };
    v.attenuation_color.map(|c| -c.max(f32::MIN_POSITIVE).ln() / v.attenuation_distance)
}

/// Absorption coefficients inside, 1/m; none where the surface has no inside.
pub fn inside(m: &Material) -> Option<[f32; 3]> {
    is_thick(m).then(|| absorption(m))
}

/// Does glTF say that nobody sees it from behind? Not of a boundary that light goes through, nor of models that are not glTF's.
pub fn can_be_culled(m: &Material) -> bool {
    let transmits = m.transmission > 0.0 || m.diffuse_transmission.is_some() || is_thick(m);
    !m.double_sided && !transmits && m.model.is_none()
}

/// Does light get lost inside?
pub fn absorbs(m: &Material) -> bool {
    inside(m).is_some_and(|absorption| absorption.iter().any(|s| *s > 0.0))
}
