//! Shaders make materials from what is known of a hit (paper, section 4.5).

use jerboa_ir::lang::{Fun, Row};

use crate::bsdf::models::make_bsdf;
use crate::geometry::SurfaceElement;
use crate::material::{Material, absorption, base_color, make_emission};
use crate::normal_map::apply_normal_map;
use crate::ray::{Hit, Ray};
use crate::schema::Materials;

/// (ray, hit, surface) → material.
pub type Shader = Fun<(Ray, Hit, SurfaceElement), Material>;

/// The shader of a material: looks up its textures at the hit.
pub fn make_shader(row: Row<Materials>) -> Shader {
    Shader::lam(|b, (_ray, _hit, surf)| {
        let plain = surf;
        let surf = apply_normal_map(b, row, plain);
        let base = base_color(b, row, surf.uv) * surf.color;
        let bsdf = make_bsdf(b, row, (plain, surf), base);
        let absorption = absorption(b, row);
        Material {
            bsdf,
            emission: make_emission(row, surf),
            is_emissive: row.get(Materials::EMISSIVE),
            is_unlit: row.get(Materials::UNLIT),
            base,
            absorption,
            normal: surf.local.normal,
        }
    })
}
