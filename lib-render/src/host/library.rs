//! A list of components and the generic programs that are made of it, each when it is first needed.

use std::sync::{Arc, LazyLock, OnceLock};

use jerboa_peval::Generic;

use super::device::DeviceKind;
use super::error::Error;
use super::generate::{Entries, TracerKind, program};
use super::tables::models::check_models;
use crate::components::Components;
use jerboa_scenes::Scene;

/// Components and their generic programs, which renderers share. A copy is the same library.
///
/// There is one program for each kind of machine and each group of tracers, so that nobody waits for entries that he does
/// not ask for.
#[derive(Clone)]
pub struct Library(Arc<Inner>);

struct Inner {
    components: Components,
    programs: [OnceLock<Generic>; 2 * Entries::ALL.len()],
}

static STANDARD: LazyLock<Library> = LazyLock::new(|| Library::new(Components::new()));

impl Library {
    /// The library of these components.
    pub fn new(components: Components) -> Library {
        Library(Arc::new(Inner { components, programs: Default::default() }))
    }

    /// That of [`Components::new`], one for the whole process.
    pub fn standard() -> &'static Library {
        &STANDARD
    }

    /// What it is made of.
    pub fn components(&self) -> &Components {
        &self.0.components
    }

    /// The generic program of a device that has the entries of a tracer.
    pub fn generic(&self, device: DeviceKind, tracer: TracerKind) -> &Generic {
        let (entries, components) = (Entries::of(tracer), self.components());
        let place = usize::from(device.is_gpu()) * Entries::ALL.len() + entries as usize;
        self.0.programs[place].get_or_init(|| Generic::new(program(components, device.is_gpu(), entries)))
    }

    /// Has it all that a scene and a tracer name?
    ///
    /// # Errors
    /// When there is no component of a name, or it does not take such numbers: which, where, and which there are.
    pub fn check(&self, scene: &Scene, tracer: TracerKind) -> Result<(), Error> {
        check_models(scene, self.components())?;
        self.check_tracer(tracer)
    }

    /// Has it this tracer?
    ///
    /// # Errors
    /// When it is one of a user's crate, and not registered.
    pub fn check_tracer(&self, tracer: TracerKind) -> Result<(), Error> {
        let TracerKind::Own(name) = tracer else { return Ok(()) };
        let names: Vec<&str> = self.components().tracers().iter().map(|(name, _)| *name).collect();
        match names.contains(&name) {
            true => Ok(()),
            false if names.is_empty() => Err(Error::new(format!("no tracer \"{name}\": none is registered"))),
            false => Err(Error::new(format!("no tracer \"{name}\"; registered are {}", names.join(", ")))),
        }
    }
}
