//! The environment that a glTF scene names in its `extras.environment`: `uri` of an image, or `sky` (the numbers of [`Sky`]
//! by their names); `intensity`, `rotation_deg`.

use super::Loader;
use super::folder::{Resolved, resolve};
use super::json::Json;
use crate::environment::decode;
use crate::error::warn;
use crate::{Environment, Error, Sky};

impl<'a> Loader<'a> {
    /// Reads the environment of `scene`, if it has one. A missing image is a warning and no environment.
    pub fn environment(&mut self, scene: &Json<'a>) -> Result<(), Error> {
        let Some(at) = scene.get("extras").and_then(|e| e.get("environment")) else {
            return Ok(());
        };
        let environment = match at.get("sky") {
            Some(sky) => Some(read_sky(&sky)?),
            None => self.environment_image(&at.need("uri")?)?,
        };
        let Some(mut environment) = environment else { return Ok(()) };
        let place = at.get("intensity");
        environment.intensity = at.number_or("intensity", 1.0)? as f32;
        if let Some(place) = place.filter(|_| environment.intensity < 0.0) {
            return Err(place.fault("a negative intensity"));
        }
        environment.rotation_deg = at.number_or("rotation_deg", 0.0)? as f32;
        self.scene.environment = Some(environment);
        Ok(())
    }

    /// Reads the image at a URI; none, with a warning, where there is no such file.
    fn environment_image(&mut self, uri: &Json<'a>) -> Result<Option<Environment>, Error> {
        let bytes = match resolve(uri, self.limits)? {
            Resolved::Bytes(bytes) => bytes,
            Resolved::Missing(reason) => {
                let message = format!("\"{}\" {reason}: there is no environment", uri.shown());
                warn(&mut self.scene.warnings, &uri.path, message);
                return Ok(None);
            }
        };
        let (environment, repaired) = decode(uri.file, &uri.path, &bytes, self.limits)?;
        if repaired > 0 {
            warn(
                &mut self.scene.warnings,
                &uri.path,
                format!("{repaired} texels are not finite or negative: 0 is used"),
            );
        }
        Ok(Some(environment))
    }
}

fn read_sky(at: &Json) -> Result<Environment, Error> {
    let default = Sky::default();
    let sky = Sky {
        elevation_deg: at.number_or("elevation_deg", default.elevation_deg)?,
        azimuth_deg: at.number_or("azimuth_deg", default.azimuth_deg)?,
        turbidity: at.number_or("turbidity", default.turbidity.into())? as f32,
        albedo: at.numbers_or("albedo", default.albedo.map(f64::from))?.map(|c| c as f32),
        sun: at.get("sun").map_or(Ok(default.sun), |_| at.flag("sun"))?,
        ..default
    };
    sky.environment().map_err(|reason| at.fault(reason))
}
