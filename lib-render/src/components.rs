//! The components that a generic program is made of, beside those that there is always one of: the library's, and those
//! that a user's crate adds.
//!
//! A component is a name, the numbers it takes, and a constructor. A scene names it and gives the numbers. The generic
//! program depends on this list, never on a scene (Law 1): whoever builds it does so [`within`](Components::within) the list,
//! and constructors that choose among kinds ask for it.
//!
//! The crate `examples/custom` adds one of each.

use std::cell::RefCell;

use jerboa_ir::lang::{F32, Row};

use crate::bsdf::models::{MODELS, Model};
use crate::camera::CameraFn;
use crate::core::color::{Color, color};
use crate::light::Light;
use crate::schema::{Lights, Parameters};
use crate::texture::Texture;
use crate::tracer::Tracer;

/// Numbers that a component takes, under one name.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// What scenes call them.
    pub name: &'static str,
    /// As many as there are, with the values they have where a scene says nothing.
    pub default: &'static [f32],
    /// Smallest and largest value.
    pub range: (f32, f32),
}

/// The numbers of a component in a scene, in the order of its parameters.
#[derive(Clone, Copy)]
pub struct Numbers(pub(crate) Row<Parameters>);

impl Numbers {
    /// The number at this place.
    pub fn number(self, place: u32) -> F32 {
        Row::<Parameters>::at(self.0.index() + place).get(Parameters::VALUE)
    }

    /// Three numbers in a row.
    pub fn color(self, first: u32) -> Color {
        color(self.number(first), self.number(first + 1), self.number(first + 2))
    }
}

/// Builds a texture of a user's crate.
pub type MakeTexture = fn(Numbers) -> Texture;
/// Builds a light of a user's crate, one without a surface, from its row: place, direction, strength, probability.
pub type MakeLight = fn(Row<Lights>, Numbers) -> Light;
/// Builds a tracer of a user's crate.
pub type MakeTracer = fn(CameraFn) -> Tracer;

/// A component of a user's crate that scenes name.
#[derive(Clone, Copy, Debug)]
pub struct Own<M> {
    /// What scenes call it.
    pub name: &'static str,
    /// The numbers it takes.
    pub parameters: &'static [Parameter],
    /// Builds it, while the generic program is built.
    pub make: M,
}

/// What scenes may name.
///
/// ```
/// use jerboa_lib_render::components::Components;
/// use jerboa_lib_render::bsdf::{mirror, models::Model};
///
/// let mine = Components::new().bsdf(Model { name: "chrome", ..mirror::MODEL });
/// assert_eq!(mine.models().last().unwrap().name, "chrome");
/// ```
#[derive(Clone, Debug)]
pub struct Components {
    models: Vec<Model>,
    textures: Vec<Own<MakeTexture>>,
    lights: Vec<Own<MakeLight>>,
    tracers: Vec<(&'static str, MakeTracer)>,
}

impl Default for Components {
    fn default() -> Components {
        Components::new()
    }
}

impl Components {
    /// The library's.
    pub fn new() -> Components {
        Components { models: MODELS.to_vec(), textures: Vec::new(), lights: Vec::new(), tracers: Vec::new() }
    }

    /// And a model of scattering, for `Material::model`.
    ///
    /// # Panics
    /// When there is one of that name; so do all of these.
    pub fn bsdf(mut self, model: Model) -> Components {
        assert!(self.models.iter().all(|m| m.name != model.name), "there is a model `{}`", model.name);
        self.models.push(model);
        self
    }

    /// And a texture, for `TextureSource::Own`.
    pub fn texture(mut self, texture: Own<MakeTexture>) -> Components {
        assert!(self.textures.iter().all(|t| t.name != texture.name), "there is a texture `{}`", texture.name);
        self.textures.push(texture);
        self
    }

    /// And a light, for `LightKind::Own`. The bidirectional tracer refuses it: its weights compare the densities of all ways to draw
    /// a path, and those of a light it does not know it cannot tell. The path tracer and the light tracer ask the light itself.
    pub fn light(mut self, light: Own<MakeLight>) -> Components {
        assert!(self.lights.iter().all(|l| l.name != light.name), "there is a light `{}`", light.name);
        self.lights.push(light);
        self
    }

    /// And a tracer, for `TracerKind::Own`.
    pub fn tracer(mut self, name: &'static str, make: MakeTracer) -> Components {
        assert!(self.tracers.iter().all(|(n, _)| *n != name), "there is a tracer `{name}`");
        self.tracers.push((name, make));
        self
    }

    /// All models of scattering, the library's first.
    pub fn models(&self) -> &[Model] {
        &self.models
    }

    /// Textures of a user's crate.
    pub fn textures(&self) -> &[Own<MakeTexture>] {
        &self.textures
    }

    /// Lights of a user's crate.
    pub fn lights(&self) -> &[Own<MakeLight>] {
        &self.lights
    }

    /// Tracers of a user's crate, by name.
    pub fn tracers(&self) -> &[(&'static str, MakeTracer)] {
        &self.tracers
    }

    /// Does it with these as the components that constructors find.
    pub fn within<R>(&self, build: impl FnOnce() -> R) -> R {
        struct Restore(Components);
        impl Drop for Restore {
            fn drop(&mut self) {
                CURRENT.with_borrow_mut(|current| std::mem::swap(current, &mut self.0));
            }
        }
        let _restore = Restore(CURRENT.with_borrow_mut(|current| std::mem::replace(current, self.clone())));
        build()
    }

    /// Those of the program that is being built; the library's where none were said.
    pub fn current() -> Components {
        CURRENT.with_borrow(Clone::clone)
    }
}

thread_local! {
    static CURRENT: RefCell<Components> = RefCell::new(Components::new());
}
