//! The scalar CPU device, IR half: one kernel that follows each path of a range of samples from the camera to its end.
//!
//! Item i of a pass is sample `SAMPLE + i mod SAMPLES` of pixel `i div SAMPLES` of the crop window; its radiance and its
//! ray counts go to row i − first of the stream. So a tile is a range of items, and the host may cut the window as it
//! likes.

use jerboa_ir::lang::{Block, Bool, Exit, Fun, Keep, Left, Row, Staged, U32, entry};

use crate::core::color::{Color, black};
use crate::cutout::make_accept;
use crate::device::Device;
use crate::device::pixel::PixelSum;
use crate::geometry::triangle::Triangle;
use crate::geometry::{SurfaceElement, make_geometry};
use crate::material::Material;
use crate::ray::{Hit, Ray};
use crate::schema::{Frame, Geometries, Samples};
use crate::shader::make_shader;
use crate::tracer::lens::Splat;
use crate::tracer::{PathState, RayState, Tracer};
use crate::traverse::{TraverseFn, make_traverse};

/// A device that runs one path after the other.
pub fn make_cpu_device() -> Device {
    Device { trace }
}

fn trace(name: &str, tracer: Tracer) {
    trace_with(name, tracer, make_traverse());
}

/// The kernel of this name, over a traversal: for each item, emit, then trace and shade until the path ends.
pub fn trace_with(name: &str, tracer: Tracer, traverse: TraverseFn) {
    each_item(name, |b, at| follow(b, tracer, traverse, at, |b, vertex| ask(b, tracer, traverse, vertex, unblocked)));
}

/// The kernel of a tracer whose light falls on any pixel: it goes to the sums of [`Pixels`](crate::schema::Pixels), a row for
/// each pixel of the film, and the items' own samples are black.
pub fn trace_light(name: &str, tracer: Tracer<RayState, Splat>) {
    let traverse = make_traverse();
    each_item(name, |b, at| follow(b, tracer, traverse, at, |b, vertex| ask(b, tracer, traverse, vertex, splat)));
}

/// What of a shadow ray's light is the path's own: all, unless it is blocked.
pub(super) fn unblocked(_: &mut Block, is_blocked: Bool, light: Color) -> Color {
    is_blocked.select(black(), light)
}

/// Nothing is: it goes to the pixel it falls on, unless it is blocked.
pub(super) fn splat(b: &mut Block, is_blocked: Bool, Splat { pixel, light }: Splat) -> Color {
    b.when(!is_blocked, |b| {
        let sum = PixelSum::load(b, pixel).with_light(light);
        sum.store(b, pixel);
    });
    black()
}

/// A kernel that leaves for each item its radiance and its numbers of rays, closest hit and shadow.
pub(super) fn each_item(name: &str, trace: impl Fn(&mut Block, (U32, U32, U32)) -> (Color, U32, U32)) {
    entry(
        name,
        Fun::<(U32, U32), ()>::named(name, |b, (first, count)| {
            b.while_(
                U32::from(0),
                |_, i| i.lt(count),
                |b, i| {
                    let (radiance, closest, shadow) = trace(b, item(first + i));
                    b.store(Samples::R, i, radiance.r);
                    b.store(Samples::G, i, radiance.g);
                    b.store(Samples::B, i, radiance.b);
                    b.store(Samples::CLOSEST, i, closest);
                    b.store(Samples::SHADOW, i, shadow);
                    i + 1u32
                },
            );
        }),
    );
}

/// Column and row on the film, and sample, of an item.
pub(super) fn item(i: U32) -> (U32, U32, U32) {
    let frame = Row::<Frame>::at(0u32);
    let (samples, width) = (frame.get(Frame::SAMPLES), frame.get(Frame::CROP_WIDTH));
    let pixel = i / samples;
    let sample = frame.get(Frame::SAMPLE) + i % samples;
    (frame.get(Frame::CROP_X) + pixel % width, frame.get(Frame::CROP_Y) + pixel / width, sample)
}

