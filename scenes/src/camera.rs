//! Cameras, and what bends the light in them.

use glam::{DAffine3, DVec3};

/// How points of the film become rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// All through one point, the pinhole: glTF's perspective camera.
    Pinhole {
        /// Full vertical angle of view, radians, in (0, π).
        yfov: f64,
    },
    /// A pinhole that is not a point: what is not at one distance is out of focus. The image of a point at depth z, on the
    /// plane in focus at depth f, is a disk of diameter `aperture` · |z − f| / z.
    Thin {
        /// Full vertical angle of view, radians, in (0, π).
        yfov: f64,
        /// Diameter of the lens, in units of the scene; above 0.
        aperture: f64,
        /// Depth of the plane in focus, along the viewing direction, in units of the scene; above 0.
        focus: f64,
    },
    /// All in parallel: glTF's orthographic camera.
    Orthographic {
        /// Half the height of what is seen, in units of the scene; above 0.
        ymag: f64,
    },
    /// Equidistant: the angle from the viewing direction grows as the distance from the film's centre. Of angles beyond π
    /// there are none: pixels out there look straight back.
    Fisheye {
        /// Angle between what the middles of the film's upper and lower edges see, radians, in (0, 2π].
        angle: f64,
    },
}

/// A camera. Looks along its local −Z with +Y up. The near and far planes are ignored.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// The author's name; what the command line's `--camera` picks.
    pub name: String,
    /// Camera to world. Only the origin and the directions of the axes matter; the accessors below return those.
    pub to_world: DAffine3,
    /// How points of the film become rays.
    pub lens: Lens,
    /// Width by height of the film. `None`: the film decides.
    pub aspect: Option<f64>,
    /// Film size in pixels, from the camera's `extras.width` and `extras.height`.
    pub film: Option<(u32, u32)>,
}

impl Camera {
    /// The pinhole, or the middle of the lens or of what is seen, world frame.
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

    /// Half the film's height: on the plane at distance 1 in front of a pinhole or a thin lens (tan yfov/2), in units of the
    /// scene (orthographic), as an angle in radians (fisheye).
    pub fn half_height(&self) -> f64 {
        match self.lens {
            Lens::Pinhole { yfov } | Lens::Thin { yfov, .. } => (yfov / 2.0).tan(),
            Lens::Orthographic { ymag } => ymag,
            Lens::Fisheye { angle } => angle / 2.0,
        }
    }

    /// The same camera with a lens of this diameter (0: a pinhole) in focus at this depth, both in units of the scene; what is
    /// not given stays. Nothing where the camera has no perspective, where a number is not finite or out of range, or where
    /// a lens has no depth to be in focus at.
    pub fn with_lens(&self, aperture: Option<f64>, focus: Option<f64>) -> Option<Camera> {
        let (yfov, old, depth) = match self.lens {
            Lens::Pinhole { yfov } => (yfov, 0.0, None),
            Lens::Thin { yfov, aperture, focus } => (yfov, aperture, Some(focus)),
            Lens::Orthographic { .. } | Lens::Fisheye { .. } => return None,
        };
        let usable = |x: &f64| (*x as f32) > 0.0 && (*x as f32).is_finite();
        let lens = match aperture.unwrap_or(old) {
            0.0 => Lens::Pinhole { yfov },
            aperture => {
                Lens::Thin { yfov, aperture: Some(aperture).filter(usable)?, focus: focus.or(depth).filter(usable)? }
            }
        };
        Some(Camera { lens, ..self.clone() })
    }

    /// Width and height in pixels: the camera's own film, else 1280 wide with the camera's aspect (else 16:9).
    pub fn film_or_default(&self) -> (u32, u32) {
        self.film.unwrap_or_else(|| {
            let aspect = self.aspect.unwrap_or(16.0 / 9.0);
            (1280, (1280.0 / aspect).round().clamp(1.0, 65536.0) as u32)
        })
    }

    /// A pinhole camera at `eye` that looks at `target`, +Y up (+Z where it looks along Y).
    pub fn look_at(name: &str, eye: DVec3, target: DVec3, yfov: f64) -> Self {
        let back = (eye - target).normalize();
        let up = if back.cross(DVec3::Y).length() > 1e-6 { DVec3::Y } else { DVec3::Z };
        let right = up.cross(back).normalize();
        let to_world = DAffine3::from_cols(right, back.cross(right), back, eye);
        Camera { name: name.into(), to_world, lens: Lens::Pinhole { yfov }, aspect: None, film: None }
    }
}
