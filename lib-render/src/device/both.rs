//! The scalar CPU device for bidirectional path tracing: the loop over a path twice, once with a tracer whose paths start at a light and
//! once with one whose paths start at the camera (paper, section 4.6).
//!
//! The first path leaves its vertices in the stream [`LightVertices`]; each vertex of the second is connected with all of
//! them. What has been hit there is shaded again for it, in one function for all vertices of both paths: a copy for each pair
//! of classes of surfaces would be many.

use jerboa_ir::lang::{Block, Fun, U32, never};

use crate::core::color::{Color, black};
use crate::core::vec::Vec3;
use crate::device::cpu::{Vertex, ask, each_item, follow, is_blocked, splat, unblocked};
use crate::geometry::make_geometry;
use crate::geometry::triangle::Triangle;
use crate::ray::{Hit, Ray};
use crate::schema::{Geometries, LightVertices, NONE};
use crate::shader::make_shader;
use crate::tracer::Tracer;
use crate::tracer::bidirectional::{FarEnd, LightVertex, Walk, connect};
use crate::tracer::lens::Splat;
use crate::traverse::{TraverseFn, make_traverse};

/// (where it is, where its light comes from, the near end) → the far end of a connection.
type FarEndFn = Fun<(Hit, Vec3, Vec3), FarEnd>;

/// The kernel of this name. Its items' samples are what the camera's paths bring home; the rest is left as
/// [`trace_light`](super::cpu::trace_light) leaves it.
pub fn trace_both(name: &str, eye: Tracer<Walk>, light: Tracer<Walk, Splat>) {
    let (traverse, far_end) = (make_traverse(), make_far_end());
    each_item(name, |b, at| {
        end_with(b, 0.into());
        let (_, closest, shadow) = follow(b, light, traverse, at, |b, vertex| {
            keep(b, vertex);
            ask(b, light, traverse, vertex, splat)
        });
        let (sum, more_closest, more_shadow) = follow(b, eye, traverse, at, |b, vertex| {
            let (direct, asked) = ask(b, eye, traverse, vertex, unblocked);
            let (connected, rays) = connect_all(b, traverse, far_end, vertex);
            (direct + connected, asked + rays)
        });
        (sum, closest + more_closest, shadow + more_shadow)
    });
}

/// The kept vertices end before this row.
fn end_with(b: &mut Block, row: U32) {
    b.store(LightVertices::PRIMITIVE, row, U32::from(NONE));
}

/// Keep a vertex of the path from the light.
fn keep(b: &mut Block, Vertex { ray, hit, state, surf, mat }: Vertex<Walk>) {
    let vertex = LightVertex::new(b, (ray, hit, state), surf, mat);
    let row = vertex.vertex - 1u32;
    b.store_record(LightVertices::PRIMITIVE, row, vertex);
    end_with(b, row + 1u32);
}

/// What all kept vertices send to a vertex of the path from the camera, and the shadow rays that this takes.
fn connect_all(b: &mut Block, traverse: TraverseFn, far_end: FarEndFn, near: Vertex<Walk>) -> (Color, U32) {
    let Vertex { ray, hit, state, surf, mat } = near;
    let all = |b: &mut Block| {
        let start = (U32::from(0), black(), U32::from(0));
        let (_, sum, rays) = b.while_(
            start,
            |b, (row, _, _)| b.load(LightVertices::PRIMITIVE, row).ne(NONE),
            |b, (row, sum, rays)| {
                let light: LightVertex = b.load_record(LightVertices::PRIMITIVE, row);
                let some = |b: &mut Block| {
                    let far = far_end.call(b, (light.hit, light.from, surf.point));
                    let (shadow, carried) = connect(b, (ray, hit, state), surf, mat, light, far);
                    let trace = |b: &mut Block| {
                        let is_blocked = is_blocked(b, traverse, state.path, shadow);
                        (is_blocked.select(black(), carried), U32::from(1))
                    };
                    b.if_(carried.is_black(), |_| (black(), U32::from(0)), trace)
                };
                let (more, ray) = b.if_(light.light.is_black(), |_| (black(), U32::from(0)), some);
                (row + 1u32, sum + more, rays + ray)
            },
        );
        (sum, rays)
    };
    b.if_(mat.bsdf.is_specular | mat.is_unlit, |_| (black(), U32::from(0)), all)
}

/// The far end of a connection. It stays a call.
fn make_far_end() -> FarEndFn {
    let body = |b: &mut Block, _: FarEndFn, (hit, from, point): (Hit, Vec3, Vec3)| {
        let geometry = Triangle::of(b, hit).geometry();
        let none = NONE.into();
        // Neither a surface nor its material depends on the ray that found it.
        let ray = Ray { org: point, dir: -from, tmax: hit.t, skip: none, skip1: none, skip2: none };
        b.dispatch(geometry, |b, row| {
            let geometry = make_geometry(row, make_shader(row.get(Geometries::MATERIAL)));
            let surf = geometry.surface_element.call(b, (ray, hit));
            let mat = geometry.shader.call(b, (ray, hit, surf));
            FarEnd::new(b, surf, mat, from, point)
        })
    };
    FarEndFn::rec("far_end", |_| never(), body)
}
