//! The vocabulary of glTF's schema, as the `gltf` crate defines it: component types, element types, modes, kinds.
//!
//! Only the crate's words are used, one string or number at a time, so nothing in a file can nest through it. Its readers
//! (gltf 1.4.1) round transforms to single precision, cannot say where a fault is, and can be made to panic, to allocate
//! without bound or to open any file.

use ::gltf::json::Value;
use ::gltf::json::deserialize::from_value;
use ::gltf::json::extensions::scene::khr_lights_punctual::VALID_TYPES as VALID_LIGHT_TYPES;
use ::gltf::json::validation::Checked;
use ::gltf::json::{accessor, animation, camera, material, mesh, texture};
use std::fmt::Debug;

pub(super) use ::gltf::json::extensions::scene::khr_lights_punctual::Type as LightType;
pub(super) use accessor::{ComponentType, GenericComponentType, IndexComponentType, Type as ElementType};
pub(super) use animation::Interpolation;
pub(super) use camera::Type as CameraType;
pub(super) use material::AlphaMode;
pub(super) use mesh::Mode;
pub(super) use texture::{MagFilter, WrappingMode};

/// An enumeration of the schema. In JSON its words are strings, or codes that OpenGL gave them.
pub(super) trait Word: Sized {
    /// All of them as JSON has them, for messages.
    const ALL: &'static dyn Debug;

    /// The word for a string or for an integer below 2^32 (the crate drops the bits above), if it is one.
    fn parse(value: Value) -> Option<Self>;
}

macro_rules! words {
    ($($word:ty: $all:expr;)*) => {$(
        impl Word for $word {
            const ALL: &'static dyn Debug = &$all;

            fn parse(value: Value) -> Option<Self> {
                match from_value(value) {
                    Ok(Checked::Valid(word)) => Some(word),
                    _ => None,
                }
            }
        }
    )*};
}

words! {
    GenericComponentType: accessor::VALID_COMPONENT_TYPES;
    IndexComponentType: accessor::VALID_INDEX_TYPES;
    ElementType: accessor::VALID_ACCESSOR_TYPES;
    Mode: mesh::VALID_MODES;
    WrappingMode: texture::VALID_WRAPPING_MODES;
    MagFilter: texture::VALID_MAG_FILTERS;
    Interpolation: animation::VALID_INTERPOLATIONS;
    AlphaMode: material::VALID_ALPHA_MODES;
    CameraType: camera::VALID_CAMERA_TYPES;
    LightType: VALID_LIGHT_TYPES;
}
