//! Ambient occlusion: how much of the sky over a point is open.
//!
//! At the first hit a shadow ray goes out with density cos/π around the shading normal, on the side that is seen, and brings
//! home 1 if it meets nothing within [`Settings::OCCLUSION_DISTANCE`]. So the mean is ∫ V cos/π dω: 1 on an open plane, 1/2 at a
//! wall as high as the world, 0 in a closed room where the distance is infinite. A direction below the surface itself, which
//! a bent shading normal can give, counts as blocked. Black where nothing is hit.
//!
//! Source: Zhukov, Iones, Kronin 1998, "An ambient light illumination model"; Landis 2002 for the name.

use jerboa_ir::lang::{Fun, Row, U32};

use crate::bsdf::diffuse::sample_diffuse;
use crate::camera::CameraFn;
use crate::core::color::{black, white};
use crate::core::rng::DIM_LIGHT;
use crate::geometry::offset::spawn_ray;
use crate::ray::Ray;
use crate::schema::Settings;
use crate::tracer::{OnBounceFn, OnHitFn, OnMissFn, OnShadowFn, RayState, Tracer, first_ray, side_seen};

/// A tracer of one shadow ray for each first hit.
pub fn make_occlusion_tracer(camera: CameraFn) -> Tracer {
    Tracer {
        on_emit: Fun::lam(move |b, (x, y, sample): (U32, U32, U32)| first_ray(b, camera, x, y, sample)),
        on_hit: OnHitFn::lam(|_, _| black()),
        on_miss: OnMissFn::lam(|_, _| black()),
        on_shadow: OnShadowFn::exits(|b, (ray, _, state, surf, mat, emit, skip)| {
            let RayState { rng, vertex, .. } = state;
            let side = side_seen(surf, mat, ray);
            let dir = sample_diffuse(rng.vertex(vertex, DIM_LIGHT), side);
            b.when(!side.reflects(dir), |b| skip.take(b, ()));
            let tmax = Row::<Settings>::at(0u32).get(Settings::OCCLUSION_DISTANCE);
            emit.take(b, (Ray { tmax, ..spawn_ray(surf, dir) }, white()))
        }),
        on_bounce: OnBounceFn::exits(|b, (_, _, _, _, _, _, end)| end.take(b, ())),
    }
}
