//! Bidirectional path tracing: a path from a light and a path from the camera, and each of their vertices connected.
//!
//! A path of k edges can be found in k + 2 ways: by how many of its vertices were drawn from the light. The ways are weighted
//! by the balance heuristic (Veach 1997, section 10.2), whose sums over all ways are carried along by two numbers for each
//! path (van Antwerpen 2011; Georgiev 2012, "Implementing vertex connection and merging", equations 31 to 46, without merging):
//! at a vertex, with p the density with which it was drawn from its own side, `d_next` is (density with which the connection
//! to the vertex before could be drawn) / p, and `d_past` all ways that lie further back, but for the density of the step
//! backwards from here.
//!
//! | vertices from the light | way | here |
//! |---|---|---|
//! | 0 | the camera's path hits the light | `on_hit`, `on_miss` of [`make_eye_tracer`] |
//! | 1 | it asks for a light | its `on_shadow` |
//! | 2 or more, not all | two vertices are connected | [`connect`] |
//! | all | the light's path asks for the camera | `on_shadow` of [`make_light_side_tracer`] |
//!
//! Every vertex is connected with every one, so a sample costs the product of the lengths of its two paths: much in a white
//! room, little where a scene absorbs.
//!
//! What weights need is only that all ways agree on the densities of a path; they may be others than what is drawn by, at the
//! price of variance. Three are: a light with extent counts as drawn uniformly by area from anywhere, roulette does not count,
//! and a perfectly specular event is as likely in both directions.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, Col, F32, Fun, Row, U32};

use crate::bsdf::BsdfSample;
use crate::camera::CameraFn;
use crate::core::color::{Color, black};
use crate::core::rng::{DIM_BSDF, DIM_LIGHT, Rng};
use crate::core::sampling::{UNIFORM_SPHERE_PDF, cosine_hemisphere_pdf, uniform_cone_pdf};
use crate::core::vec::{Vec3, vec3};
use crate::geometry::SurfaceElement;
use crate::geometry::offset::{offset_origin, spawn_ray, spawn_shadow_ray};
use crate::light::{DirectLightSample, area_pdf, choose_light, with_light};
use crate::material::Material;
use crate::ray::{Hit, Ray};
use crate::schema::*;
use crate::tracer::absorption::{arriving, reaching};
use crate::tracer::adjoint::{carried, scattered};
use crate::tracer::lens::{Lens, Splat};
use crate::tracer::light::{Emitted, emit, go_on};
use crate::tracer::path::{asks_for_light, direct, emitted, scatter, sky, within_depth};
use crate::tracer::{OnBounceFn, OnHitFn, OnMissFn, OnShadowFn, PathState, RayState, Tracer, first_ray, settings};

/// What both paths carry.
#[derive(Clone, Copy)]
pub struct Walk {
    /// What every path carries.
    pub path: RayState,
    /// See the module. On the way to a vertex, without what its distance and cosine make of it.
    pub d_next: F32,
    /// See the module, likewise.
    pub d_past: F32,
    /// Did this ray come from infinitely far away?
    pub is_parallel: Bool,
}
impl_staged!(Walk { path, d_next, d_past, is_parallel });

impl PathState for Walk {
    fn path(self) -> RayState {
        self.path
    }
}

/// The sums at a vertex that has been reached. Where the way there runs along the surface they are infinite: nothing else
/// finds such a path, and its weight is 0.
#[derive(Clone, Copy)]
struct Sums {
    next: F32,
    past: F32,
}

impl Walk {
    /// Weight of light that its ray finds by chance, given all other ways over this one. Nothing else finds what the camera
    /// sees.
    fn by_chance(self, others: F32) -> F32 {
        self.path.vertex.eq(1).select(F32::from(1.0), 1.0 / (1.0 + others))
    }

    /// The sums where its ray hits.
    fn reaching(self, ray: Ray, hit: Hit, surf: SurfaceElement) -> Sums {
        let cos = surf.face_cos(ray.dir).abs();
        let squared = self.is_parallel.select(F32::from(1.0), hit.t * hit.t);
        let over = 1.0 / cos;
        Sums { next: self.d_next * squared * over, past: self.d_past.absorb(over) }
    }

    /// What it carries on by a BSDF sample, from `wo`.
    fn leaving(
        self,
        b: &mut Block,
        sums: Sums,
        (surf, mat): (SurfaceElement, Material),
        wo: Vec3,
        sample: BsdfSample,
        path: RayState,
    ) -> Walk {
        let cos = surf.face_cos(sample.wi).abs();
        let (d_next, d_past) = b.if_(
            sample.is_specular,
            |_| (F32::from(0.0), sums.past.absorb(cos)),
            |b| {
                let back = mat.bsdf.pdf.call(b, (wo, sample.wi));
                (1.0 / sample.pdf_dir, (sums.past.absorb(back) + sums.next).absorb(cos / sample.pdf_dir))
            },
        );
        Walk { path, d_next, d_past, is_parallel: false.into() }
    }
}

