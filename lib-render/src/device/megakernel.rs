//! The megakernel GPU device, IR half: one kernel that follows the paths of a pixel (paper, section 4.7).
//!
//! Invocation i traces all samples that a pass asks for of a pixel, one path after the other, and leaves their exact sum in
//! row i of [`crate::schema::Pixels`]; what is not done in one launch goes on in the next. A driver's compiler takes more than
//! twice as long for twice the code, so there is one place where rays are traced: each turn of the loop traces the ray at
//! hand, of a path or of a shadow, and what follows decides on the next one. What is hit is told apart by the evaluator's
//! switch over classes of geometry.
//!
//! A path adds the very numbers that the scalar device ([`super::cpu`]) adds, in its order, so both give the same bits.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, Exit, Fun, Left, Row, U32, entry};

use crate::core::color::{Color, black};
use crate::cutout::make_accept;
use crate::device::Device;
use crate::device::cpu::item;
use crate::device::pixel::PixelSum;
use crate::device::stream::{kernel_name, vertex};
use crate::geometry::triangle::Triangle;
use crate::ray::{Hit, Ray};
use crate::schema::{Frame, Paths};
use crate::tracer::{RayState, Tracer};
use crate::traverse::memory::Memory;
use crate::traverse::{Tests, traverse_here};

/// A device that traces and shades in one kernel.
pub fn make_megakernel_device() -> Device {
    Device { trace }
}

/// What is under way: a path, and the ray at hand.
#[derive(Clone, Copy)]
struct Turn {
    /// The ray to trace now.
    ray: Ray,
    /// Is it a shadow ray?
    is_shadow: Bool,
    /// The vertex it leads to, as cut-outs count.
    vertex: U32,
    /// What it carries, if it is a shadow ray that nothing blocks.
    light: Color,
    /// Does the path go on after that?
    goes_on: Bool,
    /// With this ray.
    next: Ray,
    /// And this state.
    state: RayState,
    sum: Color,
    closest: U32,
    shadow: U32,
    /// Number of the sample within the pass.
    sample: U32,
}
impl_staged!(Turn { ray, is_shadow, vertex, light, goes_on, next, state, sum, closest, shadow, sample });

/// Vertices of a path, or of some, in one launch. A driver's watchdog ends a launch after two seconds; and Mesa's lavapipe
/// leaves every loop of an invocation after 65,535 rounds in all, which is a walk of 1,000 steps for each of twice as many rays.
const VERTICES: u32 = 32;

/// Declare the kernel of a tracer: `count` pixels of the window from number `first` on. A launch begins if `fresh` is 1, else
/// it goes on where the last one ended. A pixel is done when its sum has all samples.
fn trace(name: &str, tracer: Tracer) {
    let name = kernel_name(name, "megakernel");
    entry(
        &name,
        Fun::<(U32, U32, U32, U32), ()>::named(&name, |b, (i, count, first, fresh)| {
            b.when(i.lt(count), |b| {
                let pixel_at = (first + i) * samples();
                b.when(fresh.ne(0), |b| {
                    PixelSum::zero().store(b, i);
                    let turn = start(b, tracer, pixel_at, 0.into());
                    leave(b, i, turn);
                });
                let sum = PixelSum::load(b, i);
                b.when((sum.count + sum.dropped).lt(samples()), |b| go_on_with(b, tracer, i, pixel_at));
            });
        }),
    );
}

/// Samples of a pixel in this pass.
fn samples() -> U32 {
    Row::<Frame>::at(0u32).get(Frame::SAMPLES)
}

/// Leave a path for the next launch. Its ray is no shadow ray.
fn leave(b: &mut Block, i: U32, turn: Turn) {
    b.store_record(Paths::ORG_X, i, (turn.ray, turn.state));
    b.store_record(Paths::R, i, (turn.sum, turn.closest, turn.shadow, turn.sample));
}

/// The path that was left.
fn left(b: &mut Block, i: U32) -> Turn {
    let (ray, state): (Ray, RayState) = b.load_record(Paths::ORG_X, i);
    let (sum, closest, shadow, sample): (Color, U32, U32, U32) = b.load_record(Paths::R, i);
    Turn { sum, closest, shadow, ..first_turn(ray, state, sample) }
}

