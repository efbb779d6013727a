//! Shaders make materials from what is known of a hit (paper, section 4.5).

use jerboa_ir::lang::{Fun, Row};

use crate::bsdf::Bsdf;
use crate::bsdf::gltf::make_gltf_bsdf;
use crate::geometry::SurfaceElement;
use crate::material::{Material, absorption, base_color, gltf_values, make_emission, make_phong_material};
use crate::normal_map::apply_normal_map;
use crate::ray::{Hit, Ray};
use crate::schema::Materials;

/// (ray, hit, surface) → material.
pub type Shader = Fun<(Ray, Hit, SurfaceElement), Material>;

/// The shader of a material: looks up its textures at the hit.
pub fn make_shader(row: Row<Materials>) -> Shader {
    Shader::lam(|b, (_ray, _hit, surf)| {
        let surf = apply_normal_map(b, row, surf);
        let base = base_color(b, row, surf.uv);
        let gltf = make_gltf_bsdf(surf, gltf_values(b, row, base, surf.uv));
        let absorption = absorption(b, row);
        Material {
            bsdf: Bsdf::choose(row.get(Materials::PHONG), make_phong_material(row, surf, base), gltf),
            emission: make_emission(row, surf),
            is_emissive: row.get(Materials::EMISSIVE),
            is_unlit: row.get(Materials::UNLIT),
            base,
            absorption,
            normal: surf.local.normal,
        }
    })
}
