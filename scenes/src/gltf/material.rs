//! Materials and the textures they use; loaded when a mesh that is in the scene refers to them.

use super::Loader;
use super::json::Json;
use super::schema;
use crate::error::warn;
use crate::{AlphaMode, Error, Material, TextureRef, UvTransform, Volume};
use std::ops::RangeInclusive;

pub(super) const UNIT: RangeInclusive<f64> = 0.0..=1.0;
pub(super) const NOT_NEGATIVE: RangeInclusive<f64> = 0.0..=f32::MAX as f64;

impl<'a> Loader<'a> {
    /// The scene's material for the index at `reference`; without one, glTF's default material.
    pub fn material(&mut self, reference: Option<Json<'a>>) -> Result<usize, Error> {
        let found = reference.map(|r| r.refer(&self.root, "materials", "materials")).transpose()?;
        let index = found.as_ref().map(|(i, _)| *i);
        if let Some(&known) = self.materials.get(&index) {
            return Ok(known);
        }
        let material = match &found {
            Some((_, at)) => self.read_material(at)?,
            None => Material::default(),
        };
        self.scene.materials.push(material);
        let new = self.scene.materials.len() - 1;
        self.materials.insert(index, new);
        Ok(new)
    }

    fn read_material(&mut self, at: &Json<'a>) -> Result<Material, Error> {
        let mut m = Material { name: at.name(), ..Material::default() };
        if let Some(pbr) = at.get("pbrMetallicRoughness") {
            m.base_color = self.factors(&pbr, "baseColorFactor", m.base_color, UNIT)?;
            m.base_color_texture = self.texture_ref(&pbr, "baseColorTexture")?;
            m.metallic = self.factor(&pbr, "metallicFactor", m.metallic, UNIT)?;
            m.roughness = self.factor(&pbr, "roughnessFactor", m.roughness, UNIT)?;
            m.metallic_roughness_texture = self.texture_ref(&pbr, "metallicRoughnessTexture")?;
        }
        m.normal_texture = self.texture_ref(at, "normalTexture")?;
        m.normal_scale = self.normal_scale(at, "normalTexture")?;
        m.emissive = self.factors(at, "emissiveFactor", m.emissive, NOT_NEGATIVE)?;
        m.emissive_texture = self.texture_ref(at, "emissiveTexture")?;
        m.alpha_mode = self.alpha_mode(at)?;
        m.double_sided = at.flag("doubleSided")?;
        m.unlit = at.extension("KHR_materials_unlit")?.is_some();
        self.read_extensions(at, &mut m)?;
        self.read_lobes(at, &mut m)?;
        m.model = self.model(at)?;
        Ok(m)
    }

    fn read_extensions(&mut self, at: &Json<'a>, m: &mut Material) -> Result<(), Error> {
        if let Some(ext) = at.extension("KHR_materials_emissive_strength")? {
            let strength = self.factor(&ext, "emissiveStrength", 1.0, NOT_NEGATIVE)?;
            m.emissive = m.emissive.map(|c| c * strength);
            if m.emissive.iter().any(|c| !c.is_finite()) {
                return Err(ext.fault("emissiveFactor x emissiveStrength is beyond the range of single precision"));
            }
        }
        if let Some(ext) = at.extension("KHR_materials_ior")? {
            m.ior = ext.number_or("ior", 1.5)? as f32;
            if m.ior != 0.0 && m.ior < 1.0 {
                warn(&mut self.scene.warnings, &ext.path, "ior is below 1 (and not the special 0): 1 is used");
                m.ior = 1.0;
            }
        }
        if let Some(ext) = at.extension("KHR_materials_specular")? {
            m.specular = self.factor(&ext, "specularFactor", 1.0, UNIT)?;
            m.specular_texture = self.texture_ref(&ext, "specularTexture")?;
            m.specular_color = self.factors(&ext, "specularColorFactor", [1.0; 3], NOT_NEGATIVE)?;
            m.specular_color_texture = self.texture_ref(&ext, "specularColorTexture")?;
        }
        if let Some(ext) = at.extension("KHR_materials_transmission")? {
            m.transmission = self.factor(&ext, "transmissionFactor", 0.0, UNIT)?;
            m.transmission_texture = self.texture_ref(&ext, "transmissionTexture")?;
        }
        if let Some(ext) = at.extension("KHR_materials_volume")? {
            m.volume = Some(Volume {
                thickness: self.factor(&ext, "thicknessFactor", 0.0, NOT_NEGATIVE)?,
                thickness_texture: self.texture_ref(&ext, "thicknessTexture")?,
                attenuation_distance: match self.factor(&ext, "attenuationDistance", f32::INFINITY, NOT_NEGATIVE)? {
                    0.0 => {
                        return Err(ext.need("attenuationDistance")?.fault("0; it must be above 0"));
                    }
                    distance => distance,
                },
                attenuation_color: self.factors(&ext, "attenuationColor", [1.0; 3], UNIT)?,
            });
        }
        Ok(())
    }