impl Sums {
    /// All ways to draw what lies before a vertex otherwise, over this one, where `density` per square metre is that of
    /// drawing the vertex from the other side, and `back` that of the step backwards from it, per steradian.
    fn others(self, density: F32, back: F32) -> F32 {
        (self.next + self.past.absorb(back)).absorb(density)
    }
}

/// Paths from the camera. Vertices ask for one light each.
pub fn make_eye_tracer(camera: CameraFn) -> Tracer<Walk> {
    Tracer {
        on_emit: Fun::lam(move |b, (x, y, sample): (U32, U32, U32)| {
            let (ray, path) = first_ray(b, camera, x, y, sample);
            let d_next = 1.0 / Lens::of_frame().density(ray.dir);
            (ray, Walk { path, d_next, d_past: 0.0.into(), is_parallel: false.into() })
        }),
        on_hit: OnHitFn::<Walk>::lam(|b, (ray, hit, walk, surf, mat)| {
            emitted(b, (ray, hit, walk.path), mat, |_, value| {
                let others = walk.reaching(ray, hit, surf).others(value.pdf_area, value.pdf_dir);
                walk.by_chance(others)
            })
        }),
        on_miss: OnMissFn::<Walk>::lam(|b, (ray, walk)| {
            sky(b, ray, walk.path, |direct| {
                let last = Row::<Lights>::at(settings().get(Settings::LIGHT_COUNT).max(1u32) - 1u32);
                let sums = Sums { next: walk.d_next, past: walk.d_past };
                let others = direct.gt(0.0).select(sums.others(direct, 1.0 / disk_area(last)), 0.0.into());
                walk.by_chance(others)
            })
        }),
        on_shadow: OnShadowFn::exits(|b, (ray, hit, walk, surf, mat, emit, skip)| {
            let Walk { path, .. } = walk;
            b.when(!asks_for_light(path, mat), |b| skip.take(b, ()));
            let (index, light) = draw_light(b, path.rng.vertex(path.vertex, DIM_LIGHT), surf.point);
            let from = LightFrom::new(index, light);
            let contribution = direct(b, (ray, hit, path), surf, mat, light, |b, by_bsdf| {
                let back = mat.bsdf.pdf.call(b, (-ray.dir, light.wi));
                let by_chance = light.is_delta.select(F32::from(0.0), by_bsdf / from.direct);
                let density = from.emission * surf.face_cos(light.wi).abs();
                1.0 / (1.0 + by_chance + walk.reaching(ray, hit, surf).others(density, back))
            });
            b.when(contribution.is_black(), |b| skip.take(b, ()));
            emit.take(b, (spawn_shadow_ray(surf, light), contribution))
        }),
        on_bounce: OnBounceFn::<Walk>::exits(|b, (ray, hit, walk, surf, mat, next, end)| {
            let (sample, path) = scatter(b, (ray, hit, walk.path), surf, mat, end);
            let sums = walk.reaching(ray, hit, surf);
            let walk = walk.leaving(b, sums, (surf, mat), -ray.dir, sample, path);
            next.take(b, (spawn_ray(surf, sample.wi), walk))
        }),
    }
}

/// Paths from lights. Vertices ask for the camera.
pub fn make_light_side_tracer() -> Tracer<Walk, Splat> {
    Tracer {
        on_emit: Fun::lam(|b, at: (U32, U32, U32)| {
            let emitted = emit(b, at);
            (emitted.ray, Walk::from_light(emitted))
        }),
        on_hit: OnHitFn::lam(|_, _| black()),
        on_miss: OnMissFn::lam(|_, _| black()),
        on_shadow: OnShadowFn::exits(|b, (ray, hit, walk, surf, mat, emit, skip)| {
            let Walk { path, .. } = walk;
            b.when(!within_depth(path) | mat.is_unlit | mat.bsdf.is_specular, |b| skip.take(b, ()));
            let lens = Lens::of_frame();
            let seen = lens.seen_from(surf.point);
            b.when(!seen.is_seen, |b| skip.take(b, ()));
            let (from, to) = (-ray.dir, seen.wi);
            let density = seen.importance * surf.face_cos(to).abs();
            let f = scattered(b, surf, mat, from, to);
            let back = mat.bsdf.pdf.call(b, (from, to));
            let weight = 1.0 / (1.0 + walk.reaching(ray, hit, surf).others(density, back));
            let light = reaching(b, (ray, hit, path), surf, mat, to, seen.distance).absorb(f) * (density * weight);
            b.when(light.is_black(), |b| skip.take(b, ()));
            emit.take(b, (spawn_shadow_ray(surf, lens.as_light(seen)), Splat { pixel: seen.pixel, light }))
        }),
        on_bounce: OnBounceFn::exits(|b, (ray, hit, walk, surf, mat, next, end)| {
            let Walk { path, .. } = walk;
            b.when(!within_depth(path) | mat.is_unlit | path.vertex.ge(LIGHT_VERTICES - 1), |b| end.take(b, ()));
            let from = -ray.dir;
            let sample = mat.bsdf.sample.call(b, (path.rng.vertex(path.vertex, DIM_BSDF), from));
            let factor = carried(b, surf, mat, from, sample);
            let path = go_on(b, (ray, hit, path), surf, mat, sample.wi, factor);
            b.when(path.throughput.is_black(), |b| end.take(b, ()));
            let sums = walk.reaching(ray, hit, surf);
            let walk = walk.leaving(b, sums, (surf, mat), from, sample, path);
            next.take(b, (spawn_ray(surf, sample.wi), walk))
        }),
    }
}

