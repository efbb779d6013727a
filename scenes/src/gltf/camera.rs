//! Cameras: glTF's two, and what `extras` make of a perspective one.

use super::Loader;
use super::json::Json;
use super::schema::CameraType;
use crate::error::warn;
use crate::{Camera, Error, Lens};
use glam::DAffine3;
use std::f64::consts::{PI, TAU};

impl<'a> Loader<'a> {
    /// Adds the camera that a node refers to.
    pub fn camera(&mut self, reference: &Json<'a>, node: &Json, to_world: DAffine3) -> Result<(), Error> {
        let (_, at) = reference.refer(&self.root, "cameras", "cameras")?;
        let (lens, aspect) = match at.need("type")?.word()? {
            CameraType::Perspective => {
                let lens = at.need("perspective")?;
                let yfov = inside(&lens.need("yfov")?, PI)?;
                let aspect = lens.get("aspectRatio").map(|a| inside(&a, f64::INFINITY)).transpose()?;
                (Lens::Pinhole { yfov }, aspect)
            }
            CameraType::Orthographic => self.orthographic(&at.need("orthographic")?)?,
        };
        let extras = at.get("extras");
        let film = extras.as_ref().map(film).transpose()?.flatten();
        let name = if at.name().is_empty() { node.name() } else { at.name() };
        let camera = Camera { name, to_world, lens, aspect, film };
        self.scene.cameras.push(extras.map_or(Ok(camera.clone()), |extras| special(&extras, camera))?);
        Ok(())
    }

    /// The lens and the aspect of what is seen; its height holds whatever the film's aspect is.
    fn orthographic(&mut self, at: &Json<'a>) -> Result<(Lens, Option<f64>), Error> {
        let mut side = |key| {
            let place = at.need(key)?;
            let side = place.number()?;
            if side < 0.0 {
                warn(&mut self.scene.warnings, &place.path, "a negative magnification: its absolute value is used");
            }
            if (side as f32) == 0.0 { Err(place.fault("0; what is seen has no size")) } else { Ok(side.abs()) }
        };
        let (xmag, ymag) = (side("xmag")?, side("ymag")?);
        Ok((Lens::Orthographic { ymag }, Some(xmag / ymag)))
    }
}

/// A number above 0 and below `end`.
fn inside(at: &Json, end: f64) -> Result<f64, Error> {
    let x = at.number()?;
    let range = || if end == PI { "between 0 and pi" } else { "above 0" };
    if x > 0.0 && x < end { Ok(x) } else { Err(at.fault(format!("{x} is not {}", range()))) }
}

/// A camera with the thin lens or the fisheye lens that its extras ask for.
fn special(extras: &Json, camera: Camera) -> Result<Camera, Error> {
    let number = |key: &str| extras.get(key).map(|at| Ok((at.number()?, at))).transpose();
    if let Some((angle, at)) = number("fisheye")? {
        if !(angle > 0.0 && angle <= TAU) {
            return Err(at.fault(format!("{angle} is not above 0 and at most 2 pi")));
        }
        return Ok(Camera { lens: Lens::Fisheye { angle }, ..camera });
    }
    let Some((aperture, at)) = number("aperture")? else {
        return Ok(camera);
    };
    let focus = number("focus")?.map(|(focus, _)| focus);
    let fault = || at.fault("a thin lens takes a perspective, an aperture of 0 or more and a focus above 0");
    camera.with_lens(Some(aperture), focus).ok_or_else(fault)
}

/// Film size from a camera's extras: both numbers or neither.
fn film(extras: &Json) -> Result<Option<(u32, u32)>, Error> {
    const SIDE: u64 = 65536;
    let (Some(width), Some(height)) = (extras.get("width"), extras.get("height")) else {
        return Ok(None);
    };
    let side = |at: &Json| match at.integer()? {
        n @ 1..=SIDE => Ok(n as u32),
        n => Err(at.fault(format!("a film of {n} pixels a side, not 1 to {SIDE}"))),
    };
    Ok(Some((side(&width)?, side(&height)?)))
}
