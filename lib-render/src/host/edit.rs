//! Editing: a scene changes while its renderer exists.
//!
//! The tables are laid out anew as far as the change reaches. A kernel stays if every fact that its residual depends on still
//! holds; so at level `Structure` a changed number makes no kernel anew, and a changed structure only those that saw it. What
//! is made anew may be in the [cache](super::code_cache) of machine code. The film is the caller's: it starts again.

use std::sync::Arc;
use std::time::{Duration, Instant};

use jerboa_peval::Facts;
use jerboa_scenes::Scene;

use super::error::Error;
use super::generate::{Generated, Request, generate};
use super::renderer::{Device, Options, Renderer};
use super::tables::Change;

/// What an edit took.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Edit {
    /// Names of the kernels that were made anew.
    pub kernels: Vec<String>,
    /// Wall time, tables included.
    pub time: Duration,
}

impl Renderer {
    /// Take over a changed material of the scene that the renderer was made for; nothing else of the scene may differ.
    ///
    /// # Errors
    /// When the scene has no such material, or the evaluator or the code generator gives up: a fault of Jerboa. The renderer
    /// is then as it was.
    pub fn set_material(&mut self, scene: &Scene, material: usize) -> Result<Edit, Error> {
        let Some(new) = scene.materials.get(material) else {
            return Err(Error::new(format!(
                "there is no material {material}: the scene has {}",
                scene.materials.len()
            )));
        };
        // A surface that shines, or did, is a light.
        let lights = new.is_emissive() || self.tables.is_emissive(material);
        self.update(scene, Change { lights, texels: false })
    }

    /// Take over a changed light of the scene that the renderer was made for; nothing else of the scene may differ.
    ///
    /// # Errors
    /// As [`Renderer::set_material`].
    pub fn set_light(&mut self, scene: &Scene, light: usize) -> Result<Edit, Error> {
        if light >= scene.lights.len() {
            return Err(Error::new(format!("there is no light {light}: the scene has {}", scene.lights.len())));
        }
        self.update(scene, Change { lights: true, texels: false })
    }

    /// Take over a changed texture of the scene that the renderer was made for, and its image; nothing else of the scene may
    /// differ.
    ///
    /// # Errors
    /// As [`Renderer::set_material`].
    pub fn set_texture(&mut self, scene: &Scene, texture: usize) -> Result<Edit, Error> {
        if texture >= scene.textures.len() {
            return Err(Error::new(format!("there is no texture {texture}: the scene has {}", scene.textures.len())));
        }
        // How much a textured light shines decides how often it is chosen.
        let shines = |m: &jerboa_scenes::Material| m.emissive_texture.is_some_and(|t| t.texture == texture);
        self.update(scene, Change { lights: scene.materials.iter().any(shines), texels: true })
    }

    /// Lay out what changed, and make those kernels anew whose facts did.
    fn update(&mut self, scene: &Scene, change: Change) -> Result<Edit, Error> {
        let start = Instant::now();
        let Options { choices, known, .. } = self.options;
        let former = self.tables.change(scene, &choices, known, change);
        match self.remake(former.facts()) {
            Ok(kernels) => Ok(Edit { kernels, time: start.elapsed() }),
            Err(error) => {
                self.tables.restore(former);
                Err(error)
            }
        }
    }

    /// Make the kernels anew that depend on facts which no longer hold, and say which.
    fn remake(&mut self, former: &Facts) -> Result<Vec<String>, Error> {
        let Options { device, tracer, keep, .. } = self.options;
        let holds =
            |kernel: &Generated| kernel.residual.folds.iter().all(|fold| former.agrees(&self.tables.facts, *fold));
        let requests = device.requests(&self.tables, tracer);
        let stays = |r: &Request| self.kernels().iter().find(|k| k.name == r.name && holds(k)).cloned();
        let kept: Vec<Option<Arc<Generated>>> = requests.iter().map(stays).collect();
        let anew: Vec<Request> =
            requests.into_iter().zip(&kept).filter(|(_, kernel)| kernel.is_none()).map(|(r, _)| r).collect();
        let mut made = generate(&self.tables, &anew, keep)?.kernels.into_iter();
        let kernels = kept.into_iter().map(|kernel| kernel.or_else(|| made.next()).expect("it is kept or made"));
        self.device = Device::new(kernels.collect(), &self.options);
        Ok(anew.into_iter().map(|r| r.name).collect())
    }
}
