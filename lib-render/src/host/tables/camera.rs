//! Kinds of cameras: what a kernel is specialised for.

use jerboa_scenes::{Camera, Lens, Scene};

use crate::host::error::Error;
use crate::schema::{CAMERA_FISHEYE, CAMERA_ORTHOGRAPHIC, CAMERA_PINHOLE, CAMERA_THIN};

/// The kind of a camera's [`Lens`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CameraKind {
    /// All rays through one point.
    Pinhole,
    /// Through a disk.
    Thin,
    /// Parallel rays.
    Orthographic,
    /// Angles as the distance from the film's centre.
    Fisheye,
}

impl CameraKind {
    /// The kind of a camera.
    pub fn of(camera: &Camera) -> CameraKind {
        match camera.lens {
            Lens::Pinhole { .. } => CameraKind::Pinhole,
            Lens::Thin { .. } => CameraKind::Thin,
            Lens::Orthographic { .. } => CameraKind::Orthographic,
            Lens::Fisheye { .. } => CameraKind::Fisheye,
        }
    }

    /// The kind of a scene's first camera; a pinhole where there is none.
    pub fn of_scene(scene: &Scene) -> CameraKind {
        scene.cameras.first().map_or(CameraKind::Pinhole, CameraKind::of)
    }

    /// The number by which kernels know it.
    pub fn row(self) -> u32 {
        match self {
            CameraKind::Pinhole => CAMERA_PINHOLE,
            CameraKind::Thin => CAMERA_THIN,
            CameraKind::Orthographic => CAMERA_ORTHOGRAPHIC,
            CameraKind::Fisheye => CAMERA_FISHEYE,
        }
    }

    /// Refuse a camera of another kind.
    pub fn check(self, camera: &Camera) -> Result<(), Error> {
        let kind = CameraKind::of(camera);
        if kind == self {
            return Ok(());
        }
        Err(Error::new(format!(
            "camera \"{}\": its kind is {kind:?}, but the renderer is specialised for {self:?}; make one with \
             choices.camera = Some(CameraKind::{kind:?})",
            camera.name
        )))
    }
}
