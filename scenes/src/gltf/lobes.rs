//! The lobes of a material that extensions add.

use super::Loader;
use super::json::Json;
use super::material::UNIT;
use crate::{Clearcoat, Error, Material};

impl<'a> Loader<'a> {
    /// Reads the lobes of the material at `at`.
    pub(super) fn read_lobes(&mut self, at: &Json<'a>, m: &mut Material) -> Result<(), Error> {
        if let Some(ext) = at.extension("KHR_materials_clearcoat") {
            m.clearcoat = Some(self.clearcoat(&ext)?);
        }
        Ok(())
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
