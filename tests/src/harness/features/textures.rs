//! Features of textures: how one is looked up ([`TABLE`]), and what stands for it in a material ([`USES`]).

use jerboa_scenes::{Filter, TextureSource, Wrap};

use super::Feature;
use super::used::*;

/// How they are looked up.
pub const TABLE: &[Feature] = &[
    Feature { name: "textures", used: has_textures, facts: &["Textures.KIND"], leaves: &["Textures.", "Uvs."] },
    Feature {
        name: "images",
        used: has_images,
        facts: &[],
        leaves: &["Texels.RGBA", "Textures.OFFSET", "Textures.WIDTH", "Textures.HEIGHT", "image.rs", "image/border.rs"],
    },
    Feature {
        name: "images of colours",
        used: has_coloured_images,
        facts: &["Textures.SRGB"],
        leaves: &["SrgbCurve.LINEAR"],
    },
    Feature {
        name: "nearest texels",
        used: |s| has_filter(s, Filter::Nearest),
        facts: &["Textures.FILTER"],
        leaves: &["image/nearest.rs"],
    },
    Feature {
        name: "bilinear filter",
        used: |s| has_filter(s, Filter::Bilinear),
        facts: &["Textures.FILTER"],
        leaves: &["image/bilinear.rs"],
    },
    Feature {
        name: "bicubic filter",
        used: |s| has_filter(s, Filter::Bicubic),
        facts: &["Textures.FILTER"],
        leaves: &["image/bicubic.rs"],
    },
    Feature {
        name: "images that repeat",
        used: |s| has_wrap(s, Wrap::Repeat),
        facts: &["Textures.WRAP_"],
        leaves: &["image/border/repeat.rs"],
    },
    Feature {
        name: "images that are mirrored",
        used: |s| has_wrap(s, Wrap::Mirror),
        facts: &["Textures.WRAP_"],
        leaves: &["image/border/mirror.rs"],
    },
    Feature {
        name: "images whose edge goes on",
        used: |s| has_wrap(s, Wrap::Clamp),
        facts: &["Textures.WRAP_"],
        leaves: &["image/border/clamp.rs"],
    },
    Feature {
        name: "borders of one colour",
        used: |s| looks_up(s, |t| t.border.is_some()),
        facts: &["Textures.WRAP_"],
        leaves: &["Textures.BORDER_", "image/border/constant.rs"],
    },
    Feature {
        name: "patterns",
        used: |s| has_source(s, |source| is_checkerboard(source) || is_noise(source)),
        facts: &["Textures.KIND"],
        leaves: &["Textures.EVEN_", "Textures.ODD_"],
    },
    Feature {
        name: "checkerboards",
        used: |s| has_source(s, is_checkerboard),
        facts: &["Textures.KIND"],
        leaves: &["texture/checkerboard.rs"],
    },
    Feature {
        name: "noise",
        used: |s| has_source(s, is_noise),
        facts: &["Textures.KIND"],
        leaves: &["texture/noise.rs"],
    },
    Feature {
        name: "textures of a user's crate",
        used: |s| has_source(s, |source| matches!(source, TextureSource::Own(_))),
        facts: &["Textures.KIND"],
        leaves: &["Textures.NUMBERS"],
    },
    Feature {
        name: "KHR_texture_transform",
        used: |s| textures(&s.scene).any(|t| t.transform.is_some()),
        facts: &["Textures.TRANSFORMED"],
        leaves: &["Textures.M0", "Textures.M1", "texture/transform.rs"],
    },
    Feature {
        name: "the second set of coordinates",
        used: |s| textures(&s.scene).any(|t| t.uv_set == 1) && has_mesh(s, |mesh| mesh.uvs[1].is_some()),
        facts: &["Textures.UV_SET", "Geometries.HAS_UV1"],
        leaves: &["Uvs.U1", "Uvs.V1"],
    },
];

fn is_checkerboard(source: TextureSource) -> bool {
    matches!(source, TextureSource::Checkerboard { .. })
}

fn is_noise(source: TextureSource) -> bool {
    matches!(source, TextureSource::Noise { .. })
}

