//! Materials: which lobes a surface can have at all, and their numbers.

use jerboa_ir::table;

use super::Textures;

/// [`Materials::ALPHA_MODE`]: every hit counts.
pub const ALPHA_OPAQUE: u32 = 0;
/// [`Materials::ALPHA_MODE`]: a hit counts where alpha ≥ cutoff.
pub const ALPHA_MASK: u32 = 1;
/// [`Materials::ALPHA_MODE`]: a hit counts with probability alpha.
pub const ALPHA_BLEND: u32 = 2;

/// GGX α below which a lobe counts as perfectly smooth (accuracy.md, T6): the [`Materials::SMOOTH`] column and the decision
/// per hit, hence `sample`, `pdf` and `eval`, agree on it.
pub const SMOOTH_ALPHA: f32 = 1e-3;

/// [`Materials::SMOOTH`]: the microfacet lobes have α ≥ [`SMOOTH_ALPHA`] everywhere.
pub const SMOOTH_NEVER: u32 = 0;
/// [`Materials::SMOOTH`]: α < 1e-3 everywhere: perfect reflection and refraction.
pub const SMOOTH_ALWAYS: u32 = 1;
/// [`Materials::SMOOTH`]: a texture decides at each hit.
pub const SMOOTH_PER_HIT: u32 = 2;

