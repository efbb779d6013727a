//! Pinhole cameras.

use glam::{DAffine3, DVec3};

/// A pinhole camera: glTF's perspective camera. Looks along its local −Z with +Y up. The near and far planes are ignored.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// The author's name; what the command line's `--camera` picks.
    pub name: String,
    /// Camera to world. Only the origin and the directions of the axes matter; the accessors below return those.
    pub to_world: DAffine3,
    /// Full vertical angle of view, radians, in (0, π).
    pub yfov: f64,
    /// Width by height of the film. `None`: the film decides.
    pub aspect: Option<f64>,
    /// Film size in pixels, from the camera's `extras.width` and `extras.height`.
    pub film: Option<(u32, u32)>,
}

impl Camera {
    /// The pinhole, world frame.
    pub fn position(&self) -> DVec3 {
        self.to_world.translation
    }

    /// Unit vector to the right of the film, world frame.
    pub fn right(&self) -> DVec3 {
        self.to_world.matrix3.x_axis.normalize()
    }

    /// Unit vector to the top of the film, world frame.
    pub fn up(&self) -> DVec3 {
        self.to_world.matrix3.y_axis.normalize()
    }

    /// Unit vector into the scene, world frame.
    pub fn forward(&self) -> DVec3 {
        -self.to_world.matrix3.z_axis.normalize()
    }

    /// Width and height in pixels: the camera's own film, else 1280 wide with the camera's aspect (else 16:9).
    pub fn film_or_default(&self) -> (u32, u32) {
        self.film.unwrap_or_else(|| {
            let aspect = self.aspect.unwrap_or(16.0 / 9.0);
            (1280, (1280.0 / aspect).round().clamp(1.0, 65536.0) as u32)
        })
    }

    /// A camera at `eye` that looks at `target`, +Y up (+Z where it looks along Y).
    pub fn look_at(name: &str, eye: DVec3, target: DVec3, yfov: f64) -> Self {
        let back = (eye - target).normalize();
        let up = if back.cross(DVec3::Y).length() > 1e-6 { DVec3::Y } else { DVec3::Z };
        let right = up.cross(back).normalize();
        let to_world = DAffine3::from_cols(right, back.cross(right), back, eye);
        Camera { name: name.into(), to_world, yfov, aspect: None, film: None }
    }
}
