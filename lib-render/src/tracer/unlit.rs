//! Unlit surfaces (KHR_materials_unlit): a path from the camera ends there and brings home their base colour. They are no lights.

use crate::core::color::Color;
use crate::material::Material;

/// What an unlit surface shows a path with this throughput.
pub fn shown(throughput: Color, mat: Material) -> Color {
    throughput.absorb(mat.base)
}
