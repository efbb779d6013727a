//! The components that scenes name: their numbers in the lists, and the numbers that they take.

use jerboa_scenes::{LightKind, Material, Model as Named, Scene, TextureSource};

use super::lights::Counts;
use super::memory::{Memory, Table};
use super::textures::asks_for;
use crate::bsdf::models::Model;
use crate::components::{Components, Parameter};
use crate::host::error::Error;
use crate::light::seen::Seen;
use crate::lobes::Lobe;
use crate::schema::{Models, Parameters};
use crate::texture::Lookup;

/// The model of a material, glTF's where it names none, and the numbers that it takes.
///
/// # Errors
/// When there is no model of that name, or it does not take those numbers or parts.
pub fn resolve(material: &Material, models: &[Model]) -> Result<(u32, Vec<f32>), Error> {
    let Some(asked) = &material.model else {
        return Ok((0, Vec::new()));
    };
    let what = format!("material \"{}\", model \"{}\"", material.name, asked.name);
    let all: Vec<Takes> = models.iter().map(|m| (m.name, m.parameters)).collect();
    let found = find(&what, asked, &all)?;
    let has_parts = models[found.0 as usize].has_parts;
    if has_parts != asked.parts.is_some() {
        let how = match has_parts {
            true => "it is made of two other materials: name them by `first` and `second`",
            false => "it is not made of other materials: leave them out",
        };
        return Err(Error::new(format!("{}{what}: {how}", place(asked))));
    }
    Ok(found)
}

/// Name and parameters of a component.
pub type Takes = (&'static str, &'static [Parameter]);

/// The number of the component that is asked for, `what` in messages, among all of its kind, and its numbers.
///
/// # Errors
/// When there is none of that name, or it does not take those numbers.
pub fn find(what: &str, asked: &Named, all: &[Takes]) -> Result<(u32, Vec<f32>), Error> {
    let fault = |why: String| Error::new(format!("{}{what}: {why}", place(asked)));
    let Some((number, (_, parameters))) = (0..).zip(all).find(|(_, (name, _))| *name == asked.name) else {
        return Err(fault(format!("it is not registered; there are {}", names(all.iter().map(|a| a.0)))));
    };
    let takes = |name: &str| parameters.iter().any(|p| p.name == name);
    if let Some((name, _)) = asked.numbers.iter().find(|(name, _)| !takes(name)) {
        return Err(fault(format!("it takes no `{name}`; it takes {}", names(parameters.iter().map(|p| p.name)))));
    }
    let given = |p: &Parameter| asked.numbers.iter().find(|(name, _)| name == p.name);
    let numbers = parameters.iter().map(|p| match given(p) {
        None => Ok(p.default.to_vec()),
        Some((_, xs)) => check(p, xs).map_err(fault),
    });
    Ok((number, numbers.collect::<Result<Vec<_>, Error>>()?.concat()))
}

/// Where in a file it was asked for.
fn place(asked: &Named) -> String {
    if asked.path.is_empty() { String::new() } else { format!("{}: ", asked.path) }
}

/// The texture of a user's crate at this place of the scene's list.
///
/// # Errors
/// As [`find`].
pub fn own_texture(scene: &Scene, own: usize, components: &Components) -> Result<(u32, Vec<f32>), Error> {
    let all: Vec<Takes> = components.textures().iter().map(|t| (t.name, t.parameters)).collect();
    own_component("texture", scene, own, &all)
}

/// The light of a user's crate at this place of the scene's list.
///
/// # Errors
/// As [`find`].
pub fn own_light(scene: &Scene, own: usize, components: &Components) -> Result<(u32, Vec<f32>), Error> {
    let all: Vec<Takes> = components.lights().iter().map(|l| (l.name, l.parameters)).collect();
    own_component("light", scene, own, &all)
}

fn own_component(kind: &str, scene: &Scene, own: usize, all: &[Takes]) -> Result<(u32, Vec<f32>), Error> {
    let Some(asked) = scene.own.get(own) else {
        return Err(Error::new(format!("there is no component {own} for a {kind}: the scene has {}", scene.own.len())));
    };
    find(&format!("{kind} \"{}\"", asked.name), asked, all)
}

