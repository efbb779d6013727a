//! Shaders make materials from what is known of a hit (paper, section 4.5).

use jerboa_ir::lang::Fun;

use crate::geometry::SurfaceElement;
use crate::material::Material;
use crate::ray::{Hit, Ray};

/// (ray, hit, surface) → material.
pub type Shader = Fun<(Ray, Hit, SurfaceElement), Material>;
