//! Models of scattering other than glTF's own, by name and numbers.

/// A model that a material names in place of glTF's.
///
/// What a name means, and which numbers go with it, is the renderer's to say: its list has a row for each model, those of a
/// user's crate too. Base colour, roughness, index of refraction, normal map, emission and holes stay glTF's.
///
/// ```
/// use jerboa_scenes::{Material, Model};
///
/// let shiny = Model::named("phong").with("ks", &[0.4, 0.3, 0.2]).with("ns", &[40.0]);
/// let material = Material { model: Some(shiny), ..Material::diffuse("shiny", [0.5; 3]) };
/// assert_eq!(material.model.unwrap().numbers[1], ("ns".to_string(), vec![40.0]));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// Its name in the renderer's list.
    pub name: String,
    /// Its numbers by name; those that are missing have the list's defaults.
    pub numbers: Vec<(String, Vec<f32>)>,
    /// The materials that it is made of, for one that blends two: places in [`Scene::materials`](crate::Scene::materials).
    pub parts: Option<[usize; 2]>,
    /// JSON path of the file that named it, for messages; empty where no file did.
    pub path: String,
}

impl Model {
    /// The model of this name, with the list's defaults.
    pub fn named(name: &str) -> Model {
        Model { name: name.into(), ..Model::default() }
    }

    /// With these numbers.
    pub fn with(mut self, name: &str, numbers: &[f32]) -> Model {
        self.numbers.push((name.into(), numbers.into()));
        self
    }

    /// Made of these two materials.
    pub fn of(self, parts: [usize; 2]) -> Model {
        Model { parts: Some(parts), ..self }
    }
}
