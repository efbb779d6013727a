//! Materials: glTF's metallic-roughness model and its ratified extensions, as numbers and texture references.

use crate::{Anisotropy, Clearcoat, DiffuseTransmission, Iridescence, Model, Sheen};

/// How alpha (base colour's fourth channel) decides whether a ray meets the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    Opaque,
    /// The surface is there where alpha ≥ the cutoff.
    Mask(f32),
    /// The surface is there with probability alpha.
    Blend,
}

/// A use of a texture by a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Index into [`Scene::textures`](crate::Scene::textures).
    pub texture: usize,
    /// Which of the mesh's texture coordinate sets: 0 or 1. A mesh without that set stands at (0, 0).
    pub uv_set: usize,
    /// KHR_texture_transform, when the file has it.
    pub transform: Option<UvTransform>,
}

/// KHR_texture_transform: `u' = offset.u + cos·s + sin·t`, `v' = offset.v − sin·s + cos·t`, where `(s, t) = scale ∘ uv`.
///
/// The sign of the rotation is the one that Khronos's TextureTransformTest marks as correct ("counter-clockwise", v
/// pointing down); the GLSL in the extension's text, read by columns, turns the other way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvTransform {
    /// Added last, in units of the image.
    pub offset: [f32; 2],
    /// Radians, counter-clockwise about the uv origin as the extension draws it.
    pub rotation: f32,
    /// Applied first.
    pub scale: [f32; 2],
}

/// A surface. Colours are linear RGB; colour textures are sRGB and decoded to linear *before* they are filtered; data
/// textures (metallic-roughness, normal, transmission, thickness, specular) are linear as stored.
///
/// Occlusion textures are not kept: they stand for ambient light that a path tracer computes.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The author's name, for messages.
    pub name: String,
    /// Reflectance (dielectric) or F0 (metal), and alpha. In 0..=1.
    pub base_color: [f32; 4],
    /// Multiplies `base_color`; sRGB, alpha linear.
    pub base_color_texture: Option<TextureRef>,
    /// 0 = dielectric, 1 = metal.
    pub metallic: f32,
    /// Perceptual roughness; GGX alpha is its square.
    pub roughness: f32,
    /// Green multiplies roughness, blue multiplies metallic.
    pub metallic_roughness_texture: Option<TextureRef>,
    /// Tangent-space normal map: n = 2·rgb − 1.
    pub normal_texture: Option<TextureRef>,
    /// Multiplies x and y of the normal map.
    pub normal_scale: f32,
    /// Radiance leaving the front, W·sr⁻¹·m⁻² up to the scene's scale: `emissiveFactor · emissiveStrength`.
    pub emissive: [f32; 3],
    /// Multiplies `emissive`; sRGB.
    pub emissive_texture: Option<TextureRef>,
    /// What alpha means.
    pub alpha_mode: AlphaMode,
    /// Emission leaves both sides. Never affects intersection.
    pub double_sided: bool,
    /// A hit adds the base colour as radiance and ends the path; it is not a light.
    pub unlit: bool,
    /// Index of refraction of the dielectric; at least 1. 0 is the extension's "F0 = 1".
    pub ior: f32,
    /// Strength of the dielectric's specular layer, 0..=1.
    pub specular: f32,
    /// Alpha multiplies `specular`.
    pub specular_texture: Option<TextureRef>,
    /// Tint of the dielectric's F0; may exceed 1.
    pub specular_color: [f32; 3],
    /// Multiplies `specular_color`; sRGB.
    pub specular_color_texture: Option<TextureRef>,
    /// Share of the light below the surface that is transmitted rather than diffused, 0..=1.
    pub transmission: f32,
    /// Red multiplies `transmission`.
    pub transmission_texture: Option<TextureRef>,
    /// The inside, for a closed mesh; `None` is a thin wall.
    pub volume: Option<Volume>,
    /// Highlights stretched along a direction.
    pub anisotropy: Option<Anisotropy>,
    /// Diffuse light that comes through.
    pub diffuse_transmission: Option<DiffuseTransmission>,
    /// A thin film on the specular layer and the metal.
    pub iridescence: Option<Iridescence>,
    /// A sheen over the above.
    pub sheen: Option<Sheen>,
    /// A clear coat over all of it.
    pub clearcoat: Option<Clearcoat>,
    /// The model that scatters light in place of glTF's (`extras.bsdf` of a file).
    pub model: Option<Model>,
}

