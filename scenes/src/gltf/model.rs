//! The model of scattering that a material names in its `extras.bsdf`: `model`, the numbers that go with it by name, and
//! for one that blends two other materials `first` and `second`.

use super::Loader;
use super::json::Json;
use crate::{Error, Model};

impl<'a> Loader<'a> {
    /// The model that this material names, if it names one.
    pub fn model(&mut self, material: &Json<'a>) -> Result<Option<Model>, Error> {
        let Some(at) = named(material) else {
            return Ok(None);
        };
        let properties = at.value.as_object().into_iter().flatten();
        let mut model = Model::named(at.need("model")?.text()?);
        for name in
            properties.map(|(name, _)| name).filter(|name| !["model", "first", "second"].contains(&name.as_str()))
        {
            let numbers = at.get(name).map_or(Ok(Vec::new()), |place| numbers(&place))?;
            model.numbers.push((name.clone(), numbers));
        }
        if at.get("first").is_some() || at.get("second").is_some() {
            model.parts = Some([self.part(&at.need("first")?)?, self.part(&at.need("second")?)?]);
        }
        model.path = at.path;
        Ok(Some(model))
    }

    /// A material that another is made of. It is not made of others itself, so there are no circles.
    fn part(&mut self, at: &Json<'a>) -> Result<usize, Error> {
        let (_, part) = at.refer(&self.root, "materials", "materials")?;
        if named(&part).is_some_and(|model| model.get("first").is_some() || model.get("second").is_some()) {
            return Err(at.fault("a material that is made of others; a part must stand alone"));
        }
        self.material(Some(at.clone()))
    }
}

/// The object that names it. Extras are anybody's: exporters write other things under this name too, such as a string.
fn named<'a>(material: &Json<'a>) -> Option<Json<'a>> {
    material.get("extras")?.get("bsdf").filter(|at| at.value.is_object())
}

/// A number, or an array of numbers.
fn numbers(at: &Json) -> Result<Vec<f32>, Error> {
    let all = match at.elements() {
        Some(elements) => elements.iter().map(Json::number).collect(),
        None => at.number().map(|x| vec![x]),
    };
    Ok(all?.into_iter().map(|x: f64| x as f32).collect())
}
