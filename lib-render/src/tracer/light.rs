//! The light tracer: paths start at lights, and each of their vertices asks whether the camera sees it.
//!
//! It is the adjoint of the path tracer and has the same expectation, but for what it cannot find: a pinhole is never hit, so
//! every path it adds has a vertex that scatters diffusely before the camera. Emitters that are seen directly, and all that is
//! seen in perfect mirrors and through smooth glass, are black; caustics, which a path tracer finds by chance, are its
//! strength. Surfaces that are unlit are no lights here. And where a mesh is coarse and its normals smooth, a surface sends
//! light below the horizon of its shading normal, where no BSDF draws a direction: what goes on from there to another surface
//! is missing (the bidirectional tracer finds it from the other side).
//!
//! The path of (pixel, sample) is a function of both and the seed, in a stream of numbers of its own; which pixels its light
//! falls on does not depend on them. So of Sobol points the samples of each pixel are a set of their own here too: they fill the space
//! of numbers evenly, those of all pixels together by chance. Path vertices count from 0, the light. Roulette goes by the share of the emitted light
//! that is left.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, F32, Fun, Row, U32};

use crate::core::color::{Color, black, read_color};
use crate::core::rng::{DIM_BSDF, DIM_ROULETTE, Stream};
use crate::core::vec::{Vec3, vec3};
use crate::geometry::SurfaceElement;
use crate::geometry::offset::{spawn_ray, spawn_shadow_ray};
use crate::light::{EmissionSample, choose_light, with_light};
use crate::material::Material;
use crate::ray::{Hit, Ray};
use crate::schema::{Frame, Lights, NONE, Settings};
use crate::tracer::absorption::{absorption_along, arriving, reaching};
use crate::tracer::adjoint::{carried, scattered};
use crate::tracer::lens::{Lens, Splat};
use crate::tracer::path::{has_lights, within_depth};
use crate::tracer::roulette::survival;
use crate::tracer::{OnBounceFn, OnHitFn, OnMissFn, OnShadowFn, RayState, Tracer, settings};

/// Sets the numbers of paths from lights apart from those of paths from the camera under the same seed: the first bits of
/// the fraction of √2.
pub const LIGHT_STREAM: u32 = 0x6a09_e667;

/// The light tracer.
pub fn make_light_tracer() -> Tracer<RayState, Splat> {
    Tracer {
        on_emit: Fun::lam(|b, at: (U32, U32, U32)| {
            let Emitted { ray, state, .. } = emit(b, at);
            (ray, state)
        }),
        on_hit: OnHitFn::lam(|_, _| black()),
        on_miss: OnMissFn::lam(|_, _| black()),
        on_shadow: OnShadowFn::exits(|b, (ray, hit, state, surf, mat, emit, skip)| {
            b.when(!within_depth(state) | mat.is_unlit | mat.bsdf.is_specular, |b| skip.take(b, ()));
            let lens = Lens::of_frame();
            let seen = lens.seen_from(surf.point);
            b.when(!seen.is_seen, |b| skip.take(b, ()));
            let f = scattered(b, surf, mat, -ray.dir, seen.wi);
            let light = reaching(b, (ray, hit, state), surf, mat, seen.wi, seen.distance).absorb(f);
            let light = light * (seen.importance * surf.face_cos(seen.wi).abs());
            b.when(light.is_black(), |b| skip.take(b, ()));
            emit.take(b, (spawn_shadow_ray(surf, lens.as_light(seen)), Splat { pixel: seen.pixel, light }))
        }),
        on_bounce: OnBounceFn::exits(|b, (ray, hit, state, surf, mat, next, end)| {
            b.when(!within_depth(state) | mat.is_unlit, |b| end.take(b, ()));
            let sample = mat.bsdf.sample.call(b, (state.rng.vertex(state.vertex, DIM_BSDF), -ray.dir));
            let factor = carried(b, surf, mat, -ray.dir, sample);
            let state = go_on(b, (ray, hit, state), surf, mat, sample.wi, factor);
            b.when(state.throughput.is_black(), |b| end.take(b, ()));
            next.take(b, (spawn_ray(surf, sample.wi), state))
        }),
    }
}

/// What leaves a light.
#[derive(Clone, Copy)]
pub(super) struct Emitted {
    /// The light, a row of `Lights`.
    pub light: U32,
    /// The first ray.
    pub ray: Ray,
    /// What it carries: radiance, cosine and densities make the throughput, and that is what roulette takes for 1.
    pub state: RayState,
    /// Cosine at the light; 1 for lights without extent.
    pub cos: F32,
    /// Density of the point, per square metre, choice of the light included.
    pub pdf_area: F32,
    /// Density of the direction, per steradian.
    pub pdf_dir: F32,
}
impl_staged!(Emitted { light, ray, state, cos, pdf_area, pdf_dir });

/// The first ray of the path from a light that belongs to a sample of a pixel. Without lights, it hits nothing.
pub(super) fn emit(b: &mut Block, (x, y, sample): (U32, U32, U32)) -> Emitted {
    let frame = Row::<Frame>::at(0u32);
    let pixel = y * frame.get(Frame::WIDTH) + x;
    let rng = Stream::of(frame.get(Frame::SEED) ^ LIGHT_STREAM, pixel, sample);
    let drawn = |b: &mut Block| {
        let (u, rng) = rng.vertex(0.into(), 0).next();
        let index = choose_light(b, u);
        (index, with_light(b, index, |b, light| light.sample_emission.call(b, rng)))
    };
    let nothing = |_: &mut Block| {
        let (none, zero) = (vec3(0.0, 0.0, 0.0), F32::from(0.0));
        let sample = EmissionSample {
            pos: none,
            dir: none,
            intensity: black(),
            cos: zero,
            pdf_area: zero,
            pdf_dir: zero,
            primitive: NONE.into(),
            primitive1: NONE.into(),
        };
        (U32::from(0), sample)
    };
    let (light, sample) = b.if_(has_lights(), drawn, nothing);
    let EmissionSample { intensity, cos, pdf_area, pdf_dir, .. } = sample;
    let density = pdf_area * pdf_dir;
    let throughput = density.gt(0.0).select(intensity * (cos / density), black());
    let state = RayState {
        rng,
        vertex: 1.into(),
        throughput,
        radiance_scale: throughput.max_channel(),
        pdf_dir,
        is_specular: false.into(),
        absorption: absorption_around(Row::at(light)),
    };
    Emitted { light, ray: sample.ray(), state, cos, pdf_area, pdf_dir }
}

/// Absorption where a light is, 1/m.
fn absorption_around(light: Row<Lights>) -> Color {
    let columns = [Lights::ABSORPTION_R, Lights::ABSORPTION_G, Lights::ABSORPTION_B];
    settings().get(Settings::HAS_VOLUMES).select(read_color(light, columns), black())
}

/// What a path from a light carries on in a direction, with this factor on its light: nothing where roulette ends it.
pub(super) fn go_on(
    b: &mut Block,
    (ray, hit, state): (Ray, Hit, RayState),
    surf: SurfaceElement,
    mat: Material,
    wi: Vec3,
    factor: Color,
) -> RayState {
    let throughput = arriving(b, state, hit).absorb(factor);
    let survival = survival(b, state.vertex, throughput / state.radiance_scale);
    let (u, _) = state.rng.vertex(state.vertex, DIM_ROULETTE).next();
    let survives = u.lt(survival) & !throughput.is_black();
    RayState {
        vertex: state.vertex + 1u32,
        throughput: survives.select(throughput / survival, black()),
        absorption: absorption_along(state, surf, mat, -ray.dir, wi),
        ..state
    }
}
