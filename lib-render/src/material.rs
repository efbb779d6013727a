//! Materials: scattering and emission of a surface (paper, section 4.2).

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, Col, F32, Fun, Row, U32};

use crate::bsdf::Bsdf;
use crate::bsdf::gltf::GltfValues;
use crate::core::color::{Color, black, read_color};
use crate::core::vec::{Vec2, Vec3};
use crate::geometry::SurfaceElement;
use crate::light::area_pdf;
use crate::light::both_sides::emission_pdf;
use crate::lobes::through_coat;
use crate::schema::{Materials, SMOOTH_ALPHA, SMOOTH_ALWAYS, SMOOTH_PER_HIT, Textures};
use crate::texture::look_up;

/// What leaves a point of an emitter in a direction, and how likely the samplers find both.
#[derive(Clone, Copy)]
pub struct EmissionValue {
    /// Radiance, W/(m² sr).
    pub intensity: Color,
    /// Density of the point under emission sampling, per square metre, the choice of the light included. (That of next event
    /// estimation is [`hit_pdf`](crate::light::hit_pdf).)
    pub pdf_area: F32,
    /// Density of the direction under emission sampling, per steradian.
    pub pdf_dir: F32,
}
impl_staged!(EmissionValue { intensity, pdf_area, pdf_dir });

/// (direction away from the surface) → emission.
pub type EmissionFn = Fun<Vec3, EmissionValue>;

/// The right-hand side of the rendering equation at a point: f and L_e.
#[derive(Clone, Copy)]
pub struct Material {
    /// Scattering.
    pub bsdf: Bsdf,
    /// Emission; asked for only where `is_emissive`.
    pub emission: EmissionFn,
    /// Does it emit?
    pub is_emissive: Bool,
    /// Unlit: the path ends here with `base` as emission.
    pub is_unlit: Bool,
    /// Base colour: what an unlit surface shows, and the albedo of the debug tracer.
    pub base: Color,
    /// Absorption coefficient behind the surface, 1/m; black where there is no absorbing volume.
    pub absorption: Color,
    /// Shading normal with the normal map applied, unit, world: the cosine that goes with f is to this normal.
    pub normal: Vec3,
}
impl_staged!(Material { bsdf, emission, is_emissive, is_unlit, base, absorption, normal });

/// Tint of the layer.
const SPECULAR_COLOR: [Col<Materials, F32>; 3] = [Materials::SPECULAR_R, Materials::SPECULAR_G, Materials::SPECULAR_B];

/// A colour factor times its texture, if there is one.
pub fn textured(
    b: &mut Block,
    row: Row<Materials>,
    factor: [Col<Materials, F32>; 3],
    (flag, texture): (Col<Materials, Bool>, Col<Materials, Row<Textures>>),
    uv: [Vec2; 2],
) -> Color {
    let factor = read_color(row, factor);
    b.if_(row.get(flag), |b| factor * look_up(b, row.get(texture), uv).color, |_| factor)
}

/// Base colour at these texture coordinates.
pub fn base_color(b: &mut Block, row: Row<Materials>, uv: [Vec2; 2]) -> Color {
    let factor = [Materials::BASE_R, Materials::BASE_G, Materials::BASE_B];
    textured(b, row, factor, (Materials::BASE_TEXTURED, Materials::BASE_TEXTURE), uv)
}

/// Emitted radiance at these texture coordinates, for the sides that emit.
pub fn emitted_radiance(b: &mut Block, row: Row<Materials>, uv: [Vec2; 2]) -> Color {
    let factor = [Materials::EMISSION_R, Materials::EMISSION_G, Materials::EMISSION_B];
    textured(b, row, factor, (Materials::EMISSION_TEXTURED, Materials::EMISSION_TEXTURE), uv)
}

/// The parameters of glTF's model at these texture coordinates, with this base colour.
pub fn gltf_values(b: &mut Block, row: Row<Materials>, base: Color, uv: [Vec2; 2]) -> GltfValues {
    let get = |column| row.get(column);
    let (roughness, metallic) = b.if_(
        row.get(Materials::METALLIC_ROUGHNESS_TEXTURED),
        |b| {
            let texel = look_up(b, row.get(Materials::METALLIC_ROUGHNESS_TEXTURE), uv).color;
            (get(Materials::ROUGHNESS) * texel.g, get(Materials::METALLIC) * texel.b)
        },
        |_| (get(Materials::ROUGHNESS), get(Materials::METALLIC)),
    );
    let specular = b.if_(
        row.get(Materials::SPECULAR_TEXTURED),
        |b| get(Materials::SPECULAR) * look_up(b, row.get(Materials::SPECULAR_TEXTURE), uv).alpha,
        |_| get(Materials::SPECULAR),
    );
    let transmission = b.if_(
        row.get(Materials::TRANSMISSION_TEXTURED),
        |b| get(Materials::TRANSMISSION) * look_up(b, row.get(Materials::TRANSMISSION_TEXTURE), uv).color.r,
        |_| get(Materials::TRANSMISSION),
    );
    let tint = (Materials::SPECULAR_COLOR_TEXTURED, Materials::SPECULAR_COLOR_TEXTURE);
    let alpha = roughness * roughness;
    GltfValues {
        has_diffuse: row.get(Materials::HAS_DIFFUSE),
        has_specular: row.get(Materials::HAS_SPECULAR),
        has_metal: row.get(Materials::HAS_METAL),
        has_transmission: row.get(Materials::HAS_TRANSMISSION),
        thin: row.get(Materials::THIN),
        smooth: is_smooth(row.get(Materials::SMOOTH), alpha),
        base,
        metallic,
        alpha,
        ior: get(Materials::IOR),
        specular,
        specular_color: textured(b, row, SPECULAR_COLOR, tint, uv),
        transmission,
        ..GltfValues::none()
    }
}

/// Does a lobe of this `SMOOTH_*` and width count as perfectly smooth?
pub fn is_smooth(smooth: U32, alpha: F32) -> Bool {
    smooth.eq(SMOOTH_ALWAYS) | (smooth.eq(SMOOTH_PER_HIT) & alpha.lt(SMOOTH_ALPHA))
}

/// Absorption coefficient behind the surface, 1/m.
pub fn absorption(b: &mut Block, row: Row<Materials>) -> Color {
    let columns = [Materials::ABSORPTION_R, Materials::ABSORPTION_G, Materials::ABSORPTION_B];
    b.if_(row.get(Materials::HAS_ABSORPTION), |_| read_color(row, columns), |_| black())
}

/// Lambertian emission of a surface: from the front, and from the back where the material is double-sided. A clear coat dims it.
pub fn make_emission(row: Row<Materials>, surf: SurfaceElement) -> EmissionFn {
    EmissionFn::lam(|b, dir| {
        let cos = surf.face_cos(dir);
        let both = row.get(Materials::DOUBLE_SIDED);
        let pdf_dir = emission_pdf(both, cos);
        let radiance = emitted_radiance(b, row, surf.uv);
        let radiance = through_coat(b, row, surf.uv, cos, radiance);
        EmissionValue {
            intensity: (both | cos.gt(0.0)).select(radiance, black()),
            pdf_area: area_pdf(surf.light),
            pdf_dir,
        }
    })
}
