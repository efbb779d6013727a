//! The lobes that glTF's extensions add to its material, and the layers they put over it, read from their columns.

use jerboa_ir::lang::{Block, Bool, F32, Row};

use crate::bsdf::Bsdf;
use crate::bsdf::coat::{CoatValues, make_coat, passed};
use crate::bsdf::gltf::GltfValues;
use crate::bsdf::layer::make_layered_bsdf;
use crate::bsdf::models::Site;
use crate::bsdf::sheen::{SheenValues, make_sheen};
use crate::components::Components;
use crate::core::color::Color;
use crate::core::thin_film::Film;
use crate::core::vec::Vec2;
use crate::geometry::SurfaceElement;
use crate::material::{is_smooth, textured};
use crate::normal_map::{NormalMap, mapped_normal};
use crate::schema::{Materials, Models, SMOOTH_ALPHA};
use crate::texture::look_up;

/// What glTF's extensions add to its material, in the order of their rows in [`Models`], after those of the models.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Lobe {
    /// KHR_materials_clearcoat.
    Coat,
    /// KHR_materials_sheen.
    Sheen,
    /// KHR_materials_anisotropy.
    Anisotropy,
    /// KHR_materials_diffuse_transmission.
    DiffuseTransmission,
    /// KHR_materials_iridescence.
    Film,
}

impl Lobe {
    /// All of them.
    pub const ALL: [Lobe; 5] = [Lobe::Coat, Lobe::Sheen, Lobe::Anisotropy, Lobe::DiffuseTransmission, Lobe::Film];

    /// Has any material of the scene this lobe?
    fn is_used(self) -> Bool {
        let number = Components::current().models().len() + self as usize;
        Row::<Models>::at(number as u32).get(Models::USED)
    }
}

/// The normal map of the coat.
const COAT_NORMALS: NormalMap =
    (Materials::COAT_NORMAL_TEXTURED, Materials::COAT_NORMAL_TEXTURE, Materials::COAT_NORMAL_SCALE);

/// `base`, which has these values, under the layers of its material.
pub fn make_layers(b: &mut Block, site: Site, values: GltfValues, base: Bsdf) -> Bsdf {
    // About the albedo of what is there already.
    let under = values.is_nothing().select(F32::from(0.0), values.base.max_channel().max(0.04));
    let sheen = b.if_(Lobe::Sheen.is_used(), |b| sheen_values(b, site, under), |_| SheenValues::none());
    let base = make_layered_bsdf(site.surf, make_sheen(site.surf, 0, sheen), base);
    let under = sheen.present.select(under.max(sheen.color.max_channel()), under);
    let coat = b.if_(
        Lobe::Coat.is_used(),
        |b| coat_values(b, site.row, site.plain, values.is_solid(), under),
        |_| CoatValues::none(site.surf.local.normal),
    );
    make_layered_bsdf(site.surf, make_coat(site.surf, 1, coat), base)
}

/// The sheen.
fn sheen_values(b: &mut Block, site: Site, under: F32) -> SheenValues {
    let (row, uv) = (site.row, site.surf.uv);
    let factor = [Materials::SHEEN_R, Materials::SHEEN_G, Materials::SHEEN_B];
    let texture = (Materials::SHEEN_COLOR_TEXTURED, Materials::SHEEN_COLOR_TEXTURE);
    let roughness = row.get(Materials::SHEEN_ROUGHNESS);
    SheenValues {
        present: row.get(Materials::HAS_SHEEN),
        color: textured(b, row, factor, texture, uv),
        roughness: b.if_(
            row.get(Materials::SHEEN_ROUGHNESS_TEXTURED),
            |b| roughness * look_up(b, row.get(Materials::SHEEN_ROUGHNESS_TEXTURE), uv).alpha,
            |_| roughness,
        ),
        under,
    }
}

/// Share of the surface that the coat covers.
fn coat_strength(b: &mut Block, row: Row<Materials>, uv: [Vec2; 2]) -> F32 {
    let factor = row.get(Materials::COAT);
    let textured = |b: &mut Block| factor * look_up(b, row.get(Materials::COAT_TEXTURE), uv).color.r;
    b.if_(row.get(Materials::COAT_TEXTURED), textured, |_| factor)
}

/// What comes through the coat of light that the material emits, in a direction of this cosine to the face normal
/// (KHR_materials_clearcoat, "Emission"). By the face normal and not the coat's own, so that light sampling, which has no
/// surface element, gives what a ray sees.
pub fn through_coat(b: &mut Block, row: Row<Materials>, uv: [Vec2; 2], cos: F32, light: Color) -> Color {
    let coated = |b: &mut Block| {
        let strength = coat_strength(b, row, uv);
        let is_inside = row.get(Materials::HAS_TRANSMISSION) & !row.get(Materials::THIN) & cos.lt(0.0);
        light * is_inside.select(1.0.into(), passed(strength, cos.abs()))
    };
    let asked = |b: &mut Block| b.if_(row.get(Materials::HAS_COAT), coated, |_| light);
    b.if_(Lobe::Coat.is_used(), asked, |_| light)
}

