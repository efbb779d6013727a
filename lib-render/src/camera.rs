//! Cameras: where paths start. One file per kind.

use jerboa_ir::lang::{F32, Fun, Row, U32};

use crate::camera::fisheye::fisheye_ray;
use crate::camera::orthographic::orthographic_ray;
use crate::camera::pinhole::pinhole_ray;
use crate::camera::thin_lens::thin_lens_ray;
use crate::core::rng::Rng;
use crate::core::vec::{Vec3, vec3};
use crate::ray::Ray;
use crate::schema::{CAMERA_FISHEYE, CAMERA_ORTHOGRAPHIC, CAMERA_THIN, Frame, NONE, Settings};

pub mod fisheye;
pub mod orthographic;
pub mod pinhole;
pub mod thin_lens;

/// (column, row of the pixel, rng at dimension 0 of vertex 0) → the ray through a point of the pixel's square, uniform
/// over it. Draws two numbers together, and two more where there is a lens.
pub type CameraFn = Fun<(U32, U32, Rng), Ray>;

/// A camera and a point of its film. World.
///
/// A point (a, b) in [0, 1)² of pixel (i, j), row 0 at the top, lies at x = 2 (i + a) / width − 1 and
/// y = 1 − 2 (j + b) / height of the film: on it, at p = x right + y up, where `right` and `up` are scaled by the field of
/// view (`scenes/SEMANTICS.md`, 1).
#[derive(Clone, Copy)]
pub struct View {
    /// Where the camera is.
    pub eye: Vec3,
    /// Viewing direction, unit.
    pub forward: Vec3,
    /// See [`Frame::RIGHT_X`].
    pub right: Vec3,
    /// See [`Frame::UP_X`].
    pub up: Vec3,
    /// x right
    pub across: Vec3,
    /// −y up
    pub down: Vec3,
}

impl View {
    /// The camera of the frame, and the point of its film so many pixels from the left and from the top.
    fn new(column: F32, row: F32) -> View {
        let frame = Row::<Frame>::at(0u32);
        let read = |x, y, z| vec3(frame.get(x), frame.get(y), frame.get(z));
        let right = read(Frame::RIGHT_X, Frame::RIGHT_Y, Frame::RIGHT_Z);
        let up = read(Frame::UP_X, Frame::UP_Y, Frame::UP_Z);
        View {
            eye: read(Frame::EYE_X, Frame::EYE_Y, Frame::EYE_Z),
            forward: read(Frame::FORWARD_X, Frame::FORWARD_Y, Frame::FORWARD_Z),
            right,
            up,
            across: right * (2.0 * column / frame.get(Frame::WIDTH).to_f32() - 1.0),
            down: up * (2.0 * row / frame.get(Frame::HEIGHT).to_f32() - 1.0),
        }
    }

    /// forward + p
    pub fn ahead(self) -> Vec3 {
        self.forward + self.across - self.down
    }
}

/// The camera of the kind that [`Settings::CAMERA`] knows; of what it reads all else is bulk: moving never recompiles.
pub fn make_camera() -> CameraFn {
    CameraFn::lam(|b, (i, j, rng)| {
        let ([x, y], rng) = rng.pair();
        let view = View::new(i.to_f32() + x, j.to_f32() + y);
        let (org, dir) = b.switch(
            Row::<Settings>::at(0u32).get(Settings::CAMERA),
            &[
                (CAMERA_THIN, &|_| thin_lens_ray(view, rng)),
                (CAMERA_ORTHOGRAPHIC, &|_| orthographic_ray(view)),
                (CAMERA_FISHEYE, &|_| fisheye_ray(view)),
            ],
            |_| pinhole_ray(view),
        );
        Ray { org, dir, tmax: F32::from(f32::INFINITY), skip: NONE.into(), skip1: NONE.into(), skip2: NONE.into() }
    })
}
