//! KHR_lights_punctual, with a size: `extras.radius` of a point or a spot, m, and `extras.angle` of a directional light, radians
//! from rim to rim. 0 is none.

use super::Loader;
use super::json::Json;
use super::schema::LightType;
use crate::{Error, Light, LightKind};
use glam::DAffine3;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

impl<'a> Loader<'a> {
    /// Adds the light that a node's extension refers to.
    pub fn light(&mut self, reference: &Json<'a>, to_world: DAffine3) -> Result<(), Error> {
        let Some(list) = self.root.extension("KHR_lights_punctual")? else {
            return Err(reference.fault("the file has no KHR_lights_punctual lights"));
        };
        let (_, at) = reference.refer(&list, "lights", "lights")?;
        let radius = || size(&at, "radius", f64::from(f32::MAX), "a radius is a finite number of metres, 0 or more");
        let kind = match at.need("type")?.word()? {
            LightType::Point => radius()?.map_or(LightKind::Point, |radius| LightKind::Sphere { radius }),
            LightType::Directional => {
                let angle = size(&at, "angle", PI, "the angle across a sun is 0 to pi, in radians")?;
                angle.map_or(LightKind::Directional, |angle| LightKind::Sun { angle })
            }
            LightType::Spot => {
                let cone = at.need("spot")?;
                let inner = cone.number_or("innerConeAngle", 0.0)?;
                let outer = cone.number_or("outerConeAngle", FRAC_PI_4)?;
                if !(0.0 <= inner && inner < outer && outer <= FRAC_PI_2 + 1e-6) {
                    return Err(cone.fault("cone angles must be 0 <= inner < outer <= pi/2"));
                }
                let [inner, outer] = [inner, outer].map(|angle| angle as f32);
                radius()?.map_or(LightKind::Spot { inner, outer }, |radius| LightKind::Disk { inner, outer, radius })
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

/// A light's size in its extras, at most so large; none where it is absent, 0, or rounds to 0.
fn size(light: &Json, key: &str, most: f64, range: &str) -> Result<Option<f32>, Error> {
    let Some(at) = light.get("extras").and_then(|extras| extras.get(key)) else {
        return Ok(None);
    };
    match at.number()? {
        x if (0.0..=most).contains(&x) => Ok(Some(x as f32).filter(|x| *x > 0.0)),
        x => Err(at.fault(format!("{x}: {range}"))),
    }
}
