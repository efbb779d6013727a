//! The environment that a glTF scene names in its `extras.environment`: `uri`, `intensity`, `rotation_deg`.

use super::Loader;
use super::folder::{Resolved, resolve};
use super::json::Json;
use crate::Error;
use crate::environment::decode;
use crate::error::warn;

impl<'a> Loader<'a> {
    /// Reads the environment of `scene`, if it has one. A missing image is a warning and no environment.
    pub fn environment(&mut self, scene: &Json<'a>) -> Result<(), Error> {
        let Some(at) = scene.get("extras").and_then(|e| e.get("environment")) else {
            return Ok(());
        };
        let uri = at.need("uri")?;
        let bytes = match resolve(&uri, self.limits)? {
            Resolved::Bytes(bytes) => bytes,
            Resolved::Missing(reason) => {
                let message = format!("\"{}\" {reason}: there is no environment", uri.shown());
                warn(&mut self.scene.warnings, &uri.path, message);
                return Ok(());
            }
        };
        let (mut environment, repaired) = decode(uri.file, &uri.path, &bytes, self.limits)?;
        if repaired > 0 {
            warn(
                &mut self.scene.warnings,
                &uri.path,
                format!("{repaired} texels are not finite or negative: 0 is used"),
            );
        }
        let place = at.get("intensity");
        environment.intensity = at.number_or("intensity", 1.0)? as f32;
        if let Some(place) = place.filter(|_| environment.intensity < 0.0) {
            return Err(place.fault("a negative intensity"));
        }
        environment.rotation_deg = at.number_or("rotation_deg", 0.0)? as f32;
        self.scene.environment = Some(environment);
        Ok(())
    }
}