table! {
    /// Materials, as glTF describes them, with the lobes that can be present at all as structure.
    pub classed Materials {
        /// A hit adds the base colour as emission and ends the path.
        UNLIT: Bool, structure;
        /// Does it emit?
        EMISSIVE: Bool, structure;
        /// Does emission leave both sides? (It never affects intersection.)
        DOUBLE_SIDED: Bool, structure;
        /// `ALPHA_*`.
        ALPHA_MODE: U32, structure;
        /// Do rays pass through it from behind?
        CULLED: Bool, structure;
        /// Diffuse lobe: not all metal, not all transmission.
        HAS_DIFFUSE: Bool, structure;
        /// Dielectric reflection layer: specular above 0 and not all metal.
        HAS_SPECULAR: Bool, structure;
        /// Metal lobe: metallic may be above 0.
        HAS_METAL: Bool, structure;
        /// Transmission lobe.
        HAS_TRANSMISSION: Bool, structure;
        /// Transmission without a volume: light passes straight, the surface has no inside.
        THIN: Bool, structure;
        /// Does the volume absorb?
        HAS_ABSORPTION: Bool, structure;
        /// `SMOOTH_*`.
        SMOOTH: U32, structure;
        /// Number of the model that scatters light, in the list of models; 0 is glTF's.
        MODEL: U32, structure;
        /// The first of the numbers that the model takes.
        NUMBERS: ref Parameters, structure;
        /// The first of the materials that the model is made of, if it is.
        FIRST: ref Materials, structure;
        /// The second.
        SECOND: ref Materials, structure;
        /// Is the roughness another along the material's direction than across it?
        HAS_ANISOTROPY: Bool, structure;
        /// Does diffuse light come through?
        HAS_DIFFUSE_TRANSMISSION: Bool, structure;
        /// Is there a thin film on layer and metal?
        HAS_FILM: Bool, structure;
        /// Is there a sheen?
        HAS_SHEEN: Bool, structure;
        /// Is there a clear coat?
        HAS_COAT: Bool, structure;
        /// `SMOOTH_*` of the coat.
        COAT_SMOOTH: U32, structure;
        /// Base colour has a texture.
        BASE_TEXTURED: Bool, structure;
        /// Metallic and roughness have a texture.
        METALLIC_ROUGHNESS_TEXTURED: Bool, structure;
        /// There is a normal map.
        NORMAL_TEXTURED: Bool, structure;
        /// Emission has a texture.
        EMISSION_TEXTURED: Bool, structure;
        /// Specular strength has a texture (alpha channel).
        SPECULAR_TEXTURED: Bool, structure;
        /// Specular colour has a texture.
        SPECULAR_COLOR_TEXTURED: Bool, structure;
        /// Transmission has a texture (red channel).
        TRANSMISSION_TEXTURED: Bool, structure;
        /// Anisotropy has a texture (direction in red and green, strength in blue).
        ANISOTROPY_TEXTURED: Bool, structure;
        /// The share of diffuse transmission has a texture (alpha channel).
        DIFFUSE_TRANSMISSION_TEXTURED: Bool, structure;
        /// The colour of diffuse transmission has a texture.
        DIFFUSE_TRANSMISSION_COLOR_TEXTURED: Bool, structure;
        /// The film's share has a texture (red channel).
        FILM_TEXTURED: Bool, structure;
        /// The film's thickness has a texture (green channel).
        FILM_THICKNESS_TEXTURED: Bool, structure;
        /// The sheen's colour has a texture.
        SHEEN_COLOR_TEXTURED: Bool, structure;
        /// The sheen's roughness has a texture (alpha channel).
        SHEEN_ROUGHNESS_TEXTURED: Bool, structure;
        /// The coat's strength has a texture (red channel).
        COAT_TEXTURED: Bool, structure;
        /// The coat's roughness has a texture (green channel).
        COAT_ROUGHNESS_TEXTURED: Bool, structure;
        /// The coat has a normal map.
        COAT_NORMAL_TEXTURED: Bool, structure;
        /// Base colour texture; row 0 where there is none.
        BASE_TEXTURE: ref Textures, structure;
        /// Metallic (blue) and roughness (green).
        METALLIC_ROUGHNESS_TEXTURE: ref Textures, structure;
        /// Normal map.
        NORMAL_TEXTURE: ref Textures, structure;
        /// Emission.
        EMISSION_TEXTURE: ref Textures, structure;
        /// Specular strength.
        SPECULAR_TEXTURE: ref Textures, structure;
        /// Specular colour.
        SPECULAR_COLOR_TEXTURE: ref Textures, structure;
        /// Transmission.
        TRANSMISSION_TEXTURE: ref Textures, structure;
        /// Direction and strength of anisotropy.
        ANISOTROPY_TEXTURE: ref Textures, structure;
        /// Share of diffuse transmission.
        DIFFUSE_TRANSMISSION_TEXTURE: ref Textures, structure;
        /// Colour of diffuse transmission.
        DIFFUSE_TRANSMISSION_COLOR_TEXTURE: ref Textures, structure;
        /// Share of the film.
        FILM_TEXTURE: ref Textures, structure;
        /// Thickness of the film.
        FILM_THICKNESS_TEXTURE: ref Textures, structure;
        /// Colour of the sheen.
        SHEEN_COLOR_TEXTURE: ref Textures, structure;
        /// Roughness of the sheen.
        SHEEN_ROUGHNESS_TEXTURE: ref Textures, structure;
        /// Strength of the coat.
        COAT_TEXTURE: ref Textures, structure;
        /// Roughness of the coat.
        COAT_ROUGHNESS_TEXTURE: ref Textures, structure;
        /// Normal map of the coat.
        COAT_NORMAL_TEXTURE: ref Textures, structure;
        /// Base colour factor, linear.
        BASE_R: F32, value;
        /// See [`Materials::BASE_R`].
        BASE_G: F32, value;
        /// See [`Materials::BASE_R`].
        BASE_B: F32, value;
        /// Alpha factor.
        BASE_A: F32, value;
        /// Smallest alpha of a hit, mode mask.
        ALPHA_CUTOFF: F32, value;
        /// Metallic factor in [0, 1].
        METALLIC: F32, value;
        /// Roughness factor in [0, 1]; α is its square.
        ROUGHNESS: F32, value;
        /// Scale of the normal map's x and y.
        NORMAL_SCALE: F32, value;
        /// Emitted radiance, W/(m² sr), strength included.
        EMISSION_R: F32, value;
        /// See [`Materials::EMISSION_R`].
        EMISSION_G: F32, value;
        /// See [`Materials::EMISSION_R`].
        EMISSION_B: F32, value;
        /// Index of refraction inside, relative to outside.
        IOR: F32, value;
        /// Specular strength in [0, 1].
        SPECULAR: F32, value;
        /// Specular colour factor.
        SPECULAR_R: F32, value;
        /// See [`Materials::SPECULAR_R`].
        SPECULAR_G: F32, value;
        /// See [`Materials::SPECULAR_R`].
        SPECULAR_B: F32, value;
        /// Transmission factor in [0, 1].
        TRANSMISSION: F32, value;
        /// Anisotropy in [0, 1].
        ANISOTROPY: F32, value;
        /// The direction of anisotropy as turned from the tangent: its part along the tangent.
        ANISOTROPY_X: F32, value;
        /// Its part along the bitangent.
        ANISOTROPY_Y: F32, value;
        /// Share of the diffuse light that comes through, in [0, 1].
        DIFFUSE_TRANSMISSION: F32, value;
        /// Colour of the diffuse light that comes through.
        DIFFUSE_TRANSMISSION_R: F32, value;
        /// See [`Materials::DIFFUSE_TRANSMISSION_R`].
        DIFFUSE_TRANSMISSION_G: F32, value;
        /// See [`Materials::DIFFUSE_TRANSMISSION_R`].
        DIFFUSE_TRANSMISSION_B: F32, value;
        /// Share of the surface that the film covers, in [0, 1].
        FILM: F32, value;
        /// Index of the film.
        FILM_IOR: F32, value;
        /// Thickness of the film where its texture is 0, nanometres.
        FILM_THINNEST: F32, value;
        /// Thickness of the film where its texture is 1, and without a texture, nanometres.
        FILM_THICKEST: F32, value;
        /// Colour of the sheen.
        SHEEN_R: F32, value;
        /// See [`Materials::SHEEN_R`].
        SHEEN_G: F32, value;
        /// See [`Materials::SHEEN_R`].
        SHEEN_B: F32, value;
        /// Roughness of the sheen in [0, 1]; α is its square.
        SHEEN_ROUGHNESS: F32, value;
        /// Strength of the coat in [0, 1].
        COAT: F32, value;
        /// Roughness of the coat in [0, 1]; α is its square.
        COAT_ROUGHNESS: F32, value;
        /// Scale of the coat's normal map's x and y.
        COAT_NORMAL_SCALE: F32, value;
        /// Absorption coefficient of the volume, 1/m.
        ABSORPTION_R: F32, value;
        /// See [`Materials::ABSORPTION_R`].
        ABSORPTION_G: F32, value;
        /// See [`Materials::ABSORPTION_R`].
        ABSORPTION_B: F32, value;
    }
}

table! {
    /// The list of models, then of the lobes that extensions add to glTF's (`lobes::Lobe`), then of what few textures ask for
    /// (`texture::Lookup`) and of lights that rays see (`light::seen::Seen`), one row each. It is known at every level of knowledge:
    /// a renderer is put together from what the scene names.
    pub classed Models {
        /// Has any material of the scene this model, or this lobe, any of its textures this way, or such a light?
        USED: Bool, structure;
    }
}

table! {
    /// What models take beside the numbers of glTF's materials, one after the other.
    pub classed Parameters {
        /// A number.
        VALUE: F32, value;
    }
}
