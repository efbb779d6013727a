//! Which of the things that a file may hold more than one of are shown.

use crate::Error;

/// What to show of a glTF file: a scene, a variant of its materials, a moment of its animations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Selection {
    /// A scene by name or by number, from 0. `None`: the file's default scene, else the first.
    pub scene: Option<String>,
    /// A variant of KHR_materials_variants by name or by number. `None`: the default materials.
    pub variant: Option<String>,
    /// The moment to show, seconds; before the first and after the last keyframe everything stands still. `None`: the rest
    /// pose.
    pub time: Option<f64>,
    /// The animation to play, by name or by number. `None`: all of them together. Without a time it has no meaning.
    pub animation: Option<String>,
}

/// The position of what was `asked` for in a list of names: the first of that name, else the one of that number. `noun`
/// says what they name.
pub(crate) fn choose<'a>(
    noun: &'static str,
    asked: &str,
    names: impl Iterator<Item = &'a str> + Clone,
) -> Result<usize, Error> {
    let count = names.clone().count();
    let numbered = || asked.parse().ok().filter(|i| *i < count);
    let known = || names.clone().enumerate().map(|(i, n)| if n.is_empty() { i.to_string() } else { n.to_string() });
    names.clone().position(|n| n == asked && !n.is_empty()).or_else(numbered).ok_or_else(|| Error::Choice {
        noun,
        name: asked.into(),
        known: known().collect(),
    })
}
