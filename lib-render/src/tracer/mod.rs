//! Renderers: what happens to a path, never in which order (paper, section 4.6).
//!
//! Each function takes its outcomes as exits; a device connects them. `on_shadow` either traces a shadow ray or does not;
//! `on_bounce` either goes on or ends the path.
//!
//! | tracer | paths start | vertices ask for |
//! |---|---|---|
//! | [`path`] | at the camera | a light |
//! | [`light`] | at a light | the camera |
//! | [`bidirectional`] | one of each | both, and each other |
//! | [`occlusion`] | at the camera | the sky, once |
//! | [`debug`], [`aov`] | at the camera | nothing |
//!
//! What a path lies in absorbs: it begins with what the host found around the camera or the light ([`Frame::ABSORPTION_R`],
//! [`Lights::ABSORPTION_R`](crate::schema::Lights::ABSORPTION_R)), and a refraction changes it.

pub mod path;
pub mod absorption;
pub mod roulette;
pub mod learned;
pub mod unlit;
pub mod debug;
pub mod aov;
pub mod occlusion;
pub mod adjoint;
pub mod lens;
pub mod light;
pub mod bidirectional;

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, Exit, F32, Fun, Never, Row, Staged, U32};

use crate::bsdf::frame::Side;
use crate::camera::CameraFn;
use crate::core::color::{Color, black, read_color, white};
use crate::core::rng::Stream;
use crate::geometry::{Frame3, SurfaceElement};
use crate::material::Material;
use crate::ray::{Hit, Ray};
use crate::schema::{Frame, Settings};
use crate::tracer::learned::pixel_scale;

/// What a path carries from vertex to vertex.
#[derive(Clone, Copy)]
pub struct RayState {
    /// Random numbers of this sample.
    pub rng: Stream,
    /// Number of the vertex this ray leads to: 1 is what the camera sees.
    pub vertex: U32,
    /// Product of the weights so far.
    pub throughput: Color,
    /// Product of the radiance scales of refraction in `throughput` (N22); what is left without them tells roulette what the path is
    /// worth, so it begins with what light counts in the pixel.
    pub radiance_scale: F32,
    /// Density per steradian with which the last BSDF sampled this ray.
    pub pdf_dir: F32,
    /// Could light sampling not have found what this ray hits? (Camera ray, or after a specular event.)
    pub is_specular: Bool,
    /// Absorption coefficient along this ray, 1/m.
    pub absorption: Color,
}
impl_staged!(RayState { rng, vertex, throughput, radiance_scale, pdf_dir, is_specular, absorption });

/// What travels along a path: a [`RayState`], and whatever else its tracer keeps.
pub trait PathState: Staged {
    /// What every path carries.
    fn path(self) -> RayState;
}

impl PathState for RayState {
    fn path(self) -> RayState {
        self
    }
}

/// (x, y on the film; sample) → first ray.
pub type OnEmitFn<S = RayState> = Fun<(U32, U32, U32), (Ray, S)>;
/// A hit → what the surface itself adds to the path.
pub type OnHitFn<S = RayState> = Fun<(Ray, Hit, S, SurfaceElement, Material), Color>;
/// A miss → what lies behind everything adds to the path.
pub type OnMissFn<S = RayState> = Fun<(Ray, S), Color>;
/// A hit → a shadow ray and what it carries if it is not blocked, or nothing.
pub type OnShadowFn<S = RayState, L = Color> =
    Fun<(Ray, Hit, S, SurfaceElement, Material, Exit<(Ray, L)>, Exit<()>), Never>;
/// A hit → the next ray, or the end of the path.
pub type OnBounceFn<S = RayState> = Fun<(Ray, Hit, S, SurfaceElement, Material, Exit<(Ray, S)>, Exit<()>), Never>;

/// A renderer, of paths that carry `S` and whose shadow rays carry `L`: light for the path's own pixel ([`Color`]), or for
/// any pixel ([`Splat`](lens::Splat)).
#[derive(Clone, Copy)]
pub struct Tracer<S: Staged = RayState, L: Staged = Color> {
    /// Where paths start.
    pub on_emit: OnEmitFn<S>,
    /// What a hit surface adds.
    pub on_hit: OnHitFn<S>,
    /// What the surroundings add.
    pub on_miss: OnMissFn<S>,
    /// Where shadow rays go.
    pub on_shadow: OnShadowFn<S, L>,
    /// How a path goes on.
    pub on_bounce: OnBounceFn<S>,
}

/// The camera's ray for a sample of a pixel, and the state of a path that starts with it.
pub fn first_ray(b: &mut Block, camera: CameraFn, x: U32, y: U32, sample: U32) -> (Ray, RayState) {
    let frame = Row::<Frame>::at(0u32);
    let pixel = y * frame.get(Frame::WIDTH) + x;
    let rng = Stream::of(frame.get(Frame::SEED), pixel, sample);
    let around = read_color(frame, [Frame::ABSORPTION_R, Frame::ABSORPTION_G, Frame::ABSORPTION_B]);
    let state = RayState {
        rng,
        vertex: 1.into(),
        throughput: white(),
        radiance_scale: pixel_scale(b, pixel),
        pdf_dir: 0.0.into(),
        is_specular: true.into(),
        absorption: settings().get(Settings::HAS_VOLUMES).select(around, black()),
    };
    (camera.call(b, (x, y, rng.vertex(0.into(), 0))), state)
}

/// The choices of the render.
fn settings() -> Row<Settings> {
    Row::at(0u32)
}

/// The side of a surface that a ray has hit, by the shading normal with the normal map.
fn side_seen(surf: SurfaceElement, mat: Material, ray: Ray) -> Side {
    let local = Frame3 { normal: mat.normal, ..surf.local };
    Side::new(SurfaceElement { local, ..surf }, -ray.dir)
}
