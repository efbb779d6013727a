//! The models that materials name: their numbers in the list, and the numbers that they take.

use jerboa_scenes::{Material, Scene};

use super::memory::{Memory, Table};
use crate::bsdf::models::{Model, Parameter};
use crate::host::error::Error;
use crate::schema::{Models, Parameters};

/// The model of a material, glTF's where it names none, and the numbers that it takes.
///
/// # Errors
/// When there is no model of that name, or it does not take those numbers or parts.
pub fn resolve(material: &Material, models: &[Model]) -> Result<(u32, Vec<f32>), Error> {
    let Some(asked) = &material.model else {
        return Ok((0, Vec::new()));
    };
    let fault = |what: String| {
        let place = if asked.path.is_empty() { String::new() } else { format!("{}: ", asked.path) };
        Error::new(format!("{place}material \"{}\", model \"{}\": {what}", material.name, asked.name))
    };
    let Some((number, model)) = (0..).zip(models).find(|(_, model)| model.name == asked.name) else {
        return Err(fault(format!("no such model; there are {}", names(models.iter().map(|m| m.name)))));
    };
    if model.has_parts != asked.parts.is_some() {
        let what = if model.has_parts { "name them by `first` and `second`" } else { "leave them out" };
        let of =
            if model.has_parts { "it is made of two other materials" } else { "it is not made of other materials" };
        return Err(fault(format!("{of}: {what}")));
    }
    let takes = |name: &str| model.parameters.iter().any(|p| p.name == name);
    if let Some((name, _)) = asked.numbers.iter().find(|(name, _)| !takes(name)) {
        return Err(fault(format!(
            "it takes no `{name}`; it takes {}",
            names(model.parameters.iter().map(|p| p.name))
        )));
    }
    let given = |p: &Parameter| asked.numbers.iter().find(|(name, _)| name == p.name);
    let numbers = model.parameters.iter().map(|p| match given(p) {
        None => Ok(p.default.to_vec()),
        Some((_, xs)) => check(p, xs).map_err(fault),
    });
    Ok((number, numbers.collect::<Result<Vec<_>, Error>>()?.concat()))
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

/// Can the models of all materials be had?
///
/// # Errors
/// As [`resolve`]; and when a part is no material of the scene, or is made of parts itself.
pub fn check_models(scene: &Scene, models: &[Model]) -> Result<(), Error> {
    for material in &scene.materials {
        resolve(material, models)?;
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

/// The numbers that models take, equal runs of them once.
#[derive(Default)]
pub struct Numbers(Vec<f32>);

impl Numbers {
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

/// The list of models, with those marked that the scene has.
pub fn list(scene: &Scene, models: &[Model]) -> Memory {
    let used: Vec<u32> = scene.materials.iter().map(|m| resolve(m, models).map_or(0, |(number, _)| number)).collect();
    let mut table = Table::<Models>::new();
    (0..models.len() as u32).for_each(|number| _ = table.push().set(Models::USED, used.contains(&number)));
    table.finish()
}
