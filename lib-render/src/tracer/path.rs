//! The path tracer: next event estimation and multiple importance sampling (Veach 1997, chapter 9), roulette by
//! throughput.
//!
//! Path vertices count from 0, the camera; the ray that leaves vertex k is edge k + 1. Vertex 1 is what the camera sees.
//! A path has at most `MAX_DEPTH` edges: 1 shows emitters only, 2 adds direct light.

use jerboa_ir::lang::{Block, Bool, Exit, F32, Fun, U32};

use crate::bsdf::BsdfSample;
use crate::camera::CameraFn;
use crate::core::color::{Color, black};
use crate::core::rng::{DIM_BSDF, DIM_LIGHT, DIM_ROULETTE};
use crate::geometry::SurfaceElement;
use crate::geometry::offset::{spawn_ray, spawn_shadow_ray};
use crate::light::environment::seen_environment;
use crate::light::seen::{Seen, sum_of_shapes, sum_of_suns};
use crate::light::{DirectLightSample, hit_pdf, sample_light};
use crate::material::{EmissionValue, Material};
use crate::mis::power_heuristic;
use crate::ray::{Hit, Ray};
use crate::schema::Settings;
use crate::tracer::absorption::{absorption_along, arriving, from_afar, reaching};
use crate::tracer::roulette::survival_towards;
use crate::tracer::unlit::shown;
use crate::tracer::{OnBounceFn, OnHitFn, OnMissFn, OnShadowFn, RayState, Tracer, first_ray, settings};

/// The path tracer.
pub fn make_path_tracer(camera: CameraFn) -> Tracer {
    Tracer {
        on_emit: Fun::lam(move |b, (x, y, sample): (U32, U32, U32)| first_ray(b, camera, x, y, sample)),
        on_hit: OnHitFn::lam(|b, (ray, hit, state, surf, mat)| {
            let own = emitted(b, (ray, hit, state), mat, |b, _| {
                let by_light = hit_pdf(b, surf.light, ray.org, hit.t, surf.face_cos(ray.dir));
                by_chance(state, by_light)
            });
            b.if_(Seen::Shape.is_used(), |b| own + shapes(b, ray, state, hit.t), |_| own)
        }),
        on_miss: OnMissFn::lam(|b, (ray, state)| {
            let sky = sky(b, ray, state, |by_light| by_chance(state, by_light));
            let sky = b.if_(Seen::Sun.is_used(), |b| sky + suns(b, ray, state), |_| sky);
            b.if_(Seen::Shape.is_used(), |b| sky + shapes(b, ray, state, F32::from(f32::INFINITY)), |_| sky)
        }),
        on_shadow: OnShadowFn::exits(|b, (ray, hit, state, surf, mat, emit, skip)| {
            b.when(!asks_for_light(state, mat), |b| skip.take(b, ()));
            let light = sample_light(b, state.rng.vertex(state.vertex, DIM_LIGHT), surf.point);
            let contribution = direct(b, (ray, hit, state), surf, mat, light, |_, by_bsdf| {
                light.is_delta.select(F32::from(1.0), power_heuristic(light.pdf_dir, by_bsdf))
            });
            b.when(contribution.is_black(), |b| skip.take(b, ()));
            emit.take(b, (spawn_shadow_ray(surf, light), contribution))
        }),
        on_bounce: OnBounceFn::exits(|b, (ray, hit, state, surf, mat, next, end)| {
            let (sample, state) = scatter(b, (ray, hit, state), surf, mat, end);
            next.take(b, (spawn_ray(surf, sample.wi), state))
        }),
    }
}

/// Weight of light that a ray finds by chance, where light sampling has this density.
fn by_chance(state: RayState, by_light: F32) -> F32 {
    state.is_specular.select(F32::from(1.0), power_heuristic(state.pdf_dir, by_light))
}

/// Does a vertex of a path from the camera ask for a light?
pub(super) fn asks_for_light(state: RayState, mat: Material) -> Bool {
    has_lights() & within_depth(state) & !mat.is_unlit & !mat.bsdf.is_specular
}

