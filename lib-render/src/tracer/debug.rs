//! Debug tracers: what the camera sees, without light.

use jerboa_ir::lang::{Block, F32, Fun, U32};

use crate::camera::CameraFn;
use crate::core::color::{Color, black, color, gray};
use crate::geometry::SurfaceElement;
use crate::material::Material;
use crate::ray::{Hit, Ray};
use crate::tracer::{OnBounceFn, OnHitFn, OnMissFn, OnShadowFn, Tracer, first_ray};

/// What to show at the first hit.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Show {
    /// Shading normal, world, as (n + 1) / 2.
    Normals,
    /// Base colour.
    Albedo,
    /// Distance from the camera, m.
    Depth,
}

/// A tracer that shows this. Black where nothing is hit.
pub fn make_debug_tracer(camera: CameraFn, show: Show) -> Tracer {
    make_first_hit_tracer(camera, move |_, (_, hit, _, mat)| match show {
        Show::Normals => {
            let half = |x: F32| x * 0.5 + 0.5;
            color(half(mat.normal.x), half(mat.normal.y), half(mat.normal.z))
        }
        Show::Albedo => mat.base,
        Show::Depth => gray(hit.t),
    })
}

/// A tracer that ends at the first hit, and shows something of it. Black where nothing is hit.
pub fn make_first_hit_tracer(
    camera: CameraFn,
    show: impl Fn(&mut Block, (Ray, Hit, SurfaceElement, Material)) -> Color,
) -> Tracer {
    Tracer {
        on_emit: Fun::lam(move |b, (x, y, sample): (U32, U32, U32)| first_ray(b, camera, x, y, sample)),
        on_hit: OnHitFn::lam(|b, (ray, hit, _, surf, mat)| -> Color { show(b, (ray, hit, surf, mat)) }),
        on_miss: OnMissFn::lam(|_, _| black()),
        on_shadow: OnShadowFn::exits(|b, (_, _, _, _, _, _, skip)| skip.take(b, ())),
        on_bounce: OnBounceFn::exits(|b, (_, _, _, _, _, _, end)| end.take(b, ())),
    }
}
