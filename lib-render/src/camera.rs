//! Cameras: where paths start.

use jerboa_ir::lang::{F32, Fun, Row, U32};

use crate::core::rng::Rng;
use crate::core::vec::vec3;
use crate::ray::Ray;
use crate::schema::{Frame, NONE};

/// (column, row of the pixel, rng at dimension 0 of vertex 0) → the ray through a point of the pixel's square, uniform
/// over it. Draws two numbers.
pub type CameraFn = Fun<(U32, U32, Rng), Ray>;

/// A pinhole camera. Through pixel (i, j) at (a, b) in [0, 1)², row 0 at the top, goes the direction
/// forward + (2 (i + a) / width − 1) right + (1 − 2 (j + b) / height) up, where `right` and `up` are scaled by the field
/// of view (`scenes/SEMANTICS.md`, 1). Everything it reads is bulk: moving never recompiles.
pub fn make_perspective_camera() -> CameraFn {
    CameraFn::lam(|_, (i, j, rng)| {
        let (a, rng) = rng.next();
        let (b, _) = rng.next();
        let frame = Row::<Frame>::at(0u32);
        let read = |x, y, z| vec3(frame.get(x), frame.get(y), frame.get(z));
        let right = read(Frame::RIGHT_X, Frame::RIGHT_Y, Frame::RIGHT_Z);
        let up = read(Frame::UP_X, Frame::UP_Y, Frame::UP_Z);
        let forward = read(Frame::FORWARD_X, Frame::FORWARD_Y, Frame::FORWARD_Z);
        let across = 2.0 * (i.to_f32() + a) / frame.get(Frame::WIDTH).to_f32() - 1.0;
        let down = 2.0 * (j.to_f32() + b) / frame.get(Frame::HEIGHT).to_f32() - 1.0;
        Ray {
            org: read(Frame::EYE_X, Frame::EYE_Y, Frame::EYE_Z),
            dir: (forward + right * across - up * down).normalize(),
            tmax: F32::from(f32::INFINITY),
            skip: NONE.into(),
            skip1: NONE.into(),
            skip2: NONE.into(),
        }
    })
}
