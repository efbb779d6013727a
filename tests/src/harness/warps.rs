//! The table of warps of uniform numbers to shapes and directions. A row is drawn against its density, normalised, and
//! held to its shape at the ends of the unit square.

use std::f32::consts::FRAC_1_PI;

use jerboa_ir::lang::{Bool, F32};
use jerboa_lib_render::core::sampling::*;
use jerboa_lib_render::core::triangle::uniform_triangle;
use jerboa_lib_render::core::vec::{Vec2, Vec3, vec2, vec3};

/// What a warp fills.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Shape {
    /// Directions; the density is per steradian.
    Directions,
    /// The disk of radius 1, or the square around it; z = 0.
    Disk,
    /// Weights of two edges of a triangle; z = 0.
    Triangle,
}

/// A warp of the unit square, with its density.
#[derive(Clone, Copy)]
pub struct Warp {
    /// Name of the kernel.
    pub name: &'static str,
    /// What it fills.
    pub shape: Shape,
    /// The warp.
    pub map: fn(Vec2) -> Vec3,
    /// Its density anywhere.
    pub pdf: fn(Vec3) -> F32,
}

/// How far a sample may lie beyond a rim by rounding, in units of the rim.
const ROUNDING: f32 = 1e-6;

fn flat(p: Vec2) -> Vec3 {
    vec3(p.x, p.y, 0.0)
}

fn inside(yes: Bool, density: impl Into<F32>) -> F32 {
    yes.select(density.into(), 0.0.into())
}

/// Not the ends of [0, 1].
fn off_rim(u: F32) -> F32 {
    u * 0.999_999 + 5e-7
}

/// Is a direction within the cone? By the sine where the cosine has no digits.
fn in_cone(w: Vec3, one_minus_cos: f32) -> Bool {
    let sin2 = one_minus_cos * (2.0 - one_minus_cos) * (1.0 + ROUNDING);
    if one_minus_cos < 0.5 {
        w.z.gt(0.0) & (w.x * w.x + w.y * w.y).le(sin2)
    } else {
        (1.0 - w.z).le(one_minus_cos * (1.0 + ROUNDING))
    }
}

macro_rules! cone {
    ($name:literal, $one_minus_cos:literal) => {
        Warp {
            name: $name,
            shape: Shape::Directions,
            map: |u| uniform_cone(u, F32::from($one_minus_cos)),
            pdf: |w| inside(in_cone(w, $one_minus_cos), uniform_cone_pdf(F32::from($one_minus_cos))),
        }
    };
}

/// Every warp.
pub const WARPS: [Warp; 10] = [
    Warp {
        name: "concentric disk",
        shape: Shape::Disk,
        map: |u| flat(concentric_disk(u)),
        pdf: |p| inside(p.dot(p).le(1.0 + ROUNDING), FRAC_1_PI),
    },
    Warp {
        name: "tents",
        shape: Shape::Disk,
        map: |u| flat(vec2(tent(off_rim(u.x)), tent(off_rim(u.y)))),
        pdf: |p| inside(p.abs().max_element().le(1.0), (1.0 - p.x.abs()) * (1.0 - p.y.abs())),
    },
    Warp {
        name: "triangle",
        shape: Shape::Triangle,
        map: |u| flat(uniform_triangle(u)),
        pdf: |p| inside(p.x.ge(0.0) & p.y.ge(0.0) & (p.x + p.y).le(1.0 + ROUNDING), 2.0),
    },
    Warp {
        name: "cosine hemisphere",
        shape: Shape::Directions,
        map: cosine_hemisphere,
        pdf: |w| cosine_hemisphere_pdf(w.z),
    },
    Warp { name: "sphere", shape: Shape::Directions, map: uniform_sphere, pdf: |_| UNIFORM_SPHERE_PDF.into() },
    cone!("cone of the whole sphere", 2.0),
    cone!("cone of a half sphere", 1.0),
    cone!("cone, wide", 0.3),
    cone!("cone, narrow", 1e-3),
    cone!("cone, a thousandth of a degree", 1.5e-10),
];