    fn alpha_mode(&mut self, at: &Json<'a>) -> Result<AlphaMode, Error> {
        Ok(match at.word_or("alphaMode", schema::AlphaMode::Opaque)? {
            schema::AlphaMode::Opaque => AlphaMode::Opaque,
            schema::AlphaMode::Mask => AlphaMode::Mask(self.factor(at, "alphaCutoff", 0.5, NOT_NEGATIVE)?),
            schema::AlphaMode::Blend => AlphaMode::Blend,
        })
    }

    /// Scale of x and y of the normal map there.
    pub(super) fn normal_scale(&self, at: &Json, key: &str) -> Result<f32, Error> {
        at.get(key).map_or(Ok(1.0), |map| Ok(map.number_or("scale", 1.0)? as f32))
    }

    /// A number clamped to `range`, with a warning where that changes it.
    pub(super) fn factor(
        &mut self,
        at: &Json,
        key: &str,
        default: f32,
        range: RangeInclusive<f64>,
    ) -> Result<f32, Error> {
        let Some(place) = at.get(key) else {
            return Ok(default);
        };
        let number = place.number()?;
        Ok(self.clamp(&place, number, range))
    }

    /// `N` numbers, each clamped to `range`.
    pub(super) fn factors<const N: usize>(
        &mut self,
        at: &Json,
        key: &str,
        default: [f32; N],
        range: RangeInclusive<f64>,
    ) -> Result<[f32; N], Error> {
        let Some(place) = at.get(key) else {
            return Ok(default);
        };
        let numbers = place.numbers::<N>()?;
        Ok(numbers.map(|x| self.clamp(&place, x, range.clone())))
    }

    fn clamp(&mut self, at: &Json, x: f64, range: RangeInclusive<f64>) -> f32 {
        if !range.contains(&x) {
            warn(&mut self.scene.warnings, &at.path, "a factor out of its range is clamped");
        }
        x.clamp(*range.start(), *range.end()) as f32
    }

    /// A texture reference of a material. `None` too where the texture cannot be had: the factor then stands alone, as if
    /// the texture were white (a normal map: flat).
    pub(super) fn texture_ref(&mut self, at: &Json<'a>, key: &str) -> Result<Option<TextureRef>, Error> {
        let Some(place) = at.get(key) else {
            return Ok(None);
        };
        let transform = place.extension("KHR_texture_transform")?;
        let mut uv_set = place.integer_or("texCoord", 0)?;
        if let Some(ext) = &transform {
            uv_set = ext.integer_or("texCoord", uv_set)?;
        }
        let transform = transform.map(|ext| self.uv_transform(&ext)).transpose()?;
        if uv_set > 1 {
            warn(
                &mut self.scene.warnings,
                &place.path,
                "texture coordinate sets above 1 are unknown: the texture is left out",
            );
            return Ok(None);
        }
        let texture = self.texture(&place.need("index")?)?;
        Ok(texture.map(|texture| TextureRef { texture, uv_set: uv_set as usize, transform }))
    }

    fn uv_transform(&mut self, ext: &Json) -> Result<UvTransform, Error> {
        Ok(UvTransform {
            offset: ext.numbers_or("offset", [0.0; 2])?.map(|x| x as f32),
            rotation: ext.number_or("rotation", 0.0)? as f32,
            scale: ext.numbers_or("scale", [1.0; 2])?.map(|x| x as f32),
        })
    }
}
