//! The lobes that glTF's extensions add to a material. Each is there only where the file has it.

use crate::TextureRef;

/// KHR_materials_clearcoat: a colourless dielectric layer of index 1.5 over everything else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearcoat {
    /// Share of the surface that is covered, 0..=1.
    pub factor: f32,
    /// Red multiplies `factor`.
    pub texture: Option<TextureRef>,
    /// Perceptual roughness; GGX alpha is its square.
    pub roughness: f32,
    /// Green multiplies `roughness`.
    pub roughness_texture: Option<TextureRef>,
    /// Normal map of the coat; without it the coat has the mesh's normals, whatever the material's own map says.
    pub normal_texture: Option<TextureRef>,
    /// Multiplies x and y of `normal_texture`.
    pub normal_scale: f32,
}

impl Clearcoat {
    /// A coat without textures.
    pub fn new(factor: f32, roughness: f32) -> Self {
        let (texture, roughness_texture, normal_texture) = (None, None, None);
        Clearcoat { factor, texture, roughness, roughness_texture, normal_texture, normal_scale: 1.0 }
    }

    /// The textures in use.
    pub(crate) fn textures(&self) -> impl Iterator<Item = &TextureRef> {
        [&self.texture, &self.roughness_texture, &self.normal_texture].into_iter().flatten()
    }
}
