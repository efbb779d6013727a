//! Editing: a scene changes while its renderer exists.
//!
//! The tables are laid out anew as far as the change reaches, and share the rest. A kernel stays if every fact that its residual
//! depends on still holds; so at level `Structure` a changed number makes no kernel anew, and a changed structure only those
//! that saw it. What is made anew may be in the [cache](super::code_cache) of machine code. The film is the caller's: it starts
//! again. [`super::session`] does all of it while it renders.

use std::sync::Arc;
use std::time::{Duration, Instant};

use jerboa_peval::Facts;
use jerboa_scenes::{Material, Scene, TextureSource};

use super::clock::thread_time;
use super::error::Error;
use super::generate::{Generated, Request, generate};
use super::learn::lessons::Lessons;
use super::renderer::{Device, Options, Renderer, check_tracer};
use super::tables::models::check_models;
use super::tables::{Change, Tables};

/// A part of a scene that can be changed: its kind, and its place in the scene's list.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Part {
    /// A material.
    Material(usize),
    /// A light without a surface.
    Light(usize),
    /// A texture and its image.
    Texture(usize),
}

/// What an edit took.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Edit {
    /// Names of the kernels that were specialised anew.
    pub kernels: Vec<String>,
    /// Those among them for which code was generated: their residuals were not in the cache.
    pub compiled: Vec<String>,
    /// Wall time, tables included.
    pub time: Duration,
    /// Time that threads ran for it: less than wall time on a busy machine, more where several had something to do.
    pub work: Duration,
}

impl Renderer {
    /// Take over a changed material of the scene that the renderer was made for; nothing else of the scene may differ.
    ///
    /// # Errors
    /// As [`Renderer::edited`].
    pub fn set_material(&mut self, scene: &Scene, material: usize) -> Result<Edit, Error> {
        self.set(scene, Part::Material(material))
    }

    /// Take over a changed light of the scene that the renderer was made for; nothing else of the scene may differ.
    ///
    /// # Errors
    /// As [`Renderer::edited`].
    pub fn set_light(&mut self, scene: &Scene, light: usize) -> Result<Edit, Error> {
        self.set(scene, Part::Light(light))
    }

    /// Take over a changed texture of the scene that the renderer was made for, and its image; nothing else of the scene may
    /// differ.
    ///
    /// # Errors
    /// As [`Renderer::edited`].
    pub fn set_texture(&mut self, scene: &Scene, texture: usize) -> Result<Edit, Error> {
        self.set(scene, Part::Texture(texture))
    }

    fn set(&mut self, scene: &Scene, part: Part) -> Result<Edit, Error> {
        let (edited, edit) = self.edited(scene, part)?;
        *self = edited;
        Ok(edit)
    }

    /// The renderer of a scene in which a part has changed since this one was made, and nothing else. This one stays as it is,
    /// and shares what has not changed.
    ///
    /// # Errors
    /// When the scene has no such part, or the part refers to what is not there, names a component that is not registered, or is
    /// a light that the tracer does not know; or when the evaluator or the code generator gives up: a fault of Jerboa.
    pub fn edited(&self, scene: &Scene, part: Part) -> Result<(Renderer, Edit), Error> {
        let (start, thread_start) = (Instant::now(), thread_time());
        let change = self.reach(scene, part)?;
        let Options { choices, known, .. } = self.options;
        let tables = self.tables.changed(scene, &choices, known, change);
        check_tracer(&tables, &self.options)?;
        let mut work = thread_time().saturating_sub(thread_start);
        if self.options.device.is_gpu() {
            return self.made_anew(tables, start, work);
        }
        let [kernels, made] = self.remake(&tables)?;
        work += made.iter().map(|k| k.specialize_time + k.codegen_time).sum::<Duration>();
        let device = Device::new(kernels, &self.options);
        let compiled = made.iter().filter(|k| k.codegen_time > Duration::ZERO).map(|k| k.name.clone()).collect();
        let kernels = made.into_iter().map(|k| k.name.clone()).collect();
        Ok((
            Renderer { tables, device, lessons: Lessons::default(), ..*self },
            Edit { kernels, compiled, time: start.elapsed(), work },
        ))
    }