/// The coat.
fn coat_values(b: &mut Block, row: Row<Materials>, plain: SurfaceElement, solid: Bool, under: F32) -> CoatValues {
    let get = |column| row.get(column);
    let uv = plain.uv;
    let strength = coat_strength(b, row, uv);
    let roughness = b.if_(
        row.get(Materials::COAT_ROUGHNESS_TEXTURED),
        |b| get(Materials::COAT_ROUGHNESS) * look_up(b, row.get(Materials::COAT_ROUGHNESS_TEXTURE), uv).color.g,
        |_| get(Materials::COAT_ROUGHNESS),
    );
    let alpha = roughness * roughness;
    CoatValues {
        present: row.get(Materials::HAS_COAT),
        smooth: is_smooth(row.get(Materials::COAT_SMOOTH), alpha),
        tilted: row.get(Materials::NORMAL_TEXTURED) | row.get(Materials::COAT_NORMAL_TEXTURED),
        solid,
        strength,
        alpha,
        normal: mapped_normal(b, row, COAT_NORMALS, plain),
        under,
    }
}

/// `values` with the lobes that the material adds to them.
pub fn with_lobes(b: &mut Block, site: Site, values: GltfValues) -> GltfValues {
    let mut with = |values, lobe: Lobe, added: fn(&mut Block, Site, GltfValues) -> GltfValues| {
        b.if_(lobe.is_used(), |b| added(b, site, values), |_| values)
    };
    let values = with(values, Lobe::Anisotropy, with_anisotropy);
    let values = with(values, Lobe::DiffuseTransmission, with_diffuse_transmission);
    with(values, Lobe::Film, with_film)
}

/// KHR_materials_anisotropy: α grows to 1 along the direction, with the square of the strength.
fn with_anisotropy(b: &mut Block, site: Site, values: GltfValues) -> GltfValues {
    let (row, frame) = (site.row, site.surf.local);
    let get = |column| row.get(column);
    let (c, s) = (get(Materials::ANISOTROPY_X), get(Materials::ANISOTROPY_Y));
    let (strength, x, y) = b.if_(
        row.get(Materials::ANISOTROPY_TEXTURED),
        |b| {
            let texel = look_up(b, row.get(Materials::ANISOTROPY_TEXTURE), site.surf.uv).color;
            let (x, y) = (texel.r * 2.0 - 1.0, texel.g * 2.0 - 1.0);
            (get(Materials::ANISOTROPY) * texel.b, c * x - s * y, s * x + c * y)
        },
        |_| (get(Materials::ANISOTROPY), c, s),
    );
    let present = row.get(Materials::HAS_ANISOTROPY);
    let alpha = present.select(values.alpha.max(SMOOTH_ALPHA), values.alpha);
    GltfValues {
        has_anisotropy: present,
        alpha,
        alpha_along: alpha + (1.0 - alpha) * (strength * strength),
        stretch: frame.tangent * x + frame.bitangent * y,
        ..values
    }
}

fn with_diffuse_transmission(b: &mut Block, site: Site, values: GltfValues) -> GltfValues {
    let (row, uv) = (site.row, site.surf.uv);
    let share = row.get(Materials::DIFFUSE_TRANSMISSION);
    let factor =
        [Materials::DIFFUSE_TRANSMISSION_R, Materials::DIFFUSE_TRANSMISSION_G, Materials::DIFFUSE_TRANSMISSION_B];
    let texture = (Materials::DIFFUSE_TRANSMISSION_COLOR_TEXTURED, Materials::DIFFUSE_TRANSMISSION_COLOR_TEXTURE);
    GltfValues {
        has_diffuse_transmission: row.get(Materials::HAS_DIFFUSE_TRANSMISSION),
        diffuse_transmission: b.if_(
            row.get(Materials::DIFFUSE_TRANSMISSION_TEXTURED),
            |b| share * look_up(b, row.get(Materials::DIFFUSE_TRANSMISSION_TEXTURE), uv).alpha,
            |_| share,
        ),
        diffuse_transmission_color: textured(b, row, factor, texture, uv),
        ..values
    }
}

/// KHR_materials_iridescence.
fn with_film(b: &mut Block, site: Site, values: GltfValues) -> GltfValues {
    let (row, uv) = (site.row, site.surf.uv);
    let get = |column| row.get(column);
    let share = b.if_(
        row.get(Materials::FILM_TEXTURED),
        |b| get(Materials::FILM) * look_up(b, row.get(Materials::FILM_TEXTURE), uv).color.r,
        |_| get(Materials::FILM),
    );
    let thickness = b.if_(
        row.get(Materials::FILM_THICKNESS_TEXTURED),
        |b| {
            let k = look_up(b, row.get(Materials::FILM_THICKNESS_TEXTURE), uv).color.g;
            get(Materials::FILM_THINNEST) * (1.0 - k) + get(Materials::FILM_THICKEST) * k
        },
        |_| get(Materials::FILM_THICKEST),
    );
    let film = Film { ior: get(Materials::FILM_IOR), thickness };
    GltfValues { has_film: row.get(Materials::HAS_FILM), film_share: share, film, ..values }
}
