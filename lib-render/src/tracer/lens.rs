//! The camera as paths from lights see it: a point that measures light.
//!
//! Let a point of the film be drawn uniformly. The directions that it is seen in have the density
//! p(ω) = 1 / (A cos³ θ) per steradian, where A is the area of the film on the plane at distance 1 from a pinhole and θ the
//! angle to the viewing direction. The mean radiance of the film is ∫ p(ω) L(ω) dω, so light that leaves a surface towards
//! the pinhole counts p(ω) |cos| / d² of it. Pixel by pixel: a renderer that draws as many paths from lights as its film has
//! pixels and adds that to the pixel the light comes through has each pixel's mean radiance as expectation.
//!
//! Source: Veach 1997, section 8.3.2 (importance emitted by a camera).

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Bool, F32, Row, U32};

use crate::core::color::{Color, white};
use crate::core::vec::{Vec3, vec3};
use crate::light::DirectLightSample;
use crate::schema::{Frame, NONE};

/// Light that arrives at the camera through a pixel.
#[derive(Clone, Copy)]
pub struct Splat {
    /// The pixel's number, row by row over the whole film.
    pub pixel: U32,
    /// What it adds to the sum of the pixel's samples.
    pub light: Color,
}
impl_staged!(Splat { pixel, light });

/// A pinhole and its film. (The host refuses cameras of other kinds to the tracers that ask for one.)
#[derive(Clone, Copy)]
pub struct Lens {
    eye: Vec3,
    right: Vec3,
    up: Vec3,
    forward: Vec3,
}

/// The pinhole as a point sees it.
#[derive(Clone, Copy)]
pub struct Seen {
    /// Does light from there fall on the film?
    pub is_seen: Bool,
    /// On this pixel.
    pub pixel: U32,
    /// Towards the pinhole, unit, world.
    pub wi: Vec3,
    /// Distance, m.
    pub distance: F32,
    /// p(ω) / d²: share of the film's mean radiance per square metre across the way, 1/m².
    pub importance: F32,
}

impl Lens {
    /// The camera of the frame.
    pub fn of_frame() -> Lens {
        let frame = Row::<Frame>::at(0u32);
        let read = |x, y, z| vec3(frame.get(x), frame.get(y), frame.get(z));
        Lens {
            eye: read(Frame::EYE_X, Frame::EYE_Y, Frame::EYE_Z),
            right: read(Frame::RIGHT_X, Frame::RIGHT_Y, Frame::RIGHT_Z),
            up: read(Frame::UP_X, Frame::UP_Y, Frame::UP_Z),
            forward: read(Frame::FORWARD_X, Frame::FORWARD_Y, Frame::FORWARD_Z),
        }
    }

    /// Density with which a uniform point of the film is seen in a direction from the pinhole (unit), per steradian.
    pub fn density(self, dir: Vec3) -> F32 {
        let area = 4.0 * self.right.length() * self.up.length();
        let cos = self.forward.dot(dir);
        1.0 / (area * cos * cos * cos)
    }

    /// The pinhole from a point.
    pub fn seen_from(self, point: Vec3) -> Seen {
        let frame = Row::<Frame>::at(0u32);
        let (width, height) = (frame.get(Frame::WIDTH), frame.get(Frame::HEIGHT));
        let to = self.eye - point;
        let distance = to.length();
        let wi = to / distance;
        let depth = -self.forward.dot(to);
        let across = |axis: Vec3| -axis.dot(to) / (axis.length2() * depth);
        let x = (across(self.right) + 1.0) * 0.5 * width.to_f32();
        let y = (1.0 - across(self.up)) * 0.5 * height.to_f32();
        let within = |x: F32, n: U32| x.ge(0.0) & x.lt(n.to_f32());
        let is_seen = depth.gt(0.0) & within(x, width) & within(y, height);
        let pixel = y.to_u32() * width + x.to_u32();
        Seen { is_seen, pixel, wi, distance, importance: self.density(-wi) / (distance * distance) }
    }

    /// The pinhole as a light, where a shadow ray to it can end.
    pub fn as_light(self, seen: Seen) -> DirectLightSample {
        DirectLightSample {
            wi: seen.wi,
            pos: self.eye,
            distance: seen.distance,
            intensity: white(),
            pdf_dir: 1.0.into(),
            is_delta: true.into(),
            primitive: NONE.into(),
            primitive1: NONE.into(),
        }
    }
}
