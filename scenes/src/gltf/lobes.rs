//! The lobes of a material that extensions add.

use super::Loader;
use super::json::Json;
use super::material::UNIT;
use crate::{Anisotropy, Clearcoat, DiffuseTransmission, Error, Iridescence, Material, Sheen};
use std::ops::RangeInclusive;

/// Thickness of films; a thousandth of the largest has no colours left.
const NANOMETRES: RangeInclusive<f64> = 0.0..=1e7;

impl<'a> Loader<'a> {
    /// Reads the lobes of the material at `at`.
    pub(super) fn read_lobes(&mut self, at: &Json<'a>, m: &mut Material) -> Result<(), Error> {
        if let Some(ext) = at.extension("KHR_materials_anisotropy")? {
            m.anisotropy = Some(Anisotropy {
                strength: self.factor(&ext, "anisotropyStrength", 0.0, UNIT)?,
                rotation: ext.number_or("anisotropyRotation", 0.0)? as f32,
                texture: self.texture_ref(&ext, "anisotropyTexture")?,
            });
        }
        if let Some(ext) = at.extension("KHR_materials_diffuse_transmission")? {
            m.diffuse_transmission = Some(DiffuseTransmission {
                factor: self.factor(&ext, "diffuseTransmissionFactor", 0.0, UNIT)?,
                texture: self.texture_ref(&ext, "diffuseTransmissionTexture")?,
                color: self.factors(&ext, "diffuseTransmissionColorFactor", [1.0; 3], UNIT)?,
                color_texture: self.texture_ref(&ext, "diffuseTransmissionColorTexture")?,
            });
        }
        if let Some(ext) = at.extension("KHR_materials_iridescence")? {
            m.iridescence = Some(self.iridescence(&ext)?);
        }
        if let Some(ext) = at.extension("KHR_materials_sheen")? {
            m.sheen = Some(Sheen {
                color: self.factors(&ext, "sheenColorFactor", [0.0; 3], UNIT)?,
                color_texture: self.texture_ref(&ext, "sheenColorTexture")?,
                roughness: self.factor(&ext, "sheenRoughnessFactor", 0.0, UNIT)?,
                roughness_texture: self.texture_ref(&ext, "sheenRoughnessTexture")?,
            });
        }
        if let Some(ext) = at.extension("KHR_materials_clearcoat")? {
            m.clearcoat = Some(self.clearcoat(&ext)?);
        }
        Ok(())
    }

    fn iridescence(&mut self, ext: &Json<'a>) -> Result<Iridescence, Error> {
        Ok(Iridescence {
            factor: self.factor(ext, "iridescenceFactor", 0.0, UNIT)?,
            texture: self.texture_ref(ext, "iridescenceTexture")?,
            ior: self.factor(ext, "iridescenceIor", 1.3, 1.0..=100.0)?,
            thinnest: self.factor(ext, "iridescenceThicknessMinimum", 100.0, NANOMETRES)?,
            thickest: self.factor(ext, "iridescenceThicknessMaximum", 400.0, NANOMETRES)?,
            thickness_texture: self.texture_ref(ext, "iridescenceThicknessTexture")?,
        })
    }

    fn clearcoat(&mut self, ext: &Json<'a>) -> Result<Clearcoat, Error> {
        Ok(Clearcoat {
            factor: self.factor(ext, "clearcoatFactor", 0.0, UNIT)?,
            texture: self.texture_ref(ext, "clearcoatTexture")?,
            roughness: self.factor(ext, "clearcoatRoughnessFactor", 0.0, UNIT)?,
            roughness_texture: self.texture_ref(ext, "clearcoatRoughnessTexture")?,
            normal_texture: self.texture_ref(ext, "clearcoatNormalTexture")?,
            normal_scale: self.normal_scale(ext, "clearcoatNormalTexture")?,
        })
    }
}
