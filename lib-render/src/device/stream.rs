//! The wavefront CPU device, IR half: kernels over streams of paths, each a loop over a range of rows (paper, section 4.7).
//!
//! A *wave* takes all paths in flight one vertex further:
//!
//! ```text
//! generate   new paths                              -> Paths
//! trace      the nearest hit of each ray            Paths -> Hits
//!            (the host sorts row numbers by shader  Hits -> Order)
//! shade      emission, shadow ray, next ray         Paths, Hits, Order -> Next, Shadows
//! miss       what lies behind everything            Paths, Order -> Next
//! shadow     adds what no one blocks                Shadows -> Next
//! ```
//!
//! Then the host takes the radiance of paths that ended, and `Next` becomes `Paths`. What is sorted is numbers of rows: `shade`
//! reads row `PATH` and writes row i, so that paths close ranks by themselves. `shade` is specialised once for each class
//! of shaders and runs over the range of that class.
//!
//! A path adds the very numbers that the scalar device ([`super::cpu`]) adds, in its order, so both give the same bits.

use jerboa_ir::lang::{Block, Bool, Exit, Fun, Row, Staged, U32, entry};

use crate::core::color::{Color, black};
use crate::cutout::make_accept;
use crate::device::Device;
use crate::device::cpu::item;
use crate::geometry::make_geometry;
use crate::geometry::triangle::Triangle;
use crate::ray::{Hit, Ray};
use crate::schema::{Geometries, Hits, NONE, Next, Order, Paths, Shadows};
use crate::shader::make_shader;
use crate::tracer::{RayState, Tracer};
use crate::traverse::turns::{self, Question};

/// A device that takes many paths from vertex to vertex. The kernels that need no tracer are declared with it.
pub fn make_stream_device() -> Device {
    kernel("trace", trace);
    kernel("shadow", shadow);
    Device { trace: shading }
}

/// Paths that are shaded at once. Two registers hold a value of theirs: 1 % and 8 % quicker than one in cornell-box and
/// living-room, where four are 8 % slower and 25 % quicker (tests/runs/wave.txt).
const WIDTH: u8 = 8;

/// Name of a kernel that needs a tracer; the path tracer's have short names.
pub fn kernel_name(tracer: &str, stage: &str) -> String {
    if tracer == "path" { stage.into() } else { format!("{tracer}_{stage}") }
}

/// Declare the kernels of a tracer.
fn shading(name: &str, tracer: Tracer) {
    let name = |stage| kernel_name(name, stage);
    kernel(&name("generate"), |b, (lo, hi, first, number): (U32, U32, U32, U32)| {
        b.vectorize(WIDTH, lo, hi, |b, i| generate(b, tracer, i, first + (i - lo), number + (i - lo)));
    });
    kernel(&name("shade"), |b, (class, lo, hi): (Row<Geometries>, U32, U32)| {
        b.vectorize(WIDTH, lo, hi, |b, i| shade(b, tracer, class, i));
    });
    kernel(&name("miss"), |b, (lo, hi): (U32, U32)| b.vectorize(WIDTH, lo, hi, |b, i| miss(b, tracer, i)));
}

/// Declare an entry.
fn kernel<A: Staged>(name: &str, body: impl FnOnce(&mut Block, A)) {
    entry(name, Fun::<A, ()>::named(name, body));
}

/// What a path brings home: its sum, its numbers of rays, closest and shadow, and its number.
type Account = (Color, U32, U32, U32);

/// Start path i with an item of the pass.
pub(super) fn generate(b: &mut Block, tracer: Tracer, i: U32, at: U32, number: U32) {
    let (x, y, sample) = item(at);
    let (ray, state) = tracer.on_emit.call(b, (x, y, sample));
    b.store_record(Paths::ORG_X, i, (ray, state));
    let account: Account = (black(), 0.into(), 0.into(), number);
    b.store_record(Paths::R, i, (account, Bool::from(true), Bool::from(false)));
}

/// Find the nearest hit of each path of a range that has a ray, and who shades it.
fn trace(b: &mut Block, range: (U32, U32)) {
    turns::trace(b, range, false, ask_nearest, answer_nearest);
}

/// What does the ray of path i hit?
pub(super) fn ask_nearest(b: &mut Block, i: U32) -> Question {
    let is_asked = b.load(Paths::ALIVE, i);
    let (ray, state): (Ray, RayState) = b.load_record(Paths::ORG_X, i);
    Question { is_asked, ray, accept: make_accept(state) }
}

/// This.
pub(super) fn answer_nearest(b: &mut Block, i: U32, hit: Hit) {
    b.store_record(Hits::PRIMITIVE, i, hit);
    let class = b.if_(hit.is_hit(), |b| Triangle::of(b, hit).geometry().get(Geometries::CLASS), |_| U32::from(NONE));
    b.store(Hits::CLASS, i, class);
}