/// What they stand for.
pub const USES: &[Feature] = &[
    Feature {
        name: "a texture of the colour",
        used: |s| any(s, |m| m.base_color_texture.is_some()),
        facts: &["Materials.BASE_TEXTURED"],
        leaves: &["Materials.BASE_TEXTURE"],
    },
    Feature {
        name: "a texture of metalness and roughness",
        used: |s| any(s, |m| m.metallic_roughness_texture.is_some()),
        facts: &["Materials.METALLIC_ROUGHNESS_TEXTURED"],
        leaves: &["Materials.METALLIC_ROUGHNESS_TEXTURE"],
    },
    Feature {
        name: "a normal map",
        used: |s| any(s, |m| m.normal_texture.is_some()),
        facts: &["Materials.NORMAL_TEXTURED"],
        leaves: &["Materials.NORMAL_SCALE", "Materials.NORMAL_TEXTURE", "normal_map.rs"],
    },
    Feature {
        name: "a texture of the emission",
        used: |s| any(s, |m| m.emissive_texture.is_some()),
        facts: &["Materials.EMISSION_TEXTURED"],
        leaves: &["Materials.EMISSION_TEXTURE"],
    },
    Feature {
        name: "a texture of the layer's strength",
        used: |s| any(s, |m| m.specular_texture.is_some()),
        facts: &["Materials.SPECULAR_TEXTURED"],
        leaves: &["Materials.SPECULAR_TEXTURE"],
    },
    Feature {
        name: "a texture of the layer's colour",
        used: |s| any(s, |m| m.specular_color_texture.is_some()),
        facts: &["Materials.SPECULAR_COLOR_TEXTURED"],
        leaves: &["Materials.SPECULAR_COLOR_TEXTURE"],
    },
    Feature {
        name: "a texture of transmission",
        used: |s| any(s, |m| m.transmission_texture.is_some()),
        facts: &["Materials.TRANSMISSION_TEXTURED"],
        leaves: &["Materials.TRANSMISSION_TEXTURE"],
    },
    Feature {
        name: "a texture of anisotropy",
        used: |s| any(s, |m| m.anisotropy.is_some_and(|lobe| lobe.texture.is_some())),
        facts: &["Materials.ANISOTROPY_TEXTURED"],
        leaves: &["Materials.ANISOTROPY_TEXTURE"],
    },
    Feature {
        name: "a texture of the share of diffuse transmission",
        used: |s| any(s, |m| m.diffuse_transmission.is_some_and(|lobe| lobe.texture.is_some())),
        facts: &["Materials.DIFFUSE_TRANSMISSION_TEXTURED"],
        leaves: &["Materials.DIFFUSE_TRANSMISSION_TEXTURE"],
    },
    Feature {
        name: "a texture of the colour of diffuse transmission",
        used: |s| any(s, |m| m.diffuse_transmission.is_some_and(|lobe| lobe.color_texture.is_some())),
        facts: &["Materials.DIFFUSE_TRANSMISSION_COLOR_TEXTURED"],
        leaves: &["Materials.DIFFUSE_TRANSMISSION_COLOR_TEXTURE"],
    },
    Feature {
        name: "a texture of a film's share",
        used: |s| any(s, |m| m.iridescence.is_some_and(|film| film.texture.is_some())),
        facts: &["Materials.FILM_TEXTURED"],
        leaves: &["Materials.FILM_TEXTURE"],
    },
    Feature {
        name: "a texture of a film's thickness",
        used: |s| any(s, |m| m.iridescence.is_some_and(|film| film.thickness_texture.is_some())),
        facts: &["Materials.FILM_THICKNESS_TEXTURED"],
        leaves: &["Materials.FILM_THICKNESS_TEXTURE"],
    },
    Feature {
        name: "a texture of a sheen's colour",
        used: |s| any(s, |m| m.sheen.is_some_and(|sheen| sheen.color_texture.is_some())),
        facts: &["Materials.SHEEN_COLOR_TEXTURED"],
        leaves: &["Materials.SHEEN_COLOR_TEXTURE"],
    },
    Feature {
        name: "a texture of a sheen's roughness",
        used: |s| any(s, |m| m.sheen.is_some_and(|sheen| sheen.roughness_texture.is_some())),
        facts: &["Materials.SHEEN_ROUGHNESS_TEXTURED"],
        leaves: &["Materials.SHEEN_ROUGHNESS_TEXTURE"],
    },
    Feature {
        name: "a texture of a coat's strength",
        used: |s| any(s, |m| m.clearcoat.is_some_and(|coat| coat.texture.is_some())),
        facts: &["Materials.COAT_TEXTURED"],
        leaves: &["Materials.COAT_TEXTURE"],
    },
    Feature {
        name: "a texture of a coat's roughness",
        used: |s| any(s, |m| m.clearcoat.is_some_and(|coat| coat.roughness_texture.is_some())),
        facts: &["Materials.COAT_ROUGHNESS_TEXTURED"],
        leaves: &["Materials.COAT_ROUGHNESS_TEXTURE"],
    },
    Feature {
        name: "a normal map of a coat",
        used: |s| any(s, |m| m.clearcoat.is_some_and(|coat| coat.normal_texture.is_some())),
        facts: &["Materials.COAT_NORMAL_TEXTURED"],
        leaves: &["Materials.COAT_NORMAL_TEXTURE", "Materials.COAT_NORMAL_SCALE"],
    },
];