impl Walk {
    /// The first edge of a path from a light.
    fn from_light(emitted: Emitted) -> Walk {
        let Emitted { light, state, cos, pdf_area, pdf_dir, .. } = emitted;
        let row = Row::<Lights>::at(light);
        let is_parallel = is_parallel(row);
        let density = pdf_area * pdf_dir;
        let has_extent = !is_delta(row) & density.gt(0.0);
        Walk {
            path: state,
            d_next: is_parallel.select(disk_area(row), 1.0 / pdf_dir),
            d_past: has_extent.select(cos / density, 0.0.into()),
            is_parallel,
        }
    }
}

/// Has it no extent, so that no path from the camera finds it?
fn is_delta(row: Row<Lights>) -> Bool {
    let kind = row.get(Lights::KIND);
    kind.eq(LIGHT_POINT) | kind.eq(LIGHT_SPOT) | kind.eq(LIGHT_DIRECTIONAL)
}

/// Is it infinitely far away?
fn is_parallel(row: Row<Lights>) -> Bool {
    let kind = row.get(Lights::KIND);
    kind.eq(LIGHT_DIRECTIONAL) | kind.eq(LIGHT_ENVIRONMENT)
}

/// Area of the disk that light from infinitely far away starts on, m².
fn disk_area(row: Row<Lights>) -> F32 {
    let radius = row.get(Lights::SCENE_RADIUS);
    std::f32::consts::PI * radius * radius
}

/// Choose a light, and sample it from a point. Draws at most 3 numbers.
fn draw_light(b: &mut Block, rng: Rng, point: Vec3) -> (U32, DirectLightSample) {
    let (u, rng) = rng.next();
    let index = choose_light(b, u);
    (index, with_light(b, index, |b, light| light.sample_direct.call(b, (rng, point))))
}

/// What weights need to know of a light that a point asked for.
#[derive(Clone, Copy)]
struct LightFrom {
    /// Density of its direction, choice included, per steradian; that of a light with extent uniformly by area.
    direct: F32,
    /// Density with which a path from the light starts there and goes to the point, over `direct` and the cosine at the
    /// light, 1/m².
    emission: F32,
}

impl LightFrom {
    fn new(index: U32, light: DirectLightSample) -> LightFrom {
        let row = Row::<Lights>::at(index);
        let kind = row.get(Lights::KIND);
        let squared = light.distance * light.distance;
        let edge = |axes: [Col<Lights, F32>; 3]| vec3(row.get(axes[0]), row.get(axes[1]), row.get(axes[2]));
        let (e1, e2) =
            (edge([Lights::E1_X, Lights::E1_Y, Lights::E1_Z]), edge([Lights::E2_X, Lights::E2_Y, Lights::E2_Z]));
        let scale = e1.abs().max_element().max(e2.abs().max_element());
        let cos = (e1 / scale).cross(e2 / scale).normalize_scaled().dot(light.wi).abs();
        let sides = row.get(Lights::DOUBLE_SIDED).select(F32::from(0.5), 1.0.into());
        let has_area = !is_parallel(row) & !is_delta(row);
        let opening = 1.0 - row.get(Lights::COS_OUTER);
        let pointed = kind.eq(LIGHT_SPOT).select(uniform_cone_pdf(opening), UNIFORM_SPHERE_PDF.into());
        let dir = has_area.select(cosine_hemisphere_pdf(cos) * sides, pointed);
        LightFrom {
            direct: has_area.select(area_pdf(index) * squared / cos, light.pdf_dir),
            emission: is_parallel(row).select(1.0 / disk_area(row), dir / squared),
        }
    }
}