/// Shade row i: add what the surface emits, ask for light, go on or end. All rows of the range are of one class.
pub(super) fn shade(b: &mut Block, tracer: Tracer, class: Row<Geometries>, i: U32) {
    let path: U32 = b.load(Order::PATH, i);
    let (ray, state): (Ray, RayState) = b.load_record(Paths::ORG_X, path);
    let account: Account = b.load_record(Paths::R, path);
    let hit: Hit = b.load_record(Hits::PRIMITIVE, path);
    let row = class.sibling(Triangle::of(b, hit).geometry().index());
    b.dispatch(row, |b, row| store_vertex(b, tracer, row, i, (ray, hit, state), account));
}

/// One vertex of a path, whose row of geometry is known by class, into row i.
fn store_vertex(
    b: &mut Block,
    tracer: Tracer,
    row: Row<Geometries>,
    i: U32,
    at: (Ray, Hit, RayState),
    account: Account,
) {
    let (sum, closest, shadow, number) = account;
    let lit = |b: &mut Block, ray: Option<(Ray, Color)>| {
        ray.into_iter().for_each(|ray| b.store_record(Shadows::ORG_X, i, ray));
        Bool::from(ray.is_some())
    };
    let next = |b: &mut Block, next: Option<(Ray, RayState)>| {
        next.into_iter().for_each(|next| b.store_record(Next::ORG_X, i, next));
        Bool::from(next.is_some())
    };
    let (emitted, asked, alive) = vertex(b, tracer, row, at, lit, next);
    let sum = sum + emitted;
    // Light that is not asked for is black; what is asked for is added when the shadow ray has been traced.
    let (sum, shadow) = asked.select((sum, shadow + 1u32), (sum + black(), shadow));
    b.store_record(Next::R, i, (sum, closest + 1u32, shadow, number, alive, asked));
}

/// One vertex of a path: what the surface emits, what `lit` makes of the shadow ray or of there being none, and what `next`
/// makes of the next ray or of the path's end.
pub(super) fn vertex<L: Staged, N: Staged>(
    b: &mut Block,
    tracer: Tracer,
    row: Row<Geometries>,
    (ray, hit, state): (Ray, Hit, RayState),
    lit: impl Fn(&mut Block, Option<(Ray, Color)>) -> L,
    next: impl Fn(&mut Block, Option<(Ray, RayState)>) -> N,
) -> (Color, L, N) {
    let geometry = make_geometry(row, make_shader(row.get(Geometries::MATERIAL)));
    let surf = geometry.surface_element.call(b, (ray, hit));
    let mat = geometry.shader.call(b, (ray, hit, surf));
    let emitted = tracer.on_hit.call(b, (ray, hit, state, surf, mat));
    let light = b.label(|b, light: Exit<L>| {
        let of = |b: &mut Block, ray| {
            let made = lit(b, ray);
            light.take(b, made)
        };
        let emit = Exit::exits(|b, ray: (Ray, Color)| of(b, Some(ray)));
        let skip = Exit::exits(|b, ()| of(b, None));
        tracer.on_shadow.take(b, (ray, hit, state, surf, mat, emit, skip))
    });
    let onwards = b.label(|b, onwards: Exit<N>| {
        let of = |b: &mut Block, ray| {
            let made = next(b, ray);
            onwards.take(b, made)
        };
        let bounce = Exit::exits(|b, ray: (Ray, RayState)| of(b, Some(ray)));
        let end = Exit::exits(|b, ()| of(b, None));
        tracer.on_bounce.take(b, (ray, hit, state, surf, mat, bounce, end))
    });
    (emitted, light, onwards)
}

/// End the path of row i, which has hit nothing.
pub(super) fn miss(b: &mut Block, tracer: Tracer, i: U32) {
    let path: U32 = b.load(Order::PATH, i);
    let (ray, state): (Ray, RayState) = b.load_record(Paths::ORG_X, path);
    let (sum, closest, shadow, number): Account = b.load_record(Paths::R, path);
    let sky = tracer.on_miss.call(b, (ray, state));
    let none = Bool::from(false);
    b.store_record(Next::R, i, (sum + sky, closest + 1u32, shadow, number, none, none));
}

/// Trace the shadow ray of each row of a range that has one.
fn shadow(b: &mut Block, range: (U32, U32)) {
    turns::trace(b, range, true, ask_blocked, answer_blocked);
}

/// Is the shadow ray of row i blocked?
pub(super) fn ask_blocked(b: &mut Block, i: U32) -> Question {
    let is_asked = b.load(Next::ASKED, i);
    let path: U32 = b.load(Order::PATH, i);
    let state: RayState = b.load_record(Paths::RNG_START, path);
    // The way to the light is another edge of the path than the one that led here, so cut-outs decide anew.
    let edge = RayState { vertex: state.vertex + 1u32, ..state };
    Question { is_asked, ray: b.load_record(Shadows::ORG_X, i), accept: make_accept(edge) }
}

/// By this, if it is a hit.
pub(super) fn answer_blocked(b: &mut Block, i: U32, hit: Hit) {
    let (_, contribution): (Ray, Color) = b.load_record(Shadows::ORG_X, i);
    let sum: Color = b.load_record(Next::R, i);
    b.store_record(Next::R, i, sum + hit.is_hit().select(black(), contribution));
}