/// Go on with the samples of a pixel, whose first item is `at`; they are summed in row i.
fn go_on_with(b: &mut Block, tracer: Tracer, i: U32, at: U32) {
    let memory = Memory::new(b, 1);
    let turn = left(b, i);
    b.loop_((turn, U32::from(0)), |b, (turn, vertices), next, done| {
        b.when(vertices.ge(VERTICES) & !turn.is_shadow, |b| {
            leave(b, i, turn);
            done.take(b, ())
        });
        let vertices = vertices + Bool::bits(!turn.is_shadow);
        let edge = RayState { vertex: turn.vertex, ..turn.state };
        let hit = traverse_here(b, Tests::default(), memory, (turn.ray, turn.is_shadow, make_accept(edge)));
        let turn = b.label(|b, then: Exit<Turn>| {
            let answered = |b: &mut Block| {
                let light = hit.is_hit().select(black(), turn.light);
                then.take(b, go_on(Turn { sum: turn.sum + light, ..turn }))
            };
            let found = |b: &mut Block| {
                let turn = Turn { closest: turn.closest + 1u32, ..turn };
                let miss = |b: &mut Block| {
                    let sky = tracer.on_miss.call(b, (turn.ray, turn.state));
                    then.take(b, Turn { sum: turn.sum + sky, goes_on: false.into(), ..turn })
                };
                b.branch(hit.is_hit(), |b| shade(b, tracer, hit, turn, then), miss)
            };
            b.branch(turn.is_shadow, answered, found)
        });
        let ended = |b: &mut Block| {
            let sum = PixelSum::load(b, i).with(turn.sum, turn.closest, turn.shadow);
            sum.store(b, i);
            let sample = turn.sample + 1u32;
            b.when(sample.eq(samples()), |b| done.take(b, ()));
            let turn = start(b, tracer, at + sample, sample);
            next.take(b, (turn, vertices))
        };
        b.branch(turn.is_shadow | turn.goes_on, |b| next.take(b, (turn, vertices)), ended)
    })
}

/// The first turn of a path: that of an item of the pass.
fn start(b: &mut Block, tracer: Tracer, at: U32, sample: U32) -> Turn {
    let (x, y, number) = item(at);
    let (ray, state) = tracer.on_emit.call(b, (x, y, number));
    first_turn(ray, state, sample)
}

/// The first turn of a path that begins with this ray.
fn first_turn(ray: Ray, state: RayState, sample: U32) -> Turn {
    Turn {
        ray,
        is_shadow: false.into(),
        vertex: state.vertex,
        light: black(),
        goes_on: true.into(),
        next: ray,
        state,
        sum: black(),
        closest: 0.into(),
        shadow: 0.into(),
        sample,
    }
}

/// One vertex of the path: the shadow ray is next, or the path goes on, or ends.
fn shade(b: &mut Block, tracer: Tracer, hit: Hit, turn: Turn, then: Exit<Turn>) -> Left {
    let geometry = Triangle::of(b, hit).geometry();
    let Turn { ray, state, .. } = turn;
    b.dispatch_left(geometry, |b, row| {
        let lit = |_: &mut Block, lit: Option<(Ray, Color)>| {
            let (ray, light) = lit.unwrap_or((ray, black()));
            (Bool::from(lit.is_some()), ray, light)
        };
        let next = |_: &mut Block, next: Option<(Ray, RayState)>| {
            let (ray, state) = next.unwrap_or((ray, state));
            (Bool::from(next.is_some()), ray, state)
        };
        let (emitted, (asked, shadow_ray, light), (goes_on, next, after)) =
            vertex(b, tracer, row, (ray, hit, state), lit, next);
        let turn = Turn { goes_on, next, state: after, sum: turn.sum + emitted, ..turn };
        // The way to the light is another edge of the path than the one that led here, so cut-outs decide anew.
        let shadow = Turn {
            ray: shadow_ray,
            is_shadow: true.into(),
            vertex: state.vertex + 1u32,
            light,
            shadow: turn.shadow + 1u32,
            ..turn
        };
        let turn = asked.select(shadow, go_on(Turn { sum: turn.sum + black(), ..turn }));
        then.take(b, turn)
    })
}

/// The turn after this one, if the path goes on.
fn go_on(turn: Turn) -> Turn {
    Turn { ray: turn.next, is_shadow: false.into(), vertex: turn.state.vertex, ..turn }
}