/// KHR_materials_volume: the absorbing inside of a closed mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// Thickness for rasterisers, in local units. A path tracer needs only whether it is above 0.
    pub thickness: f32,
    /// Green multiplies `thickness`.
    pub thickness_texture: Option<TextureRef>,
    /// Distance in world units after which white light has become `attenuation_color`; infinite = clear.
    pub attenuation_distance: f32,
    /// See `attenuation_distance`.
    pub attenuation_color: [f32; 3],
}

impl Default for Material {
    /// glTF's defaults: a white, fully rough *metal*.
    fn default() -> Self {
        Material {
            name: String::new(),
            base_color: [1.0; 4],
            base_color_texture: None,
            metallic: 1.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            emissive: [0.0; 3],
            emissive_texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
            unlit: false,
            ior: 1.5,
            specular: 1.0,
            specular_texture: None,
            specular_color: [1.0; 3],
            specular_color_texture: None,
            transmission: 0.0,
            transmission_texture: None,
            volume: None,
            anisotropy: None,
            diffuse_transmission: None,
            iridescence: None,
            sheen: None,
            clearcoat: None,
            model: None,
        }
    }
}

impl Material {
    /// Exactly Lambert: dielectric, rough, without a specular layer.
    pub fn diffuse(name: &str, rgb: [f32; 3]) -> Self {
        let [r, g, b] = rgb;
        Material { name: name.into(), base_color: [r, g, b, 1.0], metallic: 0.0, specular: 0.0, ..Material::default() }
    }

    /// Metal of a given F0 and perceptual roughness; roughness 0 is a mirror.
    pub fn metal(name: &str, rgb: [f32; 3], roughness: f32) -> Self {
        let [r, g, b] = rgb;
        Material { name: name.into(), base_color: [r, g, b, 1.0], roughness, ..Material::default() }
    }

    /// Diffuse under glTF's dielectric specular layer.
    pub fn plastic(name: &str, rgb: [f32; 3], roughness: f32) -> Self {
        Material { roughness, specular: 1.0, ..Material::diffuse(name, rgb) }
    }

    /// Clear, smooth, closed dielectric.
    pub fn glass(name: &str, ior: f32) -> Self {
        Material {
            name: name.into(),
            metallic: 0.0,
            roughness: 0.0,
            ior,
            transmission: 1.0,
            volume: Some(Volume {
                thickness: 1.0,
                thickness_texture: None,
                attenuation_distance: f32::INFINITY,
                attenuation_color: [1.0; 3],
            }),
            ..Material::default()
        }
    }

    /// Black surface that emits `radiance` from its front.
    pub fn emitter(name: &str, radiance: [f32; 3]) -> Self {
        Material { emissive: radiance, ..Material::diffuse(name, [0.0; 3]) }
    }

    /// Whether the surface is a light. A texture may still make it black everywhere.
    pub fn is_emissive(&self) -> bool {
        !self.unlit && self.emissive.iter().any(|&c| c > 0.0)
    }

    /// The textures in use.
    pub fn textures(&self) -> impl Iterator<Item = &TextureRef> {
        [
            &self.base_color_texture,
            &self.metallic_roughness_texture,
            &self.normal_texture,
            &self.emissive_texture,
            &self.specular_texture,
            &self.specular_color_texture,
            &self.transmission_texture,
        ]
        .into_iter()
        .chain(self.volume.as_ref().map(|v| &v.thickness_texture))
        .flatten()
        .chain(self.anisotropy.iter().flat_map(|lobe| &lobe.texture))
        .chain(self.diffuse_transmission.iter().flat_map(DiffuseTransmission::textures))
        .chain(self.iridescence.iter().flat_map(Iridescence::textures))
        .chain(self.sheen.iter().flat_map(Sheen::textures))
        .chain(self.clearcoat.iter().flat_map(Clearcoat::textures))
    }
}
