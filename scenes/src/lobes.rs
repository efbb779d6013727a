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

/// KHR_materials_sheen: fibres that stand up from cloth, over the base and under a coat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheen {
    /// Linear RGB, 0..=1; black is no sheen.
    pub color: [f32; 3],
    /// Multiplies `color`; sRGB.
    pub color_texture: Option<TextureRef>,
    /// Perceptual roughness; alpha is its square.
    pub roughness: f32,
    /// Alpha multiplies `roughness`.
    pub roughness_texture: Option<TextureRef>,
}

impl Sheen {
    /// A sheen without textures.
    pub fn new(color: [f32; 3], roughness: f32) -> Self {
        Sheen { color, color_texture: None, roughness, roughness_texture: None }
    }

    /// The textures in use.
    pub(crate) fn textures(&self) -> impl Iterator<Item = &TextureRef> {
        [&self.color_texture, &self.roughness_texture].into_iter().flatten()
    }
}

/// KHR_materials_anisotropy: highlights that are stretched along a direction of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anisotropy {
    /// 0..=1; GGX alpha along the direction grows from the material's own to 1 with its square.
    pub strength: f32,
    /// Of the direction, from the tangent, counter-clockwise, in radians.
    pub rotation: f32,
    /// Red and green: the direction, 2·rg − 1, which `rotation` turns; blue multiplies `strength`.
    pub texture: Option<TextureRef>,
}

impl Anisotropy {
    /// Anisotropy along the tangent, without a texture.
    pub fn new(strength: f32) -> Self {
        Anisotropy { strength, rotation: 0.0, texture: None }
    }
}

/// KHR_materials_iridescence: a thin film on the specular layer and the metal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iridescence {
    /// Share of the surface that is covered, 0..=1.
    pub factor: f32,
    /// Red multiplies `factor`.
    pub texture: Option<TextureRef>,
    /// Index of refraction of the film, at least 1.
    pub ior: f32,
    /// Thickness where its texture is 0, nanometres.
    pub thinnest: f32,
    /// Thickness where its texture is 1, and where there is none, nanometres.
    pub thickest: f32,
    /// Green goes from `thinnest` to `thickest`.
    pub thickness_texture: Option<TextureRef>,
}

impl Iridescence {
    /// A film of this thickness in nanometres and of the extension's index, without textures.
    pub fn new(factor: f32, thickness: f32) -> Self {
        let (texture, thickness_texture) = (None, None);
        Iridescence { factor, texture, ior: 1.3, thinnest: 100.0, thickest: thickness, thickness_texture }
    }

    /// The textures in use.
    pub(crate) fn textures(&self) -> impl Iterator<Item = &TextureRef> {
        [&self.texture, &self.thickness_texture].into_iter().flatten()
    }
}

/// KHR_materials_diffuse_transmission: diffuse light that comes through, as through a leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseTransmission {
    /// Share of the diffuse light that comes through, 0..=1.
    pub factor: f32,
    /// Alpha multiplies `factor`.
    pub texture: Option<TextureRef>,
    /// Linear RGB of what comes through, 0..=1.
    pub color: [f32; 3],
    /// Multiplies `color`; sRGB.
    pub color_texture: Option<TextureRef>,
}

impl DiffuseTransmission {
    /// Without textures.
    pub fn new(factor: f32, color: [f32; 3]) -> Self {
        DiffuseTransmission { factor, texture: None, color, color_texture: None }
    }

    /// The textures in use.
    pub(crate) fn textures(&self) -> impl Iterator<Item = &TextureRef> {
        [&self.texture, &self.color_texture].into_iter().flatten()
    }
}
