//! Scenes as plain host data.

mod camera;
mod environment;
mod error;
mod gltf;
mod light;
mod limits;
mod material;
mod mesh;
mod scene;
mod texture;

pub mod builtin;

pub use camera::Camera;
pub use environment::Environment;
pub use error::{Error, Warning};
pub use light::{Light, LightKind};
pub use limits::Limits;
pub use material::{AlphaMode, Material, TextureRef, UvTransform, Volume};
pub use mesh::{Instance, Mesh};
pub use scene::Scene;
pub use texture::{Filter, Image, Texture, TextureSource, Wrap};