/// A vertex of a path from a light, to be connected with: a row of [`LightVertices`].
#[derive(Clone, Copy)]
pub struct LightVertex {
    /// Where it is.
    pub hit: Hit,
    /// Where the light comes from, unit, world.
    pub from: Vec3,
    /// The light that arrives; black where nothing can be connected.
    pub light: Color,
    next: F32,
    past: F32,
    /// Its number along the path.
    pub vertex: U32,
}
impl_staged!(LightVertex { hit, from, light, next, past, vertex });

impl LightVertex {
    /// The vertex that a path from a light has reached.
    pub fn new(b: &mut Block, (ray, hit, walk): (Ray, Hit, Walk), surf: SurfaceElement, mat: Material) -> LightVertex {
        let Sums { next, past } = walk.reaching(ray, hit, surf);
        let light = arriving(b, walk.path, hit);
        let light = (mat.bsdf.is_specular | mat.is_unlit).select(black(), light);
        LightVertex { hit, from: -ray.dir, light, next, past, vertex: walk.path.vertex }
    }
}

/// The far end of a connection, as the near one sees it.
#[derive(Clone, Copy)]
pub struct FarEnd {
    /// Towards it, unit, world.
    pub wi: Vec3,
    /// Distance, m.
    pub distance: F32,
    /// Where a shadow ray to it ends, world.
    pub pos: Vec3,
    /// What it scatters this way of the light that arrives there, per steradian.
    pub f: Color,
    /// Face normal there.
    pub normal: Vec3,
    /// Density with which its own path goes this way, per steradian.
    pub forward: F32,
    /// Density with which a path that comes from here goes back to where its light comes from, per steradian.
    pub back: F32,
}
impl_staged!(FarEnd { wi, distance, pos, f, normal, forward, back });

impl FarEnd {
    /// The surface with this material, whose light comes from a direction, seen from a point.
    pub fn new(b: &mut Block, surf: SurfaceElement, mat: Material, from: Vec3, point: Vec3) -> FarEnd {
        let way = surf.point - point;
        let distance = way.length_scaled();
        let wi = way / distance;
        let to = -wi;
        FarEnd {
            wi,
            distance,
            pos: offset_origin(surf, to),
            f: scattered(b, surf, mat, from, to),
            normal: surf.face_normal,
            forward: mat.bsdf.pdf.call(b, (to, from)),
            back: mat.bsdf.pdf.call(b, (from, to)),
        }
    }
}

/// The connection of a path from the camera, at the vertex it has reached, with a vertex of the path from the light: a shadow
/// ray, and what it carries, weighted. Black where there is none.
pub fn connect(
    b: &mut Block,
    (ray, hit, walk): (Ray, Hit, Walk),
    surf: SurfaceElement,
    mat: Material,
    light: LightVertex,
    far: FarEnd,
) -> (Ray, Color) {
    let (path, wo, wi) = (walk.path, -ray.dir, far.wi);
    let edges = light.vertex + path.vertex + 1u32;
    let is_within = !settings().get(Settings::DEPTH_LIMITED) | edges.le(settings().get(Settings::MAX_DEPTH));
    let (squared, far_cos) = (far.distance * far.distance, far.normal.dot(wi).abs());
    let f_cos = mat.bsdf.eval.call(b, (wi, wo)) * mat.normal.dot(wi).abs();
    let (forward, back) = (mat.bsdf.pdf.call(b, (wi, wo)), mat.bsdf.pdf.call(b, (wo, wi)));
    let on_light = Sums { next: light.next, past: light.past }.others(forward * far_cos / squared, far.back);
    let cos = surf.face_cos(wi).abs();
    let on_eye = walk.reaching(ray, hit, surf).others(far.forward * cos / squared, back);
    let weight = 1.0 / (1.0 + on_light + on_eye);
    let carried = reaching(b, (ray, hit, path), surf, mat, wi, far.distance);
    let carried = carried.absorb(f_cos).absorb(far.f).absorb(light.light);
    let carried = carried * (weight * far_cos / squared);
    let target = DirectLightSample {
        wi,
        pos: far.pos,
        distance: far.distance,
        intensity: black(),
        pdf_dir: 1.0.into(),
        is_delta: true.into(),
        primitive: light.hit.primitive,
        primitive1: NONE.into(),
    };
    let shadow = spawn_shadow_ray(surf, target);
    // The shadow ray sees neither end's triangle. So both must still be seen from the sides that were asked, or of a wall that
    // holds both ends one could be on the inside and the other on the outside.
    let is_as_asked = |normal: Vec3| {
        let (asked, seen) = (normal.dot(wi), normal.dot(shadow.dir));
        (asked.gt(0.0) & seen.gt(0.0)) | (asked.lt(0.0) & seen.lt(0.0))
    };
    let is_seen = is_within & is_as_asked(surf.face_normal) & is_as_asked(far.normal);
    (shadow, is_seen.select(carried, black()))
}