    /// The renderer for changed tables on a GPU: no kernel is kept.
    fn made_anew(&self, tables: Tables, start: Instant, work: Duration) -> Result<(Renderer, Edit), Error> {
        let (device, specialize_time, codegen_time) = Device::made(&tables, &self.options)?;
        let requests = self.options.device.requests(&tables, self.options.tracer);
        let kernels: Vec<String> = requests.into_iter().map(|r| r.name).collect();
        let work = work + specialize_time + codegen_time;
        let edit = Edit { compiled: kernels.clone(), kernels, time: start.elapsed(), work };
        Ok((Renderer { tables, device, lessons: Lessons::default(), ..*self }, edit))
    }

    /// How far a change of a part reaches.
    fn reach(&self, scene: &Scene, part: Part) -> Result<Change, Error> {
        let missing = |what: &str, number: usize, count: usize| {
            Err(Error::new(format!("there is no {what} {number}: the scene has {count}")))
        };
        let change = match part {
            Part::Material(number) => {
                let Some(new) = scene.materials.get(number) else {
                    return missing("material", number, scene.materials.len());
                };
                if let Some(texture) = textures(new).find(|t| *t >= scene.textures.len()) {
                    return missing("texture", texture, scene.textures.len());
                }
                // A surface that shines, or did, is a light.
                Ok(Change { lights: new.is_emissive() || self.tables.is_emissive(number), texels: false })
            }
            Part::Light(number) if number >= scene.lights.len() => missing("light", number, scene.lights.len()),
            Part::Light(_) => Ok(Change { lights: true, texels: false }),
            Part::Texture(number) => {
                let Some(new) = scene.textures.get(number) else {
                    return missing("texture", number, scene.textures.len());
                };
                if let TextureSource::Image(image) = new.source
                    && image >= scene.images.len()
                {
                    return missing("image", image, scene.images.len());
                }
                // How much a textured light shines decides how often it is chosen.
                let shines = |m: &Material| m.emissive_texture.is_some_and(|t| t.texture == number);
                Ok(Change { lights: scene.materials.iter().any(shines), texels: true })
            }
        }?;
        check_models(scene, self.tables.library.components())?;
        Ok(change)
    }

    /// The kernels for changed tables: those whose facts still hold, and the others made anew, which are also the second list.
    fn remake(&self, tables: &Tables) -> Result<[Vec<Arc<Generated>>; 2], Error> {
        let Options { device, tracer, keep, .. } = self.options;
        let agree = |former: &Facts, kernel: &Generated| {
            kernel.residual.folds.iter().all(|fold| former.agrees(&tables.facts, *fold))
        };
        let requests = device.requests(tables, tracer);
        let stays =
            |r: &Request| self.kernels().iter().find(|k| k.name == r.name && agree(&self.tables.facts, k)).cloned();
        let kept: Vec<Option<Arc<Generated>>> = requests.iter().map(stays).collect();
        let anew: Vec<Request> =
            requests.into_iter().zip(&kept).filter(|(_, kernel)| kernel.is_none()).map(|(r, _)| r).collect();
        let made = generate(tables, &anew, keep)?.kernels;
        let mut next = made.iter().cloned();
        let kernels = kept.into_iter().map(|kernel| kernel.or_else(|| next.next()).expect("it is kept or made"));
        Ok([kernels.collect(), made])
    }
}

/// Textures that a material refers to.
fn textures(m: &Material) -> impl Iterator<Item = usize> {
    let all = [
        m.base_color_texture,
        m.metallic_roughness_texture,
        m.normal_texture,
        m.emissive_texture,
        m.specular_texture,
        m.specular_color_texture,
        m.transmission_texture,
    ];
    all.into_iter().flatten().map(|t| t.texture)
}