/// How a path from the camera goes on: a sample of the BSDF, and what the next ray carries. It ends where it may have no
/// further edge, where nothing is scattered, and where roulette says so.
pub(super) fn scatter(
    b: &mut Block,
    (ray, hit, state): (Ray, Hit, RayState),
    surf: SurfaceElement,
    mat: Material,
    end: Exit<()>,
) -> (BsdfSample, RayState) {
    b.when(!within_depth(state) | mat.is_unlit, |b| end.take(b, ()));
    let sample = mat.bsdf.sample.call(b, (state.rng.vertex(state.vertex, DIM_BSDF), -ray.dir));
    let throughput = arriving(b, state, hit).absorb(sample.weight);
    b.when(throughput.is_black(), |b| end.take(b, ()));
    let radiance_scale = state.radiance_scale * sample.radiance_scale;
    let survival = survival_towards(b, state.vertex, throughput / radiance_scale, surf.point, sample.wi);
    let (u, _) = state.rng.vertex(state.vertex, DIM_ROULETTE).next();
    b.when(u.ge(survival), |b| end.take(b, ()));
    let state = RayState {
        vertex: state.vertex + 1u32,
        throughput: throughput / survival,
        radiance_scale,
        pdf_dir: sample.pdf_dir,
        is_specular: sample.is_specular,
        absorption: absorption_along(state, surf, mat, -ray.dir, sample.wi),
        ..state
    };
    (sample, state)
}

/// Is there a light that can be sampled?
pub(super) fn has_lights() -> Bool {
    settings().get(Settings::HAS_LIGHTS)
}

/// May the path have one edge more than those that lead to this vertex?
pub(super) fn within_depth(state: RayState) -> Bool {
    !settings().get(Settings::DEPTH_LIMITED) | state.vertex.lt(settings().get(Settings::MAX_DEPTH))
}

/// What the surface itself adds to a path from the camera: its emission, times its weight; an unlit one its base colour.
pub(super) fn emitted(
    b: &mut Block,
    (ray, hit, state): (Ray, Hit, RayState),
    mat: Material,
    weight: impl Fn(&mut Block, EmissionValue) -> F32,
) -> Color {
    let unlit = |b: &mut Block| shown(arriving(b, state, hit), mat);
    let lit = |b: &mut Block| {
        let emission = |b: &mut Block| {
            let value = mat.emission.call(b, -ray.dir);
            let weight = weight(b, value);
            arriving(b, state, hit).absorb(value.intensity) * weight
        };
        b.if_(mat.is_emissive, emission, |_| black())
    };
    b.if_(mat.is_unlit, unlit, lit)
}

/// What the environment adds to a ray from the camera that hits nothing; its weight is told the density of light sampling.
pub(super) fn sky(b: &mut Block, ray: Ray, state: RayState, weight: impl Fn(F32) -> F32) -> Color {
    let radiance = |b: &mut Block| {
        let (radiance, by_light) = seen_environment(ray.dir);
        let weight = weight(by_light);
        from_afar(b, state).absorb(radiance) * weight
    };
    b.if_(settings().get(Settings::HAS_ENVIRONMENT), radiance, |_| black())
}

/// What spheres and disks add that a ray meets before this distance.
fn shapes(b: &mut Block, ray: Ray, state: RayState, until: F32) -> Color {
    sum_of_shapes(b, ray.org, ray.dir, until, |b, met| {
        let throughput = arriving(b, state, Hit::miss(met.distance));
        throughput.absorb(met.radiance) * by_chance(state, met.pdf_dir)
    })
}

/// What suns add to a ray that hits nothing.
fn suns(b: &mut Block, ray: Ray, state: RayState) -> Color {
    sum_of_suns(b, ray.dir, |b, met| from_afar(b, state).absorb(met.radiance) * by_chance(state, met.pdf_dir))
}

/// What a light sample adds if nothing is in between; its weight is told the density of BSDF sampling.
pub(super) fn direct(
    b: &mut Block,
    (ray, hit, state): (Ray, Hit, RayState),
    surf: SurfaceElement,
    mat: Material,
    light: DirectLightSample,
    weight: impl Fn(&mut Block, F32) -> F32,
) -> Color {
    b.if_(
        light.intensity.is_black() | light.pdf_dir.eq(0.0),
        |_| black(),
        |b| {
            let f_cos = mat.bsdf.eval.call(b, (light.wi, -ray.dir)) * mat.normal.dot(light.wi).abs();
            let by_bsdf = mat.bsdf.pdf.call(b, (light.wi, -ray.dir));
            let weight = weight(b, by_bsdf);
            let throughput = reaching(b, (ray, hit, state), surf, mat, light.wi, light.distance);
            throughput.absorb(f_cos).absorb(light.intensity) * (weight / light.pdf_dir)
        },
    )
}
