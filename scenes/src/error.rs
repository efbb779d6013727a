//! What can go wrong with a user's file, in the user's words: whose fault, where, what to do.

use std::fmt;
use std::path::PathBuf;

/// A fault that leaves no scene to return. Each prints as one line naming the file, the place in its JSON where
/// there is one, the reason and the remedy.
#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    /// A file could not be read from disk, or is not a regular file.
    Read {
        /// The file as it was asked for.
        file: PathBuf,
        /// What the operating system said.
        reason: String,
    },
    /// No built-in scene has this name.
    Builtin {
        /// The name asked for.
        name: String,
    },
    /// Of the things there are to choose from, none has this name or number.
    Choice {
        /// What was to be chosen: `camera`, `scene`, `variant`, `animation`.
        noun: &'static str,
        /// The name asked for.
        name: String,
        /// The names there are; numbers where there is no name.
        known: Vec<String>,
    },
    /// The file is not a glTF 2.0 container: a bad GLB header or chunk, or another format.
    Container {
        /// The file.
        file: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The JSON text does not parse.
    Json {
        /// The file.
        file: PathBuf,
        /// Line and column in the JSON text, from 1, and what the parser expected.
        reason: String,
    },
    /// A property is missing, of the wrong type, out of range or contradicts another one.
    Value {
        /// The file.
        file: PathBuf,
        /// JSON path of the property, such as `nodes[3].matrix`.
        path: String,
        /// What is wrong with it.
        reason: String,
    },
    /// An index points outside the list it refers to.
    Index {
        /// The file.
        file: PathBuf,
        /// JSON path of the index.
        path: String,
        /// The index found.
        index: u64,
        /// How many there are, and of what: `3 vertices`.
        of: String,
    },
    /// A URI does not lead to data that a scene may use: only `data:` and files in the scene's own folder do.
    Uri {
        /// The file that contains the URI.
        file: PathBuf,
        /// JSON path of the URI.
        path: String,
        /// The URI, shortened.
        uri: String,
        /// What is wrong with it, as a predicate: `is an absolute path`.
        reason: String,
    },
    /// The file requires an extension that Jerboa does not know.
    Extension {
        /// The file.
        file: PathBuf,
        /// The extension's name.
        name: String,
    },
    /// Something is larger than the [`Limits`](crate::Limits) allow.
    Limit {
        /// The file.
        file: PathBuf,
        /// JSON path of what is too large; empty for the file as a whole.
        path: String,
        /// What was measured, with its size: `12000 x 12000 texels`.
        what: String,
        /// The limit, with the name of its field.
        limit: String,
    },
    /// An environment image cannot be used.
    Environment {
        /// The image file, or the scene file that refers to it.
        file: PathBuf,
        /// JSON path of the reference; empty when the user named the image.
        path: String,
        /// What the decoder said.
        reason: String,
    },
}

impl Error {
    fn text(&self) -> String {
        match self {
            Error::Read { file, reason } => {
                format!("{}: cannot be read: {reason}; check the path and its permissions", file.display())
            }
            Error::Builtin { name } => {
                let known: Vec<_> = crate::builtin::list().iter().map(|b| b.name).collect();
                format!("builtin:{name}: no such built-in scene; there are {}", known.join(", "))
            }
            Error::Choice { noun, name, known } if known.is_empty() => {
                format!("{noun} \"{name}\": there is no {noun} to choose; leave the name out")
            }
            Error::Choice { noun, name, known } => {
                format!("{noun} \"{name}\": there is no {noun} of that name or number; there are {}", known.join(", "))
            }
            Error::Container { file, reason } => {
                format!("{}: not a glTF 2.0 file: {reason}; export it again as .glb or .gltf", file.display())
            }
            Error::Json { file, reason } => {
                format!("{}: the JSON does not parse: {reason}; export it again", file.display())
            }
            Error::Value { file, path, reason } => {
                format!("{}: {path}: {reason}; correct the property or export again", file.display())
            }
            Error::Index { file, path, index, of } => {
                format!(
                    "{}: {path}: index {index}, but there are {of}; the exporter wrote a broken reference",
                    file.display()
                )
            }
            Error::Uri { file, path, uri, reason } => format!(
                "{}: {path}: \"{uri}\" {reason}; use a data: URI or a file in the scene's own folder",
                file.display()
            ),
            Error::Extension { file, name } => format!(
                "{}: extensionsRequired: {name} is required but unknown to Jerboa; {}",
                file.display(),
                match name.as_str() {
                    "EXT_meshopt_compression" | "KHR_meshopt_compression" =>
                        "export without mesh compression, or with Draco's",
                    "KHR_texture_basisu" => "export textures as PNG, JPEG or WebP",
                    _ => "export without it",
                }
            ),
            Error::Limit { file, path, what, limit } => {
                let colon = if path.is_empty() { "" } else { ": " };
                format!(
                    "{}: {path}{colon}{what} exceeds the limit of {limit}; make it smaller or raise the limit",
                    file.display()
                )
            }
            Error::Environment { file, path, reason } => {
                let colon = if path.is_empty() { "" } else { ": " };
                format!(
                    "{}: {path}{colon}not a usable environment image: {reason}; give a lat-long .hdr or .exr",
                    file.display()
                )
            }
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&one_line(&self.text()))
    }
}

impl std::error::Error for Error {}

/// A fault that was repaired or a feature that was left out while loading; the image may differ from the author's intent.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// JSON path of the first place, such as `materials[2]`; empty when it concerns the scene as a whole.
    pub path: String,
    /// What was found and what was done about it.
    pub message: String,
    /// How many times the same message was given.
    pub count: usize,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = if self.path.is_empty() { String::new() } else { format!("{}: ", self.path) };
        let times = if self.count > 1 { format!(" ({} times)", self.count) } else { String::new() };
        f.write_str(&one_line(&format!("{place}{}{times}", self.message)))
    }
}

/// Without control characters: names and decoders' words come from elsewhere, and a message is a line.
fn one_line(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).collect()
}

/// Adds a warning: the same message again only raises its count, and so does any message after the first hundred.
pub(crate) fn warn(warnings: &mut Vec<Warning>, path: &str, message: impl Into<String>) {
    const LISTED: usize = 100;
    let mut message = message.into();
    if warnings.len() >= LISTED && !warnings[..LISTED].iter().any(|w| w.message == message) {
        message = "further warnings are only counted".into();
    }
    match warnings.iter_mut().find(|w| w.message == message) {
        Some(same) => same.count += 1,
        None => warnings.push(Warning { path: path.to_string(), message, count: 1 }),
    }
}
