//! The thread that takes edits, in order, and makes a renderer of each.

use std::mem::swap;
use std::sync::Arc;

use jerboa_scenes::{self as scenes, Scene, TextureSource};

use super::{Live, Shared, Value};
use crate::host::edit::{Edit, Part};
use crate::host::error::Error;

/// Makes renderers of edits.
pub(super) struct Editor<'s> {
    shared: &'s Shared,
    scene: Scene,
    /// What it made last.
    live: Live,
}

impl<'s> Editor<'s> {
    /// One that begins with what is live.
    pub(super) fn new(shared: &'s Shared, scene: Scene, live: Live) -> Editor<'s> {
        Editor { shared, scene, live }
    }

    /// Takes edits until the session ends.
    pub(super) fn run(&mut self) -> Result<(), Error> {
        while let Some((number, value)) = self.next() {
            let outcome = self.apply(value);
            let mut state = self.shared.lock();
            if outcome.is_ok() {
                self.live.revision = number;
                state.live = self.live.clone();
                state.handle.cancel();
            }
            if let Some(outcome) = outcome.transpose() {
                state.outcomes.insert(number, outcome);
            }
            self.shared.changed.notify_all();
        }
        Ok(())
    }

    /// Waits for the next edit; nothing at the end.
    fn next(&self) -> Option<(u64, Value)> {
        let mut state = self.shared.lock();
        while !state.stopped {
            if !state.queue.is_empty() {
                return Some(state.queue.remove(0));
            }
            state = self.shared.wait(state);
        }
        None
    }

    /// Makes what is to be live of a value; of a camera nothing has to be made. When it fails all stays as it was.
    fn apply(&mut self, value: Value) -> Result<Option<Edit>, Error> {
        match value {
            Value::Camera(camera) => {
                self.live.camera = camera;
                Ok(None)
            }
            Value::Material(number, mut material) => self.swapped(Part::Material(number), |scene| {
                scene.materials.get_mut(number).into_iter().for_each(|old| swap(old, &mut *material));
            }),
            Value::Light(number, mut light) => self.swapped(Part::Light(number), |scene| {
                scene.lights.get_mut(number).into_iter().for_each(|old| swap(old, &mut light));
            }),
            Value::Texture(number, mut texture, mut image) => {
                let place = match (&image, texture.source) {
                    (None, _) => None,
                    (Some(image), _) if !has_its_texels(image) => {
                        let (width, height) = (image.width, image.height);
                        let texels = image.rgba.len();
                        return Err(Error::new(format!("an image of {width}x{height} has {texels} texels")));
                    }
                    (Some(_), TextureSource::Image(place)) => Some(place),
                    (Some(_), TextureSource::Checkerboard { .. } | TextureSource::Noise { .. }) => {
                        return Err(Error::new(format!("texture {number} is a pattern and takes no image")));
                    }
                    (Some(_), TextureSource::Own(_)) => {
                        return Err(Error::new(format!(
                            "texture {number} is a component of its own and takes no image"
                        )));
                    }
                };
                self.swapped(Part::Texture(number), |scene| {
                    scene.textures.get_mut(number).into_iter().for_each(|old| swap(old, &mut texture));
                    let old = place.and_then(|place| scene.images.get_mut(place));
                    old.into_iter().zip(&mut image).for_each(|(old, new)| swap(old, new));
                })
            }
        }
    }

    /// Exchanges a part of the scene and makes the renderer anew; exchanges it back if that fails.
    fn swapped(&mut self, part: Part, mut exchange: impl FnMut(&mut Scene)) -> Result<Option<Edit>, Error> {
        exchange(&mut self.scene);
        match self.live.renderer.edited(&self.scene, part) {
            Ok((renderer, edit)) => {
                self.live.renderer = Arc::new(renderer);
                Ok(Some(edit))
            }
            Err(error) => {
                exchange(&mut self.scene);
                Err(error)
            }
        }
    }
}

/// Are there texels, and as many as its size says?
fn has_its_texels(image: &scenes::Image) -> bool {
    let texels = image.rgba.len() as u64;
    texels > 0 && texels == u64::from(image.width) * u64::from(image.height)
}