/// As many numbers as the parameter has, within its range. One number stands for all.
fn check(p: &Parameter, xs: &[f32]) -> Result<Vec<f32>, String> {
    let (count, (lo, hi)) = (p.default.len(), p.range);
    if xs.len() != count && xs.len() != 1 {
        return Err(format!("`{}` is {count} numbers, not {}", p.name, xs.len()));
    }
    // Not a number is not in a range either.
    match xs.iter().find(|x| !(lo..=hi).contains(*x)) {
        Some(x) => Err(format!("`{}` is {x}, and must be from {lo} to {hi}", p.name)),
        None if xs.len() == count => Ok(xs.into()),
        None => Ok(vec![xs[0]; count]),
    }
}

fn names<'a>(all: impl Iterator<Item = &'a str>) -> String {
    let all: Vec<&str> = all.collect();
    if all.is_empty() { "none".into() } else { all.join(", ") }
}

/// Can all components that a scene names be had?
///
/// # Errors
/// As [`resolve`] and [`find`]; and when a part is no material of the scene, or is made of parts itself.
pub fn check_models(scene: &Scene, components: &Components) -> Result<(), Error> {
    for texture in &scene.textures {
        if let TextureSource::Own(own) = texture.source {
            own_texture(scene, own, components)?;
        }
    }
    for light in &scene.lights {
        if let LightKind::Own(own) = light.kind {
            own_light(scene, own, components)?;
        }
    }
    for material in &scene.materials {
        resolve(material, components.models())?;
        let parts = material.model.iter().filter_map(|model| model.parts).flatten();
        for part in parts {
            let what = match scene.materials.get(part) {
                None => format!("there is no material {part} for a part: the scene has {}", scene.materials.len()),
                Some(part) if part.model.as_ref().is_some_and(|m| m.parts.is_some()) => {
                    format!("its part \"{}\" is made of parts itself; a part must stand alone", part.name)
                }
                Some(_) => continue,
            };
            return Err(Error::new(format!("material \"{}\": {what}", material.name)));
        }
    }
    Ok(())
}

/// The numbers that components take, equal runs of them once.
#[derive(Default)]
pub struct Numbers(Vec<f32>);

impl Numbers {
    /// Those of the lights of a user's crate, which come first: so an edit of something else does not move them.
    pub fn of_lights(scene: &Scene, components: &Components) -> Numbers {
        let mut numbers = Numbers::default();
        for light in &scene.lights {
            if let LightKind::Own(own) = light.kind {
                numbers.place(&own_light(scene, own, components).unwrap_or_default().1);
            }
        }
        numbers
    }

    /// First row of these numbers.
    pub fn place(&mut self, run: &[f32]) -> u32 {
        if run.is_empty() {
            return 0;
        }
        let same = |at: &[f32]| at.iter().zip(run).all(|(a, b)| a.to_bits() == b.to_bits());
        let found = self.0.windows(run.len()).position(same);
        found.unwrap_or_else(|| {
            self.0.extend(run);
            self.0.len() - run.len()
        }) as u32
    }

    /// The table of them.
    pub fn finish(self) -> Memory {
        let mut table = Table::<Parameters>::new();
        self.0.into_iter().for_each(|x| _ = table.push().set(Parameters::VALUE, x));
        table.finish()
    }
}

/// The list of models and what stands after it, with those marked that the scene has.
pub fn list(scene: &Scene, models: &[Model], lights: Counts) -> Memory {
    let used: Vec<u32> = scene.materials.iter().map(|m| resolve(m, models).map_or(0, |(number, _)| number)).collect();
    let mut table = Table::<Models>::new();
    let has = |lobe| scene.materials.iter().any(|m| super::lobes::has(m, lobe));
    (0..models.len() as u32).for_each(|number| _ = table.push().set(Models::USED, used.contains(&number)));
    Lobe::ALL.into_iter().for_each(|lobe| _ = table.push().set(Models::USED, has(lobe)));
    Lookup::ALL.into_iter().for_each(|lookup| _ = table.push().set(Models::USED, asks_for(scene, lookup)));
    let count = |seen| match seen {
        Seen::Shape => lights.shapes,
        Seen::Sun => lights.suns,
    };
    Seen::ALL.into_iter().for_each(|seen| _ = table.push().set(Models::USED, count(seen) > 0));
    table.finish()
}
