//! KHR_lights_punctual.

use super::Loader;
use super::json::Json;
use super::schema::LightType;
use crate::{Error, Light, LightKind};
use glam::DAffine3;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

impl<'a> Loader<'a> {
    /// Adds the light that a node's extension refers to.
    pub fn light(&mut self, reference: &Json<'a>, to_world: DAffine3) -> Result<(), Error> {
        let Some(list) = self.root.extension("KHR_lights_punctual") else {
            return Err(reference.fault("the file has no KHR_lights_punctual lights"));
        };
        let (_, at) = reference.refer(&list, "lights", "lights")?;
        let kind = match at.need("type")?.word()? {
            LightType::Point => LightKind::Point,
            LightType::Directional => LightKind::Directional,
            LightType::Spot => {
                let cone = at.need("spot")?;
                let inner = cone.number_or("innerConeAngle", 0.0)?;
                let outer = cone.number_or("outerConeAngle", FRAC_PI_4)?;
                if !(0.0 <= inner && inner < outer && outer <= FRAC_PI_2 + 1e-6) {
                    return Err(cone.fault("cone angles must be 0 <= inner < outer <= pi/2"));
                }
                LightKind::Spot { inner: inner as f32, outer: outer as f32 }
            }
        };
        let strength = at.number_or("intensity", 1.0)?;
        let intensity = at.numbers_or("color", [1.0; 3])?.map(|c| (c * strength) as f32);
        if intensity.iter().any(|c| !c.is_finite() || *c < 0.0) {
            return Err(at.fault("color x intensity must be finite and not negative"));
        }
        self.count_lights(reference, 1)?;
        self.scene.lights.push(Light { name: at.name(), kind, intensity, to_world });
        Ok(())
    }

    /// Counts so many light sources more.
    pub fn count_lights(&mut self, at: &Json<'a>, more: u64) -> Result<(), Error> {
        self.lights_left = self.lights_left.checked_sub(more).ok_or_else(|| {
            let limit = format!("{} light sources (lights)", self.limits.lights);
            at.limit_fault(format!("the scene up to here, {more} lamps or emissive triangles more,"), limit)
        })?;
        Ok(())
    }
}
