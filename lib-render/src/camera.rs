//! Cameras: where paths start.

use jerboa_ir::lang::{Block, F32, Fun, Row, U32};

use crate::core::math::sincos;
use crate::core::rng::Rng;
use crate::core::sampling::concentric_disk;
use crate::core::vec::{Vec3, vec2, vec3};
use crate::ray::Ray;
use crate::schema::{CAMERA_FISHEYE, CAMERA_ORTHOGRAPHIC, CAMERA_THIN, Frame, NONE, Settings};

/// (column, row of the pixel, rng at dimension 0 of vertex 0) → the ray through a point of the pixel's square, uniform
/// over it. Draws two numbers together, and two more where there is a lens.
pub type CameraFn = Fun<(U32, U32, Rng), Ray>;

/// The camera of the kind that [`Settings::CAMERA`] knows; of what it reads all else is bulk: moving never recompiles.
///
/// A point (a, b) in [0, 1)² of pixel (i, j), row 0 at the top, lies at x = 2 (i + a) / width − 1 and
/// y = 1 − 2 (j + b) / height of the film: on it, at p = x right + y up, where `right` and `up` are scaled by the field of
/// view (`scenes/SEMANTICS.md`, 1). The ray there:
///
/// - pinhole: from the eye along forward + p;
/// - thin lens: from a point of the lens, uniform over its disk, to eye + focus · (forward + p) (Cook, Porter & Carpenter
///   1984, 4);
/// - orthographic: from eye + p along forward;
/// - fisheye: at the angle θ = |p| from forward towards p, at most π.
pub fn make_camera() -> CameraFn {
    CameraFn::lam(|b, (i, j, rng)| {
        let ([x, y], rng) = rng.pair();
        let frame = Row::<Frame>::at(0u32);
        let read = |x, y, z| vec3(frame.get(x), frame.get(y), frame.get(z));
        let right = read(Frame::RIGHT_X, Frame::RIGHT_Y, Frame::RIGHT_Z);
        let up = read(Frame::UP_X, Frame::UP_Y, Frame::UP_Z);
        let forward = read(Frame::FORWARD_X, Frame::FORWARD_Y, Frame::FORWARD_Z);
        let eye = read(Frame::EYE_X, Frame::EYE_Y, Frame::EYE_Z);
        let across = 2.0 * (i.to_f32() + x) / frame.get(Frame::WIDTH).to_f32() - 1.0;
        let down = 2.0 * (j.to_f32() + y) / frame.get(Frame::HEIGHT).to_f32() - 1.0;
        let pinhole = |_: &mut Block| (eye, (forward + right * across - up * down).normalize());
        let thin = |_: &mut Block| {
            let ([u, v], _) = rng.pair();
            let disk = concentric_disk(vec2(u, v));
            let lens = right * (disk.x * frame.get(Frame::LENS_RIGHT)) + up * (disk.y * frame.get(Frame::LENS_UP));
            let sharp = (forward + right * across - up * down) * frame.get(Frame::FOCUS);
            (eye + lens, (sharp - lens).normalize())
        };
        let orthographic = |_: &mut Block| (eye + right * across - up * down, forward);
        let fisheye = |_: &mut Block| (eye, bent(forward, right * across - up * down));
        let (org, dir) = b.switch(
            Row::<Settings>::at(0u32).get(Settings::CAMERA),
            &[(CAMERA_THIN, &thin), (CAMERA_ORTHOGRAPHIC, &orthographic), (CAMERA_FISHEYE, &fisheye)],
            pinhole,
        );
        Ray { org, dir, tmax: F32::from(f32::INFINITY), skip: NONE.into(), skip1: NONE.into(), skip2: NONE.into() }
    })
}

/// The direction at the angle |p| from `forward` towards p, which is across it.
fn bent(forward: Vec3, p: Vec3) -> Vec3 {
    let length = p.length();
    let (sin, cos) = sincos(length.min(std::f32::consts::PI));
    // sin θ / θ → 1.
    let share = length.gt(0.0).select(sin / length, 1.0.into());
    forward * cos + p * share
}