/// One path: its radiance and its numbers of rays, closest hit and shadow. `light` gives the light that a vertex asks for, and
/// the shadow rays that this takes.
pub(super) fn follow<S: PathState, L: Staged>(
    b: &mut Block,
    tracer: Tracer<S, L>,
    traverse: TraverseFn,
    at: (U32, U32, U32),
    light: impl Fn(&mut Block, Vertex<S>) -> (Color, U32),
) -> Brought {
    let (ray, state) = tracer.on_emit.call(b, at);
    let start = (ray, state, black(), U32::from(0), U32::from(0));
    b.loop_(start, |b, path: Path<S>, next, done| {
        let (ray, state, sum, closest, shadow) = path;
        let hit = traverse.call(b, (ray, Keep(false.into()), make_accept(state.path())));
        let closest = closest + 1u32;
        b.branch(
            hit.is_hit(),
            |b| {
                let geometry = Triangle::of(b, hit).geometry();
                b.dispatch_left(geometry, |b, row| {
                    shade(b, tracer, row, hit, (ray, state, sum, closest, shadow), &light, (next, done))
                })
            },
            |b| {
                let sky = tracer.on_miss.call(b, (ray, state));
                done.take(b, (sum + sky, closest, shadow))
            },
        )
    })
}

/// What the loop over a path's vertices carries: ray, state, radiance, and numbers of rays, closest hit and shadow.
type Path<S> = (Ray, S, Color, U32, U32);

/// What a path brings home: its radiance, and its numbers of rays, closest hit and shadow.
type Brought = (Color, U32, U32);

/// A vertex of a path, as functions of a tracer are given it.
#[derive(Clone, Copy)]
pub(super) struct Vertex<S> {
    /// The ray that led here.
    pub ray: Ray,
    /// Where it hit.
    pub hit: Hit,
    /// What the path carries.
    pub state: S,
    /// The surface.
    pub surf: SurfaceElement,
    /// Its material.
    pub mat: Material,
}

/// One vertex: add what the surface emits, ask for light, go on or end.
fn shade<S: PathState, L: Staged>(
    b: &mut Block,
    tracer: Tracer<S, L>,
    row: Row<Geometries>,
    hit: Hit,
    (ray, state, sum, closest, shadow): Path<S>,
    light: &impl Fn(&mut Block, Vertex<S>) -> (Color, U32),
    (next, done): (Exit<Path<S>>, Exit<Brought>),
) -> Left {
    let geometry = make_geometry(row, make_shader(row.get(Geometries::MATERIAL)));
    let surf = geometry.surface_element.call(b, (ray, hit));
    let mat = geometry.shader.call(b, (ray, hit, surf));
    let sum = sum + tracer.on_hit.call(b, (ray, hit, state, surf, mat));

    let (light, rays) = light(b, Vertex { ray, hit, state, surf, mat });
    let (sum, shadow) = (sum + light, shadow + rays);

    let bounce = Exit::exits(|b, (ray, state): (Ray, S)| next.take(b, (ray, state, sum, closest, shadow)));
    let end = Exit::exits(|b, ()| done.take(b, (sum, closest, shadow)));
    tracer.on_bounce.take(b, (ray, hit, state, surf, mat, bounce, end))
}

/// Trace the shadow ray of a vertex, if there is one; `arrive` is told whether it is blocked, and what it carries.
pub(super) fn ask<S: PathState, L: Staged>(
    b: &mut Block,
    tracer: Tracer<S, L>,
    traverse: TraverseFn,
    Vertex { ray, hit, state, surf, mat }: Vertex<S>,
    arrive: impl Fn(&mut Block, Bool, L) -> Color,
) -> (Color, U32) {
    b.label(|b, k: Exit<(Color, U32)>| {
        let emit = Exit::exits(|b, (shadow_ray, light): (Ray, L)| {
            let is_blocked = is_blocked(b, traverse, state.path(), shadow_ray);
            let light = arrive(b, is_blocked, light);
            k.take(b, (light, 1.into()))
        });
        let skip = Exit::exits(|b, ()| k.take(b, (black(), 0.into())));
        tracer.on_shadow.take(b, (ray, hit, state, surf, mat, emit, skip))
    })
}

/// Is there something on the way of a shadow ray from the vertex of this state?
pub(super) fn is_blocked(b: &mut Block, traverse: TraverseFn, state: RayState, ray: Ray) -> Bool {
    // The way to the light is another edge of the path than the one that led here, so cut-outs decide anew.
    let edge = RayState { vertex: state.vertex + 1u32, ..state };
    traverse.call(b, (ray, Keep(true.into()), make_accept(edge))).is_hit()
}
