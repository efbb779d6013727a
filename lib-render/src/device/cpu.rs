//! The scalar CPU device, IR half: one kernel that follows each path of a range of samples from the camera to its end.
//!
//! Item i of a pass is sample `SAMPLE + i mod SAMPLES` of pixel `i div SAMPLES` of the crop window; its radiance and its
//! ray counts go to row i − first of the stream. So a tile is a range of items, and the host may cut the window as it
//! likes.

use jerboa_ir::lang::{Block, Exit, Fun, Keep, Left, Row, U32, entry};

use crate::core::color::{Color, black};
use crate::cutout::make_accept;
use crate::device::Device;
use crate::geometry::make_geometry;
use crate::ray::{Hit, Ray};
use crate::schema::{Frame, Geometries, Primitives, Samples};
use crate::shader::make_shader;
use crate::tracer::{RayState, Tracer};
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
    entry(
        name,
        Fun::<(U32, U32), ()>::named(name, |b, (first, count)| {
            b.while_(
                U32::from(0),
                |_, i| i.lt(count),
                |b, i| {
                    let (x, y, sample) = item(first + i);
                    let (radiance, closest, shadow) = path(b, tracer, traverse, x, y, sample);
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

/// One path: its radiance and its numbers of rays, closest hit and shadow.
fn path(b: &mut Block, tracer: Tracer, traverse: TraverseFn, x: U32, y: U32, sample: U32) -> (Color, U32, U32) {
    let (ray, state) = tracer.on_emit.call(b, (x, y, sample));
    let start = Path { ray, state, sum: black(), closest: 0.into(), shadow: 0.into() };
    b.loop_(start, |b, path, next, done| {
        let hit = traverse.call(b, (path.ray, Keep(false.into()), make_accept(path.state)));
        let path = Path { closest: path.closest + 1u32, ..path };
        b.branch(
            hit.is_hit(),
            |b| {
                let geometry = Row::<Primitives>::at(hit.primitive).get(Primitives::GEOMETRY);
                b.dispatch_left(Row::<Geometries>::at(geometry), |b, row| {
                    shade(b, tracer, traverse, row, path, hit, next, done)
                })
            },
            |b| {
                let sky = tracer.on_miss.call(b, (path.ray, path.state));
                done.take(b, (path.sum + sky, path.closest, path.shadow))
            },
        )
    })
}

/// What the loop over a path's vertices carries.
#[derive(Clone, Copy)]
struct Path {
    ray: Ray,
    state: RayState,
    sum: Color,
    closest: U32,
    shadow: U32,
}
jerboa_ir::impl_staged!(Path { ray, state, sum, closest, shadow });

/// One vertex: add what the surface emits, ask for light, go on or end.
#[allow(clippy::too_many_arguments)] // the loop's state and its two ways out
fn shade(
    b: &mut Block,
    tracer: Tracer,
    traverse: TraverseFn,
    row: Row<Geometries>,
    path: Path,
    hit: Hit,
    next: Exit<Path>,
    done: Exit<(Color, U32, U32)>,
) -> Left {
    let Path { ray, state, .. } = path;
    let geometry = make_geometry(row, make_shader(row.get(Geometries::MATERIAL)));
    let surf = geometry.surface_element.call(b, (ray, hit));
    let mat = geometry.shader.call(b, (ray, hit, surf));
    let sum = path.sum + tracer.on_hit.call(b, (ray, hit, state, surf, mat));

    // Trace the shadow ray, if there is one.
    let (light, rays) = b.label(|b, k: Exit<(Color, U32)>| {
        // The way to the light is another edge of the path than the one that led here, so cut-outs decide anew.
        let edge = RayState { vertex: state.vertex + 1u32, ..state };
        let emit = Exit::exits(|b, (shadow_ray, contribution): (Ray, Color)| {
            let blocked = traverse.call(b, (shadow_ray, Keep(true.into()), make_accept(edge))).is_hit();
            k.take(b, (blocked.select(black(), contribution), 1.into()))
        });
        let skip = Exit::exits(|b, ()| k.take(b, (black(), 0.into())));
        tracer.on_shadow.take(b, (ray, hit, state, surf, mat, emit, skip))
    });
    let path = Path { sum: sum + light, shadow: path.shadow + rays, ..path };

    let bounce = Exit::exits(|b, (ray, state): (Ray, RayState)| next.take(b, Path { ray, state, ..path }));
    let end = Exit::exits(|b, ()| done.take(b, (path.sum, path.closest, path.shadow)));
    tracer.on_bounce.take(b, (ray, hit, state, surf, mat, bounce, end))
}
